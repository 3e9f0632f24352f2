//! The parts of a link as numbers, for people and for programs.

use serde::Serialize;
use sextant_channel::{ChannelLaw, Db, Dbm, ObstacleField, PathBudget};
use sextant_sim::{LinkBudget, LinkReception, ReceptionModel};

use super::changes::{BurstsReport, FadingReport, MeasuredReport};
use super::rays::RayReport;

/// The link between two stations. It prints as a table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LinkReport {
    /// Name of the scenario.
    pub scenario: String,
    /// Its seed, which shadowing is drawn from.
    pub seed: u64,
    /// Name of the network, if the scenario has several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub network: Option<String>,
    /// The two ends.
    pub ends: [LinkEnd; 2],
    /// Distance of the two (m).
    pub distance_m: f64,
    /// The radius of communication (m), if the channel has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_range_m: Option<f64>,
    /// Loss on the way, the same in both directions; absent beyond the radius of communication.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub path: Option<PathReport>,
    /// The ways of a signal from the first end to the second one: the straight line, then the others, the strongest first;
    /// absent beyond the radius of communication.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rays: Option<Vec<RayReport>>,
    /// Gain of the sum of the fields of all rays (dB): that of a narrow band.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub field_gain_db: Option<f64>,
    /// How shadowing changes the power.
    pub shadowing: ShadowingReport,
    /// How fading changes the power, if links fade.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fading: Option<FadingReport>,
    /// How bursts of loss change the link, if there are any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bursts: Option<BurstsReport>,
    /// Share of the frames, received otherwise, that receivers lose (`faults.message_loss`): all probabilities count it. Absent if they
    /// lose none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub message_loss: Option<f64>,
    /// From the first end to the second one, and back; absent beyond the radius of communication.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub directions: Option<[Direction; 2]>,
}

/// An end of a link.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LinkEnd {
    /// Its name.
    pub name: String,
    /// What it is.
    pub kind: &'static str,
    /// Where it is (m).
    pub position_m: [f64; 3],
}

/// Loss on the way.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PathReport {
    /// Path loss exponent.
    pub exponent: f64,
    /// Distance to which the reference loss refers (m).
    pub reference_distance_m: f64,
    /// Loss at the reference distance (dB).
    pub reference_loss_db: f64,
    /// Loss from there on by the exponent (dB).
    pub distance_loss_db: f64,
    /// Loss by the gases of the air (dB), if there are any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gas_loss_db: Option<f64>,
    /// The obstacles that the straight line crosses, by index.
    pub obstacles: Vec<LossOfObstacle>,
    /// Loss by all of them (dB); `None` if nothing gets through.
    pub obstacle_loss_db: Option<f64>,
    /// Whether obstacles absorb power in this channel.
    pub obstacles_attenuate: bool,
    /// Loss of each reflection (dB), the strongest first; absent if the channel has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reflections_loss_db: Option<Vec<f64>>,
    /// Gain by all reflections together (dB).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reflection_gain_db: Option<f64>,
    /// Gain of the reflections alone (dB), if nothing gets through on the straight line: it replaces all losses of that.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reflections_alone_db: Option<f64>,
}

/// An obstacle on the way.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LossOfObstacle {
    /// Its index: first come `world.obstacles`, then the pieces of `world.walls`, then the slabs of `world.storeys`.
    pub obstacle: usize,
    /// Its name, if it has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Its material, if it has one by name.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub material: Option<&'static str>,
    /// Length of the line inside it (m).
    pub length_m: f64,
    /// Loss by absorption over this length (dB).
    pub absorption_db: f64,
    /// Loss however thick it is, for all passages (dB); `None` if it lets nothing through.
    pub fixed_db: Option<f64>,
    /// The whole loss (dB); `None` if it lets nothing through.
    pub loss_db: Option<f64>,
}

/// How shadowing changes the power of a link.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ShadowingReport {
    /// Standard deviation (dB).
    pub sigma_db: f64,
    /// Who has a draw: `per_packet`, `per_link` or `spatial`.
    pub correlation: &'static str,
    /// The gain of this link (dB), if it has one for all packets.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub draw_db: Option<f64>,
}

/// A link in one direction.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Direction {
    /// Who sends.
    pub from: String,
    /// Who receives.
    pub to: String,
    /// Transmit power (dBm).
    pub tx_power_dbm: f64,
    /// The best sector of the sender, if its antenna has sectors.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sector: Option<u8>,
    /// Gain of the sender towards the receiver, with that sector (dB).
    pub transmit_gain_db: f64,
    /// Gain of the receiver (dB).
    pub receive_gain_db: f64,
    /// What was measured in this direction at the start, if the network has measured links: it replaces the items above, and
    /// the share replaces the rule of the receiver.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub measured: Option<MeasuredReport>,
    /// Power at the receiver (dBm); `None` if nothing arrives. Without shadowing if each packet has its own, and without fading
    /// that changes in time.
    pub received_dbm: Option<f64>,
    /// What the receiver makes of it.
    pub reception: ReceptionReport,
}

/// What a receiver makes of a power, if nobody else sends.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReceptionReport {
    /// Minimum power of a frame that can be received (dBm).
    pub sensitivity_dbm: f64,
    /// Noise in the bandwidth of the receiver (dBm).
    pub noise_floor_dbm: f64,
    /// Ratio of the power to the noise (dB).
    pub snr_db: Option<f64>,
    /// The rule that decides: `overlap`, `sinr_threshold`, `sir_threshold` or `ber`.
    pub rule: &'static str,
    /// The ratio that the rule demands (dB), of the signal to noise and interference together or, with `sir_threshold`, to
    /// interference alone: how much stronger than all others a frame must be to survive.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub threshold_db: Option<f64>,
    /// Least power at which a frame is received (dBm), by the sensitivity and by the noise.
    pub least_power_dbm: f64,
    /// How far the power is above it (dB).
    pub margin_db: Option<f64>,
    /// Size of the frame of the probabilities (octets).
    pub frame_octets: u16,
    /// Probability that such a frame is received at this power.
    pub probability: f64,
    /// The same over all draws of shadowing, fading and bursts of loss.
    pub probability_over_shadowing: f64,
    /// Power from which on the receiver finds the channel busy (dBm).
    pub busy_from_dbm: f64,
    /// Whether the receiver finds it busy while the sender sends.
    pub is_busy: bool,
}

impl PathReport {
    pub(super) fn new(law: &ChannelLaw, path: &PathBudget, tx: Dbm, obstacles: &ObstacleField) -> Self {
        let PathBudget { distance, obstacle_loss, reflections, .. } = path;
        let crossed = |loss: &sextant_channel::ObstacleLoss| LossOfObstacle {
            obstacle: loss.obstacle,
            name: obstacles.obstacles()[loss.obstacle].name().map(str::to_owned),
            material: obstacles.obstacles()[loss.obstacle].material().map(|material| material.name),
            length_m: loss.length_m,
            absorption_db: loss.absorption.0,
            fixed_db: finite(loss.fixed.0),
            loss_db: finite(loss.loss().0),
        };
        let reflected = reflections.as_ref().filter(|rays| !rays.is_empty());
        Self {
            exponent: law.path_loss().exponent(),
            reference_distance_m: law.path_loss().reference_distance_m(),
            reference_loss_db: distance.reference.0,
            distance_loss_db: distance.spreading.0,
            gas_loss_db: distance.gas.map(|gas| gas.0),
            obstacles: path.obstacles.iter().map(crossed).collect(),
            obstacle_loss_db: finite(obstacle_loss.0),
            obstacles_attenuate: law.obstacles_attenuate(),
            reflections_loss_db: reflections.as_ref().map(|rays| rays.iter().map(|ray| ray.loss.0).collect()),
            reflections_alone_db: reflected
                .filter(|_| obstacle_loss.0.is_infinite())
                .and_then(|_| finite((path.mean_power(tx) - tx).0)),
            reflection_gain_db: reflected.and_then(|_| finite((path.mean_power(tx) - path.direct_power(tx)).0)),
        }
    }
}

impl Direction {
    pub(super) fn new(from: &str, to: &str, budget: &LinkBudget) -> Self {
        Self {
            from: from.to_owned(),
            to: to.to_owned(),
            tx_power_dbm: budget.tx_power.0,
            sector: budget.sector,
            transmit_gain_db: budget.transmit_gain.0,
            receive_gain_db: budget.receive_gain.0,
            measured: MeasuredReport::of(budget),
            received_dbm: finite(budget.power.0),
            reception: ReceptionReport::new(&budget.reception, budget.power),
        }
    }
}

impl ReceptionReport {
    fn new(reception: &LinkReception, power: Dbm) -> Self {
        let (rule, threshold) = match reception.model {
            ReceptionModel::Overlap => ("overlap", None),
            ReceptionModel::SinrThreshold { least } => ("sinr_threshold", Some(least)),
            ReceptionModel::SirThreshold { least } => ("sir_threshold", Some(least)),
            ReceptionModel::Ber => ("ber", None),
        };
        Self {
            sensitivity_dbm: reception.sensitivity.0,
            noise_floor_dbm: reception.noise_floor.0,
            snr_db: finite((power - reception.noise_floor).0),
            rule,
            threshold_db: threshold.map(|least| Db::from_factor(least).0),
            least_power_dbm: reception.least_power.0,
            margin_db: finite((power - reception.least_power).0),
            frame_octets: reception.frame_octets,
            probability: reception.probability,
            probability_over_shadowing: reception.probability_over_shadowing,
            busy_from_dbm: reception.busy_from.0,
            is_busy: reception.is_busy(power),
        }
    }
}

/// A number that JSON can write.
fn finite(number: f64) -> Option<f64> {
    Some(number).filter(|number| number.is_finite())
}
