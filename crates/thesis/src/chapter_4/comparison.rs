//! MmTM in three set-ups against DR-MDS and NTLDV-HOP (section 4.4.2).

use super::super::claim::{Check, Claim};
use super::super::comparison_charts::{DISPLACEMENTS, comparison_charts};
use super::super::environment::Environment;
use super::super::experiment::{Content, Experiment, Quantity};
use super::super::published::Published;
use super::super::runs::Term;
use super::place::{DR_MDS, ESTIMATORS, Estimator, MMTM, NTLDV_HOP, Setup};
use sextant::summary::measures::{map, position_errors};
use sextant::summary::{MapSummary, Number};

const SECTION: &str = "section 4.4.2";

const MEAN: &Number<MapSummary> = &map::POSITION_ERROR_MEAN_M;
const NEAR: &Number<MapSummary> = &position_errors::WITHIN_0_7_M;

const ERRORS: [(&str, &Number<MapSummary>); 4] = [
    ("mean distance error", MEAN),
    ("median distance error", &map::POSITION_ERROR_MEDIAN_M),
    ("80th percentile of the distance error", &map::POSITION_ERROR_P80_M),
    ("90th percentile of the distance error", &map::POSITION_ERROR_P90_M),
];

/// A map that is compared.
struct Contender {
    name: String,
    scenario: &'static str,
    estimator: &'static Estimator,
}

impl Contender {
    fn mmtm(setup: Setup, environment: Environment) -> Self {
        let (name, scenario) = (format!("MmTM with {}", setup.name()), setup.scenario(environment));
        Self { name, scenario, estimator: &MMTM }
    }

    fn other(estimator: &'static Estimator, environment: Environment) -> Self {
        Self { name: estimator.name.to_owned(), scenario: environment.comparison(), estimator }
    }

    fn term(&self, number: &'static Number<MapSummary>) -> Term {
        Term::new(self.scenario, self.estimator.measure(number))
    }

    fn quantity(&self, what: &str, number: &'static Number<MapSummary>) -> Quantity {
        Quantity::new(format!("{}: {what}", self.name), self.scenario, self.estimator.measure(number))
    }
}

/// The maps of an environment that are compared.
struct Contenders {
    mmtm: [Contender; 3],
    others: [Contender; 2],
}

impl Contenders {
    fn of(environment: Environment) -> Self {
        Self {
            mmtm: Setup::ALL.map(|setup| Contender::mmtm(setup, environment)),
            others: [&DR_MDS, &NTLDV_HOP].map(|estimator| Contender::other(estimator, environment)),
        }
    }

    fn all(&self) -> impl Iterator<Item = &Contender> {
        self.mmtm.iter().chain(&self.others)
    }
}

pub(super) fn experiment(id: &'static str, environment: Environment) -> Experiment {
    let contenders = Contenders::of(environment);
    let mut quantities: Vec<Quantity> = contenders.mmtm.iter().flat_map(of_mmtm).collect();
    quantities.extend(contenders.others.iter().flat_map(of_other));
    for setup in Setup::ALL {
        for estimator in &ESTIMATORS[1..] {
            let name = format!("{}, {}", setup.name(), estimator.name);
            let contender = Contender { name, scenario: setup.scenario(environment), estimator };
            let of = |(what, number)| contender.quantity(what, number);
            quantities.extend([ERRORS[0], ERRORS[2]].map(of));
            quantities.push(contender.quantity("nodes with zero sector displacement", DISPLACEMENTS[0]));
        }
    }
    let names = ["cdf", "displacement"].map(|what| format!("{id}-{what}"));
    let maps: Vec<_> = contenders.all().map(|contender| (contender.name.clone(), contender)).collect();
    Experiment {
        id,
        title: match environment {
            Environment::Warehouse => "Comparison with DR-MDS and NTLDV-HOP in the warehouse",
            Environment::Greenhouse => "Comparison with DR-MDS and NTLDV-HOP in the greenhouse",
        },
        content: Content::Quantities(quantities),
        distributions: &[],
        charts: comparison_charts(names, environment, &maps, |contender, number| contender.term(number)).to_vec(),
        claims: claims(&contenders),
        notes: &[
            "The robot has 16 sectors. The layouts are ours, because the figures of the thesis are lost.",
            "The papers of DR-MDS and NTLDV-HOP were not available: both are reconstructed from what is known of them, with \
             the true path loss. The thesis does not say how many anchors they had; here a fifth of the nodes. Their \
             neighbours and ranges come from neighbour discovery over the sectors of the nodes.",
            "Errors are over the nodes with a position that the map had to estimate. The shares and distributions of errors \
             count nodes without a position as infinitely far.",
            "The thesis compares the distributions by a logarithm of the error, and says that the error of all nodes in MmTM is \
             less than 5 % of that of the others. Here the means are compared.",
            "The thesis defines the sector displacement for pairs of neighbours, and counts nodes: here the displacement of a \
             node is the median over its neighbours on the ground, unless `metrics` of the scenario says otherwise.",
        ],
    }
}

fn of_mmtm(contender: &Contender) -> Vec<Quantity> {
    quantities(contender, Some("> 50"), None, Some("80"))
}

fn of_other(contender: &Contender) -> Vec<Quantity> {
    quantities(contender, Some("< 20"), Some("> 30"), None)
}

/// The lines of a map; published are the shares with zero and three sectors of displacement, and near the truth.
fn quantities(contender: &Contender, zero: Option<&str>, three: Option<&str>, near: Option<&str>) -> Vec<Quantity> {
    let published = |quantity: Quantity, value: Option<&str>| match value {
        Some(value) => quantity.published(value, SECTION),
        None => quantity,
    };
    let mut quantities: Vec<_> = ERRORS.map(|(what, number)| contender.quantity(what, number)).to_vec();
    quantities.push(published(contender.quantity("nodes with an error of at most 0.7 m", NEAR), near));
    for (sectors, number) in DISPLACEMENTS.into_iter().enumerate() {
        let what = format!("nodes with a sector displacement of {sectors}");
        let value = match sectors {
            0 => zero,
            3 => three,
            _ => None,
        };
        quantities.push(published(contender.quantity(&what, number), value));
    }
    let pairs = &map::SECTOR_DISPLACEMENT_OF_PAIRS_0;
    quantities.push(contender.quantity("pairs of neighbours with zero sector displacement", pairs));
    quantities.push(contender.quantity("nodes without a position", &map::UNMAPPED));
    quantities
}

fn claims(contenders: &Contenders) -> Vec<Claim> {
    let claim =
        |text: String, value: &str, check| Claim { text, published: Some(Published::new(value, SECTION)), check };
    let Contenders { mmtm, others } = contenders;
    let mut claims = Vec::new();
    for contender in mmtm {
        let name = &contender.name;
        for other in others {
            claims.push(claim(
                format!("the mean error of {name} is below 5 % of that of {}", other.name),
                "\"less than 5%\"",
                Check::Ratio([contender.term(MEAN), other.term(MEAN)], 0.0..0.05),
            ));
        }
    }
    for contender in mmtm {
        let name = &contender.name;
        claims.push(claim(
            format!("at least 80 % of the nodes of {name} have an error of at most 0.7 m"),
            "\"80% of nodes\"",
            Check::Above(contender.term(NEAR), 0.8),
        ));
        claims.push(claim(
            format!("more than half of the nodes of {name} have zero sector displacement"),
            "\"more than 50%\"",
            Check::Above(contender.term(DISPLACEMENTS[0]), 0.5),
        ));
    }
    for other in others {
        let name = &other.name;
        claims.push(claim(
            format!("less than a fifth of the nodes of {name} have zero sector displacement"),
            "\"less than 20%\"",
            Check::Below(other.term(DISPLACEMENTS[0]), 0.2),
        ));
        claims.push(claim(
            format!("more than 30 % of the nodes of {name} have a sector displacement of three"),
            "\"more than 30%\"",
            Check::Above(other.term(DISPLACEMENTS[3]), 0.3),
        ));
    }
    let [vaa, vbs, space] = mmtm;
    claims.push(claim(
        "the mean error of MmTM with 3D is less than with VAA and VBS".to_owned(),
        "\"3D robot path antenna setup has a better performance\"",
        Check::Least([space, vaa, vbs].map(|contender| contender.term(MEAN)).to_vec()),
    ));
    claims
}
