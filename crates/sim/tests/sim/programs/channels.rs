//! Channels, power and carrier sense of programs.

use sextant_channel::Dbm;
use sextant_mac::program::ProgramConfig;

use super::{Script, Step, log, script, to_all, us};
use crate::network;
use crate::on_air::Frames;

fn run(places_m: &[f64], scripts: Vec<Script>) -> Vec<Script> {
    let setup = super::setup(places_m, ProgramConfig { channels: vec![15, 26], wake_up_us: Some(500.0) });
    network::run(setup, scripts).applications
}

#[test]
fn a_radio_hears_its_own_channel_alone() {
    let on = |tune: Step| {
        script(&[
            (0, tune),
            (1, |radio| {
                radio.receive();
                Ok(())
            }),
        ])
    };
    let sender = script(&[
        (0, |radio| radio.tune(26).map(drop)),
        (1000, |radio| radio.transmit_at(us(2000), to_all(b"one")).map(drop)),
        (4000, |radio| radio.tune(11).map(drop)),
        (5000, |radio| radio.transmit_at(us(6000), to_all(b"two")).map(drop)),
    ]);
    let moves = {
        let mut moves = on(|radio| radio.tune(26).map(drop));
        moves.steps.push((3000, |radio| radio.tune(11).map(drop)));
        moves
    };
    let stations =
        run(&[0.0, 5.0, 5.0, 5.0], vec![sender, on(|radio| radio.tune(15).map(drop)), on(|_| Ok(())), moves]);
    assert_eq!(log(&stations[1]), [(501, "ready")]);
    assert_eq!(log(&stations[2]), [(501, "ready"), (6160, "began 6000"), (6640, "received two from 0")]);
    let both = [
        (501, "ready"),
        (2160, "began 2000"),
        (2640, "received one from 0"),
        // It is deaf for a turnaround.
        (3192, "ready"),
        (6160, "began 6000"),
        (6640, "received two from 0"),
    ];
    assert_eq!(log(&stations[3]), both);
}

#[test]
fn an_observer_is_told_the_channel_of_a_frame() {
    let sender = script(&[
        (1000, |radio| radio.transmit(to_all(b"one")).map(drop)),
        (3000, |radio| radio.tune(15).map(drop)),
        (4000, |radio| radio.transmit(to_all(b"two")).map(drop)),
    ]);
    let setup = super::setup(&[0.0], ProgramConfig { channels: vec![15, 26], wake_up_us: None });
    let mut channels = Frames::kept(|frame| frame.channel);
    network::run_watched(setup, vec![sender], &mut channels);
    assert_eq!(channels.0, [Some(11), Some(15)]);
}

#[test]
fn frames_on_different_channels_do_not_collide() {
    let at = |tune: Step| script(&[(0, tune), (1000, |radio| radio.transmit_at(us(2000), to_all(b"one")).map(drop))]);
    let listens = script(&[(0, |radio| {
        radio.receive();
        Ok(())
    })]);
    let stations = run(&[0.0, 5.0, 3.0], vec![at(|radio| radio.tune(15).map(drop)), listens, at(|_| Ok(()))]);
    assert_eq!(log(&stations[1]), [(500, "ready"), (2160, "began 2000"), (2640, "received one from 2")]);
}

#[test]
fn carrier_sense_finds_the_energy_of_others_above_the_threshold() {
    // On air from 2000 to 2640 us, 9 m away: -19.1 dBm there, so a microsecond in a window of 128 is above the threshold
    // of -80 dBm.
    let listens = |start: u64, threshold: Step, assess: Step| {
        let mut listens = script(&[
            (0, threshold),
            (0, |radio| {
                radio.receive();
                Ok(())
            }),
        ]);
        listens.steps.push((start, assess));
        listens
    };
    let default: Step = |_| Ok(());
    let cca: Step = |radio| radio.assess().map(drop);
    let long: Step = |radio| radio.assess_for(std::time::Duration::from_micros(1024)).map(drop);
    let high: Step = |radio| radio.set_threshold(Dbm(-19.0));
    let cases = [
        (1871, default, cca, 1999, "idle"),
        (1872, default, cca, 2000, "idle"),
        (1880, default, cca, 2008, "busy"),
        (2400, default, cca, 2528, "busy"),
        (2640, default, cca, 2768, "idle"),
        (2100, high, cca, 2228, "idle"),
        (1000, default, long, 2024, "busy"),
    ];
    for (start, threshold, assess, end, found) in cases {
        let sender = script(&[(1000, |radio| radio.transmit_at(us(2000), to_all(b"one")).map(drop))]);
        let stations = run(&[0.0, 9.0], vec![sender, listens(start, threshold, assess)]);
        assert!(log(&stations[1]).contains(&(end, found)), "{start}: {:?}", stations[1].log);
    }
}

#[test]
fn less_power_reaches_less_far() {
    // The loss over 9 m is 19.1 dB, and the sensitivity is -90 dBm.
    for (power, is_heard) in
        [((|radio| radio.set_power(Dbm(-70.9))) as Step, true), (|radio| radio.set_power(Dbm(-71.0)), false)]
    {
        let sender = script(&[(0, power), (1000, |radio| radio.transmit_at(us(2000), to_all(b"one")).map(drop))]);
        let listens = script(&[(0, |radio| {
            radio.receive();
            Ok(())
        })]);
        let stations = run(&[0.0, 9.0], vec![sender, listens]);
        assert_eq!(log(&stations[1]).contains(&(2640, "received one from 0")), is_heard);
    }
}
