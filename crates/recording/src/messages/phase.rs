//! The phases of a run: the survey, then each application.

use std::collections::BTreeMap;
use std::time::Duration;

use sextant_kernel::SimTime;

/// Name of the phase of the survey; no application has it.
pub const SURVEY: &str = "survey";

/// A simulation in a recording that has several. Time in each begins at 0; in the recording, one follows the other.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Phase {
    /// `survey`, or the name of an application.
    pub name: String,
    /// Its time 0 in the recording.
    pub start: SimTime,
    /// Its end in the recording.
    pub end: SimTime,
}

impl Phase {
    /// When a phase begins that follows one with this `end`: at the next whole second, so that each message is in one phase
    /// alone.
    #[must_use]
    pub fn start_after(end: SimTime) -> SimTime {
        SimTime::ZERO + Duration::from_secs(end.as_nanos() / 1_000_000_000 + 1)
    }

    /// Whether `time` is in it.
    #[must_use]
    pub fn contains(&self, time: SimTime) -> bool {
        (self.start..=self.end).contains(&time)
    }
}

/// The phases as a metadata record: lists with commas.
pub(crate) fn record(phases: &[Phase]) -> BTreeMap<String, String> {
    let list = |of: fn(&Phase) -> String| phases.iter().map(of).collect::<Vec<_>>().join(",");
    [
        ("names", list(|phase| phase.name.clone())),
        ("start_ns", list(|phase| phase.start.as_nanos().to_string())),
        ("end_ns", list(|phase| phase.end.as_nanos().to_string())),
    ]
    .map(|(key, value)| (key.to_owned(), value))
    .into()
}

/// The phases in a metadata record; `None` if it has another form.
pub(crate) fn read(record: &BTreeMap<String, String>) -> Option<Vec<Phase>> {
    let times = |key: &str| -> Option<Vec<SimTime>> {
        record.get(key)?.split(',').map(|nanos| nanos.parse().ok().map(SimTime::from_nanos)).collect()
    };
    let names: Vec<&str> = record.get("names")?.split(',').collect();
    let (starts, ends) = (times("start_ns")?, times("end_ns")?);
    if starts.len() != names.len() || ends.len() != names.len() {
        return None;
    }
    let phase = |((name, start), end): ((&str, SimTime), SimTime)| Phase { name: name.to_owned(), start, end };
    Some(names.into_iter().zip(starts).zip(ends).map(phase).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn phases_are_read_back_and_do_not_overlap() {
        let survey =
            Phase { name: SURVEY.to_owned(), start: SimTime::ZERO, end: SimTime::from_nanos(12_000_000_000) };
        assert_eq!(Phase::start_after(survey.end), SimTime::from_nanos(13_000_000_000));
        let start = Phase::start_after(survey.end);
        let search = Phase { name: "detarsk".to_owned(), start, end: SimTime::from_nanos(13_400_000_001) };
        assert_eq!(Phase::start_after(search.end), SimTime::from_nanos(14_000_000_000));
        let phases = vec![survey, search];
        assert_eq!(read(&record(&phases)), Some(phases.clone()));
        let mut damaged = record(&phases);
        damaged.insert("end_ns".to_owned(), "1".to_owned());
        assert_eq!(read(&damaged), None);
    }
}
