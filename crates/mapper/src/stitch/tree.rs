//! The frames of robots along a spanning tree of the pairs that agree best.

use super::frame_change::FrameChange;
use super::pair::{PairFit, PairState};

/// The change of each robot's frame into that of the first one, along the tree that begins at the first robot and always
/// goes on with the pair in which most nodes agree (Prim 1957); `None` for robots that it does not reach.
pub(super) fn frames(robots: usize, pairs: &[PairFit]) -> Vec<Option<FrameChange>> {
    let mut frames: Vec<Option<FrameChange>> = vec![None; robots];
    if let Some(first) = frames.first_mut() {
        *first = Some(FrameChange::NONE);
    }
    loop {
        let mut best: Option<(usize, usize, FrameChange)> = None;
        for pair in pairs {
            let PairState::Fitted { change, agreeing, .. } = &pair.state else { continue };
            let [a, b] = pair.robots;
            let next = match (&frames[a], &frames[b]) {
                (Some(known), None) => (b, known.after(change)),
                (None, Some(known)) => (a, known.after(&change.inverse())),
                _ => continue,
            };
            if best.as_ref().is_none_or(|(most, ..)| agreeing > most) {
                best = Some((*agreeing, next.0, next.1));
            }
        }
        let Some((_, robot, frame)) = best else { return frames };
        frames[robot] = Some(frame);
    }
}
