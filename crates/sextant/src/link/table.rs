//! A link as a table.

use std::fmt::{self, Display, Formatter};

use sextant_kernel::text::listed;

use super::rays;
use super::report::{Direction, LinkReport, PathReport, ReceptionReport};

/// Width of the names of the items, and of a column of numbers.
const ITEM: usize = 34;
const COLUMN: usize = 22;

impl Display for LinkReport {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let [a, b] = &self.ends;
        let network = self.network.as_ref().map(|name| format!(", network {name}")).unwrap_or_default();
        writeln!(f, "link {} - {} in {} (seed {}){network}", a.name, b.name, self.scenario, self.seed)?;
        writeln!(f)?;
        for end in &self.ends {
            let [x, y, z] = end.position_m;
            writeln!(f, "{:<12} ({x:.2}, {y:.2}, {z:.2}) m: {}", end.name, end.kind)?;
        }
        writeln!(f, "{:<12} {:.3} m", "distance", self.distance_m)?;
        writeln!(f)?;
        let (Some(path), Some(directions)) = (&self.path, &self.directions) else {
            let range_m = self.max_range_m.unwrap_or(f64::INFINITY);
            return writeln!(f, "no link: the radius of communication is {range_m} m (`channel.max_range_m`)");
        };
        // One column says all if both directions are alike.
        let [forth, back] = directions;
        let are_alike = Direction { from: forth.from.clone(), to: forth.to.clone(), ..back.clone() } == *forth;
        let shown: &[Direction] = if are_alike { std::slice::from_ref(forth) } else { directions };
        let header = |direction: &Direction| match are_alike {
            true => "both directions".to_owned(),
            false => format!("{} to {}", direction.from, direction.to),
        };
        row(f, "", shown.iter().map(header))?;
        let dbm = |value: f64| format!("{value:.2} dBm");
        row(f, "transmit power", shown.iter().map(|direction| dbm(direction.tx_power_dbm)))?;
        let has_antennas = |direction: &Direction| {
            direction.sector.is_some() || direction.transmit_gain_db.abs() + direction.receive_gain_db.abs() > 0.0
        };
        let has_antennas = shown.iter().any(has_antennas);
        if has_antennas {
            let sector = |direction: &Direction| match direction.sector {
                Some(sector) => format!("sector {sector} {}", gain(direction.transmit_gain_db)),
                None => gain(direction.transmit_gain_db),
            };
            row(f, "antenna of the sender, best sector", shown.iter().map(sector))?;
        }
        self.write_path(f, path, shown.len())?;
        if has_antennas {
            row(f, "antenna of the receiver", shown.iter().map(|direction| gain(direction.receive_gain_db)))?;
        }
        if shown.iter().any(|direction| direction.measured.is_some()) {
            let text = |direction: &Direction| direction.measured.map_or("no row".to_owned(), |it| it.text());
            row(f, "measured instead", shown.iter().map(text))?;
        }
        let or_none =
            |value: Option<f64>, unit: &str| value.map_or("nothing".to_owned(), |v| format!("{v:.2} {unit}"));
        row(f, "power at the receiver", shown.iter().map(|direction| or_none(direction.received_dbm, "dBm")))?;
        writeln!(f)?;
        let receptions: Vec<&ReceptionReport> = shown.iter().map(|direction| &direction.reception).collect();
        let all =
            |text: &dyn Fn(&ReceptionReport) -> String| receptions.iter().map(|it| text(it)).collect::<Vec<_>>();
        row(f, "sensitivity", all(&|it| dbm(it.sensitivity_dbm)))?;
        row(f, "noise", all(&|it| dbm(it.noise_floor_dbm)))?;
        row(f, "signal to noise", all(&|it| or_none(it.snr_db, "dB")))?;
        row(f, "least power to be received", all(&|it| dbm(it.least_power_dbm)))?;
        row(f, "margin above it", all(&|it| or_none(it.margin_db, "dB")))?;
        let octets = receptions.first().map_or(0, |it| it.frame_octets);
        row(f, &format!("received, of {octets} octets"), all(&|it| share(it.probability)))?;
        let drawn = [
            (self.shadowing.sigma_db > 0.0, "shadowing"),
            (self.fading.is_some(), "fading"),
            (self.bursts.is_some(), "bursts"),
        ];
        let drawn: Vec<_> = drawn.into_iter().filter(|(is_drawn, _)| *is_drawn).map(|(_, name)| name).collect();
        if !drawn.is_empty() {
            let name = if drawn.len() == 1 {
                format!(".. over all draws of {}", drawn[0])
            } else {
                format!(".. over {}", listed(&drawn))
            };
            row(f, &name, all(&|it| share(it.probability_over_shadowing)))?;
        }
        row(f, "channel is busy from", all(&|it| dbm(it.busy_from_dbm)))?;
        row(f, "receiver finds it busy", all(&|it| if it.is_busy { "yes" } else { "no" }.to_owned()))?;
        writeln!(f)?;
        if let Some(rays) = self.rays.as_ref().filter(|rays| rays.len() > 1) {
            rays::write_table(f, rays, self.field_gain_db)?;
        }
        self.write_notes(f, path, &receptions)
    }
}

impl LinkReport {
    /// The losses on the way, which are the same in both directions.
    fn write_path(&self, f: &mut Formatter<'_>, path: &PathReport, columns: usize) -> fmt::Result {
        let same = |value: String| std::iter::repeat_n(value, columns);
        let reference = format!("loss over the first {} m", path.reference_distance_m);
        row(f, &reference, same(gain(-path.reference_loss_db)))?;
        row(f, &format!("distance, exponent {}", path.exponent), same(gain(-path.distance_loss_db)))?;
        if let Some(loss_db) = path.gas_loss_db {
            row(f, "gases of the air", same(gain(-loss_db)))?;
        }
        for crossed in &path.obstacles {
            let name = crossed.name.clone().unwrap_or_else(|| format!("obstacle {}", crossed.obstacle));
            let loss = crossed.loss_db.map_or("nothing gets through".to_owned(), |loss_db| gain(-loss_db));
            let inside = crossed.material.map_or("inside".to_owned(), |material| format!("of {material}"));
            row(f, &format!("{name}, {:.2} m {inside}", crossed.length_m), same(loss))?;
        }
        let count = path.reflections_loss_db.as_ref().map_or(0, Vec::len);
        let reflections = sextant_kernel::text::counted(count, "reflection");
        if let Some(gain_db) = path.reflection_gain_db {
            row(f, &reflections, same(gain(gain_db)))?;
        }
        if let Some(gain_db) = path.reflections_alone_db {
            row(f, &format!("instead of all losses: {reflections}"), same(gain(gain_db)))?;
        }
        if let Some(draw_db) = self.shadowing.draw_db {
            row(f, "shadowing of this link", same(gain(draw_db)))?;
        }
        if let Some(draw_db) = self.fading.as_ref().and_then(|fading| fading.draw_db) {
            row(f, "fading of this link", same(gain(draw_db)))?;
        }
        Ok(())
    }

    /// What the numbers do not say.
    fn write_notes(&self, f: &mut Formatter<'_>, path: &PathReport, receptions: &[&ReceptionReport]) -> fmt::Result {
        let sigma_db = self.shadowing.sigma_db;
        if sigma_db > 0.0 && self.shadowing.draw_db.is_none() {
            writeln!(
                f,
                "Each packet has its own shadowing, with a standard deviation of {sigma_db} dB: the power is the mean."
            )?;
        } else if sigma_db > 0.0 {
            writeln!(
                f,
                "The shadowing of this link is drawn with a standard deviation of {sigma_db} dB; another seed has another one."
            )?;
        }
        if let Some(fading) = &self.fading {
            fading.write_notes(f)?;
        }
        if let Some(bursts) = &self.bursts {
            bursts.write_notes(f)?;
        }
        if let Some(loss) = self.message_loss {
            writeln!(
                f,
                "Receivers lose a further {} of the frames (`faults.message_loss`); it counts above.",
                share(loss)
            )?;
        }
        if !path.obstacles_attenuate {
            writeln!(f, "Obstacles do not absorb power in this channel (`obstacles_attenuate = false`).")?;
        }
        if let Some(rays) = path.reflections_loss_db.as_ref().filter(|rays| !rays.is_empty()) {
            let losses: Vec<String> = rays.iter().map(|loss_db| format!("{loss_db:.2}")).collect();
            writeln!(f, "The reflections lose {} dB on their ways.", losses.join(", "))?;
        }
        let rules = receptions.iter().map(|it| (it.rule, it.threshold_db));
        let Some((rule, threshold_db)) = rules.into_iter().next() else { return Ok(()) };
        let threshold_db = threshold_db.unwrap_or_default();
        match rule {
            "overlap" => writeln!(f, "Two frames above the sensitivity that overlap destroy each other."),
            "sinr_threshold" => writeln!(
                f,
                "A frame survives others as long as it is {threshold_db:.2} dB above noise and interference together."
            ),
            "sir_threshold" => {
                writeln!(f, "A frame survives others as long as it is {threshold_db:.2} dB above the interference.")
            }
            _ => writeln!(f, "Noise and interference cause bit errors; a frame with a wrong bit is lost."),
        }?;
        writeln!(f, "The probabilities are those without interference.")
    }
}

fn row(f: &mut Formatter<'_>, item: &str, values: impl IntoIterator<Item = String>) -> fmt::Result {
    write!(f, "{item:<ITEM$}")?;
    for value in values {
        write!(f, " {value:>COLUMN$}")?;
    }
    writeln!(f)
}

/// A gain or, if negative, a loss.
fn gain(db: f64) -> String {
    format!("{db:+.2} dB")
}

/// A probability in percent.
fn share(probability: f64) -> String {
    format!("{:.1} %", 100.0 * probability)
}
