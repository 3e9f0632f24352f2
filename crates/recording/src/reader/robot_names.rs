//! Names of robots in the order of their first use in a file.

use std::collections::BTreeMap;

use sextant_kernel::RobotId;

/// Names of robots and their numbers: the first name is robot 0.
#[derive(Debug, Default)]
pub struct RobotNames {
    names: Vec<String>,
    ids: BTreeMap<String, RobotId>,
}

impl RobotNames {
    /// The number of the robot called `name`; a new name gets the next number.
    pub fn id(&mut self, name: &str) -> RobotId {
        if let Some(&id) = self.ids.get(name) {
            return id;
        }
        let id = RobotId::from_index(self.names.len());
        self.names.push(name.to_owned());
        self.ids.insert(name.to_owned(), id);
        id
    }

    /// The names; the index is the [`RobotId`].
    pub fn into_vec(self) -> Vec<String> {
        self.names
    }
}
