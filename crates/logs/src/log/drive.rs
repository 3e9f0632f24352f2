//! A path and packets, from any files: `path.csv` and `packets.csv`, a bag, captures, GPX and others.

use super::companions::Companions;
use super::file_names;
use super::form::{PacketKind, PathKind};
use super::layout::{Drive, PacketPart};
use super::recognition;
use crate::bag::{Bag, BagPackets, BagPath};
use crate::csv::table_source::TableSource;
use crate::csv::written::Written;
use crate::error::robot_log_error::RobotLogError;
use crate::options::bag_options::BagClock;
use crate::options::read_options::ReadOptions;
use crate::packets::gatherer::Gatherer;
use crate::packets::packet_table;
use crate::packets::packet_table::Robots;
use crate::packets::reciprocal::Roles;
use crate::path::gpx;
use crate::path::headings;
use crate::path::nmea;
use crate::path::path_file;
use crate::path::paths::Paths;
use crate::path::tum;
use crate::ranges::range_table::Whereabouts;
use crate::robot_log::RobotLog;
use crate::sniffer;

/// Reads the log. Times of all files are in one clock: seconds since 1970, or any other start that is the same in both files.
pub(crate) fn read(drive: &Drive, options: &ReadOptions) -> Result<RobotLog, RobotLogError> {
    let Drive { path, packets, folder } = drive;
    let mut notes = Vec::new();
    let path_bag = (path.kind == PathKind::Bag).then(|| Bag::open(&path.file)).transpose()?;
    let packet_bag = match (packets.kind, packets.files.as_slice()) {
        (PacketKind::Bag, [file, ..]) if path_bag.is_none() || *file != path.file => Some(Bag::open(file)?),
        _ => None,
    };
    for bag in path_bag.iter().chain(&packet_bag) {
        notes.extend(bag.notes.iter().cloned());
    }
    let bag_path = path_bag.as_ref().map(|bag| BagPath::read(bag, options)).transpose()?;
    let heard_in = if packets.kind == PacketKind::Bag { packet_bag.as_ref().or(path_bag.as_ref()) } else { None };
    let bag_ranges = heard_in.map(|bag| BagPackets::of_ranges(bag, options)).transpose()?.flatten();
    // Where ranges are named and packets are not, there may be none.
    let has_packets =
        bag_ranges.is_none() || options.form.packet_fields.is_some() || options.bag.packet_topic.is_some();
    let bag_packets = heard_in.filter(|_| has_packets).map(|bag| BagPackets::choose(bag, options)).transpose()?;
    let has_stamps = bag_path.as_ref().is_none_or(BagPath::has_stamps)
        && bag_packets.iter().chain(&bag_ranges).all(BagPackets::has_stamps);
    let clock = options.bag.bag_clock.unwrap_or(if has_stamps { BagClock::Stamp } else { BagClock::Log });
    tell_bags(drive, bag_path.as_ref(), bag_packets.as_ref().or(bag_ranges.as_ref()), clock, &mut notes);
    if let Some(ranges) = &bag_ranges {
        notes.push(format!("the ranges are those of {}", ranges.described()));
    }

    let skips_no_fix = options.repair.skip_no_fix;
    if path.kind != PathKind::Bag {
        recognition::refuse_foreign(&path.file)?;
    }
    let paths = match &bag_path {
        Some(bag) => Paths::of_one(bag.path(clock, &mut notes)?, bag.plane()),
        None => match path.kind {
            PathKind::Tum => tum::read(&path.file, skips_no_fix, &mut notes)?,
            PathKind::Gpx => gpx::read(&path.file, skips_no_fix, &mut notes)?,
            PathKind::Nmea => nmea::read(&path.file, skips_no_fix, &mut notes)?,
            PathKind::Csv | PathKind::Bag => {
                let written = Written::of_places(&options.form);
                path_file::read(path.file.as_path(), &written, skips_no_fix, &mut notes)?
            }
        },
    };
    if paths.paths.len() > 1 && !matches!(packets.kind, PacketKind::Csv | PacketKind::Ranges) {
        let robots = paths.paths.len();
        let problem = format!("found the paths of {robots} robots; allowed: that of the one that heard the packets");
        return Err(RobotLogError::line(&path.file, 1, problem));
    }
    let companions = match folder {
        Some(folder) => Companions::of_folder(folder, options.form.time_zone),
        None => Companions::none(path.file.as_path().into()),
    };
    let odometry = Some(path.name()).filter(|name| name == file_names::ODOMETRY);
    let table = (path.kind == PathKind::Csv).then(|| TableSource::from(path.file.as_path()));
    let log = gather(paths, table, &companions, options, notes, |known, roles, gatherer, notes| {
        if let Some(ranges) = &bag_ranges {
            ranges.gather_ranges(clock, gatherer)?;
        }
        match (&bag_packets, packets) {
            (Some(bag), _) => {
                let delay = bag.gather(clock, roles, gatherer, notes)?;
                if let (Some(path), BagClock::Stamp) = (&bag_path, clock) {
                    notes.extend(path.least_delay().differs(delay));
                }
                Ok(())
            }
            (None, PacketPart { kind: PacketKind::Captures, files }) => {
                sniffer::read(files, &options.sniffer, roles, gatherer, notes)
            }
            (None, PacketPart { kind: PacketKind::Ranges | PacketKind::Bag, .. }) => Ok(()),
            (None, PacketPart { files, .. }) => {
                let written = Written::of_packets(&options.form);
                let robots = Robots { names: known, path: &path.name() };
                files
                    .iter()
                    .try_for_each(|file| packet_table::read(file.as_path(), &written, robots, roles, gatherer, notes))
            }
        }
    })?;
    Ok(RobotLog { odometry, ..log })
}

/// Reads the log of a path and packets in tables.
pub(crate) fn read_tables(
    path: TableSource<'_>,
    packets: Option<TableSource<'_>>,
    companions: &Companions<'_>,
    options: &ReadOptions,
) -> Result<RobotLog, RobotLogError> {
    let mut notes = Vec::new();
    let name = path.part().name();
    let written = Written::of_places(&options.form);
    let paths = path_file::read(path.clone(), &written, options.repair.skip_no_fix, &mut notes)?;
    gather(paths, Some(path), companions, options, notes, |known, roles, gatherer, notes| {
        let Some(packets) = packets else { return Ok(()) };
        let written = Written::of_packets(&options.form);
        packet_table::read(packets, &written, Robots { names: known, path: &name }, roles, gatherer, notes)
    })
}

/// The log of robots that drove these paths, which may be from a `table`. `hear` gives the gatherer the packets that they heard; it gets the names of the
/// robots with a path, if they have names.
fn gather(
    paths: Paths,
    table: Option<TableSource<'_>>,
    companions: &Companions<'_>,
    options: &ReadOptions,
    mut notes: Vec<String>,
    hear: impl FnOnce(&[String], &mut Roles, &mut Gatherer, &mut Vec<String>) -> Result<(), RobotLogError>,
) -> Result<RobotLog, RobotLogError> {
    let Paths { paths, mut robots, is_named, plane, headings: turned } = paths;
    let with_path = paths.len();
    let part = table.as_ref().map(TableSource::part);
    let contacts = companions.contacts(plane, &mut robots, &mut notes)?;
    let names = robots.into_vec();
    let known = if is_named { &names[..with_path] } else { &[] };
    let mut gatherer = Gatherer::of_robots(paths, names.clone(), options)?.with_contacts(contacts).with_plane(plane);
    let mut roles = Roles::of(&options.form);
    hear(known, &mut roles, &mut gatherer, &mut notes)?;
    roles.tell(&mut notes)?;
    let ranges = {
        let whereabouts = Whereabouts::Paths { paths: &gatherer.paths(), robots: known, delay_s: gatherer.delay_s() };
        companions.ranges(&options.form, whereabouts, table, gatherer.nodes(), &mut notes)?
    };
    if let Some(ranges) = ranges {
        gatherer.take_ranges(ranges);
    }
    if let (Some(column), Some(part), None) = (turned, part, &companions.tags) {
        notes.push(headings::unused_note(&part.name(), column));
    }
    let gathered = gatherer.finish()?;
    companions.refuse_sector_snrs()?;
    let log = companions.with_sectors(gathered.log, &mut notes)?;
    notes.extend(gathered.notes);
    Ok(RobotLog { log, notes, ..gathered })
}

/// Notes what is read from bags.
fn tell_bags(
    Drive { path: path_part, packets: packet_part, .. }: &Drive,
    path: Option<&BagPath<'_>>,
    packets: Option<&BagPackets<'_>>,
    clock: BagClock,
    notes: &mut Vec<String>,
) {
    let times = match clock {
        BagClock::Stamp => "the stamps of the messages",
        BagClock::Log => "when the messages were recorded",
    };
    let read = match (path, packets) {
        (None, None) => return,
        (Some(path), Some(packets)) => {
            format!("the path is that of {}, the packets are those of {}", path.described(), packets.described())
        }
        (Some(path), None) => {
            format!("the path is that of {}, the packets are those of {}", path.described(), packet_part.name())
        }
        (None, Some(packets)) => {
            format!("the path is that of {}, the packets are those of {}", path_part.name(), packets.described())
        }
    };
    let whose = if path.is_some() && packets.is_some() { "the times" } else { "the times of the bag" };
    notes.push(format!("{read}, {whose} are {times}"));
    notes.extend(path.iter().flat_map(|path| path.notes()));
}
