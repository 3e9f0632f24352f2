//! When a robot trains its beam anew: a machine that is asked at the start of each beacon interval, and told what became
//! of it.

use sextant_channel::Db;

/// When a beam is trained.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RetrainRule {
    /// With all sectors, in every beacon interval of this number.
    Every(u32),
    /// With all sectors, when the link is this much worse than it was at best since it was trained.
    OnFall(Db),
    /// With the sectors round the one that a map predicts, when that is another one or the link is this much worse than at
    /// best; with all sectors if that did not help.
    Predicted(Db),
}

/// What a robot predicts from a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Prediction {
    /// Number of the node.
    pub node: u32,
    /// Number of the own sector that points there.
    pub sector: u8,
}

/// What a beacon interval begins with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Training {
    /// A beacon in the sector of the link.
    Keep,
    /// Beacons in all sectors, and slots in which all nodes may answer.
    All,
    /// Beacons in the sectors round the predicted one, and a slot for the node.
    Near(Prediction),
}

/// When the beam of one robot is trained.
#[derive(Clone, Debug)]
pub struct Retraining {
    rule: RetrainRule,
    /// Beacon intervals since the last training with all sectors.
    since: u32,
    /// The best ratio since the link was trained; `None` without a link.
    best: Option<Db>,
    /// The last ratio of the link; `None` if nothing was answered.
    last: Option<Db>,
    /// What was predicted when the beam was trained last.
    trained_for: Option<Prediction>,
    /// The sectors round the predicted one have just not helped.
    must_search: bool,
}

impl Retraining {
    /// Before the first beacon interval: there is no link.
    #[must_use]
    pub fn new(rule: RetrainRule) -> Self {
        Self { rule, since: 0, best: None, last: None, trained_for: None, must_search: false }
    }

    /// What the beacon interval that starts now begins with, if this is predicted. If the last training found no
    /// node, each rule trains.
    pub fn begin(&mut self, prediction: Option<Prediction>) -> Training {
        self.since += 1;
        let training =
            match (self.rule, prediction) {
                (RetrainRule::Every(intervals), _) => {
                    if self.best.is_none() || self.since >= intervals {
                        Training::All
                    } else {
                        Training::Keep
                    }
                }
                (RetrainRule::OnFall(margin), _) | (RetrainRule::Predicted(margin), None) => {
                    if self.has_fallen(margin) { Training::All } else { Training::Keep }
                }
                (RetrainRule::Predicted(margin), Some(prediction)) => {
                    if self.must_search {
                        Training::All
                    } else if self.trained_for != Some(prediction) || self.has_fallen(margin) {
                        Training::Near(prediction)
                    } else {
                        Training::Keep
                    }
                }
            };
        if training != Training::Keep {
            self.trained_for = prediction;
        }
        if training == Training::All {
            (self.since, self.must_search) = (0, false);
        }
        training
    }

    /// The ratio of the link that a training chose; `None` if it found none.
    pub fn trained(&mut self, training: Training, snr: Option<Db>) {
        if let (Training::Near(_), RetrainRule::Predicted(margin)) = (training, self.rule) {
            let was = self.best;
            let is_worse = snr.zip(was).is_some_and(|(snr, was)| snr.0 < was.0 - margin.0);
            self.must_search = snr.is_none() || is_worse;
        }
        (self.best, self.last) = (snr, snr);
    }

    /// The ratio at the last exchange of the beacon interval; `None` if it was not answered.
    pub fn heard(&mut self, snr: Option<Db>) {
        self.last = snr;
        if let (Some(snr), Some(best)) = (snr, self.best) {
            self.best = Some(Db(best.0.max(snr.0)));
        }
    }

    /// Whether there is no link, or a worse one by more than `margin`.
    fn has_fallen(&self, margin: Db) -> bool {
        match (self.best, self.last) {
            (Some(best), Some(last)) => last.0 < best.0 - margin.0,
            _ => true,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KEEP: Training = Training::Keep;
    const ALL: Training = Training::All;

    fn at(node: u32, sector: u8) -> Prediction {
        Prediction { node, sector }
    }

    #[test]
    fn a_period_counts_beacon_intervals_and_nothing_else() {
        let mut machine = Retraining::new(RetrainRule::Every(3));
        let mut begun = Vec::new();
        for snr in [20.0, 3.0, 20.0, 20.0, 20.0, 20.0, 20.0] {
            let training = machine.begin(None);
            if training == ALL {
                machine.trained(ALL, Some(Db(20.0)));
            }
            machine.heard(Some(Db(snr)));
            begun.push(training);
        }
        assert_eq!(begun, [ALL, KEEP, KEEP, ALL, KEEP, KEEP, ALL]);
        // Without a link it tries each time.
        let mut alone = Retraining::new(RetrainRule::Every(3));
        for _ in 0..3 {
            assert_eq!(alone.begin(None), ALL);
            alone.trained(ALL, None);
        }
    }

    #[test]
    fn a_fall_counts_from_the_best_since_the_training() {
        let mut machine = Retraining::new(RetrainRule::OnFall(Db(3.0)));
        assert_eq!(machine.begin(None), ALL);
        machine.trained(ALL, Some(Db(10.0)));
        for (snr, next) in [(Some(8.0), KEEP), (Some(15.0), KEEP), (Some(12.0), KEEP), (Some(11.9), ALL)] {
            machine.heard(snr.map(Db));
            assert_eq!(machine.begin(None), next, "after {snr:?}");
        }
        // The level after a training is the new best.
        machine.trained(ALL, Some(Db(7.0)));
        machine.heard(Some(Db(5.0)));
        assert_eq!(machine.begin(None), KEEP);
        machine.heard(None);
        assert_eq!(machine.begin(None), ALL);
    }

    #[test]
    fn a_prediction_is_tried_first_and_all_sectors_if_it_does_not_help() {
        let mut machine = Retraining::new(RetrainRule::Predicted(Db(3.0)));
        assert_eq!(machine.begin(Some(at(4, 7))), Training::Near(at(4, 7)));
        machine.trained(Training::Near(at(4, 7)), Some(Db(12.0)));
        machine.heard(Some(Db(12.0)));
        assert_eq!(machine.begin(Some(at(4, 7))), KEEP);
        // Another sector, another node.
        assert_eq!(machine.begin(Some(at(4, 8))), Training::Near(at(4, 8)));
        machine.trained(Training::Near(at(4, 8)), Some(Db(13.0)));
        assert_eq!(machine.begin(Some(at(5, 8))), Training::Near(at(5, 8)));
        // It is blocked: all sectors, and then no more until something changes.
        machine.trained(Training::Near(at(5, 8)), Some(Db(2.0)));
        assert_eq!(machine.begin(Some(at(5, 8))), ALL);
        machine.trained(ALL, Some(Db(6.0)));
        machine.heard(Some(Db(6.0)));
        assert_eq!(machine.begin(Some(at(5, 8))), KEEP);
        machine.heard(Some(Db(1.0)));
        assert_eq!(machine.begin(Some(at(5, 8))), Training::Near(at(5, 8)));
        machine.trained(Training::Near(at(5, 8)), None);
        assert_eq!(machine.begin(Some(at(5, 8))), ALL);
        // Without a map it waits for a fall.
        machine.trained(ALL, Some(Db(6.0)));
        assert_eq!(machine.begin(None), KEEP);
    }
}
