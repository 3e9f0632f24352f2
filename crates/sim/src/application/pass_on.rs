//! Applications that hold another one, and do what that does.

/// The methods of an [`Application`](crate::Application) that passes all calls on: to what the macro `$held` makes of
/// `self.method(arguments)`.
#[macro_export]
macro_rules! pass_on {
    ($held:ident) => {
        fn started(&mut self, port: &mut $crate::Port<'_>) {
            $held!(self.started(port))
        }

        $crate::pass_on!($held but started);
    };
    ($held:ident but started) => {
        fn hears(&self) -> bool {
            $held!(self.hears())
        }

        fn senses(&self) -> bool {
            $held!(self.senses())
        }

        fn has_task(&self) -> bool {
            $held!(self.has_task())
        }

        fn may_rest(&self) -> bool {
            $held!(self.may_rest())
        }

        fn woken(&mut self, port: &mut $crate::Port<'_>) {
            $held!(self.woken(port))
        }

        fn ended(&mut self, port: &mut $crate::Port<'_>) {
            $held!(self.ended(port))
        }

        #[inline]
        fn timed(&mut self, timer: $crate::Timer, port: &mut $crate::Port<'_>) {
            $held!(self.timed(timer, port))
        }

        fn delivered(&mut self, delivery: &$crate::Delivery<'_>, port: &mut $crate::Port<'_>) {
            $held!(self.delivered(delivery, port))
        }

        #[inline]
        fn sent(
            &mut self,
            network: $crate::NetworkId,
            report: &$crate::SendReport,
            port: &mut $crate::Port<'_>,
        ) {
            $held!(self.sent(network, report, port))
        }

        fn radio(
            &mut self,
            network: $crate::NetworkId,
            event: &$crate::RadioEvent<'_>,
            port: &mut $crate::Port<'_>,
        ) {
            $held!(self.radio(network, event, port))
        }

        fn sensed(&mut self, sensed: &$crate::Sensed, port: &mut $crate::Port<'_>) {
            $held!(self.sensed(sensed, port))
        }

        fn drive_ended(&mut self, end: $crate::DriveEnd, port: &mut $crate::Port<'_>) {
            $held!(self.drive_ended(end, port))
        }

        fn swept(
            &mut self,
            network: $crate::NetworkId,
            answers: &[$crate::SweepAnswer],
            port: &mut $crate::Port<'_>,
        ) {
            $held!(self.swept(network, answers, port))
        }

        fn announced(&mut self, announcement: &$crate::Announcement, port: &mut $crate::Port<'_>) {
            $held!(self.announced(announcement, port))
        }

        fn listened(&mut self, network: $crate::NetworkId, port: &mut $crate::Port<'_>) {
            $held!(self.listened(network, port))
        }
    };
}
