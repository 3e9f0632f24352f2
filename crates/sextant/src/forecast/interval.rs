//! How often stations should wake up that sleep between checks of the channel.

use std::time::Duration;

use serde::Serialize;
use sextant_mac::RadioState;
use sextant_mac::sleep::{BestInterval, Form, IntervalPowers, PhasesConfig, SinksConfig};
use sextant_sim::Network;

/// How often stations should wake up: the interval at which checks and waking receivers together take the least power.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct IntervalForecast {
    /// The best interval (s).
    pub best_s: f64,
    /// Power of a node for checks and for waking receivers with it, what a radio takes asleep apart (W).
    pub best_power_w: f64,
    /// The interval that is set (s).
    pub interval_s: f64,
    /// The same power with that (W).
    pub power_w: f64,
}

/// Over how many hops packets go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Hops {
    /// To whom hears them.
    One,
    /// From node to node.
    Several,
}

impl IntervalForecast {
    /// The forecast for a network; `None` if its stations do not sleep or need not be woken, or if it is not known how often nodes
    /// send (a second and node, on average). The packets of a node are its own: what it sends on for others is not known before the run.
    pub(super) fn of(network: &Network, rate_per_s: Option<f64>, hops: Hops) -> Option<Self> {
        let is_routed = hops == Hops::Several;
        let sleep = &network.technology.sleeping()?.sleep;
        let rate_per_s = rate_per_s.filter(|rate| *rate > 0.0)?;
        let airtime = network.technology.airtime(network.traffic.mpdu_octets().into())?;
        let to_all = !is_routed && !network.traffic.kinds().any(|kind| kind.is_acknowledged());
        // Who knows when its receiver wakes up does not wait for it with its radio on.
        let is_aimed = sleep.phases == PhasesConfig::Learned && !to_all;
        let meets_sleepers = is_routed || to_all || sleep.sinks == SinksConfig::Sleep;
        if is_aimed || !meets_sleepers {
            return None;
        }
        let power_w = |state| network.radio_states.power_w(state, network.technology.tx_power());
        let (sending_w, receiving_w) = (power_w(RadioState::Transmit), power_w(RadioState::Receive));
        // In the gaps it receives, or turns around with the current of the receiver.
        let [strobe_s, gap_s] = [sleep.strobe_airtime(airtime), sleep.gap()].map(|span| span.as_secs_f64());
        let waking_w = (sending_w * strobe_s + receiving_w * gap_s) / (strobe_s + gap_s);
        // A packet to one station takes half an interval on average, but for wake-up frames that count down.
        let intervals = if to_all || sleep.form == Form::Csl { 1.0 } else { 0.5 };
        let spans = sleep.check_spans();
        let best = BestInterval::new(&IntervalPowers {
            receiving_w,
            sending_w: 2.0 * intervals * waking_w,
            check: spans.turning + spans.receiving,
            between_frames: Duration::from_secs_f64(1.0 / rate_per_s),
        });
        let (best_s, interval_s) = (best.interval_s(), sleep.interval.as_secs_f64());
        let power_w = best.power_w(interval_s);
        Some(Self { best_s, best_power_w: best.power_w(best_s), interval_s, power_w })
    }
}
