//! The robots of a survey: their paths, and why they ended.

use serde::Serialize;

use sextant_kernel::text::{counted, listed};

/// One robot.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct RobotSummary {
    /// Name of the robot.
    pub name: String,
    /// Places where it listened, or sent as a mobile anchor.
    pub stops: usize,
    /// Length of its path through all its known positions (m).
    pub path_length_m: f64,
    /// Why it finished: `complete`, `steps_exhausted` or `stuck`. Absent if it was interrupted or only its log is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ending: Option<&'static str>,
    /// What ended its way, told apart further. Absent if only its log is known, or an application of the caller drives it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ended: Option<RobotEnd>,
    /// When it finished (s). Absent if it was interrupted or only its log is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub duration_s: Option<f64>,
    /// Nodes from which all robots together received fewer packets than this robot was asked to receive from each node.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub unreached: Vec<String>,
    /// How many packets of each node it was asked to receive, if more than one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub packets_wanted: Option<u32>,
    /// Stops of its planned path that were left out. Absent if there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub left_out: Option<LeftOutSummary>,
}

/// What ended the way of a robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum RobotEnd {
    /// It received as many packets of each node as wanted.
    AllHeard,
    /// It has swept its area.
    AreaSwept,
    /// It came to the end of its planned path, or a mobile anchor to the end of its time.
    PathEnded,
    /// It made as many steps as it may.
    StepsExhausted,
    /// It found no further place to go to.
    Stuck,
    /// The simulated time was over.
    TimeLimit,
    /// The user ended the simulation.
    Interrupted,
}

/// Stops of a planned path that were left out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct LeftOutSummary {
    /// Inside an obstacle, or nearer to one than the radius of the robot.
    pub in_obstacles: usize,
    /// Without a way to them.
    pub unreachable: usize,
}

impl RobotEnd {
    /// What ended it, as the rest of a sentence that begins with the name of the robot.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::AllHeard => "ended because it had heard every node often enough",
            Self::AreaSwept => "ended because its area was swept",
            Self::PathEnded => "ended at the end of its path",
            Self::StepsExhausted => "ended because its steps were exhausted (`max_steps`)",
            Self::Stuck => "ended because no place to go to was left",
            Self::TimeLimit => "ended because the simulated time was over (`duration_s`)",
            Self::Interrupted => "was interrupted",
        }
    }
}

impl RobotSummary {
    /// What ended its way, which of `nodes` it did not reach, and which stops were left out, as one sentence without its full
    /// stop; `None` if that is not known.
    #[must_use]
    pub fn end(&self, nodes: usize) -> Option<String> {
        let ended = self.ended?;
        let mut text = ended.words().to_owned();
        if let Some(time_s) = self.duration_s {
            text += &format!(", after {time_s:.1} s and {}", counted(self.stops, "stop"));
        }
        if !self.unreached.is_empty() {
            let (count, were) = (self.unreached.len(), if self.unreached.len() == 1 { "was" } else { "were" });
            let heard = match self.packets_wanted {
                None => "not heard by any robot".to_owned(),
                Some(wanted) => format!("heard fewer than {wanted} times by all robots together"),
            };
            text += &format!("; {count} of {} {were} {heard}: {}", counted(nodes, "node"), listed(&self.unreached));
        }
        if let Some(LeftOutSummary { in_obstacles, unreachable }) = self.left_out {
            let all = counted(in_obstacles + unreachable, "planned stop");
            let reasons = [(in_obstacles, "inside or too near to an obstacle"), (unreachable, "without a way to it")];
            let reasons = reasons.into_iter().filter(|(count, _)| *count > 0);
            let reasons: Vec<String> = reasons.map(|(count, why)| format!("{count} {why}")).collect();
            text += &format!("; {all} left out: {}", reasons.join(", "));
        }
        Some(text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_end_of_a_way_tells_what_ended_it_and_what_is_missing() {
        let robot = RobotSummary {
            stops: 12,
            ended: Some(RobotEnd::StepsExhausted),
            duration_s: Some(20.0),
            unreached: vec!["n3".into(), "n7".into()],
            packets_wanted: Some(5),
            left_out: Some(LeftOutSummary { in_obstacles: 4, unreachable: 1 }),
            ..RobotSummary::default()
        };
        assert_eq!(
            robot.end(30).unwrap(),
            "ended because its steps were exhausted (`max_steps`), after 20.0 s and 12 stops; 2 of 30 nodes were heard \
             fewer than 5 times by all robots together: n3, n7; 5 planned stops left out: 4 inside or too near to an \
             obstacle, 1 without a way to it"
        );
        let stopped = RobotSummary { ended: Some(RobotEnd::Interrupted), ..RobotSummary::default() };
        assert_eq!(stopped.end(30).unwrap(), "was interrupted");
        assert_eq!(RobotSummary::default().end(30), None);
    }
}
