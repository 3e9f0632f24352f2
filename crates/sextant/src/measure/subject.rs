//! What is measured: a map by its name.

use sextant_mapper::KnowledgeKind;

use sextant_scenario::MapJob;

/// What a summary says of a map that the map itself does not know.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Subject<'a> {
    /// Its name in tables and recordings.
    pub(crate) name: &'a str,
    /// The knowledge that its algorithm uses.
    pub(crate) knowledge: &'a [KnowledgeKind],
    /// The networks that it uses, if the scenario names them.
    pub(crate) networks: Vec<String>,
}

impl<'a> From<&'a MapJob> for Subject<'a> {
    fn from(named: &'a MapJob) -> Self {
        let joint = named.mapper.networks();
        let networks = if joint.is_empty() {
            named.network.iter().cloned().collect()
        } else {
            joint.into_iter().map(str::to_owned).collect()
        };
        Self { name: &named.name, knowledge: named.mapper.uses(), networks }
    }
}
