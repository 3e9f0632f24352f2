//! Applications behind pointers: a caller may keep an application and lend it, or hide its type.

use super::Application;
use super::port::Port;
use crate::event::Timer;
use crate::service::delivery::{Delivery, DriveEnd};
use crate::service::network_id::NetworkId;
use crate::service::radio_event::RadioEvent;
use crate::service::report::SendReport;
use crate::service::sensed::Sensed;
use crate::service::sweep::{Announcement, SweepAnswer};

macro_rules! what_it_points_at {
    ($pointer:ty) => {
        impl<A: Application + ?Sized> Application for $pointer {
            fn hears(&self) -> bool {
                (**self).hears()
            }

            fn senses(&self) -> bool {
                (**self).senses()
            }

            fn has_task(&self) -> bool {
                (**self).has_task()
            }

            fn may_rest(&self) -> bool {
                (**self).may_rest()
            }

            fn woken(&mut self, port: &mut Port<'_>) {
                (**self).woken(port);
            }

            fn ended(&mut self, port: &mut Port<'_>) {
                (**self).ended(port);
            }

            fn started(&mut self, port: &mut Port<'_>) {
                (**self).started(port);
            }

            fn timed(&mut self, timer: Timer, port: &mut Port<'_>) {
                (**self).timed(timer, port);
            }

            fn delivered(&mut self, delivery: &Delivery<'_>, port: &mut Port<'_>) {
                (**self).delivered(delivery, port);
            }

            fn sent(&mut self, network: NetworkId, report: &SendReport, port: &mut Port<'_>) {
                (**self).sent(network, report, port);
            }

            fn radio(&mut self, network: NetworkId, event: &RadioEvent<'_>, port: &mut Port<'_>) {
                (**self).radio(network, event, port);
            }

            fn sensed(&mut self, sensed: &Sensed, port: &mut Port<'_>) {
                (**self).sensed(sensed, port);
            }

            fn drive_ended(&mut self, end: DriveEnd, port: &mut Port<'_>) {
                (**self).drive_ended(end, port);
            }

            fn swept(&mut self, network: NetworkId, answers: &[SweepAnswer], port: &mut Port<'_>) {
                (**self).swept(network, answers, port);
            }

            fn announced(&mut self, announcement: &Announcement, port: &mut Port<'_>) {
                (**self).announced(announcement, port);
            }

            fn listened(&mut self, network: NetworkId, port: &mut Port<'_>) {
                (**self).listened(network, port);
            }
        }
    };
}

what_it_points_at!(&mut A);
what_it_points_at!(Box<A>);
