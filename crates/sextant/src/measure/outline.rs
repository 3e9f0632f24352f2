//! The properties of a map in the summary, without the truth.

use sextant_kernel::NodeId;
use sextant_mapper::{
    AbsorptionMap, CalibratedCurve, Calibration, ChoiceReason, Concern, EstimatorFit, Fit, FittedChannel,
    HeightReason, Learned, LinkFit, ObstacleKnowledge, PositionError, Score, SoughtHeights, TopologyMap,
};

use super::subject::Subject;
use crate::summary::{
    CalibrationSummary, ConcernSummary, ErrorSummary, EstimatorScoreSummary, FittedChannelSummary,
    FittedProfileSummary, HeightsSource, HeightsSummary, LinkLawSummary, MapSummary, NetworkProfileSummary,
};

/// The properties of a map of nodes with these `names`, without the truth.
#[must_use]
pub fn outline(subject: &Subject<'_>, map: &TopologyMap, learned: Option<&Learned>, names: &[String]) -> MapSummary {
    let mut outline = MapSummary::default();
    match learned {
        Some(Learned::Profile(fit)) => outline.fitted_profile = Some(of_fit(fit, map)),
        Some(Learned::Profiles(fits)) => {
            let of_network =
                |(name, fit): &(String, Fit)| NetworkProfileSummary { network: name.clone(), profile: fit.into() };
            outline.fitted_profiles = fits.iter().map(of_network).collect();
        }
        Some(Learned::Calibration(calibration)) => outline_calibration(&mut outline, calibration, names),
        Some(Learned::Links(fit)) => outline.link_law = Some(fit.into()),
        Some(Learned::Choice(choice)) => {
            outline.chosen = Some(choice.chosen);
            outline.chosen_because = Some(because(choice.reason));
            outline.region_enlargement = Some(choice.enlargement).filter(|factor| *factor > 1.0);
            outline.scores = choice.scores.iter().map(Into::into).collect();
            match &choice.fit {
                Some(EstimatorFit::Links(fit)) => outline.link_law = Some(fit.into()),
                Some(EstimatorFit::Profile(fit)) => outline.fitted_profile = Some(of_fit(fit, map)),
                Some(EstimatorFit::Calibration(fit)) => outline_calibration(&mut outline, fit, names),
                None => {}
            }
        }
        Some(Learned::Channel(channel)) => {
            // A node whose place is not reliable has not converged.
            let converged = channel.converged && map.concerns().next().is_none();
            outline.fitted_channel = Some(FittedChannelSummary { converged, ..FittedChannelSummary::from(channel) });
        }
        _ => {}
    }
    let concern = |(node, concern): (NodeId, Concern)| ConcernSummary { node: names[node.index()].clone(), concern };
    let name = subject.name;
    let coincident = map.coincident();
    MapSummary {
        name: (name != map.algorithm).then(|| name.to_owned()),
        algorithm: map.algorithm.to_owned(),
        knowledge: subject.knowledge.to_vec(),
        networks: subject.networks.clone(),
        concerns: map.concerns().map(concern).collect(),
        heights: map.heights.map(HeightsSummary::from),
        coincident: (coincident > 0).then_some(coincident),
        mapped: map.mapped(),
        unmapped: map.unmapped(),
        ambiguous: Some(map.estimates.iter().flatten().filter(|estimate| estimate.ties > 1).count()),
        infeasible: Some(map.infeasible()),
        grid_step_m: map.grid_step_m,
        vertices_evaluated: (map.vertices_evaluated > 0).then_some(map.vertices_evaluated),
        ..outline
    }
}

fn of_fit(fit: &Fit, map: &TopologyMap) -> FittedProfileSummary {
    let profile = FittedProfileSummary::from(fit);
    // A node whose place is not reliable has not converged.
    let converged = profile.converged && map.concerns().next().is_none();
    FittedProfileSummary { converged, ..profile }
}

fn outline_calibration(outline: &mut MapSummary, calibration: &Calibration, names: &[String]) {
    outline.at_bound = calibration.at_bound.iter().map(|node| names[node.index()].clone()).collect();
    outline.calibration = Some(calibration.into());
}

impl From<&Fit> for FittedProfileSummary {
    fn from(fit: &Fit) -> Self {
        let range_m = fit.curve.range_m();
        Self {
            rounds: fit.rounds,
            converged: fit.converged,
            range_m,
            probability: (0..8).map(|i| fit.curve.probability(range_m * f64::from(i) / 8.0)).collect(),
            dead_stops: fit.dead_stops.clone(),
            outliers: fit.outliers.len(),
        }
    }
}

impl From<&FittedChannel> for FittedChannelSummary {
    fn from(channel: &FittedChannel) -> Self {
        Self {
            rounds: channel.rounds,
            converged: channel.converged,
            exponent: channel.exponent,
            tx_power_dbm: channel.tx_power_dbm,
            reference_distance_m: channel.reference_distance_m,
            sigma_db: channel.sigma_db,
            sensitivity_dbm: channel.sensitivity_dbm,
            loss: channel.loss,
        }
    }
}

impl From<&Calibration> for CalibrationSummary {
    fn from(calibration: &Calibration) -> Self {
        let range_m = calibration.curve.as_ref().map(CalibratedCurve::range_m);
        let along = |curve: &CalibratedCurve| {
            (0..8).map(|i| curve.probability(curve.range_m() * f64::from(i) / 8.0)).collect::<Vec<_>>()
        };
        let mut efficiency = calibration.efficiency.clone();
        efficiency.sort_by(f64::total_cmp);
        let quarter = |i: usize| efficiency[i * (efficiency.len() - 1) / 4];
        Self {
            rounds: calibration.rounds,
            converged: calibration.converged,
            range_m,
            curve_at_bound: calibration.curve_at_bound,
            probability: calibration.curve.as_ref().map(along).unwrap_or_default(),
            efficiency: if efficiency.is_empty() { Vec::new() } else { (0..=4).map(quarter).collect() },
            obstacle_knowledge: match calibration.knowledge {
                ObstacleKnowledge::None => "none",
                ObstacleKnowledge::FromReceptions => "from_receptions",
                ObstacleKnowledge::FromLog => "from_log",
            },
            absorbing_m2: calibration.obstacles.as_ref().map(AbsorptionMap::sure_m2),
            unsure_m2: calibration.obstacles.as_ref().map(AbsorptionMap::unsure_m2).filter(|&area_m2| area_m2 > 0.0),
        }
    }
}

/// The reason of a choice in words.
fn because(reason: ChoiceReason) -> &'static str {
    match reason {
        ChoiceReason::KnownPlaces => "only it can use what is known of the places",
        ChoiceReason::TooLittle => "the log has too few stops or nodes to compare estimators",
        ChoiceReason::IndependentPackets => {
            "it predicts the stops left out no worse than the link model: packets of a link seem independent"
        }
        ChoiceReason::DependentPackets => {
            "it predicts the stops left out best: packets of a link share what they lose, so that they are not independent"
        }
        ChoiceReason::BetterPlaces => {
            "its places predict the stops left out clearly better than those of the link model"
        }
    }
}

impl From<&LinkFit> for LinkLawSummary {
    fn from(fit: &LinkFit) -> Self {
        let LinkFit { law, receiver, losses, outage, evidence, rounds, settled } = *fit;
        Self {
            evidence,
            rounds,
            settled,
            distance_m: law.distance_m,
            margin: law.margin,
            slope: law.slope,
            slope_spread: law.slope_spread,
            shadowing: law.shadowing,
            shared: law.shared,
            correlation_m: law.correlation_m,
            offset: law.offset,
            direction: law.direction,
            lapse: losses.lapse,
            lapse_scatter: losses.scatter,
            outage,
            threshold_dbm: receiver.map(|receiver| receiver.threshold_dbm),
            fading_db: receiver.map(|receiver| receiver.fading_db),
            path_loss_exponent: fit.path_loss_exponent(),
            shadowing_db: receiver.map(|receiver| receiver.fading_db * law.shadowing),
        }
    }
}

impl From<&Score> for EstimatorScoreSummary {
    fn from(&Score { estimator, log_probability, error, pairs }: &Score) -> Self {
        Self { estimator, log_probability, standard_error: error, pairs }
    }
}

impl From<SoughtHeights> for HeightsSummary {
    fn from(SoughtHeights { low_m, high_m, reason }: SoughtHeights) -> Self {
        let (from, uneven_m) = match reason {
            HeightReason::Settings => (HeightsSource::Settings, None),
            HeightReason::LevelStops => (HeightsSource::Stops, None),
            HeightReason::UnevenStops(span_m) => (HeightsSource::Stops, Some(span_m)),
            HeightReason::Reach => (HeightsSource::Reach, None),
        };
        Self { low_m, high_m, from, uneven_m }
    }
}

impl From<PositionError> for ErrorSummary {
    fn from(PositionError { mean, median, p80, p90, p95, max }: PositionError) -> Self {
        Self { mean, median, p80, p90, p95, max }
    }
}
