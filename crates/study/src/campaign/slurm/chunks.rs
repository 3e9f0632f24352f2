//! The runs of each task.

use sextant::NumberRange;

use super::super::Campaign;
use super::settings::Chunk;

/// A task should take so long (s): much longer than its start, and short enough for a queue.
const LONGEST_TASK_S: f64 = 900.0;
/// A task should take at least so long (s).
const SHORTEST_TASK_S: f64 = 10.0;
/// Between these two, the work is shared by so many tasks.
const USUAL_TASKS: f64 = 64.0;

/// Shares the runs `open`, which are in order, among tasks. Runs that share a survey stay together.
pub(super) fn of(campaign: &Campaign, open: &[usize], chunk: Chunk, greatest_array: usize) -> Vec<NumberRange> {
    let runs = match chunk {
        Chunk::Runs(runs) => runs.get(),
        Chunk::Auto => automatic(open.len(), campaign.estimate().map(|all| all.total_s), campaign, greatest_array),
    };
    let mut chunks: Vec<NumberRange> = Vec::new();
    for &number in open {
        let begins_survey = campaign.sweep().work().shared(number).start == number;
        match chunks.last_mut() {
            Some(last) if last.end == number && (last.len() < runs || !begins_survey) => last.end += 1,
            _ => chunks.push(NumberRange { start: number, end: number + 1 }),
        }
    }
    chunks
}

/// Runs of a task when nothing is asked for.
fn automatic(open: usize, total_s: Option<f64>, campaign: &Campaign, greatest_array: usize) -> usize {
    let all = campaign.sweep().work().len() as f64;
    let total_s = total_s.unwrap_or(USUAL_TASKS * SHORTEST_TASK_S) * open as f64 / all;
    let task_s = (total_s / USUAL_TASKS).clamp(SHORTEST_TASK_S, LONGEST_TASK_S);
    let tasks = (total_s / task_s).ceil().max(1.0);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a ratio of times, at least 1")]
    let tasks = (tasks as usize).min(greatest_array);
    open.div_ceil(tasks)
}
