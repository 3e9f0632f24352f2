//! All outcomes of a round of random draws, each with its probability.

/// Probabilities are sums in units of one over 2 to this power, fine enough for every sequence of draws.
const WEIGHT_BITS: u32 = 100;

/// Runs a round for each sequence of draws and adds up the counts that it gives, weighted with the probability of the
/// sequence, without rounding. A draw is uniform from 0 to a maximum, which is one below a power of two.
pub(crate) fn enumerate<const N: usize>(mut round: impl FnMut(&mut dyn FnMut(u32) -> u32) -> [u32; N]) -> [f64; N] {
    let mut sums = [0_u128; N];
    // The draws of the last round, each with its largest possible value. The next round increments the last draw that
    // can still grow.
    let mut draws: Vec<(u32, u32)> = Vec::new();
    loop {
        let mut used = 0;
        let counts = round(&mut |max| {
            if used == draws.len() {
                draws.push((0, max));
            }
            used += 1;
            draws[used - 1].0
        });
        let bits: u32 = draws.iter().map(|&(_, max)| (max + 1).ilog2()).sum();
        for (sum, count) in sums.iter_mut().zip(counts) {
            *sum += u128::from(count) << (WEIGHT_BITS - bits);
        }
        while draws.pop_if(|(drawn, max)| drawn == max).is_some() {}
        let Some((drawn, _)) = draws.last_mut() else { break };
        *drawn += 1;
    }
    sums.map(|sum| sum as f64 / 2_f64.powi(100))
}
