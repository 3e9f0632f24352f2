//! What a robot works out from the readings around it.

use sextant_channel::Position;
use sextant_kernel::SimTime;
use sextant_sim::{Estimate as Told, Port};

use super::super::estimate::{Estimate, LocalFitConfig};
use super::super::field_estimate::{Disc, FieldEstimate};
use super::super::goal::Target;
use super::super::gradient::plane;
use super::super::local_fit::{Axes, Sample};
use super::super::steering::Steering;
use super::{Outlook, SeekRobot};

/// With fewer readings, the uncertainty of a plane is not known well enough to tell the source.
const LEAST_AROUND: usize = 10;

impl SeekRobot {
    pub(super) fn axes(&self) -> Axes {
        if self.steering.is_spatial() { Axes::Space } else { Axes::Plane }
    }

    /// The field at a place on the map (m) at the time `now`; `None` if it has not heard enough.
    pub(super) fn field_at(&self, place: Option<Position>, now: SimTime) -> Option<FieldEstimate> {
        match self.settings.estimate {
            Estimate::Mean(weights, reach_m) => {
                let disc = |radius_m| place.map(|center| (Disc { center, radius_m }, self.axes()));
                let within = reach_m.and_then(disc);
                let value = self.readings.mean(self.counting_since(now), weights, within)?;
                Some(FieldEstimate { value, smooth: value, gradient: None })
            }
            Estimate::LocalFit(LocalFitConfig { bandwidth_spacings, significance }) => {
                let bandwidth_m = bandwidth_spacings * self.map.spacing_m();
                self.readings.fitted(place?, self.axes(), [bandwidth_m, self.reach_m()], significance)
            }
        }
    }

    /// What it knows now; `None` until it has heard enough.
    pub(super) fn look(&mut self, port: &mut Port<'_>) -> Option<Outlook> {
        let pose = port.pose();
        let place = self.place_on_map(pose.position);
        let field = self.field_at(place, port.now())?;
        if let Some(place) = place {
            port.tell(Told::OwnPlace(place));
        }
        port.tell(Told::FieldValue { field: self.settings.goal.field, value: field.value });
        if self.record.largest.is_none_or(|largest| field.value > largest) {
            self.record.largest = Some(field.value);
        }
        Some(Outlook { pose, place, field })
    }

    /// Whether it arrives now.
    pub(super) fn arrives(&mut self, outlook: &Outlook, now: SimTime) -> bool {
        match self.settings.goal.target {
            Target::Level(level) => self.watch.arrives(level, outlook.field.value, now),
            Target::Source => {
                let Some(place) = outlook.place else { return false };
                let samples = self.around(place, self.reach_m());
                let half_turn_s = std::f64::consts::PI / self.settings.turn_rate_max_rad_per_s;
                samples.len() >= LEAST_AROUND
                    && plane(&samples).is_some_and(|plane| self.source_watch.arrives(plane, place, now, half_turn_s))
            }
        }
    }

    /// The readings within `reach_m` of a place on the map (m).
    fn around(&self, place: Position, reach_m: f64) -> Vec<Sample> {
        let is_near = |distance_m: f64| if distance_m <= reach_m { 1.0 } else { 0.0 };
        self.readings.samples(place, Axes::Plane, is_near).collect()
    }

    /// Where the gradient points, by odometry (rad).
    pub(super) fn course_rad(&self, outlook: &Outlook) -> Option<f64> {
        let Steering::Gradient { plane_reach_m, .. } = self.steering else { return None };
        let place = outlook.place?;
        let slope = plane(&self.around(place, plane_reach_m.unwrap_or(self.reach_m())))?.gradient;
        if slope.length_m() <= 0.0 {
            return None;
        }
        let way = self.by_odometry(place, slope);
        Some(libm::atan2(way.y_m, way.x_m))
    }

    /// A gradient at `place` on the map (1/m on the map) by odometry (1/m). Its length grows with the scale of the map, and
    /// its direction is turned with it.
    pub(super) fn by_odometry(&self, place: Position, gradient: Position) -> Position {
        let steepness = gradient.length_m();
        let (Some(scale), true) = (self.place.scale(), steepness > 0.0) else { return gradient };
        let ahead = place + gradient * (self.map.spacing_m() / steepness);
        let Some((here, there)) = self.place.to_odometry(place).zip(self.place.to_odometry(ahead)) else {
            return gradient;
        };
        let way = there - here;
        way * (scale * steepness / way.length_m())
    }
}
