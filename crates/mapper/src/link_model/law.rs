//! The law of links, and how it is found.

/// Number of parameters.
pub(super) const PARAMETERS: usize = 8;

/// The law of the margins of links, in standard deviations of the fading.
///
/// The margin of a link from node i to place k is `margin − slope ln(d / distance) + g + c(θ) + s`. `g` is the offset of
/// the node. `c` is what depends on the direction θ in which the node sends: cosine and sine of θ and 2θ with random
/// amplitudes. `s` is static shadowing: part of it is shared by neighbouring places, with a correlation of exp(−Δ/l)
/// (Gudmundson 1991), the rest is of the link alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Law {
    /// Mean margin at the distance `distance_m`.
    pub margin: f64,
    /// The distance (m).
    pub distance_m: f64,
    /// How much the margin falls when the distance grows by a factor of e.
    pub slope: f64,
    /// Standard deviation of the static shadowing.
    pub shadowing: f64,
    /// Share of the variance of the shadowing that neighbouring places share, 0 to 1.
    pub shared: f64,
    /// Distance over which shadowing is correlated (m).
    pub correlation_m: f64,
    /// Standard deviation of the offsets of nodes.
    pub offset: f64,
    /// Standard deviation of each amplitude of the dependence on direction.
    pub direction: f64,
    /// Standard deviation of the slopes of nodes, as a share of the slope: streets and roofs lose power at different rates.
    pub slope_spread: f64,
}

impl Law {
    /// The mean margin at a distance, as `a − slope ln d`: the `a`.
    pub(super) fn at_one_metre(&self) -> f64 {
        self.margin + self.slope * libm::log(self.distance_m)
    }

    /// Standard deviation of a margin about its mean at the distance `distance_m` of the law.
    pub(super) fn spread(&self) -> f64 {
        let (s, g, c) = (self.shadowing, self.offset, self.direction);
        (s * s + g * g + 2.0 * c * c).sqrt()
    }

    /// The law with the same spread in which nodes have nothing of their own.
    pub(super) fn of_alike_nodes(&self) -> Self {
        Self { shadowing: self.spread(), offset: 0.0, direction: 0.0, slope_spread: 0.0, ..*self }
    }

    /// Whether nodes have nothing of their own.
    pub(super) fn has_alike_nodes(&self) -> bool {
        self.offset == 0.0 && self.direction == 0.0
    }

    /// Whether no part of it is absent, so that a search that begins at it can reach all laws.
    pub(super) fn has_all_parts(&self) -> bool {
        self.offset > 0.0 && self.direction > 0.0 && self.slope_spread > 0.0 && self.shared > 0.0
    }

    /// The same law, with its margin at another distance (m).
    pub(super) fn at(&self, distance_m: f64) -> Self {
        let margin = self.margin - self.slope * libm::log(distance_m / self.distance_m);
        Self { margin, distance_m, ..*self }
    }

    /// Whether links share nothing but the distance.
    pub(super) fn has_independent_links(&self) -> bool {
        self.shared == 0.0 && self.has_alike_nodes()
    }

    /// Standard deviation of the slopes of nodes.
    pub(super) fn slope_deviation(&self) -> f64 {
        self.slope * self.slope_spread
    }

    /// The law with parameter `number` moved by `step`, or `None` if it is at its bound.
    pub(super) fn moved(&self, number: usize, step: f64) -> Option<Self> {
        let scaled = |value: f64, rate: f64, [low, high]: [f64; 2]| (value * libm::exp(rate * step)).clamp(low, high);
        let mut law = *self;
        match number {
            0 => law.margin = (law.margin + 0.4 * step).clamp(-8.0, 40.0),
            1 => law.slope = scaled(law.slope, 0.3, SLOPES),
            2 => law.shadowing = scaled(law.shadowing, 0.3, [0.1, 8.0]),
            3 => law.offset = scaled(law.offset, 0.3, [0.05, 4.0]),
            4 => {
                let odds = libm::log(law.shared / (1.0 - law.shared)) + step;
                law.shared = (1.0 / (1.0 + libm::exp(-odds))).clamp(LEAST_SHARED, 0.99);
            }
            5 => law.correlation_m = scaled(law.correlation_m, 0.3, [0.02 * self.distance_m, 10.0 * self.distance_m]),
            6 => law.direction = scaled(law.direction, 0.3, [0.05, 2.0]),
            _ => law.slope_spread = scaled(law.slope_spread, 0.5, [0.02, 0.6]),
        }
        (law != *self).then_some(law)
    }

    /// Whether parameter `number` is in the covariance of margins, apart from what nodes have of their own in slope and
    /// direction.
    pub(super) fn is_of_covariance(number: usize) -> bool {
        (2..=5).contains(&number)
    }

    /// Logarithm of the prior density of the law for each node of the log, up to a constant.
    ///
    /// Without true places, a log can explain itself by shadowing alone, with a flat curve. What is known of radio forbids
    /// it: over a factor of e in distance, links lose 6 to 17 dB (path-loss exponents of 1.5 to 4), shadowing is 4 to 8 dB
    /// (ITU-R P.1411), offsets of nodes and antennas are smaller.
    ///
    /// With strengths, a margin has `fading_db` decibels, and the path-loss exponent itself is known to be a few.
    pub(super) fn log_prior(&self, fading_db: Option<f64>) -> f64 {
        let far = |value: f64, usual: f64, factor: f64| {
            let units = libm::log(value / usual) / libm::log(factor);
            -0.5 * units * units
        };
        far(self.slope / self.shadowing, USUAL_SLOPE, 1.6)
            + far(self.direction / self.shadowing, USUAL_DIRECTION, 1.5)
            + 0.3 * far(self.offset / self.shadowing, USUAL_OFFSET, 3.0)
            + 0.3 * far(self.correlation_m, USUAL_CORRELATION * self.distance_m, 2.0)
            + 0.3 * far(self.slope_spread, USUAL_SLOPE_SPREAD, 2.0)
            + fading_db.map_or(0.0, |fading_db| far(exponent(self.slope, fading_db), USUAL_EXPONENT, 1.6))
    }

    /// The law between this one and that of usual links, in which this one has a `share`: each parameter is a geometric mean.
    /// The margin at a distance and the share of the shadowing that places share stay. A margin has `fading_db` decibels, and
    /// the median link has `median_m`.
    ///
    /// A law of highest evidence can be far off: strong shadowing over long distances, or a direction that explains what the
    /// distance should. What links have at known places keeps it near.
    pub(super) fn shrunk(&self, share: f64, fading_db: f64, median_m: f64) -> Self {
        let slope = POPULATION.exponent / exponent(1.0, fading_db);
        let shadowing = POPULATION.shadowing_db / fading_db;
        let between = |own: f64, usual: f64| libm::exp(share * libm::log(own) + (1.0 - share) * libm::log(usual));
        let shrunk_shadowing = between(self.shadowing, shadowing);
        Self {
            slope: between(self.slope, slope),
            shadowing: shrunk_shadowing,
            offset: between(self.offset, POPULATION.offset * shrunk_shadowing),
            direction: between(self.direction, POPULATION.direction_db / fading_db),
            correlation_m: between(self.correlation_m, POPULATION.correlation * median_m),
            slope_spread: between(self.slope_spread, POPULATION.slope_spread),
            ..*self
        }
    }

    /// Whether a parameter on which places hang is at its bound. Shadowing that is too small to be told is as good as none.
    pub(super) fn is_at_bound(&self) -> bool {
        [(0, -0.25), (0, 0.25), (1, -0.25), (1, 0.25), (2, 0.25)]
            .iter()
            .any(|&(number, step)| self.moved(number, step).is_none())
    }
}

/// The path-loss exponent of a slope if the fading is `fading_db`.
pub(super) fn exponent(slope: f64, fading_db: f64) -> f64 {
    slope * fading_db * std::f64::consts::LN_10 / 10.0
}

/// What links have at known places.
struct UsualLinks {
    exponent: f64,
    shadowing_db: f64,
    /// Share of the shadowing.
    offset: f64,
    /// Amplitude.
    direction_db: f64,
    slope_spread: f64,
    /// Share of the median length of a link.
    correlation: f64,
}

/// The medians of laws that were fitted at the true places of nodes of 20 sites: phones, access points, sensors and trackers,
/// indoors and outdoors.
const POPULATION: UsualLinks = UsualLinks {
    exponent: 2.26,
    shadowing_db: 5.4,
    offset: 0.33,
    direction_db: 1.4,
    slope_spread: 0.1,
    correlation: 0.32,
};

/// Bounds of the slope.
const SLOPES: [f64; 2] = [0.2, 12.0];
/// Usual slope, dependence on direction and offsets as multiples of the shadowing, and correlation as a multiple of the
/// usual distance: the centres of the prior. They are not those of [`POPULATION`], with which maps of real logs are
/// worse.
const USUAL_SLOPE: f64 = 1.7;
const USUAL_DIRECTION: f64 = 0.3;
const USUAL_OFFSET: f64 = 0.3;
const USUAL_CORRELATION: f64 = 1.0;
/// Usual spread of the slopes of nodes, and usual path-loss exponent.
const USUAL_SLOPE_SPREAD: f64 = 0.1;
const USUAL_EXPONENT: f64 = 2.6;
/// Least share of the shadowing that neighbouring places share: without any, many places would be as many independent
/// witnesses, which they never are.
const LEAST_SHARED: f64 = 0.3;

#[cfg(test)]
mod tests {
    use super::*;

    const LAW: Law = Law {
        margin: 2.0,
        distance_m: 8.0,
        slope: 3.0,
        shadowing: 2.0,
        shared: 0.9,
        correlation_m: 40.0,
        offset: 0.1,
        direction: 1.5,
        slope_spread: 0.4,
    };

    #[test]
    fn a_law_at_another_distance_has_the_same_margins() {
        let moved = LAW.at(20.0);
        assert!((moved.at_one_metre() - LAW.at_one_metre()).abs() < 1e-12 && moved.margin < LAW.margin, "{moved:?}");
        assert!(LAW.has_all_parts() && !LAW.of_alike_nodes().has_all_parts());
    }

    #[test]
    fn too_little_shadowing_to_be_told_is_no_bound_on_which_places_hang() {
        let law = Law {
            margin: 2.0,
            distance_m: 8.0,
            slope: 3.0,
            shadowing: 0.1,
            shared: 0.9,
            correlation_m: 40.0,
            offset: 0.1,
            direction: 0.3,
            slope_spread: 0.1,
        };
        assert!(!law.is_at_bound());
        assert!(Law { shadowing: 8.0, ..law }.is_at_bound());
        assert!(Law { slope: SLOPES[0], ..law }.is_at_bound() && Law { slope: SLOPES[1], ..law }.is_at_bound());
        assert!(Law { margin: 40.0, ..law }.is_at_bound());
    }

    #[test]
    fn a_law_is_drawn_toward_usual_links_by_geometric_means() {
        let law = LAW;
        let (fading_db, median_m) = (4.0, 10.0);
        let is_near = |a: f64, b: f64| (a - b).abs() < 1e-12 * b;
        let own = law.shrunk(1.0, fading_db, median_m);
        assert!(is_near(own.slope, law.slope) && is_near(own.correlation_m, law.correlation_m));
        let usual = law.shrunk(0.0, fading_db, median_m);
        assert!(is_near(exponent(usual.slope, fading_db), 2.26) && is_near(usual.shadowing * fading_db, 5.4));
        assert!(is_near(usual.direction * fading_db, 1.4) && is_near(usual.offset, 0.33 * usual.shadowing));
        assert!(is_near(usual.correlation_m, 3.2) && is_near(usual.slope_spread, 0.1));
        let half = law.shrunk(0.5, fading_db, median_m);
        assert!(is_near(half.slope * half.slope, law.slope * usual.slope));
        assert!(is_near(half.correlation_m * half.correlation_m, law.correlation_m * usual.correlation_m));
        assert!(is_near(half.margin, law.margin) && is_near(half.distance_m, 8.0) && is_near(half.shared, 0.9));
    }
}
