//! The results of a command as one JSON object, for scripts.
//!
//! Numbers are in SI units. A key that does not apply is absent. New keys may be added; existing keys do not change.
//! Everything except [`Summary::timing`] depends on scenario and seed alone.

mod battery;
mod distributed;
mod distributed_table;
mod gathering;
mod judgement;
mod links;
mod log_counts;
mod mac;
mod mac_table;
mod map;
mod map_judgement;
pub mod measures;
mod missions;
mod missions_table;
mod results;
mod robots;
mod routing;
mod routing_table;
mod rpl;
mod sensing;
mod table;
mod timing;
mod tracks;

pub use battery::{BatteryNodeSummary, BatterySummary, LifetimeSummary};
pub use distributed::{
    AnchorCounts, DistributedSummary, MeanAndMax, MessagesSummary, MobileAnchorsSummary, OrientationErrorSummary,
};
pub use gathering::{
    DiscoverySummary, EnergySummary, GatheringSummary, NotListenedSummary, RoundSummary, SectorReportsSummary,
};
pub use judgement::{Judgement, JudgementLevel};
pub use links::LinkSummary;
pub(crate) use log_counts::LogCounts;
pub use mac::{
    DelayBin, DelaySummary, MacSummary, NamedTraffic, NegotiatedSummary, SinkSummary, SleepSummary, SlotSummary,
    TrafficSummary,
};
pub use map::{
    AlignmentSummary, ConcernSummary, ConnectivitySummary, ErrorSummary, HeightsSource, HeightsSummary,
    LearnedSummary, MapSummary, MeasuredIn, SectorPairsSummary, SectorsSummary,
};
pub(crate) use map::{NODE_ERRORS, POSITION_ERRORS_M};
pub use measures::{Measure, Numbers, Unit, UnknownMeasure};
pub(crate) use missions::SEARCH_INSTANTS_S;
pub use missions::{ArrivalSummary, MissionMessages, MissionRobot, MissionSummary, MissionTarget, SearchInstant};
pub use results::{FaultsSummary, RegionSummary, ScenarioSummary, SimulationSummary, Summary};
pub use robots::{LeftOutSummary, RobotEnd, RobotSummary};
pub use routing::{AnswersSummary, DepthSummary, HopsSummary, RoutedNodeSummary, RoutingSummary};
pub use rpl::{FragmentsSummary, HealingSummary, RplSummary};
pub use sensing::{SensingSummary, SensorErrorCounts};
pub use table::write;
pub use timing::{Stopwatch, Timing, peak_rss_bytes};
pub use tracks::{DoubtedSummary, TrackSummary, UnexplainedSummary};
