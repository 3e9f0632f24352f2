//! The log of a robot from tables in memory, and the same from CSV files: 1000 nodes and 1000 stops, all pairs listed with
//! the packets received and sent, and the strengths of those that were heard. One thread.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use sextant_kernel::{Purpose, Seed};
use sextant_logs::{MemoryColumn, MemoryLog, MemoryTable, ReadOptions};

const COUNT: u32 = 1000;
const PACKETS: i64 = 10;
const SEED: Seed = Seed(5);
const WORLD: Purpose = Purpose::new(9002);

/// In which order the rows of the receptions are.
#[derive(Clone, Copy)]
enum Order {
    Nodes,
    Stops,
    Random,
}

/// The node and the stop of each row.
fn rows(order: Order) -> Vec<(u32, u32)> {
    let mut rows: Vec<(u32, u32)> = (0..COUNT).flat_map(|node| (0..COUNT).map(move |stop| (node, stop))).collect();
    match order {
        Order::Nodes => {}
        Order::Stops => rows.sort_by_key(|&(node, stop)| (stop, node)),
        Order::Random => {
            let draw = |node: u32, stop: u32| SEED.uniform(WORLD, [7, node.into(), stop.into()]).to_bits();
            rows.sort_by_cached_key(|&(node, stop)| draw(node, stop));
        }
    }
    rows
}

fn place(kind: u64, number: u32) -> [f64; 2] {
    [0, 1].map(|axis| 100.0 * SEED.uniform(WORLD, [kind, number.into(), axis]))
}

fn table(name: &str, columns: Vec<(&str, MemoryColumn<'static>)>) -> MemoryTable<'static> {
    let columns = columns.into_iter().map(|(name, column)| (name.to_owned(), column)).collect();
    MemoryTable::new(name, columns).expect("columns of one length")
}

fn log(order: Order) -> MemoryLog<'static> {
    let stops: Vec<[f64; 2]> = (0..COUNT).map(|stop| place(1, stop)).collect();
    let nodes: Vec<[f64; 2]> = (0..COUNT).map(|node| place(0, node)).collect();
    let along = |axis: usize| MemoryColumn::floats(stops.iter().map(|place| place[axis]).collect::<Vec<_>>());
    let seconds = (0..COUNT).map(|stop| 10.0 * f64::from(stop)).collect::<Vec<_>>();
    let places = vec![
        ("stop", MemoryColumn::whole((0..i64::from(COUNT)).collect::<Vec<_>>())),
        ("t_s", MemoryColumn::floats(seconds)),
        ("x_m", along(0)),
        ("y_m", along(1)),
    ];
    let rows = rows(order);
    let strengths: Vec<f64> = rows
        .iter()
        .map(|&(node, stop)| {
            let [[a, b], [c, d]] = [nodes[node as usize], stops[stop as usize]];
            let noise_db = 4.0 * SEED.normal(WORLD, [2, node.into(), stop.into()]);
            let strength_dbm = noise_db - 40.0 - 15.0 * libm::log10((a - c).powi(2) + (b - d).powi(2) + 1.0);
            if strength_dbm > -90.0 { strength_dbm.round() } else { f64::NAN }
        })
        .collect();
    #[expect(clippy::cast_possible_truncation, reason = "at most ten packets")]
    let received = |&level: &f64| if level.is_nan() { 0 } else { ((level + 95.0) as i64).clamp(1, PACKETS) };
    let heard = vec![
        (
            "node",
            MemoryColumn::Names {
                codes: rows.iter().map(|row| row.0).collect::<Vec<_>>().into(),
                names: (0..COUNT).map(|node| format!("00:16:3e:00:{:02x}:{:02x}", node / 256, node % 256)).collect(),
            },
        ),
        ("stop", MemoryColumn::whole(rows.iter().map(|row| i64::from(row.1)).collect::<Vec<_>>())),
        ("received", MemoryColumn::whole(strengths.iter().map(received).collect::<Vec<_>>())),
        ("sent", MemoryColumn::whole(vec![PACKETS; rows.len()])),
        ("rssi_dbm", MemoryColumn::floats(strengths)),
    ];
    MemoryLog::new(table("stops", places), table("receptions", heard))
}

fn robot_tables(criterion: &mut Criterion) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool of one thread");
    let options = ReadOptions::default();
    let mut group = criterion.benchmark_group("robot_tables");
    group.sample_size(10);
    for (name, order) in [("by_node", Order::Nodes), ("by_stop", Order::Stops), ("in_any_order", Order::Random)] {
        let log = log(order);
        group.bench_function(format!("memory/{name}"), |bencher| {
            bencher.iter(|| pool.install(|| black_box(sextant_logs::read_tables(&log, &options)).is_ok()));
        });
    }
    let folder = std::env::temp_dir().join(format!("sextant-robot-tables-{}", std::process::id()));
    let log = sextant_logs::read_tables(&log(Order::Nodes), &options).expect("a valid log").log;
    sextant_logs::write(&folder, &log).expect("room for a log");
    group.bench_function("files/by_node", |bencher| {
        bencher.iter(|| pool.install(|| black_box(sextant_logs::read(&folder, &options)).is_ok()));
    });
    group.finish();
    std::fs::remove_dir_all(&folder).expect("a folder of this benchmark");
}

criterion_group!(benches, robot_tables);
criterion_main!(benches);
