//! Applications: what runs on a station, above its links. An application knows its own state, what is delivered to it
//! and its clock; a robot's also its odometry and its range sensors.

mod ideal;
mod pass_on;
mod pointer;
mod port;
mod radio;

pub use port::{DriveAhead, Driving, Port};
pub use radio::RadioPort;

use crate::event::Timer;
use crate::service::delivery::{Delivery, DriveEnd};
use crate::service::network_id::NetworkId;
use crate::service::radio_event::RadioEvent;
use crate::service::report::SendReport;
use crate::service::sensed::Sensed;
use crate::service::sweep::{Announcement, SweepAnswer};

/// An application of any type; the caller may keep it, and give a reference to it.
pub type BoxedApplication<'a> = Box<dyn Application + Send + 'a>;

/// What runs on a station. It reacts to what happens, and acts through its [`Port`]. By default an application does
/// nothing.
pub trait Application {
    /// Whether it looks at what is delivered to it. Receptions of a station whose application does not are not worked
    /// out, which costs nothing. Asked once, before the start.
    fn hears(&self) -> bool {
        false
    }

    /// Whether it looks at what the sensors of its node say. Sensors of other nodes cost nothing. Asked once, before the
    /// start.
    fn senses(&self) -> bool {
        false
    }

    /// Whether the simulation goes on until the application calls [`Port::finish`]. Asked once, before the start.
    fn has_task(&self) -> bool {
        false
    }

    /// Whether it sends nothing but what a schedule says, and may leave frames out that nobody could hear: see
    /// [`Port::is_out_of_hearing`]. Asked once, before the start.
    fn may_rest(&self) -> bool {
        false
    }

    /// Somebody who listens comes near a station out of hearing.
    fn woken(&mut self, _port: &mut Port<'_>) {}

    /// The simulation ends. It is too late to send anything.
    fn ended(&mut self, _port: &mut Port<'_>) {}

    /// The simulation begins.
    fn started(&mut self, _port: &mut Port<'_>) {}

    /// A timer is due that [`Port::after`] set.
    fn timed(&mut self, _timer: Timer, _port: &mut Port<'_>) {}

    /// A frame for this station was received.
    fn delivered(&mut self, _delivery: &Delivery<'_>, _port: &mut Port<'_>) {}

    /// A frame that the application gave to [`Port::send`] has ended.
    fn sent(&mut self, _network: NetworkId, _report: &SendReport, _port: &mut Port<'_>) {}

    /// The radio says something that the program commands with [`Port::radio`]. By default, frames for the station and for all
    /// are [`delivered`](Self::delivered).
    fn radio(&mut self, _network: NetworkId, event: &RadioEvent<'_>, port: &mut Port<'_>) {
        if let RadioEvent::Received(frame) = event {
            self.delivered(&frame.delivery, port);
        }
    }

    /// A sensor of the node says something.
    fn sensed(&mut self, _sensed: &Sensed, _port: &mut Port<'_>) {}

    /// A drive is over that [`Port::drive`], [`Port::drive_arc`] or [`Port::steer`] began.
    fn drive_ended(&mut self, _end: DriveEnd, _port: &mut Port<'_>) {}

    /// The sector sweep is over that [`Port::sweep`] began; `answers` are by station.
    fn swept(&mut self, _network: NetworkId, _answers: &[SweepAnswer], _port: &mut Port<'_>) {}

    /// A frame was received of a sweep with which another station announces itself.
    fn announced(&mut self, _announcement: &Announcement, _port: &mut Port<'_>) {}

    /// The time to listen is over that [`Port::listen`] began.
    fn listened(&mut self, _network: NetworkId, _port: &mut Port<'_>) {}
}
