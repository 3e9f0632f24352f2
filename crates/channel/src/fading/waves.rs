//! The scattered field of one link: a sum of plane waves.

use std::f64::consts::TAU;

use super::PairDraws;
use crate::geometry::position::Position;

/// Number of waves N of one field.
pub(super) const WAVES: usize = 16;

/// The scattered field of one link on one radio channel:
/// `h = N^-1/2 sum_n exp(i(k (u_n·x_a + w_n·x_b) + 2π f_n t - 2π F τ_n + p_n))`.
///
/// The form is that of Xiao, Zheng and Beaulieu (2006, IEEE Transactions on Wireless Communications 5(12)), with the places
/// of both ends instead of time alone: a station that stands has a constant fade, and one that comes back finds it again. The
/// directions u_n and w_n are level and, as f_n = f_d cos b_n, drawn one from each N-th part of the circle; so are the delays
/// τ_n from each N-th part of their exponential law. Which parts meet in a wave is drawn too. So over links, the
/// autocorrelation is `J0(k |a-a'|) J0(k |b-b'|) J0(2π f_d (t-t'))`, times `1 / (1 + i 2π τ (F-F'))`, exactly.
#[derive(Clone, Copy, Debug)]
pub(super) struct Field([Wave; WAVES]);

#[derive(Clone, Copy, Debug, Default)]
struct Wave {
    /// k u_n (rad/m), at the station with the smaller number.
    at_first: [f64; 2],
    /// k w_n (rad/m), at the other one.
    at_second: [f64; 2],
    /// 2π f_n (rad/s).
    turn_rad_per_s: f64,
    /// p_n - 2π F τ_n (rad).
    phase_rad: f64,
}

/// What fields are drawn for.
#[derive(Clone, Copy, Debug)]
pub(super) struct FieldSettings {
    /// k (rad/m).
    pub(super) wave_number_per_m: f64,
    pub(super) doppler_hz: f64,
    pub(super) delay_spread_s: f64,
    /// F, from a frequency that is the same for all channels of a band (Hz).
    pub(super) offset_hz: f64,
}

/// The kinds of draws of a wave.
mod kind {
    pub(super) const FIRST: u64 = 0;
    pub(super) const SECOND: u64 = 1;
    pub(super) const DOPPLER: u64 = 2;
    pub(super) const DELAY: u64 = 3;
    pub(super) const PHASE: u64 = 4;
    /// Added to the kind of those that are permuted.
    pub(super) const ORDER: u64 = 8;
}

impl Field {
    /// The field number `number` of a link.
    pub(super) fn draw(draws: PairDraws, number: u64, settings: &FieldSettings) -> Self {
        let word = |n: usize| (number << 8) | n as u64;
        // One number of each N-th part of (0, 1), in an order that is drawn (Fisher and Yates).
        let parts = |kind: u64| {
            let mut order: [usize; WAVES] = std::array::from_fn(|n| n);
            for last in (1..WAVES).rev() {
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "a number from 0 to last"
                )]
                let other = (draws.uniform(word(last), kind + kind::ORDER) * (last + 1) as f64) as usize;
                order.swap(last, other);
            }
            order.map(|part| (part as f64 + draws.uniform(word(part), kind)) / WAVES as f64)
        };
        let direction = |part: f64| {
            let (sin, cos) = libm::sincos(TAU * part);
            [settings.wave_number_per_m * cos, settings.wave_number_per_m * sin]
        };
        let (first, second) = (parts(kind::FIRST), parts(kind::SECOND));
        let (doppler, delay) = (parts(kind::DOPPLER), parts(kind::DELAY));
        Self(std::array::from_fn(|n| {
            let delay_s = -settings.delay_spread_s * libm::log1p(-delay[n]);
            let turns = draws.uniform(word(n), kind::PHASE) - settings.offset_hz * delay_s;
            Wave {
                at_first: direction(first[n]),
                at_second: direction(second[n]),
                turn_rad_per_s: TAU * settings.doppler_hz * libm::cos(TAU * doppler[n]),
                phase_rad: TAU * (turns - turns.floor()),
            }
        }))
    }

    /// h, as real and imaginary part, with the ends at `first` and `second` at the time `t_s`.
    #[inline]
    pub(super) fn value(&self, first: Position, second: Position, t_s: f64) -> [f64; 2] {
        let (mut real, mut imaginary) = (0.0, 0.0);
        for wave in &self.0 {
            let phase = wave.at_first[0] * first.x_m
                + wave.at_first[1] * first.y_m
                + wave.at_second[0] * second.x_m
                + wave.at_second[1] * second.y_m
                + wave.turn_rad_per_s * t_s
                + wave.phase_rad;
            let (sin, cos) = libm::sincos(phase);
            real += cos;
            imaginary += sin;
        }
        let scale = (WAVES as f64).sqrt().recip();
        [scale * real, scale * imaginary]
    }
}

#[cfg(test)]
mod tests {
    use sextant_kernel::Seed;

    use super::*;
    use crate::purpose;

    /// Wavelength at 2.44 GHz (m).
    const WAVELENGTH_M: f64 = 0.122_87;
    const USUAL: FieldSettings = FieldSettings {
        wave_number_per_m: TAU / WAVELENGTH_M,
        doppler_hz: 10.0,
        delay_spread_s: 50e-9,
        offset_hz: 0.0,
    };
    const LINKS: u32 = 10_000;

    /// Where and when a field is looked at, and how it was drawn.
    #[derive(Clone, Copy)]
    struct Look {
        settings: FieldSettings,
        first: Position,
        second: Position,
        t_s: f64,
    }

    /// Mean of h h'* over many links, real and imaginary part.
    fn correlation(one: Look, other: Look) -> [f64; 2] {
        let (mut real, mut imaginary) = (0.0, 0.0);
        for link in 0..LINKS {
            let draws = PairDraws { seed: Seed(21), purpose: purpose::FADING, pair: link.into() };
            let [a, b] = [one, other]
                .map(|look| Field::draw(draws, 0, &look.settings).value(look.first, look.second, look.t_s));
            real += a[0] * b[0] + a[1] * b[1];
            imaginary += a[1] * b[0] - a[0] * b[1];
        }
        [real / f64::from(LINKS), imaginary / f64::from(LINKS)]
    }

    fn is_near([real, imaginary]: [f64; 2], expected: [f64; 2]) -> bool {
        // Five standard errors, which are at most 1 / sqrt(10 000).
        (real - expected[0]).abs() < 0.05 && (imaginary - expected[1]).abs() < 0.05
    }

    #[test]
    fn the_autocorrelation_in_place_and_time_is_that_of_clarke() {
        let usual = Look {
            settings: USUAL,
            first: Position::new(30.0, 7.0, 0.0),
            second: Position::new(1.0, 2.0, 1.0),
            t_s: 100.0,
        };
        // J0 at 0.5, 1, 2, its first zero and its least value.
        for (x, j0) in [(0.5, 0.938_47), (1.0, 0.765_20), (2.0, 0.223_89), (2.4048, 0.0), (3.8317, -0.402_76_f64)] {
            let step = Position::new(x / TAU * WAVELENGTH_M, 0.0, 0.0);
            let moved = Look { first: usual.first + step, ..usual };
            let both = Look { second: usual.second - step, ..moved };
            let later = Look { t_s: usual.t_s + x / TAU / 10.0, ..usual };
            let all = Look { t_s: later.t_s, ..both };
            for (look, expected) in [(moved, j0), (later, j0), (both, j0 * j0), (all, j0 * j0 * j0)] {
                let found = correlation(usual, look);
                assert!(is_near(found, [expected, 0.0]), "{x}: {found:?} {expected}");
            }
        }
    }

    #[test]
    fn channels_fade_for_themselves_if_they_are_farther_apart_than_the_inverse_of_the_delay_spread() {
        let look = |spread_ns: f64, offset_hz| Look {
            settings: FieldSettings { delay_spread_s: 1e-9 * spread_ns, offset_hz, ..USUAL },
            first: Position::new(4.0, 7.0, 0.0),
            second: Position::ORIGIN,
            t_s: 3.0,
        };
        for (spread_ns, apart_hz, size) in
            [(50.0, 5e6, 0.537), (50.0, 20e6, 0.157), (25.0, 5e6, 0.786), (25.0, 20e6, 0.303), (0.0, 75e6, 1.0_f64)]
        {
            let found = correlation(look(spread_ns, -35e6), look(spread_ns, -35e6 + apart_hz));
            // 1 / (1 + i 2π τ (F - F')), of which the size is (1 + (2π τ (F - F'))²)^-1/2.
            let x = -TAU * 1e-9 * spread_ns * apart_hz;
            let expected = [1.0 / (1.0 + x * x), -x / (1.0 + x * x)];
            assert!((expected[0].hypot(expected[1]) - size).abs() < 0.001);
            assert!(is_near(found, expected), "{spread_ns} ns, {apart_hz} Hz: {found:?} {expected:?}");
        }
    }
}
