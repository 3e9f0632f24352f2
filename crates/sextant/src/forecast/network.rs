//! What follows for a network: range, neighbours, load of the channel.

use serde::Serialize;
use sextant_channel::{CellIndex, Channel, ChannelLaw, Db, Dbm, ObstacleField, Position};
use sextant_kernel::NodeId;
use sextant_sim::{Network, NetworkId, Setup, Technology, Traffic};

use super::curve::Curve;
use super::interval::IntervalForecast;

/// At most so many nodes are asked for their neighbours; of more, evenly spread ones.
const MOST_ASKED: usize = 500;

/// Frames whose size is not known before the run have this one (octets): a beacon with a sequence number.
const USUAL_OCTETS: u8 = 20;

/// Size of an acknowledgement (octets).
const ACKNOWLEDGEMENT_OCTETS: u16 = 5;

/// What follows for a network.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NetworkForecast {
    /// Its name, if the scenario names its networks.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Number of its nodes.
    pub nodes: usize,
    /// How far a node is heard without obstacles.
    pub range: RangeForecast,
    /// Other nodes from which a node receives at least half of the frames, with obstacles; absent with one node.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub neighbours: Option<NeighbourForecast>,
    /// How deep fades are, if links fade.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fading: Option<FadingForecast>,
    /// Share of time for which links are in bursts of loss, if they ever are.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub burst_share: Option<f64>,
    /// How busy the channel is; absent if the rate of the traffic is not known before the run, or not all that is on air is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub load: Option<LoadForecast>,
    /// What is on air besides and is not known before the run, so that there is no `load`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub load_unknown: Option<&'static str>,
    /// How often stations should wake up, if they sleep between checks of the channel and are woken.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub interval: Option<IntervalForecast>,
}

/// How deep fades are.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FadingForecast {
    /// The law, in words.
    pub law: String,
    /// The gain that one of ten draws is below (dB).
    pub tenth_below_db: f64,
    /// The gain that one of a hundred draws is below (dB).
    pub hundredth_below_db: f64,
    /// Whether links between stations that stand change in time.
    pub changes_in_time: bool,
}

/// How far a node is heard without obstacles (m); with sectors, by the best pair.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RangeForecast {
    /// Half of the frames are received at this distance.
    pub half_m: f64,
    /// One of 100 frames is received at this distance.
    pub hundredth_m: f64,
    /// The hard radius, if the channel has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limit_m: Option<f64>,
}

/// Number of neighbours of a node.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct NeighbourForecast {
    /// Mean over the nodes.
    pub mean: f64,
    /// The least.
    pub min: usize,
    /// The most.
    pub max: usize,
    /// Number of nodes that were counted.
    pub counted: usize,
}

/// How busy the channel is: with acknowledgements, and with the tries that weak links need; not with those after collisions.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LoadForecast {
    /// Time on air of a frame (s).
    pub airtime_s: f64,
    /// Mean number of packets a node and second.
    pub rate_per_s: f64,
    /// Frames on air at once that a node senses, its own included (Erlang), mean over the nodes.
    pub mean_erlang: f64,
    /// The most of any node.
    pub max_erlang: f64,
}

/// A network, and how far its nodes are heard.
pub(super) struct Reach<'a> {
    pub(super) network: &'a Network,
    pub(super) id: NetworkId,
    channel: Channel,
    curve: Curve,
    /// Its nodes.
    pub(super) nodes: Vec<(NodeId, Position)>,
    /// The places of its sinks.
    sinks: Vec<Position>,
    /// The nodes by place.
    cells: CellIndex,
    /// Range at which one of 100 frames is received.
    pub(super) range: RangeForecast,
}

impl<'a> Reach<'a> {
    /// The networks of a setup, in their order.
    pub(super) fn all(setup: &'a Setup) -> Vec<Self> {
        setup.networks.iter().map(|network| Self::new(network, setup)).collect()
    }

    /// Where the tables of the network are in the scenario: a key before theirs, or nothing.
    pub(super) fn table(&self) -> String {
        self.network.name.as_ref().map_or(String::new(), |name| format!("networks.{name}."))
    }

    fn new(network: &'a Network, setup: &'a Setup) -> Self {
        let number = setup.networks.iter().position(|other| std::ptr::eq(other, network)).unwrap_or(0);
        let octets = Some(network.traffic.mpdu_octets()).filter(|octets| *octets > 0).unwrap_or(USUAL_OCTETS);
        let curve = Curve::new(&network.technology, octets.into(), network.channel);
        let placed = setup.world.nodes.iter().enumerate();
        let nodes: Vec<_> = placed
            .map(|(node, placed)| (NodeId::from_index(node), placed.position))
            .filter(|(node, _)| network.has(*node))
            .collect();
        let channel = Channel::new(network.channel, setup.world.obstacles.clone(), setup.seed);
        let range_m = |share: f64| {
            let budget = curve.power_dbm(share).map(|power_dbm| power(network) - Dbm(power_dbm));
            let range_m = budget.map_or(0.0, |budget| network.channel.path_loss().distance_m(budget));
            range_m.min(network.channel.max_range_m())
        };
        let limit_m = Some(network.channel.max_range_m()).filter(|range_m| range_m.is_finite());
        let range = RangeForecast { half_m: range_m(0.5), hundredth_m: range_m(0.01), limit_m };
        let id = NetworkId(u8::try_from(number).unwrap_or(u8::MAX));
        let places: Vec<Position> = nodes.iter().map(|&(_, place)| place).collect();
        let cells = CellIndex::new(&places, (0.25 * range.hundredth_m).max(f64::MIN_POSITIVE));
        let sinks = setup.sinks.iter().filter(|sink| sink.is_in(id)).map(|sink| sink.position).collect();
        Self { network, id, channel, curve, nodes, sinks, cells, range }
    }

    /// The nodes within `radius_m` of a place, in their order.
    fn near(&self, place: Position, radius_m: f64) -> impl Iterator<Item = &(NodeId, Position)> {
        let mut near = Vec::new();
        // A little farther, so that rounding leaves no node out.
        self.cells.within(place, radius_m * (1.0 + 1e-9), |node| near.push(node as usize));
        near.sort_unstable();
        let is_near = move |&node: &usize| self.nodes[node].1.distance_m(place) <= radius_m;
        near.into_iter().filter(is_near).map(|node| &self.nodes[node])
    }

    /// The nodes from which a frame may be received at `to`, in their order.
    pub(super) fn in_reach(&self, to: Position) -> impl Iterator<Item = &(NodeId, Position)> {
        self.near(to, 2.0 * self.range.hundredth_m)
    }

    /// Probability that a frame from `from` is received at `to`, undisturbed, with obstacles.
    pub(super) fn probability(&self, from: Position, to: Position) -> f64 {
        if from.distance_m(to) > 2.0 * self.range.hundredth_m {
            return 0.0;
        }
        self.channel.mean_power(power(self.network), from, to).map_or(0.0, |mean| self.curve.probability(mean))
    }

    /// The channel.
    pub(super) fn channel(&self) -> &Channel {
        &self.channel
    }

    /// The obstacles.
    pub(super) fn obstacles(&self) -> &ObstacleField {
        self.channel.obstacles()
    }

    /// Whether its links sweep sectors.
    pub(super) fn sweeps(&self) -> bool {
        self.network.technology.antennas().is_some()
    }

    /// Whether its links are as they were measured, so that its law says nothing of them.
    pub(super) fn is_measured(&self) -> bool {
        self.network.link_trace.is_some()
    }

    /// The law of its channel.
    pub(super) fn law(&self) -> &ChannelLaw {
        self.channel.law()
    }

    /// Mean number of frames a node and second, if it is known.
    pub(super) fn rate_per_s(&self) -> Option<f64> {
        if self.sweeps() || self.nodes.is_empty() {
            return None;
        }
        let rate = |(node, _): &(NodeId, Position)| {
            self.network.traffic.of(*node).map_or(Some(0.0), |traffic| traffic.rate_per_s())
        };
        let rates = self.nodes.iter().map(rate).collect::<Option<Vec<f64>>>()?;
        Some(rates.iter().sum::<f64>() / rates.len() as f64)
    }

    pub(super) fn forecast(&self) -> NetworkForecast {
        NetworkForecast {
            name: self.network.name.clone(),
            nodes: self.nodes.len(),
            range: self.range,
            neighbours: self.neighbours().filter(|_| !self.is_measured()),
            fading: self.law().fading().map(|fading| FadingForecast {
                law: fading.name(),
                tenth_below_db: fading.quantile(0.1).0,
                hundredth_below_db: fading.quantile(0.01).0,
                changes_in_time: fading.changes_in_time(),
            }),
            burst_share: self.law().bursts().map(|bursts| bursts.bad_share()),
            load: self.load().filter(|_| !self.is_measured()),
            load_unknown: None,
            interval: None,
        }
    }

    /// The nodes that are asked for their neighbours.
    fn asked(&self) -> impl Iterator<Item = &(NodeId, Position)> {
        self.nodes.iter().step_by(self.nodes.len().div_ceil(MOST_ASKED).max(1))
    }

    fn neighbours(&self) -> Option<NeighbourForecast> {
        if self.nodes.len() < 2 {
            return None;
        }
        let of = |(node, place): &(NodeId, Position)| {
            let hears = |(other, from): &&(NodeId, Position)| other != node && self.probability(*from, *place) >= 0.5;
            self.near(*place, self.range.half_m).filter(hears).count()
        };
        let counts: Vec<usize> = self.asked().map(of).collect();
        Some(NeighbourForecast {
            mean: counts.iter().sum::<usize>() as f64 / counts.len() as f64,
            min: counts.iter().copied().min()?,
            max: counts.iter().copied().max()?,
            counted: counts.len(),
        })
    }

    fn load(&self) -> Option<LoadForecast> {
        let rate_per_s = self.rate_per_s()?;
        let airtime = self.network.technology.airtime(self.network.traffic.mpdu_octets().into())?;
        let acknowledgement = self.network.technology.airtime(ACKNOWLEDGEMENT_OCTETS)?;
        let on_air_s = |(node, place): &(NodeId, Position)| {
            let Some(traffic) = self.network.traffic.of(*node) else { return 0.0 };
            let answer_s = if traffic.is_acknowledged() { acknowledgement.as_secs_f64() } else { 0.0 };
            let rate_per_s = traffic.rate_per_s().unwrap_or(0.0);
            rate_per_s * (airtime.as_secs_f64() * self.frames_of_packet(*node, *place) + answer_s)
        };
        let own = self.nodes.iter().map(on_air_s).sum::<f64>() / self.nodes.len() as f64;
        let loads: Vec<f64> = self.asked().map(|(node, place)| own * (1.0 + self.sensed(*node, *place))).collect();
        Some(LoadForecast {
            airtime_s: airtime.as_secs_f64(),
            rate_per_s,
            mean_erlang: loads.iter().sum::<f64>() / loads.len() as f64,
            max_erlang: loads.iter().copied().fold(0.0, f64::max),
        })
    }

    /// Frames that a packet of a node over one hop takes on average: several tries if it is acknowledged and the link is weak.
    pub(super) fn frames_of_packet(&self, node: NodeId, place: Position) -> f64 {
        if !self.network.traffic.of(node).is_some_and(Traffic::is_acknowledged) || self.is_measured() {
            return 1.0;
        }
        let nearest = self.sinks.iter().min_by(|a, b| a.distance_m(place).total_cmp(&b.distance_m(place)));
        let Some(&sink) = nearest else { return 1.0 };
        // The acknowledgement goes over the same link.
        let acknowledged = self.probability(place, sink) * self.probability(sink, place);
        if acknowledged <= 0.0 {
            return self.tries().into();
        }
        (1.0 - libm::pow(1.0 - acknowledged, self.tries().into())) / acknowledged
    }

    /// How often the MAC sends a frame to one station at most.
    pub(super) fn tries(&self) -> u8 {
        let retries = match &self.network.technology {
            Technology::Ieee802154(links) => links.mac.csma().max_retries(),
            Technology::Tsch(links) => links.tsch.max_retries,
            Technology::Sleeping(links) => links.sleep.max_retries,
            Technology::Programmed(_) | Technology::Ieee80211ad(_) => 0,
        };
        retries + 1
    }

    /// Expected number of other nodes that carrier sense at a node notices.
    fn sensed(&self, node: NodeId, place: Position) -> f64 {
        let threshold = self.network.technology.carrier_sense_threshold();
        let farthest_m = self.network.channel.reach_m(power(self.network), threshold);
        let others = self.near(place, farthest_m).filter(|(other, _)| *other != node);
        let share = |(_, from): &(NodeId, Position)| {
            let mean = self.channel.mean_power(power(self.network), *from, place);
            mean.map_or(0.0, |mean| self.network.channel.share_above(mean - threshold))
        };
        others.map(share).sum()
    }
}

/// The power that a node sends with, by the best pair of sectors.
fn power(network: &Network) -> Dbm {
    let gain: Db = network.technology.link_gain();
    network.technology.tx_power() + gain
}
