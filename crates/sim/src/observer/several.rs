//! Several observers as one: each event goes to all of them.

use sextant_channel::{Contact, HeardAtStop, Position, Stop};
use sextant_kernel::{NodeId, SimTime, StationId};

use super::{FrameOnAir, Observer, Progress, RememberingObserver};
use crate::service::estimate::Estimate;
use crate::service::network_id::NetworkId;
use crate::service::packet_trace::PacketTrace;
use crate::service::sensed::{FieldId, Sensed, TargetId};
use crate::station::Pose;

/// Writes the methods of [`Observer`] that pass an event on to each observer of a list.
macro_rules! each_event {
    ($($name:ident($($argument:ident: $kind:ty),*));* $(;)?) => {
        /// Ignores everything.
        impl Observer for () {}

        /// Passes everything on.
        impl<O: Observer + ?Sized> Observer for &mut O {
            $(fn $name(&mut self, $($argument: $kind),*) {
                (**self).$name($($argument),*);
            })*

            fn wants_frames(&self) -> bool {
                (**self).wants_frames()
            }

            fn wants_packets(&self) -> bool {
                (**self).wants_packets()
            }

            fn goes_on(&mut self, progress: Progress) -> bool {
                (**self).goes_on(progress)
            }
        }

        /// Passes everything on, but remembers whether the observer wants frames.
        impl Observer for RememberingObserver<'_> {
            $(fn $name(&mut self, $($argument: $kind),*) {
                self.observer.$name($($argument),*);
            })*

            fn wants_frames(&self) -> bool {
                self.wants_frames
            }

            fn wants_packets(&self) -> bool {
                self.observer.wants_packets()
            }

            fn goes_on(&mut self, progress: Progress) -> bool {
                self.observer.goes_on(progress)
            }
        }

        /// Passes everything on to the observer, if there is one.
        impl<O: Observer> Observer for Option<O> {
            $(fn $name(&mut self, $($argument: $kind),*) {
                if let Some(observer) = self {
                    observer.$name($($argument),*);
                }
            })*

            fn wants_frames(&self) -> bool {
                self.as_ref().is_some_and(Observer::wants_frames)
            }

            fn wants_packets(&self) -> bool {
                self.as_ref().is_some_and(Observer::wants_packets)
            }

            fn goes_on(&mut self, progress: Progress) -> bool {
                self.as_mut().is_none_or(|observer| observer.goes_on(progress))
            }
        }

        /// Passes everything on to both observers, to the first one first. The simulation ends when one of them ends it.
        impl<A: Observer, B: Observer> Observer for (A, B) {
            $(fn $name(&mut self, $($argument: $kind),*) {
                self.0.$name($($argument),*);
                self.1.$name($($argument),*);
            })*

            fn wants_frames(&self) -> bool {
                self.0.wants_frames() || self.1.wants_frames()
            }

            fn wants_packets(&self) -> bool {
                self.0.wants_packets() || self.1.wants_packets()
            }

            fn goes_on(&mut self, progress: Progress) -> bool {
                let (first, second) = (self.0.goes_on(progress), self.1.goes_on(progress));
                first && second
            }
        }
    };
}

each_event! {
    moved(robot: usize, time: SimTime, position: Position);
    curved(robot: usize, time: SimTime, pose: Pose);
    believed(robot: usize, time: SimTime, pose: Pose);
    met(contact: Contact);
    stopped(network: NetworkId, index: u32, stop: &Stop, end: SimTime, heard: HeardAtStop<'_>);
    estimated(station: StationId, time: SimTime, estimate: &Estimate);
    originated(station: StationId, number: u16, time: SimTime);
    target_moved(target: TargetId, time: SimTime, position: Position);
    captured(robot: usize, target: TargetId, time: SimTime);
    target_gone(target: TargetId, time: SimTime);
    sensed(node: NodeId, time: SimTime, sensed: &Sensed);
    depleted(node: NodeId, time: SimTime);
    source_removed(field: FieldId, source: usize, time: SimTime);
    framed(frame: FrameOnAir<'_>);
    traced(packet: &PacketTrace);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Counts what it sees, and ends the simulation at once if it is `impatient`.
    #[derive(Default)]
    struct Counter {
        moves: usize,
        questions: usize,
        impatient: bool,
    }

    impl Observer for Counter {
        fn moved(&mut self, _robot: usize, _time: SimTime, _position: Position) {
            self.moves += 1;
        }

        fn wants_frames(&self) -> bool {
            self.impatient
        }

        fn goes_on(&mut self, _progress: Progress) -> bool {
            self.questions += 1;
            !self.impatient
        }
    }

    #[test]
    fn a_pair_tells_both_and_ends_when_one_ends() {
        let mut pair = (Counter { impatient: true, ..Counter::default() }, (Some(Counter::default()), ()));
        pair.moved(0, SimTime::ZERO, Position::ORIGIN);
        let progress = Progress { time: SimTime::ZERO, stops: 0, nodes_heard: 0, nodes: 1, packets_offered: 0 };
        assert!(!pair.goes_on(progress) && pair.wants_frames());
        let second = pair.1.0.unwrap();
        assert_eq!([pair.0.moves, pair.0.questions, second.moves, second.questions], [1; 4]);
        assert!(().goes_on(progress) && !().wants_frames());
    }
}
