//! Which robot goes to which target.

use std::cmp::Ordering;
use std::ops::{Add, Sub};

/// A cost: first the number of robots sent to targets that they cannot meet, then the sum of the times (s).
#[derive(Clone, Copy, Debug)]
struct Cost {
    unreachable: i64,
    time_s: f64,
}

impl Cost {
    const ZERO: Self = Self { unreachable: 0, time_s: 0.0 };
    const INFINITE: Self = Self { unreachable: i64::MAX / 4, time_s: 0.0 };

    fn of(time_s: Option<f64>) -> Self {
        match time_s {
            Some(time_s) => Self { unreachable: 0, time_s },
            None => Self { unreachable: 1, time_s: 0.0 },
        }
    }

    fn is_below(self, other: Self) -> bool {
        self.unreachable.cmp(&other.unreachable).then(self.time_s.total_cmp(&other.time_s)) == Ordering::Less
    }
}

impl Add for Cost {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { unreachable: self.unreachable + other.unreachable, time_s: self.time_s + other.time_s }
    }
}

impl Sub for Cost {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self { unreachable: self.unreachable - other.unreachable, time_s: self.time_s - other.time_s }
    }
}

/// The target of each robot. `times_s[robot][target]` says how long the robot would take to meet the target (s);
/// `None` if it cannot. A time that is not a number counts as `None`.
///
/// As many targets as possible get one robot each, and then the sum of the times is least (Kuhn 1955; Munkres
/// 1957). A robot that is left over goes to the target that it meets first, so some targets may have several. A robot
/// that can meet no target has none. If two choices cost the same, the result depends on the order of robots and
/// targets alone.
#[must_use]
pub(crate) fn assign(times_s: &[Vec<Option<f64>>]) -> Vec<Option<usize>> {
    let time_s = |robot: usize, target: usize| {
        let time_s = times_s[robot].get(target).copied().flatten();
        time_s.filter(|time_s| time_s.is_finite())
    };
    let (robots, targets) = (times_s.len(), times_s.iter().map(Vec::len).max().unwrap_or(0));
    let mut own = vec![None; robots];
    if robots <= targets {
        for (robot, target) in least_cost(robots, targets, |robot, target| Cost::of(time_s(robot, target))) {
            own[robot] = Some(target);
        }
    } else {
        for (target, robot) in least_cost(targets, robots, |target, robot| Cost::of(time_s(robot, target))) {
            own[robot] = Some(target);
        }
    }
    let first_met = |robot: usize| {
        let met = (0..targets).filter_map(|target| Some((time_s(robot, target)?, target)));
        met.min_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, target)| target)
    };
    let target = |(robot, own): (usize, Option<usize>)| {
        own.filter(|&target| time_s(robot, target).is_some()).or_else(|| first_met(robot))
    };
    own.into_iter().enumerate().map(target).collect()
}

/// Another column for each row, with the least sum of costs: shortest augmenting paths, one row at a time, in
/// O(rows² · columns) (Jonker and Volgenant 1987). There are at least as many columns as rows.
fn least_cost(rows: usize, columns: usize, cost: impl Fn(usize, usize) -> Cost) -> Vec<(usize, usize)> {
    // Column `columns` stands for the row that is being added.
    let mut row_of: Vec<Option<usize>> = vec![None; columns + 1];
    let mut row_price = vec![Cost::ZERO; rows];
    let mut column_price = vec![Cost::ZERO; columns + 1];
    for row in 0..rows {
        row_of[columns] = Some(row);
        let mut column = columns;
        let mut slack = vec![Cost::INFINITE; columns];
        let mut before = vec![columns; columns];
        let mut visited = vec![false; columns + 1];
        while let Some(from) = row_of[column] {
            visited[column] = true;
            let (mut least, mut next) = (Cost::INFINITE, columns);
            for to in (0..columns).filter(|&to| !visited[to]) {
                let reduced = cost(from, to) - row_price[from] - column_price[to];
                if reduced.is_below(slack[to]) {
                    (slack[to], before[to]) = (reduced, column);
                }
                if slack[to].is_below(least) {
                    (least, next) = (slack[to], to);
                }
            }
            for to in 0..=columns {
                match row_of[to] {
                    Some(row) if visited[to] => {
                        row_price[row] = row_price[row] + least;
                        column_price[to] = column_price[to] - least;
                    }
                    _ if to < columns => slack[to] = slack[to] - least,
                    _ => {}
                }
            }
            column = next;
        }
        while column != columns {
            row_of[column] = row_of[before[column]];
            column = before[column];
        }
    }
    (0..columns).filter_map(|column| Some((row_of[column]?, column))).collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The least (number of pairs that cannot meet, sum of times) over all ways to give each robot or target its own.
    fn brute_force(times: &[Vec<Option<f64>>], robot: usize, taken: &mut Vec<bool>, spare: usize) -> (usize, f64) {
        let Some(row) = times.get(robot) else { return (0, 0.0) };
        let mut best = (usize::MAX, f64::INFINITY);
        let mut consider = |(missed, sum): (usize, f64)| {
            if missed < best.0 || missed == best.0 && sum < best.1 {
                best = (missed, sum);
            }
        };
        if spare > 0 {
            consider(brute_force(times, robot + 1, taken, spare - 1));
        }
        for (target, time) in row.iter().enumerate() {
            if !taken[target] {
                taken[target] = true;
                let (missed, sum) = brute_force(times, robot + 1, taken, spare);
                consider((missed + usize::from(time.is_none()), sum + time.unwrap_or(0.0)));
                taken[target] = false;
            }
        }
        best
    }

    proptest! {
        #[test]
        fn the_sum_is_the_least_of_all_assignments(
            rows in (1_usize..7).prop_flat_map(|targets| {
                prop::collection::vec(prop::collection::vec(prop::option::weighted(0.8, 0.0..9.0_f64), targets), 1..7)
            }),
        ) {
            let (robots, targets) = (rows.len(), rows[0].len());
            let assigned = assign(&rows);
            let (missed, least) = brute_force(&rows, 0, &mut vec![false; targets], robots.saturating_sub(targets));
            // The robots that have their target for themselves, as far as the optimum goes.
            let mut best_of = vec![None; targets];
            let pairs = least_cost_pairs(&rows);
            for &(robot, target) in &pairs {
                prop_assert_eq!(assigned[robot], Some(target));
                prop_assert!(best_of[target].replace(robot).is_none());
            }
            let sum: f64 = pairs.iter().map(|&(robot, target)| rows[robot][target].expect("reachable")).sum();
            prop_assert_eq!(pairs.len(), robots.min(targets) - missed);
            prop_assert!((sum - least).abs() < 1e-9, "{} for {}", sum, least);
            for (robot, target) in assigned.iter().enumerate() {
                prop_assert_eq!(target.is_some(), rows[robot].iter().any(Option::is_some));
                prop_assert!(target.is_none_or(|target| rows[robot][target].is_some()));
            }
        }
    }

    /// The pairs of the optimum that can meet.
    fn least_cost_pairs(rows: &[Vec<Option<f64>>]) -> Vec<(usize, usize)> {
        let (robots, targets) = (rows.len(), rows[0].len());
        let mut pairs = if robots <= targets {
            least_cost(robots, targets, |robot, target| Cost::of(rows[robot][target]))
        } else {
            let pairs = least_cost(targets, robots, |target, robot| Cost::of(rows[robot][target]));
            pairs.into_iter().map(|(target, robot)| (robot, target)).collect()
        };
        pairs.retain(|&(robot, target)| rows[robot][target].is_some());
        pairs
    }

    #[test]
    fn a_robot_gives_way_where_the_sum_is_less() {
        // Both are nearest to target 0; the first loses less by going to target 1.
        assert_eq!(assign(&[vec![Some(1.0), Some(2.0)], vec![Some(1.5), Some(9.0)]]), [Some(1), Some(0)]);
    }

    #[test]
    fn a_robot_that_is_left_over_goes_to_the_target_that_it_meets_first() {
        let times = [vec![Some(5.0), Some(3.0)], vec![Some(1.0), Some(8.0)], vec![Some(4.0), Some(2.0)]];
        assert_eq!(assign(&times), [Some(1), Some(0), Some(1)]);
    }

    #[test]
    fn targets_that_cannot_be_met_get_nobody() {
        assert_eq!(assign(&[vec![None, Some(4.0)], vec![None, None]]), [Some(1), None]);
        assert_eq!(assign(&[vec![Some(f64::INFINITY)]]), [None]);
        assert_eq!(assign(&[vec![]]), [None]);
        assert_eq!(assign(&[]), []);
    }

    #[test]
    fn equal_costs_give_the_same_assignment_each_time() {
        let times = vec![vec![Some(1.0); 4]; 4];
        let assigned = assign(&times);
        assert_eq!(assigned, assign(&times));
        let mut targets: Vec<_> = assigned.into_iter().flatten().collect();
        targets.sort_unstable();
        assert_eq!(targets, [0, 1, 2, 3]);
    }
}
