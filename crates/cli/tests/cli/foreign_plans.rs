//! Plans that somebody else made: nothing of them runs, leads out of their folder, or changes a row without a word.

use std::fs;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::{Value, json};
use tempfile::TempDir;

use crate::program::{Said, call, scenario, sextant};

/// Two cells with surveys of their own, and one run of each.
const SWEEP: &str = "[sweep]\nruns = 1\n[sweep.product]\nrobots.0.listen_s = [1.1, 1.2]\n";

/// A folder with a plan, and with programs that are called as those of Slurm, and log how.
struct Plan {
    folder: TempDir,
    name: &'static str,
}

/// Logs the words of the call, one a line, and the script; answers with a job.
const SLURM: &str = r#"#!/bin/sh
here=$(dirname "$0")
printf '%s\n' "$(basename "$0")" "$@" >>"$here/calls"
for word in "$@"; do if [ -f "$word" ]; then cat "$word" >>"$here/scripts"; fi; done
[ "$(basename "$0")" != sbatch ] || echo 4711
"#;

impl Plan {
    fn new() -> Self {
        Self::called("plan")
    }

    fn called(name: &'static str) -> Self {
        let folder = TempDir::new().expect("there is room");
        let plan = Self { folder, name };
        let smoke = fs::read_to_string(scenario("smoke.toml")).expect("it is there");
        let (before, rest) = smoke.split_once("[world.nodes.").expect("it has nodes");
        let (_, after) = rest.split_once("[[world.obstacles]]").expect("obstacles follow");
        let base = format!("{before}[world.nodes.csv]\nfile = \"nodes.csv\"\n\n[[world.obstacles]]{after}");
        fs::write(plan.file("base.toml"), base).expect("there is room");
        fs::write(plan.file("nodes.csv"), "node,x_m,y_m,z_m\nn1,3,4,0\nn12,5,6,0\n").expect("there is room");
        fs::write(plan.file("s.toml"), format!("extends = \"base.toml\"\n{SWEEP}")).expect("there is room");
        fs::write(plan.file("secret.txt"), "password = hunter2\n").expect("there is room");
        fs::create_dir(plan.file("bin")).expect("there is room");
        for program in ["sbatch", "scancel", "squeue", "scontrol"] {
            fs::write(plan.file("bin").join(program), SLURM).expect("there is room");
            let executable = fs::Permissions::from_mode(0o755);
            fs::set_permissions(plan.file("bin").join(program), executable).expect("it is ours");
        }
        let mut command = sextant();
        command
            .arg("sweep")
            .arg(plan.file("s.toml"))
            .arg(format!("--plan={}", plan.path().display()))
            .arg("--no-trial");
        command.output().expect("it starts").printed();
        plan
    }

    fn file(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn path(&self) -> PathBuf {
        self.file(self.name)
    }

    /// A command on the plan, where the programs of Slurm are the logging ones.
    fn call(&self, words: &[&str]) -> Output {
        let mut command = sextant();
        let path = format!("{}:{}", self.file("bin").display(), std::env::var("PATH").expect("there is one"));
        command.env("PATH", path).arg("sweep").arg(self.path()).args(words).output().expect("it starts")
    }

    /// Changes a JSON file of the plan.
    fn change(&self, file: &str, change: impl FnOnce(&mut Value)) {
        let path = self.path().join(file);
        let mut json: Value = serde_json::from_slice(&fs::read(&path).expect("it is there")).expect("JSON");
        change(&mut json);
        fs::write(path, json.to_string()).expect("there is room");
    }

    /// The words of all calls of programs of Slurm, and all scripts that they got.
    fn called_slurm(&self) -> (String, String) {
        let read = |name: &str| fs::read_to_string(self.file("bin").join(name)).unwrap_or_default();
        (read("calls"), read("scripts"))
    }
}

/// A change of the JSON in a file.
type Change = fn(&mut Value);

/// The message of a call that is refused as bad input, without spaces: long messages are wrapped, also within names.
fn refused(output: &Output) -> String {
    let message = squeezed(&String::from_utf8_lossy(&output.stderr));
    assert_eq!(output.status.code(), Some(2), "{message}");
    message
}

fn squeezed(text: &str) -> String {
    text.chars().filter(|c| !c.is_whitespace() && *c != '│').collect()
}

/// Whether a message that is [`refused`] has this text.
fn has(message: &str, text: &str) -> bool {
    message.contains(&squeezed(text))
}

/// All commands on a plan.
const COMMANDS: [&[&str]; 6] =
    [&["--status"], &["--cells", "0..2"], &["--submit", "slurm"], &["--resume"], &["--cancel"], &["--collect"]];

#[test]
fn an_honest_plan_is_submitted_resumed_cancelled_and_collected() {
    let plan = Plan::called("it's my $(plan) 50%");
    let words =
        ["--submit", "slurm", "--chunk", "1", "--time=1-00:00", "--partition=long,short", "--option=--qos=low"];
    plan.call(&words).printed();
    let (calls, script) = plan.called_slurm();
    assert!(calls.contains("sbatch\n--parsable\n--array=0-1\n--\n/"), "{calls}");
    for line in ["#SBATCH --job-name=sextant-it_s_my___plan__50_", "#SBATCH --time=1-00:00", "#SBATCH --qos=low"] {
        assert!(script.contains(&format!("{line}\n")), "{line} in {script}");
    }
    let output = script.lines().find(|line| line.starts_with("#SBATCH --output=")).expect("it is there");
    assert!(output.ends_with(r"/it\'s\ my\ \$\(plan\)\ 50%%/slurm/000001/%A_%a.log"), "{output}");
    // The script does its part where a shell runs it.
    let run = |task: &str| {
        let mut command = Command::new("sh");
        command.env("SLURM_ARRAY_TASK_ID", task).env("SLURM_CPUS_PER_TASK", "1");
        command.arg(plan.path().join("slurm/000001/job.sh")).output().expect("it starts").printed();
    };
    run("0");
    plan.call(&["--resume"]).printed();
    let resumed = fs::read_to_string(plan.path().join("slurm/000002/job.sh")).expect("a second script");
    assert!(
        resumed.contains("#SBATCH --qos=low\n") && resumed.contains("#SBATCH --partition=long,short\n"),
        "{resumed}"
    );
    assert_eq!(plan.call(&["--cancel"]).printed(), "cancelled: 4711, 4711\n");
    assert!(plan.called_slurm().0.ends_with("scancel\n--\n4711\n4711\n"));
    run("1");
    let table = plan.file("table.csv");
    plan.call(&["--collect", "--out", table.to_str().expect("UTF-8")]).printed();
    let mut local = sextant();
    let local_table = plan.file("local.csv");
    local.arg("sweep").arg(plan.file("s.toml")).arg("--out").arg(&local_table).output().expect("it starts").printed();
    assert_eq!(fs::read(table).expect("a table"), fs::read(local_table).expect("a table"));
}

#[test]
fn a_plan_that_was_changed_is_refused_by_each_command() {
    let changes: [(&str, Change, &str); 18] = [
        ("one survey for two", |plan| plan["surveys"] = json!([0, 0]), "`surveys[1]` is 0; allowed: one number"),
        ("surveys in another order", |plan| plan["surveys"] = json!([1, 0]), "`surveys` is a list in another order"),
        ("too many surveys", |plan| plan["surveys"] = json!([0, 1, 2]), "`surveys` is 3 items; allowed: 2"),
        ("surveys that are none", |plan| plan["surveys"] = json!([0, -1]), "`surveys` is an array of another kind"),
        ("cells in another order", |plan| plan["sha256"].as_array_mut().expect("cells").reverse(), "`identity` is `"),
        ("another seed", |plan| plan["seed"] = json!(7), "`identity` is `"),
        ("a seed that is none", |plan| plan["seed"] = json!(-1), "`seed` is -1; allowed: a whole number, 0 to"),
        ("no runs", |plan| plan["runs"] = json!(0), "`runs` is 0; allowed: a whole number, 1 to"),
        ("another version", |plan| plan["version"] = json!("9\n9"), r"is of version 9\n9; this is version"),
        (
            "another identity",
            |plan| plan["identity"] = json!("a\u{2028}b"),
            r"`identity` is `a\u{2028}b`; allowed: `",
        ),
        ("a map more", |plan| plan["subjects"]["maps"] = json!(["a"]), "`identity` is `"),
        ("another setting", |plan| plan["set"] = json!(["channel.max_range_m=5"]), "`sha256[0]` is `"),
        (
            "a time below zero",
            |plan| plan["estimate"] = json!({"trial_run": 0, "trial_s": -1.0, "total_s": 1.0}),
            "trial_s` is -1",
        ),
        ("a key more", |plan| plan["x"] = json!(1), "`x` is an unknown key"),
        ("a key less", |plan| drop(plan.as_object_mut().expect("an object").remove("seed")), "`seed` is missing"),
        (
            "another scenario",
            |plan| plan["files"]["scenario"] = json!("../../secret.txt"),
            "`files.scenario` is `../../secret.txt`",
        ),
        (
            "a scenario that is no text",
            |plan| plan["files"]["scenario"] = json!(["a"]),
            "`files.scenario` is an array",
        ),
        (
            "a named file outside",
            |plan| plan["files"]["named"] = json!({"a": "/etc/passwd"}),
            "`files.named` is `/etc/passwd`",
        ),
    ];
    for (what, change, expected) in changes {
        let plan = Plan::new();
        plan.change("plan.json", change);
        for command in COMMANDS {
            let message = refused(&plan.call(command));
            assert!(has(&message, expected), "{what}, {command:?}: {message}");
        }
        assert_eq!(plan.called_slurm().0, "", "{what}: a program was called");
        assert_eq!(fs::read_dir(plan.path().join("parts")).expect("a folder").count(), 0, "{what}");
    }
}

#[test]
fn a_changed_list_of_work_is_refused() {
    let plan = Plan::new();
    let list = plan.path().join("work.jsonl");
    let text = fs::read_to_string(&list).expect("a list");
    let (first, second) = text.split_once('\n').expect("two lines");
    for changed in
        [format!("{second}{first}\n"), format!("{first}\n"), format!("{text}{first}\n"), text.replace("1.1", "1.3")]
    {
        fs::write(&list, changed).expect("there is room");
        assert!(has(&refused(&plan.call(&["--collect"])), "was changed since the plan was made"));
    }
    fs::write(&list, text).expect("there is room");
    plan.call(&["--status"]).printed();
    plan.change("plan.json", |plan| plan["runs"] = json!(2));
    assert!(has(&refused(&plan.call(&["--status"])), "was changed since the plan was made"));
}

/// A change of a plan in a folder: what it makes of it, and how.
type FolderChange = (&'static str, fn(&Path));

#[test]
fn no_file_outside_of_the_folder_is_read() {
    let outside: [FolderChange; 7] = [
        ("a link to another file", |plan| relinked(&plan.join("files/s.toml"), "../../secret.txt")),
        ("a link to a device", |plan| relinked(&plan.join("files/s.toml"), "/dev/zero")),
        ("a pipe", |plan| {
            fs::remove_file(plan.join("files/s.toml")).expect("it is there");
            assert!(Command::new("mkfifo").arg(plan.join("files/s.toml")).status().expect("it starts").success());
        }),
        ("a linked folder", |plan| {
            fs::rename(plan.join("files"), plan.join("../elsewhere")).expect("it is there");
            symlink("../elsewhere", plan.join("files")).expect("there is room");
        }),
        ("a linked plan", |plan| relinked(&plan.join("plan.json"), "../secret.txt")),
        ("a plan without end", |plan| relinked(&plan.join("plan.json"), "/dev/zero")),
        ("linked parts", |plan| {
            fs::remove_dir(plan.join("parts")).expect("it is empty");
            symlink("..", plan.join("parts")).expect("there is room");
        }),
    ];
    for (what, make) in outside {
        let plan = Plan::new();
        make(&plan.path());
        for command in [&["--status"][..], &["--cells", "0..2"], &["--collect"]] {
            let message = refused(&plan.call(command));
            assert!(has(&message, "allowed: regular files in the folder"), "{what}, {command:?}: {message}");
            assert!(!has(&message, "hunter2"), "{what}: {message}");
        }
    }
}

fn relinked(file: &Path, target: &str) {
    fs::remove_file(file).expect("it is there");
    symlink(target, file).expect("there is room");
}

/// A plan that was changed such that all hashes in it are right.
#[test]
fn a_scenario_that_names_files_outside_of_the_plan_is_refused() {
    for (line, written) in [
        ("extends = \"../../secret.txt\"\n", "secret.txt"),
        ("extends = \"base.toml\"\nworld.nodes.csv.file = \"../../secret.txt\"\n", "secret.txt"),
        ("extends = \"base.toml\"\nworld.nodes.csv.file = \"/dev/zero\"\n", "/dev/zero"),
    ] {
        let plan = Plan::new();
        let text = format!("{line}{SWEEP}");
        fs::write(plan.path().join("files/s.toml"), &text).expect("there is room");
        let sha256 =
            Command::new("sha256sum").arg(plan.path().join("files/s.toml")).output().expect("it starts").stdout;
        let sha256 = String::from_utf8_lossy(&sha256)[..64].to_owned();
        plan.change("plan.json", |plan| plan["files"]["sha256"]["s.toml"] = json!(sha256));
        for command in [&["--status"][..], &["--cells", "0..2"]] {
            let message = refused(&plan.call(command));
            assert!(has(&message, written) && !has(&message, "hunter2"), "{line}: {message}");
            assert!(has(&message, "regular files in the folder"), "{line}: {message}");
        }
    }
}

#[test]
fn nothing_in_a_submission_reaches_slurm_unless_it_has_its_form() {
    let changes: [(&str, Change, &str); 17] = [
        (
            "a job",
            |all| all["arrays"][0]["job"] = json!("--user=me"),
            "`arrays[0].job` is `--user=me`; allowed: the number of a job",
        ),
        ("a job with a line", |all| all["arrays"][0]["job"] = json!("1\n2"), r"`arrays[0].job` is `1\n2`"),
        ("a job of tasks", |all| all["arrays"][0]["job"] = json!("1_[0-9]"), "`arrays[0].job` is `1_[0-9]`"),
        ("a number", |all| all["arrays"][0]["job"] = json!(4711), "`arrays[0].job` is 4711"),
        (
            "too many tasks",
            |all| all["arrays"][0]["tasks"] = json!(u64::MAX),
            "`arrays[0].tasks` is 18446744073709551615",
        ),
        (
            "another first task",
            |all| all["arrays"][0]["first"] = json!(u64::MAX),
            "`arrays[0].first` is 18446744073709551615",
        ),
        ("other runs", |all| all["runs"] = json!(9), "`runs` is 9; allowed: 2"),
        ("a time", |all| all["settings"]["time"] = json!("1\nid"), r"`settings.time` is `1\nid`; allowed: minutes"),
        ("a partition", |all| all["settings"]["partition"] = json!("a\rid"), r"`settings.partition` is `a\rid`"),
        ("an account", |all| all["settings"]["account"] = json!("$(id)"), "`settings.account` is `$(id)`"),
        ("memory", |all| all["settings"]["memory"] = json!("1G --wrap=id"), "`settings.memory` is `1G --wrap=id`"),
        ("cores", |all| all["settings"]["cpus"] = json!("1\nid"), r"`settings.cpus` is `1\nid`"),
        ("tasks at once", |all| all["settings"]["max_running"] = json!(0), "`settings.max_running` is 0"),
        ("runs of a task", |all| all["settings"]["chunk"] = json!({"runs": 0}), "`settings.chunk` is an object"),
        (
            "an option with a line",
            |all| all["settings"]["options"] = json!(["--qos=a\nid"]),
            r"`settings.options[0]` is `--qos=a\nid`",
        ),
        ("a word", |all| all["settings"]["options"] = json!(["id"]), "`settings.options[0]` is `id`"),
        ("a key more", |all| all["settings"]["x"] = json!(1), "`settings.x` is an unknown key"),
    ];
    let plan = Plan::new();
    plan.call(&["--submit", "slurm"]).printed();
    let record = plan.path().join("slurm/000001/submission.json");
    let honest = fs::read(&record).expect("a record");
    let before = plan.called_slurm();
    for (what, change, expected) in changes {
        fs::write(&record, &honest).expect("there is room");
        plan.change("slurm/000001/submission.json", change);
        for command in [&["--resume"][..], &["--cancel"], &["--status"], &["--submit", "slurm"]] {
            let message = refused(&plan.call(command));
            assert!(has(&message, expected), "{what}, {command:?}: {message}");
        }
    }
    fs::write(&record, &honest).expect("there is room");
    for (file, text, expected) in [
        (
            "slurm/000001/chunks",
            "0..2\n0..2\n",
            "`line 2` is `0..2`; allowed: A..B with A at least 2 and B at most 2",
        ),
        ("slurm/000001/chunks", "0..18446744073709551615\n", "`line 1` is `0..18446744073709551615`"),
        ("slurm/x; id", "", "000001, 000002 and so on"),
    ] {
        let path = plan.path().join(file);
        let honest = fs::read(&path).ok();
        fs::write(&path, text).expect("there is room");
        let message = refused(&plan.call(&["--resume"]));
        assert!(has(&message, expected), "{file}: {message}");
        match honest {
            Some(honest) => fs::write(&path, honest).expect("there is room"),
            None => fs::remove_file(&path).expect("it is there"),
        }
    }
    assert_eq!(plan.called_slurm(), before, "a program was called");
}

#[test]
fn options_that_run_something_are_taken_from_the_user_alone() {
    for option in [
        "--wrap=id",
        "--export=PATH=/tmp",
        "--prolog=/tmp/x",
        "--chdir=/",
        "--output=/tmp/x",
        "--get-user-env",
        "--mail-user=me",
    ] {
        let plan = Plan::new();
        plan.call(&["--submit", "slurm"]).printed();
        plan.change("slurm/000001/submission.json", |all| all["settings"]["options"] = json!(["--qos=low", option]));
        let message = refused(&plan.call(&["--resume"]));
        assert!(has(&message, &format!("has `{option}`; allowed in a plan")) && has(&message, "--qos"), "{message}");
        assert!(has(&message, "give all options again"), "{message}");
        assert!(!plan.path().join("slurm/000002").exists());
        plan.call(&["--resume", &format!("--option={option}")]).printed();
        assert!(plan.called_slurm().1.ends_with("--quiet\n"));
    }
}

#[test]
fn no_word_of_the_command_line_ends_a_line_of_a_script() {
    let plan = Plan::new();
    for word in [
        "--time=1\nid",
        "--partition=a\nid",
        "--account=a\u{2028}id",
        "--memory=1G\u{b}",
        "--option=--qos=a\nid",
        "--option=id",
        "--option=--qos=a\rid",
        "--time=$(id)",
        "--partition=--wrap=id",
    ] {
        let message = refused(&plan.call(&["--submit", "slurm", word]));
        assert!(has(&message, "allowed: "), "{word:?}: {message}");
    }
    assert_eq!(plan.called_slurm().0, "");
    for name in ["a\nid", "a\rid", "a\u{2028}id", "a\\b"] {
        let plan = Plan::called(name);
        let message = refused(&plan.call(&["--submit", "slurm"]));
        assert!(has(&message, "which a job script cannot have; allowed: "), "{name:?}: {message}");
        assert!(!plan.called_slurm().0.contains("sbatch"), "{name:?}");
        assert_eq!(fs::read_dir(plan.path().join("slurm")).expect("a folder").count(), 0, "{name:?}");
    }
}

#[test]
fn commands_that_are_printed_can_be_copied() {
    let folder = TempDir::new().expect("there is room");
    let printed = |words: &[&str]| call(folder.path(), words).printed();
    let scenario = printed(&["init", "--out=-a $(id).toml"]);
    assert!(scenario.contains("sextant run './-a $(id).toml' --out './-a $(id).mcap'"), "{scenario}");
    let log = printed(&["init", "log", "--out", "it's"]);
    assert!(log.contains(r"sextant map 'it'\''s' --truth 'it'\''s/nodes.csv'"), "{log}");
    fs::copy(crate::program::scenario("smoke.toml"), folder.path().join("s.toml")).expect("there is room");
    let plan = printed(&["sweep", "s.toml", "--runs", "1", "--no-trial", "--plan=--force `id`"]);
    assert!(plan.contains("sextant sweep './--force `id`' --cells 0..1\n"), "{plan}");
}
