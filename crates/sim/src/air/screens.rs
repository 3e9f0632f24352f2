//! Bodies that move between stations and hide links.

use sextant_channel::{Db, Position, Ray, Screen};
use sextant_kernel::SimTime;

use crate::station::Motion;

/// The bodies that hide links of a band, by number; without a motion they are not there.
#[derive(Clone, Debug)]
pub(crate) struct Screens {
    carrier_ghz: f64,
    bodies: Vec<(Option<Screen>, Option<Motion>)>,
}

impl Screens {
    /// Of bodies with these screens, at a carrier; `None` if no body has one. None is there yet.
    pub(crate) fn new(screens: impl Iterator<Item = Option<Screen>>, carrier_ghz: f64) -> Option<Self> {
        let bodies: Vec<_> = screens.map(|screen| (screen, None)).collect();
        bodies.iter().any(|(screen, _)| screen.is_some()).then_some(Self { carrier_ghz, bodies })
    }

    /// A body moves like this from now on; without a motion it is gone.
    pub(super) fn moves(&mut self, body: usize, motion: Option<Motion>) {
        self.bodies[body].1 = motion;
    }

    /// Loss by all bodies of a way between two places at `time`.
    pub(super) fn loss(&self, ray: &Ray, ends: [Position; 2], time: SimTime) -> Db {
        let there = self.bodies.iter().filter_map(|(screen, motion)| Some((*screen)?).zip(*motion));
        there.fold(Db(0.0), |loss, (screen, motion)| loss + screen.loss(motion.at(time), ray, ends, self.carrier_ghz))
    }
}
