//! Random numbers with an address: a draw depends on the seed, on the purpose and on who draws, never on
//! earlier draws.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// A stream of random numbers (ChaCha with 8 rounds, Bernstein 2008): portable, seekable.
pub type Stream = ChaCha8Rng;

/// What a random number is drawn for; each purpose has a number that is unique in the program. Each purpose has its
/// own streams and draws, so a new purpose does not change the draws of the others. Each crate declares its own
/// purposes, because the kernel knows neither radios nor robots.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Purpose(u64);

impl Purpose {
    /// The purpose with this number.
    #[must_use]
    pub const fn new(number: u64) -> Self {
        Self(number)
    }
}

/// The seed of a run: the root of all randomness in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Seed(pub u64);

impl Seed {
    /// The stream of one drawer (`index`: a node, a robot) for one purpose.
    #[must_use]
    pub fn stream(self, purpose: Purpose, index: u64) -> Stream {
        let mut key = [0; 32];
        for (i, word) in key.chunks_exact_mut(8).enumerate() {
            word.copy_from_slice(&self.bits(purpose, [i as u64, 0, 0]).to_le_bytes());
        }
        let mut stream = ChaCha8Rng::from_seed(key);
        stream.set_stream(index);
        stream
    }

    /// 64 random bits at the address `place`: a pure function, equal on every platform.
    ///
    /// The address is absorbed word by word through the finaliser of SplitMix64
    /// (Steele, Lea and Flood 2014, "Fast splittable pseudorandom number generators").
    #[must_use]
    #[inline]
    pub fn bits(self, purpose: Purpose, place: [u64; 3]) -> u64 {
        self.draws(purpose, place[0]).bits([place[1], place[2]])
    }

    /// The draws of one drawer for one purpose: those of [`Seed::bits`] whose address begins with `drawer`.
    #[must_use]
    #[inline]
    pub fn draws(self, purpose: Purpose, drawer: u64) -> Draws {
        Draws(mix(mix(self.0 ^ mix(purpose.0)) ^ drawer))
    }

    /// A number uniform in (0, 1) at the address `place`.
    #[must_use]
    #[inline]
    pub fn uniform(self, purpose: Purpose, place: [u64; 3]) -> f64 {
        open_unit(self.bits(purpose, place))
    }

    /// A standard normal number at the address `place` (Box and Muller 1958, the cosine branch).
    #[must_use]
    #[inline]
    pub fn normal(self, purpose: Purpose, place: [u64; 3]) -> f64 {
        let first = self.bits(purpose, place);
        let radius = (-2.0 * libm::log(open_unit(first))).sqrt();
        radius * libm::cos(std::f64::consts::TAU * open_unit(mix(first)))
    }
}

/// The draws of one drawer for one purpose: what they have in common is worked out once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Draws(u64);

impl Draws {
    /// 64 random bits at the rest of the address.
    #[must_use]
    #[inline]
    pub fn bits(self, rest: [u64; 2]) -> u64 {
        rest.into_iter().fold(self.0, |state, word| mix(state ^ word))
    }
}

/// The finaliser of SplitMix64 after its increment: a bijection on 64 bits.
#[inline]
fn mix(state: u64) -> u64 {
    let mut z = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// The upper 52 bits as a number in (0, 1), never an end point.
#[inline]
fn open_unit(bits: u64) -> f64 {
    ((bits >> 12) as f64 + 0.5) * (1.0 / (1_u64 << 52) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::Rng;

    #[test]
    fn a_stream_depends_on_its_address_alone() {
        let draw = |seed: u64, purpose, index| Seed(seed).stream(purpose, index).next_u64();
        assert_eq!(draw(1, Purpose::new(3), 3), draw(1, Purpose::new(3), 3));
        assert_ne!(draw(1, Purpose::new(3), 3), draw(1, Purpose::new(3), 4));
        assert_ne!(draw(1, Purpose::new(3), 3), draw(1, Purpose::new(2), 3));
        assert_ne!(draw(1, Purpose::new(3), 3), draw(2, Purpose::new(3), 3));
    }

    /// By a program in Python of the same definition; the first value is the published one of SplitMix64 with seed 0.
    #[test]
    fn draws_are_those_of_splitmix64() {
        assert_eq!([mix(0), mix(0x9E37_79B9_7F4A_7C15)], [0xE220_A839_7B1D_CDAF, 0x6E78_9E6A_A1B9_65F4]);
        let (seed, purpose, place) = (Seed(7), Purpose::new(4), [1, 2, 3]);
        assert_eq!(seed.bits(purpose, place), 0x7823_D3FA_AA63_78C0);
        let is_near = |found: f64, expected: f64| (found - expected).abs() < 1e-15;
        assert!(is_near(seed.uniform(purpose, place), 0.469_296_692_559_863_5));
        assert!(is_near(seed.normal(purpose, place), -0.711_628_056_659_570_2));
    }

    #[test]
    fn a_uniform_number_is_never_an_end_point() {
        let half_step = 0.5 / (1_u64 << 52) as f64;
        let ends = [open_unit(0), open_unit(1 << 63), open_unit(u64::MAX)];
        assert_eq!(ends.map(f64::to_bits), [half_step, 0.5 + half_step, 1.0 - half_step].map(f64::to_bits));
    }

    #[test]
    fn neighbouring_addresses_give_standard_normal_numbers_without_correlation() {
        const COUNT: u64 = 200_000;
        let seed = Seed(7);
        let draw = |i| seed.normal(Purpose::new(4), [i, i / 3, 5]);
        let (mut sum, mut square, mut lagged, mut tail) = (0.0, 0.0, 0.0, 0);
        for i in 0..COUNT {
            let x = draw(i);
            sum += x;
            square += x * x;
            lagged += x * draw(i + 1);
            tail += u32::from(x > 1.959_964);
        }
        // Five standard errors each: a false alarm in 1.7 million runs of this test.
        let n = COUNT as f64;
        let error = 5.0 / n.sqrt();
        assert!((sum / n).abs() < error, "mean {}", sum / n);
        assert!((square / n - 1.0).abs() < error * 2_f64.sqrt(), "variance {}", square / n);
        assert!((lagged / n).abs() < error, "lag-one correlation {}", lagged / n);
        let share = f64::from(tail) / n;
        assert!((share - 0.025).abs() < 5.0 * (0.025 * 0.975 / n).sqrt(), "upper tail {share}");
    }
}
