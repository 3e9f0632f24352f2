//! Topology maps from reception logs, and measures of how good a map is.
//!
//! Input: a [`ReceptionLog`](sextant_channel::ReceptionLog), which holds what robots recorded, and a
//! [`ReceptionProfile`], which gives the probability that a packet is received over a distance. Output: a
//! [`TopologyMap`] with an [`Estimate`] for each node that was heard. Algorithms for comparison may use more
//! knowledge ([`Knowledge`]) and state which kinds they use ([`KnowledgeKind`]). The crate does not depend on the
//! simulation and has no access to ground truth. Its metrics compare any two lists of places.
//!
//! ```
//! use sextant_channel::{Position, Reception, ReceptionLog, Stop};
//! use sextant_kernel::{NodeId, RobotId, SimTime, Unwatched};
//! use sextant_mapper::{MlTm, MlTmConfig, ProfileConfig, TrapezoidConfig};
//!
//! // A robot drives 8 m east and hears a node from the third to the fifth of its nine stops.
//! let stops = (0..9).map(|i| Stop { robot: RobotId(0), time: SimTime::ZERO, position: Position::new(f64::from(i), 0.0, 0.0), heading_rad: None });
//! let heard = |stop| Reception { node: NodeId(0), stop, received: 1, sent: 1, sector: None, rssi_dbm: None, snr_db: None };
//! let log = ReceptionLog::new(vec!["n0".into()], stops.collect(), (3..6).map(heard).collect(), Vec::new())?;
//!
//! let profile = ProfileConfig::Trapezoid(TrapezoidConfig::new(0.9, 1.0, 3.0));
//! let map = MlTm::try_from(MlTmConfig::new(0.25, profile))?.map(&log, &Unwatched)?;
//! let place = map.estimates[0].as_ref().expect("the node was heard").position;
//! assert!((place.x_m - 4.0).abs() < 0.5);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Cargo features, all on by default: `config` reads settings and writes results with serde and has their JSON schema;
//! `obstacles` maps among known obstacles, for which it needs a geometry library. A log is mapped without either.

#![cfg_attr(test, allow(clippy::disallowed_methods, reason = "oracles may be those of the C library"))]

mod absorption;
mod algorithm;
mod auto;
mod comparable;
mod comparators;
mod count_rule;
mod each_node;
mod error;
mod estimator;
mod grid_ml;
mod joint_path;
mod knowledge;
mod lattice;
mod learned;
mod link_dependence;
mod link_model;
mod log_facts;
mod metrics;
mod numerics;
mod outlook;
mod own_place;
mod parts;
mod pattern;
mod posterior;
mod profile;
mod purpose;
mod range_ml;
mod ranging;
mod rss_grid;
mod self_calibrated;
mod stitch;
mod suitable;
mod surface;
mod survey_frame;
mod topology_map;

pub use absorption::{AbsorptionMap, ObstacleClaim};
pub use algorithm::{AlgorithmConfig, MapConfig};
pub use auto::{
    Auto, AutoConfig, Choice, ChoiceReason, EstimatorFit, Opinion, OpinionConstants, OpinionSource, Opinions,
    OtherOpinions, Score,
};
pub use comparable::Comparable;
pub use comparators::{
    AngleOfArrival, AngleOfArrivalConfig, Apit, ApitConfig, AxesConfig, Centroid, CentroidConfig, Comparator,
    CountConfig, DrMds, DrMdsConfig, DvHop, DvHopConfig, ExtremeConfig, FrameConfig, GaussianProcess,
    GaussianProcessConfig, HopLength, LandmarksConfig, LogDistance, LogDistanceConfig, MdsMap, MdsMapConfig,
    NtldvHop, NtldvHopConfig, PacketCentroid, PacketCentroidConfig, RssMl, RssMlConfig, RssiCentroid,
    RssiCentroidConfig, Smacof, SmacofConfig, StrongestStop, StrongestStopConfig, TimeDifference,
    TimeDifferenceConfig, TimeOfArrival, TimeOfArrivalConfig, Tpm, TpmConfig, TriangleCentroid,
    TriangleCentroidConfig, TriangleWeights, WeightedCentroid, WeightedCentroidConfig, lateration, localise,
};
pub use count_rule::CountRule;
pub use error::MapError;
pub use estimator::{
    AnyLog, Estimator, EstimatorSettings, Landmarks, Mapper, Messages, NodeOfLog, ProfileSetting, ReceiverSetting,
};
#[cfg(feature = "obstacles")]
pub use grid_ml::ObstacleMlTm;
pub use grid_ml::{
    Fit, Fitted, FittedMlTm, JointConfig, JointMlTm, JointNetworkConfig, MlTm, MlTmConfig, MmTm, NetworkFits,
};
pub use joint_path::{
    ContradictedPlace, DoubtedReceiver, EstimatedPath, FrameOfNodes, HeldOut, LateClock, OnEstimatedPath, OnRobot,
    PathError, PathErrorConfig, PathFit, PathPose, PathRanges, PathUse, PlaceUnit, RangeFault, TagReading, TagValue,
    Track, TrackFit, TrackHeight, TrackMotion, TrackPose, TrackRangeLaw, TrackSettings, TrackStrengthLaw,
    estimate_path, track,
};
pub use knowledge::{FrameKnowledge, Knowledge, KnowledgeKind};
pub use lattice::Lattice;
pub use learned::{CurveFinding, EstimatorFindings, Finding, Line, Section, StaticShadowing};
pub use link_dependence::LinkDependence;
pub use link_model::{Law, LinkEvidence, LinkFit, LinkModel, LinkModelConfig, Losses, Receiver};
pub use log_facts::{
    GrossStrength, HeightReason, SectorLayoutConfig, SectorModel, SectorTolerance, SectorsConfig, SilenceRule,
    SoftSectorsConfig, SoughtHeights, gross_strengths,
};
pub use metrics::{
    AlignmentError, ConnectivityError, MetricError, NeighbourhoodRule, NodeDisplacement, PositionError, Reflection,
    RssLinks, SectorDisplacement, SectorDisplacementRule, SectorDistance, Similarity, connectivity_error, rss_crlb_m,
    sector_displacement, sector_of, topology_preservation_error,
};
pub use numerics::{convex_hull, never_rising};
pub use outlook::{Outlook, OutlookError, StopGain};
pub use own_place::{
    AnchorSilence, Bearing, BearingTable, DirectionRule, HeardAnchor, HeardSector, OrientationMethod, OwnEstimate,
    OwnPlace, OwnPlaceConfig, PlaceModel, RingOrientation, SectorBearing, UnorientedRing,
};
pub use parts::{FixedLaw, LogParts, PartEstimator, PartsError};
pub use pattern::{PatternFit, PatternLaw, ReportLaw};
pub use posterior::{Area, Concern, Estimate, EstimateKind, PlacePrior, Region, TieRule, TrueRanges, range_bound_m};
#[cfg(feature = "obstacles")]
pub use posterior::{TrueModel, posterior_bound_m};
pub use profile::{
    ChannelProfileConfig, FittedConfig, ObstacleUse, ProfileConfig, ReceptionProfile, TableProfile, Trapezoid,
    TrapezoidConfig,
};
pub use range_ml::{AmbiguousNode, NodeBias, RangeFit, RangeMl, RangeMlConfig, RangeUnit};
pub use ranging::{Ranging, RangingConfig};
pub use rss_grid::{FittedChannel, RssGrid, RssGridConfig};
pub use self_calibrated::{CalibratedCurve, Calibration, ObstacleKnowledge, SelfCalibrated, SelfCalibratedConfig};
pub use stitch::{
    FrameAgreement, FrameChange, FrameCovariance, Frames, Handedness, JoinedFrame, OwnMap, PairFault, PairFit,
    PairState, PlacedNode, RobotFrame, RobotOutcome, StitchConfig, StitchRules, Stitched, Stitching, moved_log,
    stitch,
};
pub use surface::Surface;
pub use survey_frame::{Axes, SurveyFrame};
pub use topology_map::{CoordinateFrame, TopologyMap};
