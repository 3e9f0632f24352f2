//! What became of the links that robots kept.

use serde::Serialize;
use sextant_apps::LinkRecord;

/// What became of the links that robots kept while they drove. Shares are of all beacon intervals, unless said otherwise.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct LinkSummary {
    /// Share of the data time in which no scheme would have been received over the link, or there was none.
    pub outage: f64,
    /// Share of the time in which no pair of sectors of any node could have carried data.
    pub ideal_outage: f64,
    /// Payload that arrived (bit/s).
    pub throughput_bit_per_s: f64,
    /// The same if the best pair of sectors of the best node were known at any time and nothing were trained.
    pub ideal_throughput_bit_per_s: f64,
    /// Share of the time that beacons, slots for answers and refinements took.
    pub overhead: f64,
    /// Mean by how much the link was weaker than the best pair of sectors, while it carried data (dB). Absent if it never did.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub snr_loss_db: Option<f64>,
    /// Share of the data frames that were not received. Absent if none was sent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frames_lost: Option<f64>,
    /// Trainings with all sectors.
    pub searches: u64,
    /// Trainings with the sectors round the predicted one.
    pub near_trainings: u64,
    /// Trainings that left a robot without a link.
    pub failed_trainings: u64,
    /// Answers that collided in a slot.
    pub collided: u64,
    /// Links that went on to another node.
    pub handovers: u64,
    /// Share of the data time by the fastest scheme that the link could carry: none, MCS 1 to 12.
    pub by_mcs: Vec<f64>,
}

impl From<&LinkRecord> for LinkSummary {
    fn from(record: &LinkRecord) -> Self {
        let time_s = record.time.as_secs_f64();
        let data_s = (record.time - record.training).as_secs_f64();
        let share = |part_s: f64, whole_s: f64| if whole_s > 0.0 { part_s / whole_s } else { 0.0 };
        Self {
            outage: share(record.outage.as_secs_f64(), data_s),
            ideal_outage: share(record.ideal_outage.as_secs_f64(), time_s),
            throughput_bit_per_s: share(record.bits as f64, time_s),
            ideal_throughput_bit_per_s: share(record.ideal_bits as f64, time_s),
            overhead: share(record.training.as_secs_f64(), time_s),
            snr_loss_db: (record.loss_s > 0.0).then(|| record.loss_db_s / record.loss_s),
            frames_lost: (record.frames > 0).then(|| record.lost_frames as f64 / record.frames as f64),
            searches: record.searches,
            near_trainings: record.near_trainings,
            failed_trainings: record.failed_trainings,
            collided: record.collided,
            handovers: record.handovers,
            by_mcs: record.by_mcs.iter().map(|time| share(time.as_secs_f64(), data_s)).collect(),
        }
    }
}
