//! The logs of several networks.

use sextant_kernel::SimTime;

use super::ReceptionLog;

/// What robots heard in one network.
#[derive(Clone, Debug, PartialEq)]
pub struct NetworkLog {
    /// The name of the network; `None` if it is the only one.
    pub network: Option<String>,
    /// What robots heard in it.
    pub log: ReceptionLog,
}

/// The logs of the networks that robots surveyed: at least one. All have the same nodes and robots. The first one is that
/// of whoever names no network.
#[derive(Clone, Debug, PartialEq)]
pub struct NetworkLogs {
    first: NetworkLog,
    others: Vec<NetworkLog>,
}

impl From<ReceptionLog> for NetworkLogs {
    /// The log of a network without a name, alone.
    fn from(log: ReceptionLog) -> Self {
        Self::new(NetworkLog { network: None, log }, Vec::new())
    }
}

impl NetworkLogs {
    /// The log of the first network, and those of the `others`.
    #[must_use]
    pub fn new(first: NetworkLog, others: Vec<NetworkLog>) -> Self {
        Self { first, others }
    }

    /// The log of the first network.
    #[must_use]
    pub fn first(&self) -> &ReceptionLog {
        &self.first.log
    }

    /// The same, to change it.
    pub fn first_mut(&mut self) -> &mut ReceptionLog {
        &mut self.first.log
    }

    /// The logs as they were at `time`.
    #[must_use]
    pub fn until(&self, time: SimTime) -> Self {
        let cut = |of: &NetworkLog| NetworkLog { network: of.network.clone(), log: of.log.until(time) };
        Self { first: cut(&self.first), others: self.others.iter().map(cut).collect() }
    }

    /// All logs, that of the first network first.
    pub fn iter(&self) -> impl Iterator<Item = &NetworkLog> + Clone {
        std::iter::once(&self.first).chain(&self.others)
    }

    /// The names of the networks, in the order of their logs.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.iter().filter_map(|log| log.network.as_deref())
    }

    /// The log of the network `name`.
    #[must_use]
    pub fn named(&self, name: &str) -> Option<&ReceptionLog> {
        self.iter().find(|log| log.network.as_deref() == Some(name)).map(|log| &log.log)
    }

    /// Makes the log of the network `name` the first one. A log of a network without a name stays the first one: it is
    /// that of any network.
    ///
    /// # Errors
    /// The names of the networks, if robots did not survey this one.
    pub fn put_first(&mut self, name: &str) -> Result<(), Vec<&str>> {
        if self.first.network.as_deref().is_none_or(|first| first == name) {
            return Ok(());
        }
        match self.others.iter().position(|other| other.network.as_deref() == Some(name)) {
            Some(other) => {
                std::mem::swap(&mut self.first, &mut self.others[other]);
                Ok(())
            }
            None => Err(self.names().collect()),
        }
    }
}

#[cfg(test)]
mod tests {

    use super::*;
    use crate::geometry::position::Position;
    use crate::reception::Stop;

    /// A log of as many stops.
    fn log(network: Option<&str>, stops: usize) -> NetworkLog {
        let stop = Stop::at(Position::ORIGIN);
        let log = ReceptionLog::new(vec!["a".into()], vec![stop; stops], Vec::new(), Vec::new()).unwrap();
        NetworkLog { network: network.map(str::to_owned), log }
    }

    #[test]
    fn the_log_of_a_network_can_be_put_first_and_all_are_kept() {
        let mut logs = NetworkLogs::new(log(Some("a"), 1), vec![log(Some("b"), 2), log(Some("c"), 3)]);
        logs.put_first("c").unwrap();
        assert_eq!(logs.names().collect::<Vec<_>>(), ["c", "b", "a"]);
        assert_eq!((logs.first().stops().len(), logs.named("a").unwrap().stops().len()), (3, 1));
        assert_eq!(logs.put_first("d"), Err(vec!["c", "b", "a"]));
        assert_eq!(logs.named("d"), None);
    }

    #[test]
    fn a_log_without_a_name_is_that_of_any_network() {
        let mut logs = NetworkLogs::from(log(None, 2).log);
        assert_eq!(logs.put_first("any"), Ok(()));
        assert_eq!((logs.first().stops().len(), logs.iter().count(), logs.names().count()), (2, 1, 0));
    }
}
