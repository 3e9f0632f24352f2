//! The fading of links: the gain between two stations at their places, at a time, on a radio channel.

use std::f64::consts::TAU;

use sextant_kernel::{Seed, SimTime, StationId};

use super::kept::Kept;
use super::law::{Depth, FadingLaw, Variation};
use super::waves::{Field, FieldSettings};
use super::{PairDraws, pair};
use crate::geometry::position::Position;
use crate::power::Db;
use crate::purpose;

/// Where in the spectrum links fade.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FadingBand {
    /// A frequency that is the same for all radio channels of a band (Hz): its wavelength is that of the fades in space.
    pub reference_hz: f64,
    /// Centre of the radio channel (Hz).
    pub center_hz: f64,
}

/// The fading of all links on one radio channel.
#[derive(Clone, Debug)]
pub struct Fading {
    law: FadingLaw,
    seed: Seed,
    fields: FieldSettings,
    center_hz: f64,
    /// The fields of links, ...
    known: Kept<Box<LinkFading>>,
    /// ... and their gains while both stations stand; `None` if gains change in time.
    standing: Option<Kept<StandingGain>>,
}

/// The gain of a link between two places.
#[derive(Clone, Copy, Debug)]
struct StandingGain {
    places: [Position; 2],
    gain: Db,
}

/// The gain is never below it: a field that cancels to the last bit has no power.
const DEEPEST: f64 = 1e-30;

/// Fields that are remembered at most (about 50 MB with one for each link), ...
const MOST_FIELDS: usize = 1 << 16;
/// ... and gains (about 19 MB).
const MOST_STANDING: usize = 1 << 18;

/// Speed of light (m/s).
const LIGHT_M_PER_S: f64 = 299_792_458.0;

/// The fields of one link.
#[derive(Clone, Debug)]
struct LinkFading {
    /// One, or m of them with Nakagami.
    fields: Vec<Field>,
    /// Phase of the direct way at the length 0 (rad).
    direct_rad: f64,
}

/// One end of a link: a station and its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FadingEnd {
    /// The station.
    pub station: StationId,
    /// Where it is.
    pub place: Position,
}

impl Fading {
    /// Fading by `law` on the radio channel `band`, with draws from `seed`, which is that of all channels.
    #[must_use]
    pub fn new(law: FadingLaw, band: FadingBand, seed: Seed) -> Self {
        let (doppler_hz, delay_spread_s) = match law.variation {
            Variation::Waves { doppler_hz, delay_spread_s } => (doppler_hz, delay_spread_s),
            Variation::Blocks { .. } => (0.0, 0.0),
        };
        let fields = FieldSettings {
            wave_number_per_m: TAU * band.reference_hz / LIGHT_M_PER_S,
            doppler_hz,
            delay_spread_s,
            offset_hz: band.center_hz - band.reference_hz,
        };
        let standing = (!law.changes_in_time()).then(|| Kept::new(MOST_STANDING));
        Self { law, seed, fields, center_hz: band.center_hz, known: Kept::new(MOST_FIELDS), standing }
    }

    /// The law.
    #[must_use]
    pub fn law(&self) -> &FadingLaw {
        &self.law
    }

    /// Gain between two stations at `now`, whichever of them is named first. What is remembered changes no result.
    #[must_use]
    pub fn gain(&mut self, a: FadingEnd, b: FadingEnd, now: SimTime) -> Db {
        let (first, second) = if a.station <= b.station { (a, b) } else { (b, a) };
        let pair = pair(first.station, second.station);
        let places = [first.place, second.place];
        let known = self.standing.as_ref().and_then(|standing| standing.get(pair));
        if let Some(known) = known.filter(|known| known.places == places) {
            return known.gain;
        }
        let gain = self.gain_at(pair, places, now);
        if let Some(standing) = &mut self.standing {
            standing.put(pair, StandingGain { places, gain });
        }
        gain
    }

    /// The gain of a link between the places of its stations, that with the smaller number first.
    fn gain_at(&mut self, pair: u64, places: [Position; 2], now: SimTime) -> Db {
        let t_s = now.as_secs_f64();
        let factor = match self.law.variation {
            Variation::Blocks { block_s } => self.block(pair, (t_s / block_s).floor()),
            Variation::Waves { .. } => {
                if self.known.get(pair).is_none() {
                    let link = Box::new(self.link(pair));
                    self.known.put(pair, link);
                }
                let link = self.known.get(pair).expect("it was put there");
                link.factor(self.law.depth, places, self.fields.wave_number_per_m, t_s)
            }
        };
        Db::from_factor(factor.max(DEEPEST))
    }

    #[cold]
    fn link(&self, pair: u64) -> LinkFading {
        let draws = PairDraws { seed: self.seed, purpose: purpose::FADING, pair };
        let count = match self.law.depth {
            Depth::Rician { .. } => 1,
            Depth::Nakagami { squares } => u64::from(squares.div_ceil(2)),
        };
        let fields = (0..count).map(|number| Field::draw(draws, number, &self.fields)).collect();
        LinkFading { fields, direct_rad: TAU * draws.uniform(DIRECT, 0) }
    }

    /// The gain of a link as a factor in a block of time.
    fn block(&self, pair: u64, block: f64) -> f64 {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an address")]
        let (block, channel) = (block as u64, self.center_hz as u64);
        let of_channel = self.seed.bits(purpose::FADING, [pair, channel, BLOCKS]);
        let draws = PairDraws { seed: self.seed, purpose: purpose::FADING, pair: of_channel };
        let normal = |number: u64| draws.normal(block, number);
        match self.law.depth {
            Depth::Rician { k } => {
                let scale = (0.5 / (k + 1.0)).sqrt();
                let real = (k / (k + 1.0)).sqrt() + scale * normal(0);
                let imaginary = scale * normal(1);
                real * real + imaginary * imaginary
            }
            Depth::Nakagami { squares } => {
                let sum: f64 = (0..u64::from(squares)).map(|number| normal(number).powi(2)).sum();
                sum / f64::from(squares)
            }
        }
    }
}

/// The word of the draw of the direct way, which no field has, ...
const DIRECT: u64 = u64::MAX;
/// ... and the kind of the addresses of blocks.
const BLOCKS: u64 = 64;

impl LinkFading {
    /// The gain as a factor.
    #[inline]
    fn factor(&self, depth: Depth, [first, second]: [Position; 2], wave_number_per_m: f64, t_s: f64) -> f64 {
        match depth {
            Depth::Rician { k } => {
                let [mut real, mut imaginary] = self.fields[0].value(first, second, t_s);
                if k > 0.0 {
                    let phase = wave_number_per_m * first.distance_m(second) + self.direct_rad;
                    let (sin, cos) = libm::sincos(phase);
                    let (direct, scattered) = ((k / (k + 1.0)).sqrt(), (k + 1.0).sqrt().recip());
                    real = direct * cos + scattered * real;
                    imaginary = direct * sin + scattered * imaginary;
                }
                real * real + imaginary * imaginary
            }
            Depth::Nakagami { squares } => {
                // The real and the imaginary part of a field have the variance 1/2 each.
                let mut sum = 0.0;
                for (field, number) in self.fields.iter().zip(0_u8..) {
                    let [real, imaginary] = field.value(first, second, t_s);
                    sum += 2.0 * real * real;
                    if 2 * number + 1 < squares {
                        sum += 2.0 * imaginary * imaginary;
                    }
                }
                sum / f64::from(squares)
            }
        }
    }
}
