//! What a training finds: which sectors are heard, and which pair of them the link gets.

use sextant_channel::Dbm;
use sextant_kernel::NodeId;
use sextant_mac::dmg::interval::{MOST_SLOTS, REFINED_SECTORS};
use sextant_sim::{SectorPair, SectorPowers};

use super::settings::BeamTracking;

/// A link that a training found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Found {
    pub(super) node: NodeId,
    pub(super) pair: SectorPair,
    /// Power of the pair.
    pub(super) power: Dbm,
}

/// What a training with all sectors came to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Search {
    pub(super) found: Option<Found>,
    /// Nodes that answered in the slot of another one, so that neither was heard.
    pub(super) collided: u64,
}

/// The sector with the greatest power among `sectors`, if that is heard.
fn strongest(powers: &[Dbm], sectors: impl Iterator<Item = u8>, least: Dbm) -> Option<(u8, Dbm)> {
    let heard = sectors.map(|sector| (sector, powers[usize::from(sector)])).filter(|&(_, power)| power >= least);
    heard.reduce(|best, other| if other.1 > best.1 { other } else { best })
}

/// All sectors of one end.
fn all(powers: &[Dbm]) -> impl Iterator<Item = u8> + use<> {
    (0..=u8::MAX).take(powers.len())
}

/// The link to a node whose beacons come from the own sectors `swept`, and how strong both sweeps were together (dB);
/// `None` if one of the two does not hear the other.
fn link(mission: &BeamTracking, node: NodeId, powers: &SectorPowers, swept: &[u8]) -> Option<(Found, f64)> {
    let least = mission.sensitivity;
    let (own, to) = strongest(powers.to_peer(), swept.iter().copied(), least)?;
    let (peer, from) = strongest(powers.from_peer(), all(powers.from_peer()), least)?;
    let own = if mission.refines { refined(powers, swept, own, peer) } else { own };
    let pair = SectorPair { own, peer };
    Some((Found { node, pair, power: powers.pair(pair) }, to.0 + from.0))
}

/// The best of the own sectors that a refinement tests while the node points: those heard best among `swept`.
fn refined(powers: &SectorPowers, swept: &[u8], own: u8, peer: u8) -> u8 {
    let mut tested = swept.to_vec();
    tested.sort_by(|&a, &b| powers.to_peer()[usize::from(b)].0.total_cmp(&powers.to_peer()[usize::from(a)].0));
    tested.truncate(REFINED_SECTORS);
    let power = |own: u8| powers.pair(SectorPair { own, peer });
    tested.into_iter().fold(own, |best, other| if power(other) > power(best) { other } else { best })
}

/// A training with all sectors: each node that hears a beacon answers in its slot, and the robot takes the node whose two
/// sweeps were the strongest. `powers` are by node.
pub(super) fn search(mission: &BeamTracking, powers: &[Option<SectorPowers>]) -> Search {
    let mut answers: Vec<Vec<(Found, f64)>> = vec![Vec::new(); MOST_SLOTS.into()];
    let mut taken = [0_u64; MOST_SLOTS as usize];
    for (number, powers) in powers.iter().enumerate() {
        let Some(powers) = powers else { continue };
        let slot = number % usize::from(MOST_SLOTS);
        if strongest(powers.to_peer(), all(powers.to_peer()), mission.sensitivity).is_some() {
            taken[slot] += 1;
            let swept: Vec<u8> = all(powers.to_peer()).collect();
            answers[slot].extend(link(mission, NodeId::from_index(number), powers, &swept));
        }
    }
    let clear = answers.iter().zip(taken).filter(|&(_, taken)| taken == 1).flat_map(|(answers, _)| answers);
    let best = clear.copied().reduce(|best, other| if other.1 > best.1 { other } else { best });
    Search { found: best.map(|(found, _)| found), collided: taken.iter().filter(|&&taken| taken > 1).sum() }
}

/// A training of the link to one node with the own sectors `swept`.
pub(super) fn try_near(
    mission: &BeamTracking,
    node: NodeId,
    powers: Option<&SectorPowers>,
    swept: &[u8],
) -> Option<Found> {
    link(mission, node, powers?, swept).map(|(found, _)| found)
}
