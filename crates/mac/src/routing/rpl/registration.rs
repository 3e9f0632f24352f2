//! How a station registers with those above it.

/// The numbers of the messages (DAO) by which a station registers, and how often the last one was sent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Registration {
    number: u8,
    tries: u8,
    is_open: bool,
}

impl Registration {
    /// A new message: its number.
    pub fn begin(&mut self) -> u8 {
        self.number = self.number.wrapping_add(1);
        (self.tries, self.is_open) = (1, true);
        self.number
    }

    /// The message was not answered: its number, if it is to be sent again, of at most so many tries.
    pub fn again(&mut self, most: u8) -> Option<u8> {
        self.is_open &= self.tries < most;
        self.tries = self.tries.saturating_add(1);
        self.is_open.then_some(self.number)
    }

    /// Message `number` was answered: whether that is the one that waits.
    pub fn answered(&mut self, number: u8) -> bool {
        let is_last = self.is_open && number == self.number;
        self.is_open &= !is_last;
        is_last
    }

    /// Whether the last message waits for its answer.
    #[must_use]
    pub fn is_open(&self) -> bool {
        self.is_open
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_is_sent_as_often_as_allowed_until_it_is_answered() {
        let mut registration = Registration::default();
        let first = registration.begin();
        assert_eq!([registration.again(3), registration.again(3)], [Some(first); 2]);
        assert_eq!((registration.again(3), registration.is_open()), (None, false));
        let second = registration.begin();
        assert!(!registration.answered(first) && registration.answered(second));
        assert!(!registration.answered(second), "an answer counts once");
    }
}
