//! Least squares by Levenberg and Marquardt's method: Gauss-Newton steps, damped until they lower the cost.

/// A sum of squares to be minimised.
pub(crate) trait LeastSquares {
    /// A point at which the cost is computed.
    type Point;
    /// A step from one point to another.
    type Step;
    /// The error that ends the work.
    type Error;

    /// The sum of squares.
    fn cost(&self, at: &Self::Point) -> f64;

    /// The solution δ of the normal equations with `damping` times their diagonal added, or an approximation; `None`
    /// if there is no solution.
    fn step(&self, at: &Self::Point, damping: f64) -> Result<Option<Self::Step>, Self::Error>;

    /// `at − δ`.
    fn moved(&self, at: &Self::Point, step: &Self::Step) -> Self::Point;

    /// Whether this step is so small that it is the last. `is_lower` says whether it lowers the cost.
    fn is_last(&self, at: &Self::Point, step: &Self::Step, is_lower: bool) -> bool;
}

/// How the damping changes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Damping {
    pub(crate) first: f64,
    /// Factor after a step that lowers the cost, and the lowest damping.
    pub(crate) ease: f64,
    pub(crate) least: f64,
    /// Factor after any other step, and the damping at which the search ends.
    pub(crate) tighten: f64,
    pub(crate) most: f64,
}

/// The minimum near `start`, found in at most `steps` steps.
pub(crate) fn minimum<P: LeastSquares>(
    problem: &P,
    start: P::Point,
    damping: Damping,
    steps: u32,
) -> Result<P::Point, P::Error> {
    let mut point = start;
    let mut lowest = problem.cost(&point);
    let mut factor = damping.first;
    for _ in 0..steps {
        let Some(step) = problem.step(&point, factor)? else { break };
        let next = problem.moved(&point, &step);
        let reached = problem.cost(&next);
        let is_lower = reached < lowest;
        let is_last = problem.is_last(&point, &step, is_lower);
        if is_lower {
            (point, lowest) = (next, reached);
            factor = (factor * damping.ease).max(damping.least);
        } else {
            factor *= damping.tighten;
        }
        if is_last || factor > damping.most {
            break;
        }
    }
    Ok(point)
}
