//! Fixed receivers and a moving transmitter: which end of a link is mapped.
//!
//! The law of a link is the same from either end: path loss, obstacles and antennas act alike in both directions (reciprocity
//! of the channel). So the receivers can be mapped from the places of the transmitter, as the nodes are from the places of
//! the robot.

use crate::error::robot_log_error::RobotLogError;
use crate::options::form_options::FormOptions;

/// What the user should know of turned roles.
pub(crate) const NOTE: &str = "roles are turned (option `reciprocal`): the nodes of the map are the receivers, and the stops are \
    places of the transmitter. A channel is reciprocal: path loss, walls and antennas act alike in both directions. What \
    differs between receivers, as noise and sensitivity, counts as an offset of the node";

/// Who moves, and so whose path it is.
#[derive(Clone, Debug)]
pub(crate) enum Roles {
    /// Robots listen to nodes.
    Usual,
    /// Nodes listen to a transmitter.
    Turned(Transmitter),
}

/// The moving transmitter.
#[derive(Clone, Debug)]
pub(crate) struct Transmitter {
    /// As the user names it.
    pub(crate) wanted: Option<String>,
    /// The first one that was heard.
    first: Option<String>,
    /// Packets of the wanted one, and of others.
    used: u64,
    others: u64,
}

impl Roles {
    pub(crate) fn of(options: &FormOptions) -> Self {
        if !options.reciprocal {
            return Self::Usual;
        }
        Self::Turned(Transmitter { wanted: options.transmitter.clone(), first: None, used: 0, others: 0 })
    }

    /// Adds what the user should know of the packets to `notes`.
    ///
    /// # Errors
    /// If all packets are of other transmitters than the user wants.
    pub(crate) fn tell(&self, notes: &mut Vec<String>) -> Result<(), RobotLogError> {
        let Self::Turned(Transmitter { wanted: Some(wanted), used, others, .. }) = self else { return Ok(()) };
        if *used == 0 {
            let problem = format!("option `transmitter` is `{wanted}`, but all {others} packets are of others");
            return Err(RobotLogError::Form { problem });
        }
        if *others > 0 {
            notes.push(format!("{others} packets of other transmitters than `{wanted}` are not used"));
        }
        Ok(())
    }
}

impl Transmitter {
    /// Whether the packets of `sender` are wanted.
    pub(crate) fn is_wanted(&mut self, sender: &str) -> bool {
        let is_wanted = self.wanted.as_ref().is_none_or(|wanted| wanted == sender);
        self.used += u64::from(is_wanted);
        self.others += u64::from(!is_wanted);
        is_wanted
    }

    /// The same, if there is one path.
    ///
    /// # Errors
    /// If another transmitter was heard before, and the user names none.
    pub(crate) fn is_the_one(&mut self, sender: &str) -> Result<bool, String> {
        if self.wanted.is_none() {
            let first = self.first.get_or_insert_with(|| sender.to_owned());
            if first != sender {
                return Err(format!(
                    "packets of the transmitters `{first}` and `{sender}`, but there is one path: name the one that drove it \
                     with option `transmitter`"
                ));
            }
        }
        Ok(self.is_wanted(sender))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_path_is_that_of_one_transmitter() {
        let options = |transmitter: Option<&str>| FormOptions {
            reciprocal: true,
            transmitter: transmitter.map(str::to_owned),
            ..FormOptions::default()
        };
        let Roles::Turned(mut any) = Roles::of(&options(None)) else { panic!("turned") };
        assert_eq!(any.is_the_one("tag"), Ok(true));
        assert_eq!(any.is_the_one("tag"), Ok(true));
        assert!(any.is_the_one("other").unwrap_err().contains("the transmitters `tag` and `other`"));
        let mut roles = Roles::of(&options(Some("other")));
        let Roles::Turned(named) = &mut roles else { panic!("turned") };
        assert_eq!((named.is_the_one("tag"), named.is_the_one("other")), (Ok(false), Ok(true)));
        let mut notes = Vec::new();
        roles.tell(&mut notes).unwrap();
        assert_eq!(notes, ["1 packets of other transmitters than `other` are not used"]);
        let absent = Roles::of(&options(Some("third"))).tell(&mut notes).unwrap_err().to_string();
        assert_eq!(absent, "option `transmitter` is `third`, but all 0 packets are of others");
    }
}
