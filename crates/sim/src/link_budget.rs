//! Link budgets: the power between two stations, item by item, and what a receiver makes of it.

use std::f64::consts::SQRT_2;
use std::sync::LazyLock;
use std::time::Duration;

use sextant_channel::{ChannelLaw, Db, Dbm, ObstacleField, PathBudget, Position, Traced};
use sextant_kernel::{NodeId, SettingError, StationId};

use crate::air::{Aim, Air, Emission, Interface, LinkItems, PlacedRadio, ReceiverId, ReceptionModel, ReceptionRules};
use crate::engine::bands::{Bands, band_of, bands};
use crate::network::Network;
use crate::service::network_id::NetworkId;
use crate::setup::Setup;
use crate::station::{Roll, StationKind};

/// Size of a frame if nobody in the network has any (octets).
const FRAME_OCTETS: u16 = 20;

/// The links of a setup before anything moves: the power of each, from the air of the simulation itself.
pub struct LinkBudgets {
    networks: Vec<Placed>,
    airs: Vec<Air>,
    obstacles: ObstacleField,
    places: Vec<Position>,
    roll: Roll,
    /// Share of the frames, received otherwise, that are not lost by `faults.message_loss`.
    kept: f64,
}

/// A network, and where its receivers are.
struct Placed {
    network: Network,
    /// Number of its air, ...
    air: usize,
    /// ... and of the first station's receiver there.
    first_receiver: u32,
    members: Option<Vec<bool>>,
}

/// A link in one direction: what its power consists of.
#[derive(Clone, Debug, PartialEq)]
pub struct LinkBudget {
    /// Transmit power, without the antenna.
    pub tx_power: Dbm,
    /// The sector of the sender that gives the greatest power, if its antenna has sectors.
    pub sector: Option<u8>,
    /// Gain of the sender towards the receiver, with that sector.
    pub transmit_gain: Db,
    /// Loss between the two places.
    pub path: PathBudget,
    /// Gain by the shadowing of this link; `None` if each packet has its own, or there is none.
    pub shadowing: Option<Db>,
    /// Gain by the fading of this link; `None` if it changes in time, or there is none.
    pub fading: Option<Db>,
    /// What was measured on this link at the start: its strength replaces the sum of all items, and its share the rule of the
    /// receiver.
    pub traced: Traced,
    /// Gain of the receiver, which listens in all directions alike.
    pub receive_gain: Db,
    /// Power at the receiver: the sum of all these. Without shadowing if each packet has its own, and without what changes in
    /// time.
    pub power: Dbm,
    /// What the receiver makes of it.
    pub reception: LinkReception,
}

/// What a receiver makes of a power, if no other signal disturbs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkReception {
    /// Minimum power of a frame that can be received.
    pub sensitivity: Dbm,
    /// Noise in the bandwidth of the receiver.
    pub noise_floor: Dbm,
    /// The rule that decides whether a frame is received.
    pub model: ReceptionModel,
    /// Least power at which a frame is received: it is above the sensitivity and far enough above the noise.
    pub least_power: Dbm,
    /// Size of the frame of the probabilities (octets).
    pub frame_octets: u16,
    /// Probability that such a frame is received at this power. `faults.message_loss` counts.
    pub probability: f64,
    /// The same at the power without the shadowing and the fading of this link, over all draws of shadowing, fading and bursts
    /// of loss.
    pub probability_over_shadowing: f64,
    /// Power of a signal from which on the receiver finds the channel busy.
    pub busy_from: Dbm,
}

impl LinkReception {
    /// Whether carrier sense at the receiver finds the channel busy while the sender sends, at this `power`.
    #[must_use]
    pub fn is_busy(&self, power: Dbm) -> bool {
        power >= self.busy_from
    }
}

impl LinkBudgets {
    /// The links of `setup`, with all stations at their start.
    ///
    /// # Errors
    /// If networks that share a band have different channels.
    pub fn new(setup: &Setup) -> Result<Self, SettingError> {
        let roll = setup.roll();
        let Setup { world, robots, sinks, networks, seed, .. } = setup;
        let nodes = world.nodes.iter().map(|node| node.position);
        let fixed = nodes.clone().chain(sinks.iter().map(|sink| sink.position));
        let bands = bands(networks)?;
        let message_loss = setup.faults.message_loss();
        let all = Bands { world, channel_seed: *seed, seed: *seed, round: 0, message_loss, roll };
        let mut airs: Vec<Air> = (bands.iter().enumerate())
            .map(|(i, band)| Air::new(all.air(i, band, networks), fixed.clone(), roll))
            .collect();
        let mut placed = Vec::with_capacity(networks.len());
        for (number, network) in (0..=u8::MAX).zip(networks) {
            let settings = network.technology.settings();
            let air = band_of(&bands, settings.spectrum());
            let rules = (0..roll.nodes).map(|node| settings.radio().rule_of(NodeId::from_index(node)));
            let rules = rules.chain(std::iter::repeat_n(0, roll.robots + roll.sinks));
            let first_receiver =
                airs[air].add_receivers(settings.radio().reception_rules(), rules, &vec![true; roll.len()]);
            for station in roll.stations() {
                if let Some(antennas) = settings.antennas() {
                    airs[air].mount(ReceiverId(first_receiver + station.0), antennas.mount(&roll, station, *seed));
                }
            }
            let members = setup.members(NetworkId(number));
            placed.push(Placed { network: network.clone(), air, first_receiver, members });
        }
        let starts = robots.iter().map(|robot| robot.body.start);
        let places = nodes.chain(starts).chain(sinks.iter().map(|sink| sink.position)).collect();
        Ok(Self {
            networks: placed,
            airs,
            obstacles: world.obstacles.clone(),
            places,
            roll,
            kept: 1.0 - message_loss,
        })
    }

    /// The obstacles, by the indices of the budgets.
    #[must_use]
    pub fn obstacles(&self) -> &ObstacleField {
        &self.obstacles
    }

    /// What a station is.
    #[must_use]
    pub fn kind(&self, station: StationId) -> StationKind {
        self.roll.kind(station)
    }

    /// Where a station stands at the start.
    ///
    /// # Panics
    /// If there is no such station.
    #[must_use]
    pub fn place(&self, station: StationId) -> Position {
        self.places[station.index()]
    }

    /// Whether a station is in a network.
    ///
    /// # Panics
    /// If there is no such network or station.
    #[must_use]
    pub fn is_in(&self, network: NetworkId, station: StationId) -> bool {
        let members = &self.networks[network.index()].members;
        members.as_ref().is_none_or(|members| members[station.index()])
    }

    /// The law of the channel of a network.
    ///
    /// # Panics
    /// If there is no such network.
    #[must_use]
    pub fn law(&self, network: NetworkId) -> &ChannelLaw {
        &self.networks[network.index()].network.channel
    }

    /// The link from one station to another in a network; `None` if they are farther apart than the radius of
    /// communication. A sender with sectors uses the one that gives the greatest power there.
    ///
    /// # Panics
    /// If there is no such network or station.
    #[must_use]
    pub fn between(&mut self, network: NetworkId, from: StationId, to: StationId) -> Option<LinkBudget> {
        let (aim, items, rules) = self.best(network, from, to)?;
        let settings = self.networks[network.index()].network.technology.settings();
        let tx_power = self.tx_power(network, from);
        let antenna = settings.antennas().map(|antennas| antennas.of(self.roll.kind(from)));
        let has_sectors = antenna.is_some_and(|antenna| !antenna.is_omnidirectional());
        let sector = match aim {
            Aim::Sector(sector) if has_sectors => antenna.map(|antenna| antenna.identity(sector)),
            Aim::Sector(_) | Aim::Omnidirectional => None,
        };
        let LinkItems { path, shadowing, transmit_gain, receive_gain, fading, traced, power } = items;
        let law = self.networks[network.index()].network.channel;
        let frame_octets = self.frame_octets(network, from);
        let airtime = settings.radio().airtime(frame_octets).unwrap_or_default();
        let mean = path.mean_power(tx_power) + transmit_gain + receive_gain;
        let measured = share_measured(traced, power, &rules, airtime);
        let reception = LinkReception {
            sensitivity: rules.sensitivity.to_dbm(),
            noise_floor: rules.noise.to_dbm(),
            model: rules.model,
            least_power: rules.least_power().to_dbm(),
            frame_octets,
            probability: self.kept
                * measured.unwrap_or_else(|| rules.reception_alone(power.to_milliwatts(), airtime)),
            probability_over_shadowing: self.kept
                * measured.unwrap_or_else(|| over_shadowing(&law, &rules, mean, airtime)),
            busy_from: settings.radio().busy_from(self.node(to)),
        };
        let shadowing = shadowing.filter(|_| law.shadowing().sigma_db() > 0.0);
        Some(LinkBudget {
            tx_power,
            sector,
            transmit_gain,
            path,
            shadowing,
            fading,
            traced,
            receive_gain,
            power,
            reception,
        })
    }

    /// The share of frames from one station to another that are received at the start if no other signal disturbs, without
    /// `faults.message_loss`: the [`probability`](LinkReception::probability) of the link, over all draws of what changes between
    /// packets (shadowing of each packet, fading in time, bursts of loss).
    ///
    /// # Panics
    /// If there is no such network or station.
    #[must_use]
    pub fn share_received(&mut self, network: NetworkId, from: StationId, to: StationId) -> f64 {
        self.share_at_least(network, from, to, 0.0).unwrap_or(0.0)
    }

    /// The same if it is not below `least`. It is sooner known that a share is below than what it is.
    ///
    /// # Panics
    /// If there is no such network or station.
    #[must_use]
    pub fn share_at_least(&mut self, network: NetworkId, from: StationId, to: StationId, least: f64) -> Option<f64> {
        self.share_unless_below(network, from, to, least).filter(|&share| share >= least)
    }

    /// The share of frames that are received; `None` if it is clearly below `least`.
    fn share_unless_below(&mut self, network: NetworkId, from: StationId, to: StationId, least: f64) -> Option<f64> {
        let (_, items, rules) = self.best(network, from, to)?;
        let placed = &self.networks[network.index()].network;
        let airtime =
            placed.technology.settings().radio().airtime(self.frame_octets(network, from)).unwrap_or_default();
        if let Some(share) = share_measured(items.traced, items.power, &rules, airtime) {
            return Some(share);
        }
        // The draws that last are in the power of the link.
        let law = placed.channel.of_changes();
        if law.shadowing().sigma_db() <= 0.0 && law.fading().is_none() && law.bursts().is_none() {
            return Some(rules.reception_alone(items.power.to_milliwatts(), airtime));
        }
        let fades = if law.fading().is_some() { MOST_FADING } else { Db(0.0) };
        let highest = items.power + Db(f64::from(MOST_SIGMAS) * law.shadowing().sigma_db()) + fades;
        if highest < rules.sensitivity.to_dbm() || is_below(least, &law, &rules, items.power, airtime) {
            return None;
        }
        Some(over_shadowing(&law, &rules, items.power, airtime))
    }

    /// What the power of a link consists of with the sector that gives the greatest one, and the rules of its receiver.
    fn best(
        &mut self,
        network: NetworkId,
        from: StationId,
        to: StationId,
    ) -> Option<(Aim, LinkItems, ReceptionRules)> {
        let placed = &self.networks[network.index()];
        let radio = |station: StationId| PlacedRadio {
            radio: Interface { receiver: ReceiverId(placed.first_receiver + station.0), station },
            place: self.places[station.index()],
        };
        let (sender, receiver) = (radio(from), radio(to));
        let settings = placed.network.technology.settings();
        let tx_power = self.tx_power(network, from);
        let antenna = settings.antennas().map(|antennas| antennas.of(self.roll.kind(from)));
        let aims: Vec<Aim> = match antenna {
            Some(antenna) => (0..antenna.sector_count()).map(Aim::Sector).collect(),
            None => vec![Aim::Omnidirectional],
        };
        let air = &mut self.airs[placed.air];
        let rules = air.rules_of(receiver.radio.receiver);
        let mut best: Option<(Aim, LinkItems)> = None;
        for aim in aims {
            let items = air.items(Emission { power: tx_power, aim }, sender, receiver)?;
            if best.as_ref().is_none_or(|(_, known)| items.power > known.power) {
                best = Some((aim, items));
            }
        }
        best.map(|(aim, items)| (aim, items, rules))
    }

    /// Transmit power of a station.
    fn tx_power(&self, network: NetworkId, station: StationId) -> Dbm {
        let settings = self.networks[network.index()].network.technology.settings();
        self.node(station).map_or(settings.radio().tx_power(), |node| settings.radio().tx_power_of(node))
    }

    fn node(&self, station: StationId) -> Option<NodeId> {
        match self.roll.kind(station) {
            StationKind::Node(node) => Some(NodeId::from_index(node)),
            StationKind::Robot(_) | StationKind::Sink(_) => None,
        }
    }

    /// Size of the frames that a station sends; those of the nodes, if it is none of them.
    fn frame_octets(&self, network: NetworkId, station: StationId) -> u16 {
        let traffic = &self.networks[network.index()].network.traffic;
        let own = self.node(station).and_then(|node| traffic.of(node));
        let sent = own.into_iter().chain(traffic.kinds()).find(|traffic| !traffic.is_silent());
        sent.map_or(FRAME_OCTETS, |traffic| traffic.mpdu_octets().into())
    }
}

/// The share of frames that arrive over a link that was measured; `None` if the law of the channel tells it.
fn share_measured(traced: Traced, power: Dbm, rules: &ReceptionRules, airtime: Duration) -> Option<f64> {
    match traced {
        Traced::Measured(link) => {
            Some(link.share.unwrap_or_else(|| rules.reception_alone(power.to_milliwatts(), airtime)))
        }
        Traced::Silent => Some(0.0),
        Traced::Law => None,
    }
}

/// Steps of the sum over the draws of shadowing in a standard deviation, ...
const STEPS: i32 = 40;
/// ... and the most standard deviations.
const MOST_SIGMAS: i32 = 6;

/// Most gain by fading: the power of a deep field (Nakagami with m 1/2) is above it once in fifty million draws.
const MOST_FADING: Db = Db(15.0);

/// Probability that a frame with the mean power `mean` is received, over all draws of shadowing, fading and bursts of loss. Thresholds have a closed
/// form; with bit errors it is the sum of the trapezoidal rule.
fn over_shadowing(law: &ChannelLaw, rules: &ReceptionRules, mean: Dbm, airtime: Duration) -> f64 {
    let sigma_db = law.shadowing().sigma_db();
    if law.fading().is_some() || law.bursts().is_some() {
        return match rules.model {
            ReceptionModel::Ber => {
                law.mean_over(|gain| rules.reception_alone((mean + gain).to_milliwatts(), airtime))
            }
            ReceptionModel::Overlap | ReceptionModel::SinrThreshold { .. } | ReceptionModel::SirThreshold { .. } => {
                law.share_received(mean - rules.least_power().to_dbm())
            }
        };
    }
    if sigma_db <= 0.0 {
        return rules.reception_alone(mean.to_milliwatts(), airtime);
    }
    if !matches!(rules.model, ReceptionModel::Ber) {
        return law.share_above(mean - rules.least_power().to_dbm());
    }
    let received = |z: f64| rules.reception_alone((mean + Db(sigma_db * z)).to_milliwatts(), airtime);
    let draws = &*NORMAL_DRAWS;
    // More power is never worse: between the draws of which none arrive and those of which all do, few are left.
    let some = draws.partition_point(|draw| received(draw.z) <= 0.0);
    let all = some + draws[some..].partition_point(|draw| received(draw.z) < 1.0);
    let (mut sum, mut weights) = (0.0, 0.0);
    for (number, draw) in draws.iter().enumerate() {
        weights += draw.weight;
        if number >= all {
            sum += draw.weight;
        } else if number >= some {
            sum += draw.weight * received(draw.z);
        }
    }
    sum / weights
}

/// Whether the share over all draws of shadowing is below `least` by a bound: draws above a limit have half of that probability, and
/// of those below it no greater share arrives than at the limit. With fading, the two share what the mean lacks.
fn is_below(least: f64, law: &ChannelLaw, rules: &ReceptionRules, mean: Dbm, airtime: Duration) -> bool {
    if let Some(fading) = law.fading() {
        // What lacks comes from shadowing or from fading: one of them has half of it at least. Bursts only lose more.
        let half = Db(0.5 * (rules.least_power().to_dbm() - mean).0);
        let by_fading = 1.0 - fading.share_below(half);
        let sigma_db = law.shadowing().sigma_db();
        let by_shadowing = if sigma_db > 0.0 { 0.5 * libm::erfc(half.0 / (sigma_db * SQRT_2)) } else { 0.0 };
        return half.0 > 0.0 && by_fading + by_shadowing < least;
    }
    if law.bursts().is_some() {
        return false;
    }
    let draws = &*NORMAL_DRAWS;
    let all: f64 = draws.iter().map(|draw| draw.weight).sum();
    let mut above = 0.0;
    let limit = draws.iter().rev().take_while(|draw| {
        above += draw.weight;
        above <= 0.5 * least * all
    });
    limit.last().is_some_and(|limit| {
        let power = mean + Db(law.shadowing().sigma_db() * limit.z);
        rules.reception_alone(power.to_milliwatts(), airtime) < 0.5 * least
    })
}

/// A draw of the normal distribution (standard deviations), and its probability but for a factor.
struct NormalDraw {
    z: f64,
    weight: f64,
}

/// The draws of the trapezoidal rule, in ascending order.
static NORMAL_DRAWS: LazyLock<Vec<NormalDraw>> = LazyLock::new(|| {
    let draw = |step: i32| {
        let z = f64::from(step) / f64::from(STEPS);
        NormalDraw { z, weight: libm::exp(-0.5 * z * z) }
    };
    (-STEPS * MOST_SIGMAS..=STEPS * MOST_SIGMAS).map(draw).collect()
});

#[cfg(test)]
mod tests;
