//! The elements of a frame (IEEE 802.11-2012, 8.4.2.1): each has an ID, a length and a content.

use super::SweepParseError;

/// An element: its ID, and its content.
pub(super) type Element<'a> = (u8, &'a [u8]);

/// The elements at the end of a frame, in their order.
pub(super) struct Elements<'a> {
    kind: &'static str,
    frame: &'a [u8],
    next: usize,
}

impl<'a> Elements<'a> {
    /// Those of a `frame` of this `kind` without its FCS, of which the first begins at octet `first`.
    pub(super) fn new(kind: &'static str, frame: &'a [u8], first: usize) -> Self {
        Self { kind, frame, next: first }
    }
}

impl<'a> Iterator for Elements<'a> {
    type Item = Result<Element<'a>, SweepParseError>;

    fn next(&mut self) -> Option<Self::Item> {
        let at = self.next;
        let rest = self.frame.get(at..).filter(|rest| !rest.is_empty())?;
        // Whatever comes after an element that is cut is lost.
        self.next = self.frame.len();
        Some(match rest {
            &[id, length, ref content @ ..] if content.len() >= usize::from(length) => {
                self.next = at + 2 + usize::from(length);
                Ok((id, &content[..usize::from(length)]))
            }
            _ => Err(SweepParseError::CutElement { kind: self.kind, at, left: rest.len() }),
        })
    }
}
