//! Where the parts of a log are: which files of a folder, or which files that flags name.

use std::path::{Path, PathBuf};

use super::file_names;
use super::form::{Form, PacketKind, PathKind};
use super::recognition::{are_ranges, names_nodes, path_kind, refuse_foreign};
use super::stop_files::StopFiles;
use crate::bag;
use crate::error::robot_log_error::RobotLogError;
use crate::options::form_options::FormOptions;
use crate::ranges::dwm1001;
use crate::sniffer;

/// The parts of a log.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Layout {
    /// `stops.csv` and `receptions.csv` in a folder.
    Stops(PathBuf),
    /// A table with a row a stop and a column a node, and the folder with what belongs to it.
    Wide { table: PathBuf, folder: Option<PathBuf> },
    /// A folder with a file a stop.
    StopFiles { folder: PathBuf, files: StopFiles, content: StopContent },
    /// A path and packets.
    Drive(Drive),
}

/// What a file of one stop holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum StopContent {
    /// A list of what was heard.
    Receptions,
    /// A table with a column a node.
    Scans,
}

/// A path and packets.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Drive {
    pub(crate) path: PathPart,
    pub(crate) packets: PacketPart,
    /// The folder with what belongs to them.
    pub(crate) folder: Option<PathBuf>,
}

/// What gives the path of a robot.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PathPart {
    pub(crate) kind: PathKind,
    pub(crate) file: PathBuf,
}

/// What gives the packets.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PacketPart {
    pub(crate) kind: PacketKind,
    /// At least one; several are captures.
    pub(crate) files: Vec<PathBuf>,
}

/// What a file or folder holds.
#[derive(Default)]
struct Holding {
    folder: Option<PathBuf>,
    stops: Option<&'static str>,
    tables: Vec<PathBuf>,
    /// A table of ranges.
    ranges: Option<PathBuf>,
    /// The path by odometry.
    odometry: Option<PathBuf>,
    paths: Vec<PathPart>,
    packets: Vec<PacketPart>,
    /// Names of files that are none of these.
    others: Vec<String>,
}

/// What a folder has of a log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FolderLog {
    /// Stops or packets in a table of that name: it is a log for certain.
    Named,
    /// Packets in captures or a bag, which may be there for another reason.
    Packets,
    /// Neither: each table in it could be the log, or have the packets.
    None,
}

impl FolderLog {
    pub(crate) fn of(folder: &Path) -> Self {
        match Holding::of_folder(folder) {
            Ok(Holding { stops: Some(_), .. }) => Self::Named,
            Ok(holding) if holding.packets.iter().any(|part| part.kind == PacketKind::Csv) => Self::Named,
            Ok(holding) if !holding.packets.is_empty() => Self::Packets,
            Ok(_) | Err(_) => Self::None,
        }
    }
}

impl Layout {
    /// The parts of the log `path`, or those that flags name.
    ///
    /// # Errors
    /// If a part is missing, or there are several and no flag chooses.
    pub(crate) fn of(path: &Path, form: &FormOptions) -> Result<Self, RobotLogError> {
        let owned = || path.to_owned();
        if let Some(template) = form.stop_files.as_ref().filter(|_| path.is_dir()) {
            let files = StopFiles::of(path, template)?;
            let content = match files.files.first() {
                Some(file) if names_nodes(&file.path, form) => StopContent::Receptions,
                _ => StopContent::Scans,
            };
            return Ok(Self::StopFiles { folder: owned(), files, content });
        }
        let holding = if path.is_dir() { Holding::of_folder(path)? } else { Holding::of_file(path, form)? };
        let Holding { folder, stops, tables, ranges, odometry, mut paths, packets, others } = holding;
        if paths.is_empty() && stops.is_none() {
            paths.extend(odometry.map(|file| PathPart { kind: PathKind::Csv, file }));
        }
        if let (Some(stops), None) = (stops, &form.packets) {
            let mut others: Vec<String> = packets.iter().map(PacketPart::name).collect();
            let alone = paths.iter().filter(|path| path.kind != PathKind::Bag).map(PathPart::name);
            others.extend(alone);
            if !others.is_empty() {
                return Err(RobotLogError::TwoLogs { path: owned(), others, stops });
            }
            return Ok(Self::Stops(owned()));
        }
        let packets = match (&form.packets, packets.as_slice()) {
            (Some(_), [_]) if folder.is_none() && (paths.is_empty() || form.path.is_some()) => {
                return Err(RobotLogError::Unused { path: owned(), what: "packets", flag: "packets" });
            }
            (Some(file), _) => PacketPart::of(file)?,
            (None, [only]) => only.clone(),
            (None, []) => {
                if let Some(ranges) = ranges {
                    let packets = PacketPart { kind: PacketKind::Ranges, files: vec![ranges] };
                    return Self::drive(path, form, &paths, packets, folder);
                }
                let is_table = form.path.is_none() && paths.is_empty();
                if let ([table], false) = (tables.as_slice(), is_table) {
                    // Beside a path, the only table has the packets.
                    let packets = PacketPart { kind: PacketKind::Csv, files: vec![table.clone()] };
                    return Self::drive(path, form, &paths, packets, folder);
                }
                return match tables.as_slice() {
                    [table] if is_table => Ok(Self::Wide { table: table.clone(), folder }),
                    [] if is_table => Err(RobotLogError::NoLog { path: owned(), found: others }),
                    several if is_table => {
                        let found = several.iter().map(|table| file_name(table)).collect();
                        Err(RobotLogError::SeveralTables { path: owned(), found })
                    }
                    _ => {
                        let found = paths.first().map_or_else(|| "a path".to_owned(), PathPart::name);
                        Err(RobotLogError::NoPacketFile { path: owned(), found })
                    }
                };
            }
            (None, several) => {
                let found = several.iter().map(PacketPart::name).collect();
                return Err(RobotLogError::Several { path: owned(), what: "packets", found, flag: "packets" });
            }
        };
        Self::drive(path, form, &paths, packets, folder)
    }

    /// The packets with the path that a flag names, or the only one of `paths` in the log.
    fn drive(
        log: &Path,
        form: &FormOptions,
        paths: &[PathPart],
        packets: PacketPart,
        folder: Option<PathBuf>,
    ) -> Result<Self, RobotLogError> {
        let owned = || log.to_owned();
        let path = match (&form.path, paths) {
            (Some(_), [_]) if folder.is_none() && form.packets.is_some() => {
                return Err(RobotLogError::Unused { path: owned(), what: "the path", flag: "path" });
            }
            (Some(file), _) => PathPart::of(file)?,
            (None, [only]) => only.clone(),
            (None, []) => {
                if packets.kind == PacketKind::Captures {
                    // Of other frames than those of a network it is no use to ask for the path.
                    packets.files.iter().try_for_each(|capture| sniffer::check_link(capture))?;
                }
                return Err(RobotLogError::NoPath { path: owned() });
            }
            (None, several) => {
                let found = several.iter().map(PathPart::name).collect();
                return Err(RobotLogError::Several { path: owned(), what: "path", found, flag: "path" });
            }
        };
        Ok(Self::Drive(Drive { path, packets, folder }))
    }

    /// The form of the log.
    pub(crate) const fn form(&self) -> Form {
        match self {
            Self::Stops(_) => Form::Stops,
            Self::Wide { .. } => Form::Wide,
            Self::StopFiles { .. } => Form::StopFiles,
            Self::Drive(Drive { path, packets, .. }) => Form::Drive(path.kind, packets.kind),
        }
    }
}

impl Holding {
    /// What the files of a folder are.
    fn of_folder(folder: &Path) -> Result<Self, RobotLogError> {
        let entries = std::fs::read_dir(folder).and_then(|entries| entries.collect::<Result<Vec<_>, _>>());
        let entries = entries.map_err(|why| RobotLogError::read(folder, why))?;
        let mut files: Vec<PathBuf> =
            entries.iter().map(std::fs::DirEntry::path).filter(|path| path.is_file()).collect();
        files.sort();
        let mut holding = Self { folder: Some(folder.to_owned()), ..Self::default() };
        let mut captures = Vec::new();
        for file in files {
            let name = file_name(&file);
            let extension = file.extension().map(|extension| extension.to_string_lossy().to_lowercase());
            match (name.as_str(), extension.as_deref()) {
                (file_names::STOPS, _) => holding.stops = Some(file_names::STOPS),
                (file_names::RECEPTIONS, _) => holding.stops = holding.stops.or(Some(file_names::RECEPTIONS)),
                (file_names::PACKETS, _) => {
                    holding.packets.push(PacketPart { kind: PacketKind::Csv, files: vec![file] })
                }
                (file_names::ODOMETRY, _) => holding.odometry = Some(file),
                (file_names::PATH, _) => holding.paths.push(PathPart { kind: PathKind::Csv, file }),
                (
                    file_names::CONTACTS
                    | file_names::SECTORS
                    | file_names::SECTOR_SNRS
                    | file_names::NODES
                    | file_names::TAGS
                    | file_names::NAMES,
                    _,
                ) => {}
                (_, Some("gpx")) => holding.paths.push(PathPart { kind: PathKind::Gpx, file }),
                (_, Some("nmea")) => holding.paths.push(PathPart { kind: PathKind::Nmea, file }),
                (_, Some("tum")) => holding.paths.push(PathPart { kind: PathKind::Tum, file }),
                (_, Some("csv" | "tsv")) if are_ranges(&file) => holding.ranges = Some(file),
                (_, Some("csv" | "tsv")) => holding.tables.push(file),
                (_, Some("txt" | "log")) if dwm1001::is_output(&file) => holding.ranges = Some(file),
                _ if sniffer::is_capture(&file) => captures.push(file),
                _ => holding.others.push(name),
            }
        }
        if !captures.is_empty() {
            holding.packets.push(PacketPart { kind: PacketKind::Captures, files: captures });
        }
        let is_alone = holding.stops.is_none() && holding.packets.is_empty() && holding.paths.is_empty();
        // A folder with nothing else is opened as a bag, so that the error tells what is wrong with it.
        if bag::holds_bag(folder) || is_alone && holding.tables.is_empty() && bag::is_bag(folder) {
            holding.add_bag(folder);
        }
        Ok(holding)
    }

    /// What a file is. A CSV file has packets if it names nodes or a flag names the path, a path if a flag names the packets,
    /// else it is a wide table.
    ///
    /// # Errors
    /// If it is none of these.
    fn of_file(file: &Path, form: &FormOptions) -> Result<Self, RobotLogError> {
        let mut holding = Self::default();
        if bag::is_bag(file) {
            holding.add_bag(file);
        } else if sniffer::is_capture(file) {
            holding.packets.push(PacketPart { kind: PacketKind::Captures, files: vec![file.to_owned()] });
        } else {
            refuse_foreign(file)?;
            let kind = path_kind(file);
            if kind != PathKind::Csv || form.packets.is_some() && !names_nodes(file, form) {
                holding.paths.push(PathPart { kind, file: file.to_owned() });
            } else if form.path.is_some() || names_nodes(file, form) {
                holding.packets.push(PacketPart { kind: PacketKind::Csv, files: vec![file.to_owned()] });
            } else {
                holding.tables.push(file.to_owned());
            }
        }
        Ok(holding)
    }

    /// A bag has both, as far as it is known without reading it.
    fn add_bag(&mut self, bag: &Path) {
        self.paths.push(PathPart { kind: PathKind::Bag, file: bag.to_owned() });
        self.packets.push(PacketPart { kind: PacketKind::Bag, files: vec![bag.to_owned()] });
    }
}

impl PathPart {
    /// What the file that a flag names is.
    fn of(file: &Path) -> Result<Self, RobotLogError> {
        readable(file)?;
        if bag::is_bag(file) {
            return Ok(Self { kind: PathKind::Bag, file: file.to_owned() });
        }
        refuse_foreign(file)?;
        Ok(Self { kind: path_kind(file), file: file.to_owned() })
    }

    /// For errors.
    pub(crate) fn name(&self) -> String {
        if self.kind == PathKind::Bag {
            format!("the bag `{}`", file_name(&self.file))
        } else {
            file_name(&self.file)
        }
    }
}

impl PacketPart {
    /// What the file that a flag names is.
    fn of(file: &Path) -> Result<Self, RobotLogError> {
        readable(file)?;
        let (kind, files) = if file.is_dir() && !bag::holds_bag(file) {
            let holding = Holding::of_folder(file)?;
            let captures = holding.packets.into_iter().find(|part| part.kind == PacketKind::Captures);
            let captures = captures.ok_or_else(|| RobotLogError::Form {
                problem: format!(
                    "option `packets` is the folder `{}`, which has neither captures nor a bag",
                    file.display()
                ),
            })?;
            (captures.kind, captures.files)
        } else if bag::is_bag(file) {
            (PacketKind::Bag, vec![file.to_owned()])
        } else if sniffer::is_capture(file) {
            (PacketKind::Captures, vec![file.to_owned()])
        } else {
            refuse_foreign(file)?;
            (PacketKind::Csv, vec![file.to_owned()])
        };
        Ok(Self { kind, files })
    }

    /// For errors.
    pub(crate) fn name(&self) -> String {
        match (self.kind, self.files.as_slice()) {
            (PacketKind::Bag, [bag, ..]) => format!("the bag `{}`", file_name(bag)),
            (_, [first, _, ..]) => format!("{} and {} more captures", file_name(first), self.files.len() - 1),
            (_, files) => files.first().map(|file| file_name(file)).unwrap_or_default(),
        }
    }
}

/// The table of ranges in the folder of a log.
pub(crate) fn ranges_of(folder: &Path) -> Option<PathBuf> {
    Holding::of_folder(folder).ok()?.ranges
}

fn readable(file: &Path) -> Result<(), RobotLogError> {
    std::fs::metadata(file).map(drop).map_err(|why| RobotLogError::read(file, why))
}

/// The name of a file without its folder.
fn file_name(file: &Path) -> String {
    file.file_name().map_or_else(|| file.display().to_string(), |name| name.to_string_lossy().into_owned())
}
