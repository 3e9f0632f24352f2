#![allow(missing_docs, reason = "probe")]
#[path = "/work/main/crates/channel/tests/channel/solids.rs"]
mod solids;
use sextant_channel::*;
use sextant_kernel::*;
use solids::*;
fn cpu() -> f64 {
    let s = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap();
    s.split(' ').next().unwrap().parse::<f64>().unwrap()
}
fn bench(name: &str, n: u64, mut f: impl FnMut(u64) -> f64) {
    let mut best = f64::MAX;
    for _ in 0..7 {
        let t = cpu();
        let mut s = 0.0;
        for i in 0..n { s += f(i); }
        std::hint::black_box(s);
        best = best.min((cpu() - t) / n as f64);
    }
    println!("{name}: {best:.1} ns");
}
#[test]
fn probe() {
    let seed = Seed(1);
    let u = |i, a, lo: f64, hi: f64| lo + (hi - lo) * seed.uniform(Purpose::Layout, [i, a, 0]);
    let mk = |c| Channel::new(ChannelConfig { shadowing: Some(ShadowingConfig { sigma_db: None, correlation: c }), ..Default::default() }, ObstacleField::default(), seed).unwrap();
    let pp = mk(CorrelationConfig::PerPacket);
    let pl = mk(CorrelationConfig::PerLink);
    let sp = mk(CorrelationConfig::Spatial(SpatialConfig { distance_m: 5.0 }));
    let (p, q) = (at(1.0, 2.0, 0.0), at(20.0, 3.0, 0.0));
    bench("per packet", 200_000, |i| pp.shadowing(NodeId(1), p, NodeId(7), q, i).0);
    bench("per link", 200_000, |i| pl.shadowing(NodeId(i as u32), p, NodeId(7), q, i).0);
    bench("spatial", 20_000, |i| sp.shadowing(NodeId(i as u32), p + at(i as f64 * 0.01, 0., 0.), NodeId(7), q, i).0);
    bench("mean free", 200_000, |i| pp.mean_power(Dbm(0.0), p + at(i as f64 * 0.01, 0., 0.), q).unwrap().0);
    for count in [100_u64, 1000, 10000] {
        let side = 5.0 * (count as f64).sqrt();
        let field = ObstacleField::new((0..count).map(|i| {
            let (x, y) = (u(i, 0, 0.0, side), u(i, 1, 0.0, side));
            let s = [u(i, 2, 0.5, 3.0), u(i, 3, 0.5, 3.0), u(i, 4, 1.0, 3.0)];
            obstacle(match i % 3 {
                0 => upright_box(at(x, y, 0.5 * s[2]), s, u(i, 5, 0.0, 180.0)),
                1 => cylinder(at(x, y, 0.0), 0.5 * s[0], s[2]),
                _ => prism(&[[x, y], [x + s[0], y], [x + s[0], y + s[1]], [x, y + 0.5 * s[1]]], 0.0, s[2]),
            }, 4.6)
        }).collect());
        let lines: Vec<_> = (0..2000).map(|i| {
            let m = at(u(i, 10, 0.0, side), u(i, 11, 0.0, side), 1.0);
            let a = u(i, 12, 0.0, 6.283);
            let h = at(a.cos(), a.sin(), 0.0) * 30.0;
            (m - h, m + h)
        }).collect();
        let mut v = vec![];
        let mut total = 0;
        for l in &lines { field.crossings(l.0, l.1, &mut v); total += v.len(); }
        println!("{count}: mean crossings {}", total as f64 / 2000.0);
        bench("  loss", 2000, |i| { let (a, b) = lines[i as usize]; field.loss(a, b).0 });
        bench("  loss 8 m", 2000, |i| { let (a, b) = lines[i as usize]; field.loss(a, a + (b - a) * 0.133).0 });
        bench("  clearance 10 m", 2000, |i| { let (a, b) = lines[i as usize]; field.clearance_m(a, b - a, 10.0, 0.2) });
        bench("  clearance 1 m", 2000, |i| { let (a, b) = lines[i as usize]; field.clearance_m(a, b - a, 1.0, 0.2) });
    }
}
