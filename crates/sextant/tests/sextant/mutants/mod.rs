//! What a check of a scenario accepts, a run accepts; and what it refuses, it names. Found by changing shipped scenarios at
//! random: keys are removed or added, numbers negated, zero, huge, tiny or not numbers, texts and types swapped.
//!
//! `SEXTANT_MUTANTS=5000 SEXTANT_MUTANTS_SEED=7 cargo test -p sextant --release --test sextant mutants` tries more, and so does
//! `.ci/release`.

mod additions;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::atomic::{AtomicU32, Ordering};

use sextant::Forecast;
use sextant::forecast::warnings;
use sextant::run::RunError;
use sextant::scenario::{Scenario, schema};
use sextant_kernel::{Purpose, Seed, Watch, Work};
use toml::{Table, Value};

use self::additions::additions;

/// Scenarios that name no files, with all kinds of tables.
const SHIPPED: [&str; 14] = [
    "smoke.toml",
    "mac/beacon-enabled.toml",
    "mac/poisson-star.toml",
    "mmtm/two-bands.toml",
    "seek/one-source.toml",
    "seek/pioneer.toml",
    "seek/two-sources.toml",
    "sensing/targets-and-fields.toml",
    "target/case-1.toml",
    "target/elements-1.toml",
    "target/imperfect-sensors.toml",
    "target/map-then-search.toml",
    "target/walls.toml",
    "teams/size.toml",
];

/// Mutants of each scenario, unless more are asked for.
const USUAL: u64 = 3;

/// So often a run asks whether it is stopped before it is.
const PATIENCE: u32 = 200;

/// Stops a run early.
#[derive(Debug, Default)]
struct Impatient(AtomicU32);

impl Watch for Impatient {
    fn begin(&self, _: Work) {}

    fn advance(&self, _: u64) {}

    fn is_stopped(&self) -> bool {
        self.0.fetch_add(1, Ordering::Relaxed) >= PATIENCE
    }
}

/// Numbers at random.
struct Luck {
    seed: Seed,
    mutant: u64,
    draws: u64,
}

impl Luck {
    /// A number below `limit`.
    fn below(&mut self, limit: usize) -> usize {
        self.draws += 1;
        let bits = self.seed.bits(Purpose::new(u64::MAX), [self.mutant, self.draws, 0]);
        usize::try_from(bits % limit as u64).expect("below the limit")
    }

    fn of<T: Clone>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len())].clone()
    }
}

/// A step from a table or an array to a value in it.
#[derive(Clone, Debug)]
enum Step {
    Key(String),
    Index(usize),
}

/// The paths of all that is in `value`.
fn paths(value: &Value, above: &[Step], all: &mut Vec<Vec<Step>>) {
    let mut add = |step: Step, inner: &Value| {
        let path = [above, &[step]].concat();
        all.push(path.clone());
        paths(inner, &path, all);
    };
    match value {
        Value::Table(table) => table.iter().for_each(|(key, inner)| add(Step::Key(key.clone()), inner)),
        Value::Array(items) => items.iter().take(3).enumerate().for_each(|(i, inner)| add(Step::Index(i), inner)),
        _ => {}
    }
}

/// The value at `path`.
fn at<'v>(root: &'v mut Value, path: &[Step]) -> &'v mut Value {
    path.iter().fold(root, |value, step| match (step, value) {
        (Step::Key(key), Value::Table(table)) => table.get_mut(key).expect("a path of this value"),
        (Step::Index(i), Value::Array(items)) => &mut items[*i],
        _ => panic!("a path of another value"),
    })
}

/// Numbers that hardly anybody means.
fn extremes() -> Vec<Value> {
    let extremes = [0.0, -1.0, 1e300, -1e300, 1e-300, 5e-324, 1e9, 1e6, f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
    extremes.map(Value::Float).to_vec()
}

/// Another value than `value`; `names` are the texts of the scenario.
fn changed(value: &Value, names: &[String], luck: &mut Luck) -> Value {
    let floats = |of: f64| {
        let scaled = [-of, 1e3 * of, 1e-3 * of].map(Value::Float);
        extremes().into_iter().chain(scaled).collect::<Vec<_>>()
    };
    let other =
        [Value::Table(Table::new()), Value::Array(Vec::new()), Value::Boolean(true), Value::String("x".into())];
    let choices = match value {
        Value::Float(number) => [floats(*number), other.to_vec()].concat(),
        Value::Integer(number) => {
            let near = [
                number.wrapping_neg(),
                number.wrapping_add(1),
                number.wrapping_sub(1),
                0,
                255,
                65_536,
                1 << 32,
                i64::MAX,
            ];
            let near = near.map(Value::Integer).to_vec();
            [near, floats(*number as f64), other.to_vec()].concat()
        }
        Value::String(text) => {
            let own = ["", "a\nb", "../x", &"x".repeat(300), &format!("{text} ")].map(str::to_owned);
            let texts = own.into_iter().chain([luck.of(names), luck.of(names)]).map(Value::String);
            texts.chain([Value::Integer(0), Value::Table(Table::new())]).collect()
        }
        Value::Array(items) => {
            let reversed = items.iter().rev().cloned().collect();
            let longer = items.iter().take(1).chain(items).cloned().collect();
            let nested = vec![value.clone()];
            let arrays = [Vec::new(), reversed, longer, nested, items.iter().take(1).cloned().collect()];
            arrays.into_iter().map(Value::Array).chain([Value::Integer(1), Value::String("x".into())]).collect()
        }
        Value::Boolean(_) | Value::Table(_) | Value::Datetime(_) => other.to_vec(),
    };
    luck.of(&choices)
}

/// A scenario with one or two changes.
fn mutant(schema: &serde_json::Value, scenario: &Value, luck: &mut Luck) -> Value {
    let mut mutant = scenario.clone();
    for _ in 0..1 + luck.below(5) / 4 {
        if luck.below(3) == 0 {
            let addition = luck.of(&additions(schema, &mutant));
            let value = addition.value(schema, luck);
            if let Some((Step::Key(key), above)) = addition.path.split_last()
                && let Value::Table(table) = at(&mut mutant, above)
            {
                table.insert(key.clone(), value);
            }
            continue;
        }
        let mut all = Vec::new();
        paths(&mutant, &[], &mut all);
        let is_text = |path: &Vec<Step>| at(&mut scenario.clone(), path).as_str().map(str::to_owned);
        let mut known = Vec::new();
        paths(scenario, &[], &mut known);
        let names: Vec<String> = known.iter().filter_map(is_text).collect();
        let path = luck.of(&all);
        let (last, above) = path.split_last().expect("a path has a step");
        if luck.below(7) == 0 {
            match (at(&mut mutant, above), last) {
                (Value::Table(table), Step::Key(key)) => drop(table.remove(key)),
                (Value::Array(items), Step::Index(i)) => drop(items.remove(*i)),
                _ => panic!("a path of another value"),
            }
        } else {
            let value = at(&mut mutant, &path);
            *value = changed(&value.clone(), &names, luck);
        }
    }
    mutant
}

/// What is wrong with what the program does with the scenario `text`, if anything.
fn fault(text: &str) -> Option<String> {
    let checked = Scenario::parse(text).and_then(|scenario| scenario.check_grids().map(|()| scenario));
    let scenario = match checked {
        Ok(scenario) => scenario,
        Err(errors) => {
            let is_vague = |message: &String| !message.contains('`') || message.len() > 5000;
            let mut messages = errors.errors().iter().map(ToString::to_string);
            return messages.find(is_vague).map(|message| format!("a vague error: {message}"));
        }
    };
    let _ = (warnings(&scenario), Forecast::of(&scenario));
    match sextant::run(&scenario, &mut (), &Impatient::default()) {
        Ok(run) => {
            let summary = run.summary().to_json();
            summary.contains(": null").then(|| "a summary with a number that is none".to_owned())
        }
        Err(RunError::Interrupted(_)) => None,
        Err(error) => Some(format!("refused by the run alone: {error}")),
    }
}

fn setting(name: &str, usual: u64) -> u64 {
    std::env::var(name).ok().and_then(|text| text.parse().ok()).unwrap_or(usual)
}

#[test]
fn what_a_check_accepts_a_run_accepts_and_errors_name_their_keys() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    let count = setting("SEXTANT_MUTANTS", USUAL);
    let seed = Seed(setting("SEXTANT_MUTANTS_SEED", 1));
    let schema = schema();
    let mut faults = Vec::new();
    for (i, name) in SHIPPED.into_iter().enumerate() {
        let text = Scenario::load(folder.join(name)).expect("a good scenario").text().to_owned();
        let scenario = Value::Table(text.parse().expect("TOML"));
        for number in 0..count {
            let mut luck = Luck { seed, mutant: number * SHIPPED.len() as u64 + i as u64, draws: 0 };
            let Ok(text) = toml::to_string(&mutant(&schema, &scenario, &mut luck)) else { continue };
            let fault =
                catch_unwind(AssertUnwindSafe(|| fault(&text))).unwrap_or_else(|_| Some("a panic".to_owned()));
            faults.extend(fault.map(|fault| format!("mutant {number} of {name}: {fault}\n{text}")));
        }
    }
    assert!(faults.is_empty(), "{} faults, the first: {}", faults.len(), faults[0]);
}
