//! Names of robots in the order in which a file names them.

use std::collections::BTreeMap;

use sextant_kernel::RobotId;

/// Names of robots, each with its identity: the first that is named is robot 0.
#[derive(Debug, Default)]
pub(crate) struct RobotNames {
    names: Vec<String>,
    ids: BTreeMap<String, RobotId>,
}

impl RobotNames {
    /// The robot called `name`.
    pub(crate) fn id(&mut self, name: &str) -> RobotId {
        if let Some(&id) = self.ids.get(name) {
            return id;
        }
        let id = RobotId::from_index(self.names.len());
        self.names.push(name.to_owned());
        self.ids.insert(name.to_owned(), id);
        id
    }

    /// The names; the index is the [`RobotId`].
    pub(crate) fn into_vec(self) -> Vec<String> {
        self.names
    }
}
