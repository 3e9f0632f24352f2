//! Other names of nodes: `4101` in one file is `0x1005` in another.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use sextant_channel::{Position, ReceptionLog};

use crate::csv::table::Table;
use crate::error::robot_log_error::RobotLogError;
use sextant_kernel::text::listed;

/// Names of nodes, and what else they are called in files.
#[derive(Clone, Debug, PartialEq)]
pub struct Names {
    /// The file that has them.
    path: PathBuf,
    /// The name of each alias.
    by_alias: BTreeMap<String, String>,
}

impl Names {
    /// Reads the file `path`: `name,alias`, where a name may have several aliases.
    ///
    /// # Errors
    /// If the file cannot be read, has an invalid row, an alias twice, or one that is the name of another node.
    pub fn read(path: &Path, notes: &mut Vec<String>) -> Result<Self, RobotLogError> {
        let table = Table::open(path, &["name", "alias"], &[])?;
        notes.extend(table.notes());
        let [name, alias] = ["name", "alias"].map(|column| table.column(column));
        let mut by_alias = BTreeMap::new();
        let mut all = BTreeSet::new();
        let head = table.rows(|row| {
            let of = row.node(name)?.into_owned();
            all.insert(of.clone());
            if let Some(before) = by_alias.insert(row.node(alias)?.into_owned(), of) {
                return Err(row.wrong(alias, format!("each alias once; this one is already that of `{before}`")));
            }
            Ok(())
        })?;
        if let Some((alias, name)) = by_alias.iter().find(|(alias, name)| alias != name && all.contains(*alias)) {
            let problem = format!("`{alias}` is both a name and an alias of `{name}`; allowed: one of them");
            return Err(head.wrong_row(0, problem));
        }
        Ok(Self { path: path.to_owned(), by_alias })
    }

    /// The name of what a file calls `name`.
    fn of<'n>(&'n self, name: &'n str) -> &'n str {
        self.by_alias.get(name).map_or(name, String::as_str)
    }

    /// Gives the nodes of `log` and `truth` their names.
    ///
    /// # Errors
    /// If an alias occurs in neither of them, or two of their nodes get the same name.
    pub fn apply(
        &self,
        log: ReceptionLog,
        truth: Option<BTreeMap<String, Position>>,
    ) -> Result<(ReceptionLog, Option<BTreeMap<String, Position>>), RobotLogError> {
        let in_truth = |name: &String| truth.as_ref().is_some_and(|truth| truth.contains_key(name));
        let in_log: BTreeSet<&String> = log.names().iter().collect();
        let unknown: Vec<&String> =
            self.by_alias.keys().filter(|alias| !in_log.contains(alias) && !in_truth(alias)).collect();
        if !unknown.is_empty() {
            let problem = format!("no node of the log or of the true positions is called {}", listed(&unknown));
            return Err(self.refused(problem));
        }
        self.check(log.names(), "log")?;
        let names = log.names().iter().map(|name| self.of(name).to_owned()).collect();
        let truth = match truth {
            None => None,
            Some(truth) => {
                self.check(truth.keys(), "file of true positions")?;
                Some(truth.into_iter().map(|(name, place)| (self.of(&name).to_owned(), place)).collect())
            }
        };
        Ok((log.with_names(names), truth))
    }

    /// Refuses two nodes of one name.
    fn check<'n>(&self, names: impl IntoIterator<Item = &'n String>, whose: &str) -> Result<(), RobotLogError> {
        let mut called: BTreeMap<&str, &str> = BTreeMap::new();
        for own in names {
            let name = self.of(own);
            if let Some(other) = called.insert(name, own) {
                return Err(self.refused(format!("the nodes `{other}` and `{own}` of the {whose} are both `{name}`")));
            }
        }
        Ok(())
    }

    fn refused(&self, problem: String) -> RobotLogError {
        RobotLogError::Form { problem: format!("`{}`: {problem}", self.path.display()) }
    }
}
