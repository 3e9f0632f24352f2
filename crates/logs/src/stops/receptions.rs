//! `receptions.csv`: what was heard of each node at each stop.

use std::collections::BTreeMap;

use sextant_channel::{ReceptionLogBuilder, SectorReport};
use sextant_kernel::NodeId;

use super::pair_notes::{Listing, PartNames};
use super::pairs::{Collector, Kept, PairCount};
use super::sector_snrs;
use super::stop_table::Stops;
use crate::csv::header::{KnownColumns, Others};
use crate::csv::lookup::Lookup;
use crate::csv::table::{Column, Table, TableRow};
use crate::csv::table_source::TableSource;
use crate::error::robot_log_error::RobotLogError;
use crate::options::field_names::FieldNames;
use crate::options::form_options::FormOptions;
use crate::packets::rssi_check::RssiCheck;
use crate::packets::sending::MOST_SENT;
use crate::packets::signal::{Signal, Strength};
use crate::packets::strengths::{Report, Strengths};

/// Names of the nodes and their receptions.
pub(crate) struct Receptions {
    /// Name of the file or table that has them, for messages.
    pub(crate) name: String,
    pub(crate) names: Vec<String>,
    pub(crate) receptions: ReceptionLogBuilder,
    /// Rows of stops that were left out.
    pub(crate) left_out: usize,
    /// The signal-to-noise ratios of all sectors, if the file has a column for them.
    pub(crate) reports: Option<Vec<SectorReport>>,
}

impl Receptions {
    /// Those of a log without a table of them.
    pub(crate) fn none() -> Self {
        Self {
            name: String::new(),
            names: Vec::new(),
            receptions: ReceptionLogBuilder::default(),
            left_out: 0,
            reports: None,
        }
    }
}

/// What the rows of the file have besides what is passed on of each.
pub(crate) struct OfRows {
    /// Name of the file or table that has them, for messages.
    pub(crate) name: String,
    /// Names of the nodes.
    pub(crate) names: Vec<String>,
    /// Rows of stops that were left out.
    pub(crate) left_out: usize,
}

/// The columns of the file.
#[derive(Clone, Copy)]
struct Columns {
    node: Column,
    stop: Column,
    received: Column,
    sent: Column,
    sector: Column,
    rssi: Column,
    snr: Column,
    sector_snrs: Column,
}

/// What is kept of the signals of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SignalKind {
    /// All that can be measured.
    Whole,
    /// Strengths.
    Strength,
    /// Nothing.
    None,
}

/// Reads the receptions at `stops` in a table, as `form` says. Nodes are numbered in the order of their first rows.
/// Their strengths go through `rssi`.
pub(crate) fn read(
    source: TableSource<'_>,
    stops: &Stops,
    form: &FormOptions,
    rssi: &mut RssiCheck,
    notes: &mut Vec<String>,
) -> Result<Receptions, RobotLogError> {
    let mut strengths = Strengths::of(form);
    let (rows, kind) = open(source, stops, form, rssi, &mut strengths, notes)?;
    let read = match kind {
        SignalKind::Whole => rows.read::<Signal>(notes),
        SignalKind::Strength => rows.read::<Strength>(notes),
        SignalKind::None => rows.read::<()>(notes),
    }?;
    strengths.finish(notes)?;
    Ok(read)
}

/// Opens a table for its rows.
pub(crate) fn open<'a>(
    source: TableSource<'a>,
    stops: &'a Stops,
    form: &FormOptions,
    rssi: &'a mut RssiCheck,
    strengths: &'a mut Strengths,
    notes: &mut Vec<String>,
) -> Result<(Rows<'a>, SignalKind), RobotLogError> {
    let names = FieldNames::of_packets(form.packet_fields.as_ref());
    let measured = ["received", "sent", "sector", "rssi_dbm", "snr_db", sector_snrs::COLUMN];
    let (required, optional) = if form.reciprocal {
        (&["stop"][..], [&["node", "receiver"], &measured[..]].concat())
    } else {
        (&["node", "stop"][..], measured.to_vec())
    };
    let table = Table::open_known(
        source,
        KnownColumns { required, optional: &optional, names: &names, others: Others::Ignored },
    )?;
    // The link quality of IEEE 802.15.4, which exported recordings have: it is a function of the strength.
    notes.extend(table.notes_besides(&["lqi"]));
    let [received, sent] = ["received", "sent"].map(|name| table.column(name));
    let (node, stop) = ends(&table, &stops.name, form.reciprocal)?;
    let [sector, level, snr] = ["sector", "rssi_dbm", "snr_db"].map(|name| table.column(name));
    let sector_snrs = table.column(sector_snrs::COLUMN);
    let columns = Columns { node, stop, received, sent, sector, rssi: level, snr, sector_snrs };
    if !received.exists() && (sent.exists() || !level.exists()) {
        return Err(table.wrong_header(format!(
            "column `received` is missing; {} the columns: node,stop,received (or node,stop,rssi_dbm, if each row is a packet)",
            table.must_have()
        )));
    }
    let listing = match (received.exists(), sent.exists()) {
        (_, false) if form.noise_floor.is_some() => Listing::Reports,
        (false, _) => Listing::Packets,
        (true, false) => Listing::Received,
        (true, true) => Listing::ReceivedOfSent,
    };
    let kind = if sector.exists() || snr.exists() {
        SignalKind::Whole
    } else if level.exists() {
        SignalKind::Strength
    } else {
        SignalKind::None
    };
    Ok((Rows { table, columns, listing, stops, rssi, strengths }, kind))
}

/// The columns of the node and of the stop. If roles are turned, the node is the receiver: without a column of its own, it is
/// in that of the stop, because there it stood, and the stop of the transmitter is in that of the node.
fn ends(table: &Table<'_>, stops: &str, is_turned: bool) -> Result<(Column, Column), RobotLogError> {
    let [node, stop, receiver] = ["node", "stop", "receiver"].map(|name| table.column(name));
    if !is_turned {
        return Ok((node, stop));
    }
    match (receiver.exists(), node.exists()) {
        (true, _) => Ok((receiver, stop)),
        (false, true) => Ok((stop, node)),
        (false, false) => Err(table.wrong_header(format!(
            "column `receiver` is missing; with option `reciprocal` {} the columns receiver,stop (where the \
             transmitter was) or node,stop (the place of the transmitter as {stops} names it, and the receiver)",
            table.must_have()
        ))),
    }
}

/// The rows of the file, and what is needed to read them.
pub(crate) struct Rows<'a> {
    table: Table<'a>,
    columns: Columns,
    pub(crate) listing: Listing,
    stops: &'a Stops,
    rssi: &'a mut RssiCheck,
    strengths: &'a mut Strengths,
}

/// A row: what was received of a node at a stop.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ReadRow {
    pub(crate) node: u32,
    pub(crate) stop: u32,
    pub(crate) count: PairCount,
    pub(crate) sector: Option<u8>,
    pub(crate) rssi_dbm: Option<f64>,
    pub(crate) snr_db: Option<f64>,
}

impl ReadRow {
    /// What was measured of its packets.
    pub(crate) fn signal(&self) -> Signal {
        Signal::new(self.count.received, self.sector, self.rssi_dbm, self.snr_db)
    }
}

impl Rows<'_> {
    /// Whether the rows have the signal-to-noise ratios of all sectors.
    pub(crate) fn have_sector_snrs(&self) -> bool {
        self.columns.sector_snrs.exists()
    }

    /// Reads the rows. What is not known of any reception takes no memory.
    fn read<S: Kept>(self, notes: &mut Vec<String>) -> Result<Receptions, RobotLogError> {
        let (listing, stops) = (self.listing, self.stops);
        let has_reports = self.have_sector_snrs();
        let mut pairs = Collector::<S>::new(listing);
        let mut reports = Vec::new();
        let OfRows { name, names, left_out } = self.each(|row, of_sectors| {
            pairs.push(row.node, row.stop, row.count, row.signal());
            let (node, stop) = (NodeId(row.node), row.stop);
            reports.extend(of_sectors.into_iter().map(|(sector, snr_db)| SectorReport {
                node,
                stop,
                sector,
                snr_db,
            }));
            Ok(())
        })?;
        let parts = PartNames { stops: &stops.name, receptions: &name };
        let receptions = pairs.finish(names.len(), &stops.sent, parts, notes);
        Ok(Receptions { name, names, receptions, left_out, reports: has_reports.then_some(reports) })
    }

    /// Calls `take` with each row, and with the signal-to-noise ratios of all sectors (dB) that it has.
    pub(crate) fn each(
        self,
        mut take: impl FnMut(&ReadRow, Vec<(u8, f64)>) -> Result<(), RobotLogError>,
    ) -> Result<OfRows, RobotLogError> {
        let Self { table, columns, listing: _, stops, rssi, strengths } = self;
        let mut names: Vec<String> = Vec::new();
        let mut nodes: BTreeMap<String, u32> = BTreeMap::new();
        let mut last: Option<u32> = None;
        let mut left_out = 0;
        let (mut of_nodes, mut of_stops) = (Lookup::new(), Lookup::new());
        let head = table.rows(|row| {
            let node = of_nodes.of(row.token(columns.node), || {
                let name = row.node(columns.node)?;
                // The rows of a node often follow each other.
                let last = last.filter(|&last| names[last as usize] == name);
                Ok(last.or_else(|| nodes.get(&*name).copied()).unwrap_or_else(|| {
                    let node = u32::try_from(names.len()).expect("fewer than 2^32 nodes");
                    names.push(name.clone().into_owned());
                    nodes.insert(name.into_owned(), node);
                    node
                }))
            })?;
            last = Some(node);
            let stop = of_stops.of(row.token(columns.stop), || {
                let id = row.filled(columns.stop).unwrap_or_default();
                if stops.left_out.contains(&*id) {
                    return Ok(None);
                }
                let stop = stops.ids.get(&*id).ok_or_else(|| row.wrong(columns.stop, known_stops(stops)))?;
                Ok(Some(*stop))
            })?;
            let Some(stop) = stop else {
                left_out += 1;
                return Ok(());
            };
            let count = count(row, columns, stop, stops)?;
            let snr_db = row.finite(columns.snr)?;
            let sector = row.sector(columns.sector)?;
            let of_sectors = sector_snrs::of_cell(row, columns.sector_snrs)?;
            if count.received == 0 && !of_sectors.is_empty() {
                return Err(row.wrong(columns.sector_snrs, "an empty cell, because no packet was received"));
            }
            let report = match rssi.take(row.finite(columns.rssi)?) {
                // Nothing was received, whatever the level is.
                rssi_dbm @ Some(_) if count.received == 0 => Report::Heard(rssi_dbm),
                rssi_dbm => strengths.take(rssi_dbm, snr_db),
            };
            match report {
                Report::Heard(rssi_dbm) => take(&ReadRow { node, stop, count, sector, rssi_dbm, snr_db }, of_sectors),
                // Noise says nothing of any sector.
                Report::Noise => {
                    let count = PairCount { received: 0, sent: count.sent.or(Some(count.received)) };
                    take(&ReadRow { node, stop, count, sector: None, rssi_dbm: None, snr_db: None }, Vec::new())
                }
            }
        })?;
        Ok(OfRows { name: head.name(), names, left_out })
    }
}

/// The packets of a row. The table of stops may say how many a node sent there.
fn count(row: &TableRow<'_>, columns: Columns, stop: u32, stops: &Stops) -> Result<PairCount, RobotLogError> {
    if !columns.received.exists() {
        // A row is a packet; without a level, it names a node of which nothing was heard.
        let received = u32::from(row.filled(columns.rssi).is_some());
        return Ok(PairCount { received, sent: None });
    }
    let received = row.whole(columns.received, MOST_SENT)?;
    let received = received.ok_or_else(|| row.wrong(columns.received, "a whole number, 0 or above"))?;
    let sent = row.whole(columns.sent, MOST_SENT)?;
    let at_stop = stops.sent[stop as usize];
    let most = sent.or(at_stop).unwrap_or(MOST_SENT);
    if received > most {
        let is_of_stop = sent.is_none() && at_stop.is_some();
        let whose = if is_of_stop { format!(" at this stop as {} has it", stops.name) } else { String::new() };
        return Err(row.wrong(columns.received, format!("at most {most}, the packets sent{whose}")));
    }
    Ok(PairCount { received, sent })
}

fn known_stops(Stops { ids, name, .. }: &Stops) -> String {
    let mut by_index: Vec<(&u32, &String)> = ids.iter().map(|(id, index)| (index, id)).collect();
    by_index.sort_unstable();
    match by_index.as_slice() {
        [(_, first), .., (_, last)] => {
            format!("one of the {} stops in {name}, from `{first}` to `{last}`", ids.len())
        }
        _ => {
            format!("the only stop in {name}: {}", by_index.iter().map(|(_, id)| id.as_str()).collect::<String>())
        }
    }
}
