//! Closed forms of what a stop tells.

use super::*;

fn at(x_m: f64, y_m: f64) -> Position {
    Position::new(x_m, y_m, 0.0)
}

/// One node at the origin with these variances along x and y (m²).
fn outlook(law: StopLaw, variances: [f64; 2]) -> Outlook {
    let [x, y] = variances;
    let node = NodeOutlook::new(NodeId(0), Position::ORIGIN, [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0; 3]]);
    Outlook { law, nodes: vec![node], unheard: None, stops: Vec::new() }
}

fn is_near(found: f64, expected: f64, share: f64) {
    assert!((found / expected - 1.0).abs() < share, "{found} instead of {expected}");
}

#[test]
fn a_strength_from_afar_is_a_linear_measurement() {
    // Over 50 m, 20 dB a factor of e are 0.4 dB a metre, and the noise is as large: precisions add.
    let law = || StopLaw::of_curve(100.0, Some([20.0, 0.4]), |_| 1.0);
    let mut outlook = outlook(law(), [1.0, 0.25]);
    is_near(outlook.mean_error_m(), 1.25_f64.sqrt(), 1e-12);
    let gain = outlook.gain(at(50.0, 0.0));
    is_near(gain.fall_m, 1.25_f64.sqrt() - (0.5_f64 + 0.25).sqrt(), 0.04);
    is_near(gain.in_reach_m, 1.25_f64.sqrt(), 1e-12);
    assert_eq!(gain.nodes, [NodeId(0)]);
    outlook.take(at(50.0, 0.0));
    is_near(outlook.mean_error_m(), (1.0_f64 / 2.0 + 0.25).sqrt(), 0.02);
    outlook.take(at(-50.0, 0.0));
    is_near(outlook.mean_error_m(), (1.0_f64 / 3.0 + 0.25).sqrt(), 0.02);
    outlook.take(at(0.0, 50.0));
    is_near(outlook.mean_error_m(), (1.0_f64 / 3.0 + 1.0 / (4.0 + 1.0)).sqrt(), 0.02);
}

#[test]
fn a_packet_at_the_end_of_the_range_halves_the_places() {
    // A disc of radius 100 m whose border goes through the mean: half of a Gaussian has the variance 1 − 2 / π.
    let law = StopLaw::of_curve(200.0, None, |distance_m| if distance_m < 100.0 { 1.0 } else { 0.0 });
    let outlook = outlook(law, [25.0, 25.0]);
    let gain = outlook.gain(at(100.0, 0.0));
    let share = 2.0 / std::f64::consts::PI;
    // Eight points along an axis have a mean distance from their middle that is 4 % too large.
    is_near(gain.fall_m, 50.0_f64.sqrt() - (25.0 + 25.0 * (1.0 - share)).sqrt(), 0.1);
    // Near the node it is heard wherever it is, and out of reach nowhere.
    assert!(outlook.gain(at(10.0, 0.0)).fall_m.abs() < 1e-9);
    assert_eq!(outlook.gain(at(500.0, 0.0)), StopGain::default());
}

#[test]
fn more_packets_tell_more_and_none_tell_nothing_new_where_a_stop_was() {
    let curve = |distance_m: f64| libm::exp(-distance_m / 10.0);
    let fall = |packets| {
        let mut law = StopLaw::of_curve(60.0, None, curve);
        law.packets = packets;
        outlook(law, [16.0, 16.0]).gain(at(12.0, 0.0)).fall_m
    };
    assert!(fall(1) > 0.0 && fall(4) > 1.5 * fall(1) && fall(4) < 4.0 * fall(1), "{} {}", fall(1), fall(4));
    let law = StopLaw::of_curve(60.0, None, curve);
    let gain = outlook(law.clone(), [16.0, 16.0]).gain(at(12.0, 0.0)).fall_m;
    let mut same = outlook(law, [16.0, 16.0]);
    same.law = same.law.correlated(5.0);
    same.stops.push(at(12.0, 0.0));
    assert!(same.gain(at(12.0, 0.0)).fall_m.abs() < 1e-12);
    same.stops[0] = at(7.0, 0.0);
    let new = same.gain(at(12.0, 0.0)).fall_m;
    assert!(new > 0.5 * gain && new < gain, "{new} of {gain}");
}

#[test]
fn beside_a_straight_way_a_stop_tells_the_side() {
    // A node 8 m to the left or to the right of a way along x.
    let law = StopLaw::of_curve(12.0, None, |distance_m| (1.0 - distance_m / 12.0).max(0.0));
    let outlook = outlook(law, [1.0, 64.0]);
    let (on_way, beside) = (outlook.gain(at(0.0, 0.0)).fall_m, outlook.gain(at(0.0, 8.0)).fall_m);
    assert!(beside > 3.0 * on_way && beside > 1.0, "{beside} m beside and {on_way} m on the way");
}

#[test]
fn a_node_that_was_never_heard_is_found_or_not() {
    // Four corners, one of which the stop hears for sure: afterwards the node is there, or at one of the other three.
    let law = StopLaw::of_curve(10.0, None, |distance_m| if distance_m < 1.0 { 1.0 } else { 0.0 });
    let corners = [at(0.0, 0.0), at(2.0, 0.0), at(0.0, 2.0), at(2.0, 2.0)];
    let unheard = UnheardNodes::new(2, &corners, &[at(90.0, 0.0)], &law);
    let mut outlook = Outlook { nodes: Vec::new(), unheard, ..outlook(law, [1.0, 1.0]) };
    is_near(outlook.mean_error_m(), 2.0_f64.sqrt(), 1e-12);
    let gain = outlook.gain(at(2.5, 2.5));
    // Three corners: a third of the mean square is 8 / 9 along each axis.
    is_near(gain.fall_m, 2.0 * (2.0_f64.sqrt() - 0.75 * (16.0_f64 / 9.0).sqrt()), 1e-9);
    is_near(gain.found, 0.5, 1e-12);
    outlook.take(at(2.5, 2.5));
    is_near(outlook.mean_error_m(), 1.0, 1e-9);
    outlook.take(at(-0.5, -0.5));
    // Now it is at one of two corners with the distance √8, with half the probability.
    is_near(outlook.mean_error_m(), 0.5 * 2.0_f64.sqrt(), 1e-9);
}

#[test]
fn the_silence_of_the_log_counts_as_that_of_a_new_stop() {
    // Two packets of which each arrives with one half: after silence the near place has a quarter of its weight.
    let mut law = StopLaw::of_curve(10.0, None, |distance_m| if distance_m < 1.0 { 0.5 } else { 0.0 });
    law.packets = 2;
    let places = [at(0.0, 0.0), at(9.0, 0.0)];
    let outlook = |stop| {
        let unheard = UnheardNodes::new(1, &places, &[stop], &law);
        Outlook { nodes: Vec::new(), unheard, ..outlook(law.clone(), [1.0, 1.0]) }
    };
    let silent = outlook(at(0.0, 0.0));
    is_near(silent.mean_error_m(), 9.0 * (0.2_f64 * 0.8).sqrt(), 1e-9);
    let mut new = outlook(at(99.0, 0.0));
    new.take(at(0.0, 0.0));
    // It is silent with the probability 5 / 8, and the node is found otherwise.
    is_near(new.mean_error_m(), 0.625 * silent.mean_error_m(), 1e-9);
}
