//! Where the search for a track with odometry begins: the path of odometry, laid on places of the tag.

use nalgebra::Vector4;
use sextant_channel::Position;

use super::epochs::Epochs;
use super::side::Line;

/// So many turns of the path are tried beside the best one: readings of few receivers do not tell it at once.
const TURNS: usize = 8;

impl Epochs {
    /// The middle of some receivers for each epoch.
    pub(super) fn around_middle(&self, receivers: &[Position]) -> Vec<[f64; 2]> {
        let count = receivers.len() as f64;
        let middle = receivers.iter().fold(Position::ORIGIN, |sum, &place| sum + place) * (1.0 / count);
        vec![[middle.x_m, middle.y_m]; self.times_s.len()]
    }

    /// The path of odometry as states, moved and turned so that it lies on `places` (m), or on their mirror images; and turned farther.
    pub(super) fn aligned(&self, places: &[[f64; 2]], line: Option<&Line>) -> Vec<Vec<Vector4<f64>>> {
        let count = places.len() as f64;
        let mean = |all: &mut dyn Iterator<Item = [f64; 2]>| {
            all.fold([0.0; 2], |[x, y], [more_x, more_y]| [x + more_x / count, y + more_y / count])
        };
        let believed: Vec<[f64; 2]> = self.believed.iter().map(|place| [place.x_m, place.y_m]).collect();
        let own = mean(&mut believed.iter().copied());
        let mirrored = line.map(|line| places.iter().map(|&place| line.mirrored(place)).collect::<Vec<_>>());
        let mut found = Vec::new();
        for places in std::iter::once(places.to_vec()).chain(mirrored) {
            let middle = mean(&mut places.iter().copied());
            let (mut along, mut across) = (0.0, 0.0);
            for (&[x, y], &[to_x, to_y]) in believed.iter().zip(&places) {
                let ([x, y], [to_x, to_y]) = ([x - own[0], y - own[1]], [to_x - middle[0], to_y - middle[1]]);
                along += x * to_x + y * to_y;
                across += x * to_y - y * to_x;
            }
            let best_rad = libm::atan2(across, along);
            for turn in 0..TURNS {
                let (sin, cos) = libm::sincos(best_rad + std::f64::consts::TAU * turn as f64 / TURNS as f64);
                let turn_rad = libm::atan2(sin, cos);
                let state = |&[x, y]: &[f64; 2]| {
                    let [x, y] = [x - own[0], y - own[1]];
                    Vector4::new(middle[0] + cos * x - sin * y, middle[1] + sin * x + cos * y, turn_rad, 0.0)
                };
                found.push(believed.iter().map(state).collect());
            }
        }
        found
    }
}
