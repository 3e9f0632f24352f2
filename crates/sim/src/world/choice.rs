//! Which nodes are meant by a share or by names.

use sextant_kernel::{NodeId, Purpose, Seed, SettingError};

use super::layout::PlacedNode;

/// Number of `count` things in a `share` of them, rounded up.
///
/// # Errors
/// If the share is outside 0 to 1.
pub(crate) fn number_of(share: f64, count: usize) -> Result<usize, SettingError> {
    SettingError::in_range("share", share, 0.0, 1.0)?;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share of a number of nodes")]
    let number = (share * count as f64).ceil() as usize;
    Ok(number)
}

/// `number` if it is at most the number of `nodes`.
///
/// # Errors
/// `count` otherwise.
pub(crate) fn at_most(number: usize, nodes: usize) -> Result<usize, SettingError> {
    if number > nodes {
        return Err(SettingError::new("count", number, format!("at most {nodes}, the number of nodes")));
    }
    Ok(number)
}

/// The `candidates` in random order. Which of two is first does not depend on the others.
pub(crate) fn drawn(
    candidates: impl Iterator<Item = NodeId>,
    purpose: Purpose,
    seed: Seed,
) -> impl Iterator<Item = NodeId> {
    let mut order: Vec<_> = candidates.map(|node| (seed.bits(purpose, [node.index() as u64, 0, 0]), node)).collect();
    order.sort_unstable();
    order.into_iter().map(|(_, node)| node)
}

/// The nodes called `names`, which are `allowed` as an error says: those that pass `is_allowed`.
///
/// # Errors
/// If a name is not that of such a node, or stands there twice.
pub(crate) fn named(
    names: &[String],
    nodes: &[PlacedNode],
    allowed: &str,
    is_allowed: impl Fn(NodeId) -> bool,
) -> Result<Vec<NodeId>, SettingError> {
    let mut chosen = Vec::new();
    for (i, name) in names.iter().enumerate() {
        let refused = |found, allowed: &str| Err(SettingError::new(format!("names[{i}]"), found, allowed));
        let node = nodes.iter().position(|node| node.name == *name).map(NodeId::from_index);
        let Some(node) = node.filter(|&node| is_allowed(node)) else {
            return refused(format!("`{name}`"), allowed);
        };
        if chosen.contains(&node) {
            return refused(format!("`{name}` again"), "each node once");
        }
        chosen.push(node);
    }
    Ok(chosen)
}
