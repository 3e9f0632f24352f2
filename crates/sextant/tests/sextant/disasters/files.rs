//! Single files: those written at once, bit by bit, and folders.

use std::fs;
use std::io::Write;
use std::path::Path;

use sextant_recording::output::{PartFile, write_file};

use super::trial::Trial;

const OLD: &[u8] = b"years of work";

fn old_file(folder: &Path) {
    fs::write(folder.join("a.csv"), OLD).expect("it works without a disaster");
}

#[test]
fn a_file_that_is_written_at_once_is_the_old_one_or_the_new_one() {
    let new: Vec<u8> = (0..3000_u32).flat_map(u32::to_le_bytes).collect();
    let work = |folder: &Path| write_file(&folder.join("a.csv"), &new).map_err(|error| error.to_string());
    let of = |prepare: &dyn Fn(&Path), before: Option<&[u8]>| {
        let disasters = Trial { prepare, work: &work }.each(|left| {
            left.check_whole("a.csv", before, &new);
            left.check_tidy();
        });
        assert!(disasters > 30, "{disasters}");
    };
    of(&old_file, Some(OLD));
    of(&|_| {}, None);
}

#[test]
fn a_long_file_is_the_old_one_or_the_new_one() {
    let rows: Vec<u8> = (0..500_u32).flat_map(|row| format!("{row},1.5,a\n").into_bytes()).collect();
    let work = |folder: &Path| {
        let write = || -> Result<(), Box<dyn std::error::Error>> {
            let mut file = PartFile::create(&folder.join("a.csv"))?;
            for _ in 0..4 {
                file.write_all(&rows)?;
            }
            Ok(file.finish()?)
        };
        write().map_err(|error| error.to_string())
    };
    let disasters = Trial { prepare: &old_file, work: &work }.each(|left| {
        left.check_whole("a.csv", Some(OLD), &rows.repeat(4));
        left.check_tidy();
    });
    assert!(disasters > 60, "{disasters}");
}

#[test]
fn an_error_names_the_file_and_the_reason() {
    let work = |folder: &Path| write_file(&folder.join("a.csv"), b"text").map_err(|error| error.to_string());
    Trial { prepare: &|_| {}, work: &work }.each(|left| {
        if let Err(told) = left.told {
            assert!(told.contains("a.csv` cannot be written: "), "{told}");
        }
    });
}
