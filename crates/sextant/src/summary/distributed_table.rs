//! How nodes computed a map, as printed lines.

use std::io::{self, Write};

use super::distributed::DistributedSummary;
use super::map::MapSummary;
use sextant_kernel::text::{counted, listed};

/// Writes how nodes computed each of `maps` that they computed; `interrupted` tells whether the user ended that.
pub(super) fn write(maps: &[MapSummary], interrupted: bool, out: &mut impl Write) -> io::Result<()> {
    for map in maps {
        let Some(work) = &map.distributed else { continue };
        let name = map.name.as_ref().unwrap_or(&map.algorithm);
        if work.converged {
            writeln!(out, "{name}: converged in {}", counted(work.iterations as usize, "iteration"))?;
        } else {
            writeln!(out, "{name}: warning: {}", work.unsettled(interrupted))?;
        }
        writeln!(out, "{name}: {}", anchors(work))?;
        if let Some(mobile) = &work.mobile {
            writeln!(
                out,
                "{name}: {:.1} % of the nodes heard mobile anchors, at {:.1} of {} on average",
                100.0 * mobile.heard_share,
                mobile.stops_heard_mean,
                counted(mobile.stops, "stop")
            )?;
        }
        let (messages, energy, memory) = (&work.messages, &work.radio_energy_j, &work.memory_octets);
        writeln!(
            out,
            "{name}: of a node on average {:.1} messages, {:.1} frames received, {} of radio energy, {} of memory",
            messages.mean_per_node,
            work.frames_received_mean,
            joules(energy.mean),
            octets(memory.mean)
        )?;
        if !work.unplaced.is_empty() {
            let unplaced = counted(work.unplaced.len(), "node");
            writeln!(out, "{name}: warning: {unplaced} without a place: {}", listed(&work.unplaced))?;
        }
    }
    Ok(())
}

fn anchors(work: &DistributedSummary) -> String {
    let mut words = format!("{}, then {} more", counted(work.anchors.initial, "anchor"), work.anchors.new);
    if work.anchors.gave_up > 0 {
        words += &format!(", {} gave up their place", work.anchors.gave_up);
    }
    if let Some(error) = &work.orientation_error_deg {
        words += &format!(", azimuths off by {:.1} degrees on average", error.mean);
    }
    match work.anchors.without_directions {
        None | Some(0) => {}
        Some(without) => words += &format!(", {without} without directions"),
    }
    words
}

/// An energy, in a unit in which it is not small.
fn joules(energy_j: f64) -> String {
    if energy_j < 1.0 { format!("{:.2} mJ", 1000.0 * energy_j) } else { format!("{energy_j:.2} J") }
}

/// A size, in a unit in which it is not large.
fn octets(octets: f64) -> String {
    if octets < 10_000.0 { format!("{octets:.0} octets") } else { format!("{:.0} kB", octets / 1000.0) }
}

#[cfg(test)]
mod tests {
    use super::super::distributed::{AnchorCounts, MeanAndMax, MessagesSummary, MobileAnchorsSummary};
    use super::*;

    #[test]
    fn a_map_that_did_not_converge_says_so() {
        let work = DistributedSummary {
            iterations: 10,
            bad: 1,
            unplaced: (0..12).map(|node| format!("n{node}")).collect(),
            anchors: AnchorCounts { initial: 5, gave_up: 1, new: 7, without_directions: Some(2) },
            messages: MessagesSummary { mean_per_node: 3.25, ..MessagesSummary::default() },
            mobile: Some(MobileAnchorsSummary { heard_share: 0.6, stops: 40, ..MobileAnchorsSummary::default() }),
            memory_octets: MeanAndMax { mean: 12_345.0, max: 20_000.0 },
            radio_energy_j: MeanAndMax { mean: 0.0125, max: 0.02 },
            frames_received_mean: 80.0,
            ..DistributedSummary::default()
        };
        let of = |work| MapSummary { algorithm: "dmmtm-hs".into(), distributed: Some(work), ..MapSummary::default() };
        let text = |work, interrupted| {
            let mut out = Vec::new();
            write(&[of(work), MapSummary::default()], interrupted, &mut out).unwrap();
            String::from_utf8(out).unwrap()
        };
        insta::assert_snapshot!(text(work.clone(), false), @r"
        dmmtm-hs: warning: did not converge: 1 node with bad coordinates and 12 nodes without a place at the end; more anchors near them, or more iterations, may give them one
        dmmtm-hs: 5 anchors, then 7 more, 1 gave up their place, 2 without directions
        dmmtm-hs: 60.0 % of the nodes heard mobile anchors, at 0.0 of 40 stops on average
        dmmtm-hs: of a node on average 3.2 messages, 80.0 frames received, 12.50 mJ of radio energy, 12 kB of memory
        dmmtm-hs: warning: 12 nodes without a place: n0, n1, n2, n3, n4, n5, n6, n7, n8, n9 and 2 more
        ");
        assert!(text(work.clone(), true).starts_with("dmmtm-hs: warning: interrupted after 10 iterations\n"));
        let settled = DistributedSummary { converged: true, iterations: 1, ..work };
        assert!(text(settled, false).starts_with("dmmtm-hs: converged in 1 iteration\n"));
    }
}
