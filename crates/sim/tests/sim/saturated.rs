//! Saturated nodes against a program of its own for unslotted CSMA-CA in continuous time.
//!
//! The program knows no event queue, no radio and no state machine: it keeps the next instant of each node as a number
//! of seconds, and the frames on air as a list of intervals. Nodes start at random instants, so no two instants are
//! ever equal.

use std::time::Duration;

use sextant_channel::{ChannelConfig, Position};
use sextant_kernel::{Purpose, Seed};
use sextant_sim::{Packets, RadioConfig, SaturatedConfig, Setup, Simulation, Sink, TrafficConfig, Unobserved};

use crate::network;

const MPDU_OCTETS: u8 = 127;
/// Time on air (s).
const FRAME_S: f64 = 4256e-6;
const BACKOFF_S: f64 = 320e-6;
const CCA_S: f64 = 128e-6;
const TURNAROUND_S: f64 = 192e-6;
/// Long interframe spacing (s).
const SPACING_S: f64 = 640e-6;

/// What a node does at its next instant.
#[derive(Clone, Copy)]
enum Step {
    /// A CCA ends, after so many busy ones for this frame.
    CcaEnds { busy: u32 },
    /// The first bit of a frame goes out.
    FrameStarts,
}

/// Frames that are received by somebody who hears all nodes, per second.
fn received_per_s(nodes: usize, duration_s: f64, seed: u64) -> f64 {
    let mut drawn = 0;
    let mut draw = || {
        drawn += 1;
        Seed(seed).uniform(Purpose::new(8), [drawn, 0, 0])
    };
    let mut backoff_s = |busy: u32| {
        let periods = f64::from(1_u32 << (3 + busy).min(5));
        BACKOFF_S * (periods * draw()).floor() + CCA_S
    };
    let phase_s = |node: u64| 0.01 * Seed(seed).uniform(Purpose::new(8), [node, 1, 0]);
    let mut next: Vec<(f64, Step)> =
        (0..nodes as u64).map(|node| (phase_s(node) + backoff_s(0), Step::CcaEnds { busy: 0 })).collect();
    // Start, end and whether another frame overlaps, of the frames that are not over for long.
    let mut frames: Vec<(f64, f64, bool)> = Vec::new();
    let mut received = 0_u32;
    loop {
        let node = (0..nodes).min_by(|&a, &b| next[a].0.total_cmp(&next[b].0)).expect("there are nodes");
        let (now, step) = next[node];
        if now >= duration_s {
            return f64::from(received) / duration_s;
        }
        frames.retain(|&(_, end, is_hit)| {
            let is_over = end < now - CCA_S;
            received += u32::from(is_over && !is_hit);
            !is_over
        });
        next[node] = match step {
            Step::CcaEnds { busy } if frames.iter().all(|&(start, end, _)| start >= now || end <= now - CCA_S) => {
                debug_assert!(busy < 5);
                (now + TURNAROUND_S, Step::FrameStarts)
            }
            // Five busy CCAs: the frame is given up, and the next one begins at once.
            Step::CcaEnds { busy } => {
                let busy = if busy == 4 { 0 } else { busy + 1 };
                (now + backoff_s(busy), Step::CcaEnds { busy })
            }
            Step::FrameStarts => {
                let mut is_hit = false;
                for (_, end, other_is_hit) in &mut frames {
                    if *end > now {
                        (*other_is_hit, is_hit) = (true, true);
                    }
                }
                frames.push((now, now + FRAME_S, is_hit));
                let ready = now + FRAME_S + SPACING_S;
                (ready + backoff_s(0), Step::CcaEnds { busy: 0 })
            }
        };
    }
}

fn star(nodes: usize, duration_s: u64, start_spread_s: f64, clock_ppm: f64, seed: u64) -> Setup {
    let config = SaturatedConfig { mpdu_octets: MPDU_OCTETS, acknowledged: false, to: None, start_spread_s };
    let traffic = TrafficConfig::Saturated(config);
    let mut setup = network::setup(&network::cluster(nodes), 0.0, ChannelConfig::default(), traffic, seed);
    setup.sinks = vec![Sink { name: "sink".into(), position: Position::new(0.0, 0.0, 0.0), networks: None }];
    setup.duration = Some(Duration::from_secs(duration_s));
    let radio = network::radios(RadioConfig { clock_ppm, ..network::radio(0.0) });
    network::ieee802154(&mut setup.networks[0]).radio = radio;
    setup
}

fn packets(setup: Setup) -> Packets {
    Simulation::new(setup).expect("good settings").run(&mut Unobserved).packets
}

#[test]
fn saturated_nodes_bring_what_a_program_in_continuous_time_finds() {
    for nodes in [5, 20, 50] {
        // Both rates are those of about so many frames that end nearly independently of each other; a frame is received
        // with a probability of at least a tenth, so the deviation of a rate is at most three times that of a Poisson
        // process, and mostly below it. Four deviations of the difference: a false alarm in 16 000 runs.
        let (duration_s, runs) = (20, 3);
        let exact: f64 = (0..8).map(|seed| received_per_s(nodes, 40.0, seed)).sum::<f64>() / 8.0;
        for clock_ppm in [0.0, 40.0] {
            let received: u64 =
                (0..runs).map(|seed| packets(star(nodes, duration_s, 0.01, clock_ppm, seed)).received).sum();
            let simulated_s = (duration_s * runs) as f64;
            let found = received as f64 / simulated_s;
            let deviation = (exact / simulated_s + exact / 320.0).sqrt();
            assert!((found - exact).abs() < 4.0 * deviation, "{nodes}: {found}, not {exact}, at {clock_ppm} ppm");
        }
    }
}

#[test]
fn nodes_that_start_at_once_collide_more_often_until_their_clocks_drift_apart() {
    let received = |spread_s, clock_ppm| packets(star(50, 20, spread_s, clock_ppm, 1)).received as f64;
    let (spread, at_once, drifting) = (received(0.01, 0.0), received(0.0, 0.0), received(0.0, 40.0));
    // 19.7 instead of 16.2 kbit/s in the long run; the counts are about 420 and 350.
    assert!(at_once < 0.92 * spread, "{at_once} and {spread}");
    assert!(drifting > 1.08 * at_once, "{drifting} and {at_once}");
}
