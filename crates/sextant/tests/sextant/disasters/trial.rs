//! Work that is done again and again, each time with another disaster.

use std::fmt;
use std::fs;
use std::path::Path;
use std::sync::Arc;

use sextant_recording::disk::{Luck, SimulatedDisk, Trouble, replace};

/// A survey of a few nodes at a few stops, as text.
pub(crate) const SHORT: &str = r#"
name = "short"
seed = 1
radio = { tx_power_dbm = -50.0, sensitivity_dbm = -90.0 }
traffic.beacon = { mpdu_octets = 20, interval_s = 0.5, jitter = 0.1 }
reception.sinr_threshold.threshold_db = 3.0
mac.csma_unslotted = {}
world.nodes.lattice = { spacing_m = 2.0, count = 6, region.rectangle = { min_m = [0.0, 0.0], max_m = [6.0, 4.0] } }

[channel]
environment = "light-tree"
max_range_m = 6.0
path_loss.log_distance.reference_loss_db = 0.0

[[robots]]
name = "surveyor"
start_m = [-1.0, -1.0]
listen_s = 1.0
controller.s_path = { lane_spacing_m = 4.0, overshoot_m = 1.0, region.rectangle = { min_m = [0.0, 0.0], max_m = [6.0, 4.0] } }

[[maps]]
[maps.algorithm.ml_tm]
grid_step_m = 0.5
profile.trapezoid = { p0 = 0.9, plateau_m = 1.0, range_m = 6.0 }
"#;

/// Work that writes files, and what it is done on.
pub(crate) struct Trial<'a> {
    /// Puts files into the folder that are there before.
    pub(crate) prepare: &'a dyn Fn(&Path),
    /// Writes files in the folder; the error is what the user is told.
    pub(crate) work: &'a (dyn Fn(&Path) -> Result<(), String> + Sync),
}

/// What a disaster left.
pub(crate) struct Left<'a> {
    /// The folder, as a process finds it that starts afterwards.
    pub(crate) folder: &'a Path,
    /// What the user was told.
    pub(crate) told: &'a Result<(), String>,
    /// Which change of the disk it was, from 0.
    pub(crate) at: usize,
    pub(crate) trouble: Trouble,
    /// What the disk kept that it need not have kept, after a loss of power.
    pub(crate) luck: Option<Luck>,
}

impl fmt::Display for Left<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { at, trouble, luck, told, .. } = self;
        write!(f, "{trouble:?} at change {at}, kept {luck:?}, told {told:?}")
    }
}

impl Left<'_> {
    /// Whether a process that went on could clean up.
    pub(crate) fn has_power(&self) -> bool {
        self.trouble != Trouble::PowerLoss
    }

    /// The content of a file; `None` if there is none.
    pub(crate) fn read(&self, name: &str) -> Option<Vec<u8>> {
        fs::read(self.folder.join(name)).ok()
    }

    /// Checks that the file `name` is the one from `before` or the whole `new` one, and that one if it was reported.
    pub(crate) fn check_whole(&self, name: &str, before: Option<&[u8]>, new: &[u8]) {
        let found = self.read(name);
        let found = found.as_deref();
        if self.told.is_ok() {
            assert!(found == Some(new), "{self}: `{name}` was reported");
        }
        assert!(found == Some(new) || found == before, "{self}: `{name}` is neither the old file nor the new one");
    }

    /// Checks that no temporary file remains where the process could remove it.
    pub(crate) fn check_tidy(&self) {
        if !self.has_power() {
            return;
        }
        let names = fs::read_dir(self.folder)
            .expect("it works without a disaster")
            .map(|entry| entry.expect("it works without a disaster").file_name());
        let left: Vec<_> = names.filter(|name| name.to_string_lossy().contains(".part")).collect();
        assert!(left.is_empty(), "{self}: {left:?}");
    }
}

impl Trial<'_> {
    /// Does the work once for each change that it makes and each trouble, and calls `check` with what is left. Returns the number
    /// of disasters.
    pub(crate) fn each(&self, check: impl Fn(&Left<'_>)) -> usize {
        let changes = self.changes();
        assert!(changes > 0, "the work changes nothing");
        let mut disasters = 0;
        for trouble in [Trouble::Error, Trouble::Full, Trouble::Torn, Trouble::Interrupted] {
            for at in 0..changes {
                let folder = tempfile::tempdir().expect("it works without a disaster");
                (self.prepare)(folder.path());
                let (told, _) = self.done(folder.path(), Some((at, trouble)));
                let left = Left { folder: folder.path(), told: &told, at, trouble, luck: None };
                if trouble == Trouble::Interrupted {
                    assert!(told.is_ok(), "{left}");
                }
                check(&left);
                disasters += 1;
            }
        }
        for at in 0..=changes {
            let folder = tempfile::tempdir().expect("it works without a disaster");
            (self.prepare)(folder.path());
            let trouble = Trouble::PowerLoss;
            let (told, disk) = self.done(folder.path(), Some((at, trouble)));
            for luck in [Luck::None, Luck::Names, Luck::Torn, Luck::All] {
                let image = tempfile::tempdir().expect("it works without a disaster");
                disk.after_power_loss(luck, image.path()).expect("it works without a disaster");
                check(&Left { folder: image.path(), told: &told, at, trouble, luck: Some(luck) });
                disasters += 1;
            }
        }
        eprintln!("{disasters} disasters");
        disasters
    }

    /// The number of changes of the disk that the work makes. It is the same each time.
    fn changes(&self) -> usize {
        let folder = tempfile::tempdir().expect("it works without a disaster");
        (self.prepare)(folder.path());
        let (told, disk) = self.done(folder.path(), None);
        assert_eq!(told, Ok(()), "without a disaster");
        disk.changes()
    }

    fn done(&self, folder: &Path, trouble: Option<(usize, Trouble)>) -> (Result<(), String>, Arc<SimulatedDisk>) {
        let disk = Arc::new(SimulatedDisk::new(folder, trouble).expect("it works without a disaster"));
        let replaced = replace(folder, disk.clone());
        // On one thread, so that the changes have an order.
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("it works without a disaster");
        let told = pool.install(|| (self.work)(folder));
        drop(replaced);
        (told, disk)
    }
}

/// The file `name` that `work` writes without a disaster.
pub(crate) fn undisturbed(work: &dyn Fn(&Path) -> Result<(), String>, name: &str) -> Vec<u8> {
    let folder = tempfile::tempdir().expect("it works without a disaster");
    work(folder.path()).expect("it works without a disaster");
    fs::read(folder.path().join(name)).expect("it works without a disaster")
}

/// Checks that the file `name` is whole or not there after each disaster, that the same `work` then goes on to the same file,
/// and `also` what is left then. Returns the file and the number of disasters.
pub(crate) fn goes_on(
    work: &(dyn Fn(&Path) -> Result<(), String> + Sync),
    name: &str,
    also: impl Fn(&Left<'_>),
) -> (Vec<u8>, usize) {
    let whole = undisturbed(work, name);
    let disasters = Trial { prepare: &|_| {}, work }.each(|left| {
        left.check_whole(name, None, &whole);
        work(left.folder).unwrap_or_else(|error| panic!("{left}: {error}"));
        assert!(left.read(name).as_ref() == Some(&whole), "{left}: `{name}` is another one");
        also(left);
    });
    (whole, disasters)
}
