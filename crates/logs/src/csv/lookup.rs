//! What was found for the texts of a column, so that each text of a table in memory is looked up once and not once a row.

use std::collections::BTreeMap;

use crate::error::robot_log_error::RobotLogError;

/// What was found for the texts of a column, by the numbers that stand for them.
pub(crate) struct Lookup<T> {
    /// Of the small numbers.
    near: Vec<Option<T>>,
    /// Of the others.
    far: BTreeMap<u64, T>,
}

/// So many numbers are small.
const NEAR: usize = 1 << 20;

impl<T: Copy> Lookup<T> {
    pub(crate) fn new() -> Self {
        Self { near: Vec::new(), far: BTreeMap::new() }
    }

    /// What was found for the text of number `token`, or what `find` finds for it now. Without a number it is always found
    /// anew.
    ///
    /// # Errors
    /// That of `find`.
    pub(crate) fn of(
        &mut self,
        token: Option<u64>,
        find: impl FnOnce() -> Result<T, RobotLogError>,
    ) -> Result<T, RobotLogError> {
        let Some(token) = token else { return find() };
        let Some(at) = usize::try_from(token).ok().filter(|&at| at < NEAR) else {
            if let Some(&found) = self.far.get(&token) {
                return Ok(found);
            }
            let found = find()?;
            self.far.insert(token, found);
            return Ok(found);
        };
        if let Some(&Some(found)) = self.near.get(at) {
            return Ok(found);
        }
        let found = find()?;
        if self.near.len() <= at {
            self.near.resize((at + 1).next_power_of_two(), None);
        }
        self.near[at] = Some(found);
        Ok(found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_number_is_looked_up_once() {
        let mut lookup = Lookup::new();
        let mut looked_up = Vec::new();
        for token in [Some(3), Some(1 << 40), Some(3), None, Some(1 << 40), None, Some(0)] {
            let found = lookup.of(token, || {
                looked_up.push(token);
                Ok(token.map_or(9, |token| token + 1))
            });
            assert_eq!(found, Ok(token.map_or(9, |token| token + 1)));
        }
        assert_eq!(looked_up, [Some(3), Some(1 << 40), None, None, Some(0)]);
    }
}
