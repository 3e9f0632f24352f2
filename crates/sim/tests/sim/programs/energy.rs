//! Energy by state, against products of power and time.

use std::time::Duration;

use sextant_channel::Dbm;
use sextant_kernel::SimTime;
use sextant_mac::program::ProgramConfig;
use sextant_mac::{EnergySpent, RadioState, RadioStates};
use sextant_sim::{Application, BatteryConfig, NetworkId, Port, RadioEvent, Setup, Timer};

use super::{NETWORK, Script, Step, script, to_all, us};
use crate::network;

fn spent(script: Script, duration: Duration) -> EnergySpent {
    let setup = Setup { duration: Some(duration), ..super::setup(&[0.0], ProgramConfig::default()) };
    network::run(setup, vec![script]).networks[0].energy[0]
}

fn assert_spent(found: EnergySpent, expected_mj: [f64; 4]) {
    let found = [found.tx_j, found.rx_j, found.idle_j, found.sleep_j].map(|joules| 1e3 * joules);
    for (found, expected) in found.into_iter().zip(expected_mj) {
        assert!((found - expected).abs() < 1e-9, "{found}, not {expected} mJ");
    }
}

#[test]
fn a_radio_that_listens_one_second_in_ten_and_idles_else_uses_68_mj() {
    let steps: [(u64, Step); 2] = [
        (0, |radio| {
            radio.idle();
            Ok(())
        }),
        (500, |radio| radio.listen(Some(SimTime::from_secs(4)), SimTime::from_secs(5)).map(drop)),
    ];
    let found = spent(script(&steps), Duration::from_secs(10));
    // 18.8 mA and 0.426 mA at 3 V; a turnaround of 192 us takes the current of the receiver.
    let (rx_mw, idle_mw) = (56.4, 1.278);
    assert_spent(found, [0.0, rx_mw * 1.000_192, idle_mw * 8.999_808, 0.0]);
    assert!((1e3 * found.rx_j - 56.4).abs() < 0.05 && (1e3 * found.idle_j - 11.5).abs() < 0.05);
}

#[test]
fn a_frame_takes_a_turnaround_and_its_airtime_at_the_power_that_was_chosen() {
    // 11 octets of header: 544 us. 17.4 mA at 0 dBm, 8.5 mA at -25 dBm.
    let at = |power: Step| script(&[(0, power), (1000, |radio| radio.transmit(to_all(b"")).map(drop))]);
    for (power, tx_ma) in [
        ((|_| Ok(())) as Step, 17.4),
        (|radio| radio.set_power(Dbm(-25.0)), 8.5),
        (|radio| radio.set_power(Dbm(-4.0)), 15.2),
    ] {
        let found = spent(at(power), Duration::from_secs(1));
        let sleeping_s = 1.0 - 736e-6;
        assert_spent(found, [3.0 * tx_ma * 544e-6, 56.4 * 192e-6, 0.0, 0.06 * sleeping_s]);
    }
}

/// Asks for its energy at each event.
#[derive(Default)]
struct Watched(Vec<f64>);

impl Application for Watched {
    fn started(&mut self, port: &mut Port<'_>) {
        let mut radio = port.radio(NETWORK).expect("programs command the radios");
        radio.set_power(Dbm(-25.0)).expect("it is less than before");
        radio.transmit_at(us(1000), to_all(b"")).expect("it is free");
        self.0.push(radio.energy_j());
    }

    fn radio(&mut self, _network: NetworkId, _event: &RadioEvent<'_>, port: &mut Port<'_>) {
        self.0.push(port.radio(NETWORK).expect("programs command the radios").energy_j());
    }
}

#[test]
fn a_program_knows_what_it_has_used() {
    let stations = network::run(super::setup(&[0.0], ProgramConfig::default()), vec![Watched::default()]);
    let radio = RadioStates::cc2420();
    let joules = |state, us: f64| 1e-6 * us * radio.power_w(state, Dbm(-25.0));
    let sent = joules(RadioState::Sleep, 808.0) + joules(RadioState::Turnaround, 192.0);
    let expected = [0.0, sent + joules(RadioState::Transmit, 544.0)];
    let found = &stations.applications[0].0;
    assert_eq!(found.len(), 2);
    assert!(found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-12), "{found:?}");
}

/// Listens all the time, and asks each 100 ms what is left in its battery.
#[derive(Default)]
struct Gauge {
    left_j: Vec<Option<f64>>,
}

impl Application for Gauge {
    fn started(&mut self, port: &mut Port<'_>) {
        port.radio(NETWORK).expect("programs command the radios").receive();
        self.timed(Timer(0), port);
    }

    fn timed(&mut self, timer: Timer, port: &mut Port<'_>) {
        self.left_j.push(port.charge_j());
        port.after(Duration::from_millis(100), timer);
    }
}

#[test]
fn a_program_knows_what_is_left_in_its_battery_until_that_is_empty() {
    // 56.4 mJ: a second of receiving at 56.4 mW, and the load of 0.1 mA takes 0.3 mW of it.
    let config: BatteryConfig = toml::from_str("capacity_j = 0.0564\nload_ma = 0.1").expect("a good table");
    let plain = Setup { duration: Some(Duration::from_secs(2)), ..super::setup(&[0.0], ProgramConfig::default()) };
    let batteries = Some(config.build(&plain.world.nodes, plain.seed).expect("good batteries"));
    let ended = network::run(Setup { batteries, ..plain.clone() }, vec![Gauge::default()]);
    let found = &ended.applications[0].left_j;
    assert_eq!(found.len(), 10, "it dies before the eleventh");
    for (i, left_j) in found.iter().enumerate() {
        let expected = 0.0564 - 0.0567 * 0.1 * i as f64;
        assert!((left_j.expect("a battery") - expected).abs() < 1e-9, "{i}: {left_j:?}, not {expected}");
    }
    let record = ended.survey.batteries[0];
    let death_s = record.depleted.expect("empty").as_secs_f64();
    assert!((death_s - 0.0564 / 0.0567).abs() < 0.0011, "{death_s}");
    assert!((record.used_j - 0.0564).abs() < 1e-4 && (record.lifetime_s - death_s).abs() < 1e-12);
    assert!((ended.networks[0].energy[0].total_j() - 0.0564 * death_s).abs() < 1e-9);
    // Without a battery there is nothing to ask for.
    let without = network::run(plain, vec![Gauge::default()]);
    assert!(without.applications[0].left_j.len() == 20 && without.applications[0].left_j.iter().all(Option::is_none));
}
