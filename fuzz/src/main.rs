//! Replays inputs: `sextant-fuzz TARGET FILE..`. Built by `fuzz/run.sh`, it looks for new ones: the environment variable
//! `SEXTANT_FUZZ_TARGET` names the target, and the arguments are those of libFuzzer.

#![cfg_attr(fuzzing, no_main)]

#[cfg(fuzzing)]
mod engine;

#[cfg(not(fuzzing))]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args_os().skip(1);
    let name = arguments.next().unwrap_or_default();
    let name = name.to_string_lossy();
    let target = sextant_fuzz::target(&name).ok_or_else(|| {
        let known: Vec<_> = sextant_fuzz::TARGETS.iter().map(|target| target.name).collect();
        format!("`{name}` is not a target; allowed: {}", known.join(", "))
    })?;
    for file in arguments {
        target.run(&std::fs::read(&file)?);
        eprintln!("{}: all properties hold", file.display());
    }
    Ok(())
}
