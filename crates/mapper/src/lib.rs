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
//! let stops = (0..9).map(|i| Stop { robot: RobotId(0), time: SimTime::ZERO, position: Position::new(f64::from(i), 0.0, 0.0) });
//! let heard = |stop| Reception { node: NodeId(0), stop, received: 1, sent: 1, sector: None, rssi_dbm: None, snr_db: None };
//! let log = ReceptionLog::new(vec!["n0".into()], stops.collect(), (3..6).map(heard).collect(), Vec::new())?;
//!
//! let profile = ProfileConfig::Trapezoid(TrapezoidConfig::new(0.9, 1.0, 3.0));
//! let map = MlTm::try_from(MlTmConfig::new(0.25, profile))?.map(&log, &Unwatched)?;
//! let place = map.estimates[0].as_ref().expect("the node was heard").position;
//! assert!((place.x_m - 4.0).abs() < 0.5);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod algorithm;
mod alignment;
mod auto;
mod bounded_search;
mod cells;
mod comparators;
mod concern;
mod directions;
mod error;
mod estimate_kind;
mod findings;
mod fitted;
mod fitted_ml_tm;
mod heights;
mod isotonic;
mod joint;
mod knowledge;
pub mod lateration;
mod lattice;
mod least_squares;
mod link_model;
mod local_posterior;
mod memory;
mod metrics;
mod ml_tm;
mod mm_tm;
mod node_evidence;
mod normal;
mod obstacle_ml_tm;
mod orientation;
mod own_place;
mod packet_centroid;
mod place_prior;
mod posterior_bound;
mod profile;
mod purpose;
mod reach;
mod region;
mod search_box;
mod sector_errors;
mod sectors;
mod self_calibrated;
mod solver;
mod surface;
mod topology_map;

pub use algorithm::{AlgorithmConfig, Learned, MapConfig, Mapper, ProfileSetting};
pub use alignment::{AlignmentError, Reflection, Similarity};
pub use auto::{Auto, AutoConfig, Choice, ChoiceReason, EstimatorFit, Score};
pub use comparators::{
    Apit, ApitConfig, AxesConfig, Centroid, CentroidConfig, Comparator, CountConfig, DrMds, DrMdsConfig, DvHop,
    DvHopConfig, ExtremeConfig, FittedChannel, FrameConfig, GaussianProcess, GaussianProcessConfig, HopLength,
    LandmarksConfig, LogDistance, LogDistanceConfig, MdsMap, MdsMapConfig, NtldvHop, NtldvHopConfig, Ranging,
    RangingConfig, RssGrid, RssGridConfig, RssMl, RssMlConfig, RssiCentroid, RssiCentroidConfig, Smacof,
    SmacofConfig, StrongestStop, StrongestStopConfig, Tpm, TpmConfig, TriangleCentroid, TriangleCentroidConfig,
    TriangleWeights, WeightedCentroid, WeightedCentroidConfig,
};
pub use concern::Concern;
pub use error::MapError;
pub use estimate_kind::{EstimateKind, TieRule};
pub use fitted::{Fit, Fitted};
pub use fitted_ml_tm::FittedMlTm;
pub use heights::{HeightReason, SoughtHeights};
pub use isotonic::never_rising;
pub use joint::{JointConfig, JointMlTm, JointNetworkConfig};
pub use knowledge::{Knowledge, KnowledgeKind};
pub use lattice::Lattice;
pub use link_model::{Law, LinkEvidence, LinkFit, LinkModel, LinkModelConfig, Losses, Receiver};
pub use metrics::{
    ConnectivityError, MetricError, NeighbourhoodRule, NodeDisplacement, PositionError, RssLinks, SectorDisplacement,
    SectorDisplacementRule, SectorDistance, connectivity_error, rss_crlb_m, sector_displacement, sector_of,
    topology_preservation_error,
};
pub use ml_tm::{CountRule, MlTm, MlTmConfig};
pub use mm_tm::MmTm;
pub use obstacle_ml_tm::ObstacleMlTm;
pub use orientation::{Bearing, DirectionRule, OrientationMethod, RingOrientation, UnorientedRing};
pub use own_place::{AnchorSilence, HeardAnchor, HeardSector, OwnEstimate, OwnPlace, OwnPlaceConfig, PlaceModel};
pub use packet_centroid::{PacketCentroid, PacketCentroidConfig};
pub use place_prior::{Area, PlacePrior};
pub use posterior_bound::{TrueModel, posterior_bound_m};
pub use profile::{
    ChannelProfileConfig, FittedConfig, ObstacleUse, ProfileConfig, ReceptionProfile, TableProfile, Trapezoid,
    TrapezoidConfig, at_least_one,
};
pub use region::Region;
pub use sectors::{SectorLayoutConfig, SectorModel, SectorTolerance, SectorsConfig, SilenceRule, SoftSectorsConfig};
pub use self_calibrated::{
    AbsorptionMap, CalibratedCurve, Calibration, ObstacleClaim, ObstacleKnowledge, SelfCalibrated,
    SelfCalibratedConfig,
};
pub use surface::Surface;
pub use topology_map::{CoordinateFrame, Estimate, TopologyMap};
