//! The rules by which a log chooses an estimator, as a table. `docs/algorithms/auto.md` shows it.

/// Why an estimator was chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChoiceReason {
    /// Something is known of the places, which only the link model can use.
    KnownPlaces,
    /// The log has too few stops or nodes to leave some out: the link model maps it.
    TooLittle,
    /// Strengths do not speak for the places of the one of independent packets that predicts as well.
    Strengths,
    /// Each stop counts as one packet of a node, so that the log does not tell whether packets are independent.
    SinglePackets,
    /// The one of independent packets that predicts as well as the link model does not settle on the log.
    Unsettled,
    /// It takes packets as independent of each other, and predicts what was left out as well as the link model, or better.
    IndependentPackets,
    /// The link model predicts what was left out better than estimators for which packets are independent.
    DependentPackets,
}

/// What the rules look at.
#[derive(Clone, Copy, Debug)]
pub(super) struct ChoiceFacts {
    /// Whether something is known of the places of nodes.
    pub(super) knows_places: bool,
    /// Whether stops could be left out, so that estimators were compared.
    pub(super) compared: bool,
    /// The number of the most trusted estimator of independent packets, if it predicts as well as the link model does.
    pub(super) as_good: Option<usize>,
    /// Whether strengths, if the log has any, speak for its places.
    pub(super) strengths_agree: bool,
    /// Whether the log has strengths, and most links no more than one packet.
    pub(super) single_packets: bool,
    /// Whether it settles on the log, as far as it was tried.
    pub(super) settles: bool,
}

/// A rule. The first one whose condition holds decides.
struct Rule {
    reason: ChoiceReason,
    holds: fn(&ChoiceFacts) -> bool,
    /// The number of the candidate that it takes; `None` is the link model.
    takes: fn(&ChoiceFacts) -> Option<usize>,
    /// The condition as the page shows it.
    #[cfg_attr(not(test), expect(dead_code, reason = "shown by the page, which a test compares with the table"))]
    condition: &'static str,
    /// What it takes, as the page shows it.
    #[cfg_attr(not(test), expect(dead_code, reason = "shown by the page, which a test compares with the table"))]
    choice: &'static str,
    /// The reason that is printed.
    because: &'static str,
}

const LINK_MODEL: fn(&ChoiceFacts) -> Option<usize> = |_| None;

/// The rules, from the first to the last.
const RULES: [Rule; 7] = [
    Rule {
        reason: ChoiceReason::KnownPlaces,
        holds: |facts| facts.knows_places,
        takes: LINK_MODEL,
        condition: "something is known of the places",
        choice: "link model",
        because: "only it can use what is known of the places",
    },
    Rule {
        reason: ChoiceReason::TooLittle,
        holds: |facts| !facts.compared,
        takes: LINK_MODEL,
        condition: "no stops can be left out",
        choice: "link model",
        because: "the log has too few stops or nodes to compare estimators",
    },
    Rule {
        reason: ChoiceReason::Strengths,
        holds: |facts| facts.as_good.is_some() && !facts.strengths_agree,
        takes: LINK_MODEL,
        condition: "an estimator of independent packets predicts as well, but strengths do not speak for its places",
        choice: "link model",
        because: "an estimator of independent packets predicts the stops left out as well, but strengths do not speak for its places",
    },
    Rule {
        reason: ChoiceReason::SinglePackets,
        holds: |facts| facts.as_good.is_some() && facts.single_packets,
        takes: LINK_MODEL,
        condition: "an estimator of independent packets predicts as well, but there are strengths, and most links have one packet",
        choice: "link model",
        because: "the log has strengths, and most of its links have one packet: that does not tell whether packets are independent",
    },
    Rule {
        reason: ChoiceReason::Unsettled,
        holds: |facts| facts.as_good.is_some() && !facts.settles,
        takes: LINK_MODEL,
        condition: "an estimator of independent packets predicts as well, but its fit or most of its places do not settle",
        choice: "link model",
        because: "an estimator of independent packets predicts the stops left out as well, but does not settle on this log",
    },
    Rule {
        reason: ChoiceReason::IndependentPackets,
        holds: |facts| facts.as_good.is_some(),
        takes: |facts| facts.as_good,
        condition: "an estimator of independent packets predicts as well",
        choice: "that estimator",
        because: "it predicts the stops left out no worse than the link model: packets of a link seem independent",
    },
    Rule {
        reason: ChoiceReason::DependentPackets,
        holds: |_| true,
        takes: LINK_MODEL,
        condition: "otherwise",
        choice: "link model",
        because: "no estimator of independent packets predicts the stops left out as well: packets of a link share what they lose",
    },
];

/// The number of the candidate that the rules take (`links` is that of the link model), and why.
pub(super) fn choose(facts: &ChoiceFacts, links: usize) -> (usize, ChoiceReason) {
    let rule = RULES.iter().find(|rule| (rule.holds)(facts)).expect("the last rule always holds");
    ((rule.takes)(facts).unwrap_or(links), rule.reason)
}

impl ChoiceReason {
    /// The reason in words.
    pub(super) fn because(self) -> &'static str {
        RULES.iter().find(|rule| rule.reason == self).expect("each reason is that of a rule").because
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_rule_that_holds_decides() {
        let facts = |knows_places, compared, as_good| ChoiceFacts {
            knows_places,
            compared,
            as_good,
            strengths_agree: true,
            single_packets: false,
            settles: true,
        };
        let single = ChoiceFacts { single_packets: true, ..facts(false, true, Some(2)) };
        let contradicted = ChoiceFacts { strengths_agree: false, ..facts(false, true, Some(2)) };
        let unsettled = ChoiceFacts { settles: false, ..facts(false, true, Some(2)) };
        for (facts, expected) in [
            (facts(true, true, Some(2)), (0, ChoiceReason::KnownPlaces)),
            (facts(false, false, None), (0, ChoiceReason::TooLittle)),
            (facts(false, true, Some(2)), (2, ChoiceReason::IndependentPackets)),
            (contradicted, (0, ChoiceReason::Strengths)),
            (single, (0, ChoiceReason::SinglePackets)),
            (unsettled, (0, ChoiceReason::Unsettled)),
            (facts(false, true, None), (0, ChoiceReason::DependentPackets)),
        ] {
            assert_eq!(choose(&facts, 0), expected, "{facts:?}");
        }
    }

    #[test]
    fn the_page_shows_the_table() {
        let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/algorithms/auto.md");
        let page = std::fs::read_to_string(page).expect("the page of auto");
        let rows: Vec<String> = RULES
            .iter()
            .map(|rule| format!("| {} | {} | {} |\n", rule.condition, rule.choice, rule.because))
            .collect();
        assert!(page.contains(&rows.concat()), "the page is to show:\n{}", rows.concat());
    }
}
