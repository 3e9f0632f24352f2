//! Names of nodes that differ only in the case of letters or in blanks.

use std::collections::BTreeMap;

use sextant_channel::ReceptionLog;
use sextant_kernel::text::{counted, listed};

use super::finding::Finding;

/// What is odd of the names of the nodes.
pub(super) fn finding(log: &ReceptionLog) -> Option<Finding> {
    let mut alike: BTreeMap<String, Vec<&str>> = BTreeMap::new();
    for name in log.names() {
        let plain: String = name.to_lowercase().split_whitespace().collect();
        alike.entry(plain).or_default().push(name);
    }
    let quoted = |name: &&str| format!("`{name}`");
    alike.retain(|_, names| names.len() > 1);
    let told: Vec<String> =
        alike.values().map(|names| names.iter().map(quoted).collect::<Vec<_>>().join(" and ")).collect();
    (!told.is_empty()).then(|| Finding {
        check: "alike-names",
        odd: format!(
            "names of {} differ only in the case of letters or in blanks: {}",
            counted(alike.values().map(Vec::len).sum(), "node"),
            listed(&told)
        ),
        cost: "if they are of one node, it is mapped several times, each time from a part of what was heard"
            .to_owned(),
        remedy: "give a node one name: in the files, or by option `names`".to_owned(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_differ_in_case_or_blanks_are_told_and_others_are_not() {
        let told = |names: &[&str]| {
            let names = names.iter().map(|&name| name.to_owned()).collect();
            finding(&ReceptionLog::new(names, Vec::new(), Vec::new(), Vec::new()).unwrap())
        };
        assert_eq!(told(&["n1", "n2", "n 3"]), None);
        let found = told(&["n1", "N1", "n2", "n2 ", "n3"]).unwrap();
        let odd = "names of 4 nodes differ only in the case of letters or in blanks: `n1` and `N1`, `n2` and `n2 `";
        assert_eq!(found.odd, odd);
    }
}
