//! What a radio says: windows, the start and the end of frames, acknowledgements.

use sextant_kernel::StationId;
use sextant_mac::oqpsk::link_quality;
use sextant_sim::{Acknowledging, Destination, Hearing, RadioEvent, RadioFrame};

use super::{Script, Step, log, run, script, to_all, us};
use crate::network;

fn to(station: u32, payload: &[u8]) -> RadioFrame<'_> {
    RadioFrame { to: Destination::Station(StationId(station)), payload, acknowledged: true, packet: None }
}

/// A station whose receiver is on from 192 us on.
fn listener() -> Script {
    script(&[(0, |radio| {
        radio.receive();
        Ok(())
    })])
}

#[test]
fn a_frame_begins_at_its_delimiter_and_is_received_at_its_end() {
    // 11 octets of header and 3 of payload: 640 us on air.
    let sender = script(&[(1000, |radio| radio.transmit(to_all(b"one")).map(drop))]);
    let stations = run(&[0.0, 5.0], vec![sender, listener()]);
    assert_eq!(log(&stations[0]), [(1832, "sent 1192")]);
    let heard = [(192, "ready"), (1352, "began 1192"), (1832, "received one from 0")];
    assert_eq!(log(&stations[1]), heard);
}

#[test]
fn a_window_hears_what_begins_in_it_to_its_end() {
    // The frame is on air from 1192 to 1832 us.
    let sender = || script(&[(1000, |radio| radio.transmit(to_all(b"one")).map(drop))]);
    let windows: [(Step, &[(u64, &str)]); 4] = [
        (
            |radio| radio.listen(Some(us(1192)), us(1193)).map(drop),
            &[(1192, "ready"), (1352, "began 1192"), (1832, "received one from 0"), (1832, "over")],
        ),
        (|radio| radio.listen(Some(us(1193)), us(1500)).map(drop), &[(1193, "ready"), (1500, "over")]),
        (|radio| radio.listen(Some(us(900)), us(1192)).map(drop), &[(900, "ready"), (1192, "over")]),
        (
            |radio| radio.listen(None, us(3000)).map(drop),
            &[(192, "ready"), (1352, "began 1192"), (1832, "received one from 0"), (3000, "over")],
        ),
    ];
    for (window, heard) in windows {
        let stations = run(&[0.0, 5.0], vec![sender(), script(&[(0, window)])]);
        assert_eq!(log(&stations[1]), heard);
    }
}

#[test]
fn a_frame_during_which_the_receiver_goes_off_is_lost_without_a_word() {
    let sender = script(&[(1000, |radio| radio.transmit(to_all(b"one")).map(drop))]);
    let mut listener = listener();
    listener.steps.push((1400, |radio| {
        radio.off();
        Ok(())
    }));
    let stations = run(&[0.0, 5.0], vec![sender, listener]);
    assert_eq!(log(&stations[1]), [(192, "ready"), (1352, "began 1192")]);
}

#[test]
fn frames_that_overlap_are_garbled_after_a_delimiter_and_silent_before() {
    let at = |start: Step| script(&[(1000, start)]);
    let first = || at(|radio| radio.transmit_at(us(2000), to_all(b"one")).map(drop));
    let stations = run(
        &[0.0, 5.0, 3.0],
        vec![first(), listener(), at(|radio| radio.transmit_at(us(2300), to_all(b"two")).map(drop))],
    );
    // The second one is no frame to a receiver that is locked on.
    assert_eq!(log(&stations[1]), [(192, "ready"), (2160, "began 2000"), (2640, "garbled")]);
    let stations = run(
        &[0.0, 5.0, 3.0],
        vec![first(), listener(), at(|radio| radio.transmit_at(us(2100), to_all(b"two")).map(drop))],
    );
    assert_eq!(log(&stations[1]), [(192, "ready")]);
}

#[test]
fn a_frame_for_one_station_is_acknowledged_by_it_and_ignored_by_others() {
    // 12 octets and the header: 1 octet of payload, 576 us on air from 1192 on.
    let sender = || script(&[(1000, |radio| radio.transmit(to(1, b"!")).map(drop))]);
    let stations = run(&[0.0, 5.0, 3.0], vec![sender(), listener(), listener()]);
    let end = 1192 + 576;
    assert_eq!(log(&stations[0]), [(end, "sent 1192"), (end + 192 + 352, "acknowledged")]);
    let own = [(192, "ready"), (1352, "began 1192"), (end, "received ! from 0"), (end + 736, "ready")];
    assert_eq!(log(&stations[1]), own);
    let of_others = [
        (192, "ready"),
        (1352, "began 1192"),
        (end, "ignored"),
        (end + 192 + 160, "began 1960"),
        (end + 192 + 352, "ignored"),
    ];
    assert_eq!(log(&stations[2]), of_others);
    // Who wants to hear all is told the frame, and does not acknowledge it.
    let all = script(&[(0, |radio| {
        radio.receive();
        radio.hear(Hearing::All);
        Ok(())
    })]);
    // The third station has no commands, so its radio is off.
    let stations = run(
        &[0.0, 3.0, 5.0],
        vec![script(&[(1000, |radio| radio.transmit(to(2, b"!")).map(drop))]), all, script(&[])],
    );
    assert!(log(&stations[1]).contains(&(end, "received ! from 0")));
    assert_eq!(log(&stations[0]), [(end, "sent 1192"), (end + 864, "unacknowledged")]);
}

#[test]
fn an_acknowledgement_can_be_turned_off_and_awaited_for_less() {
    let mut listener = listener();
    listener.steps.push((500, |radio| {
        radio.set_acknowledging(Acknowledging::Off);
        Ok(())
    }));
    let sender = script(&[
        (900, |radio| radio.set_ack_wait(std::time::Duration::from_micros(544))),
        (1000, |radio| radio.transmit(to(1, b"!")).map(drop)),
    ]);
    let stations = run(&[0.0, 5.0], vec![sender, listener]);
    assert_eq!(log(&stations[0]), [(1768, "sent 1192"), (1768 + 544, "unacknowledged")]);
}

/// Keeps the quality and the power of what it receives.
#[derive(Default)]
struct Quality(Vec<(u8, f64, u64)>);

impl sextant_sim::Application for Quality {
    fn radio(&mut self, _network: sextant_sim::NetworkId, event: &RadioEvent<'_>, _port: &mut sextant_sim::Port<'_>) {
        if let RadioEvent::Received(frame) = event {
            self.0.push((
                frame.lqi,
                frame.delivery.rssi.0,
                u64::try_from((frame.end - frame.start).as_micros()).expect("a frame is short"),
            ));
        }
    }

    fn started(&mut self, port: &mut sextant_sim::Port<'_>) {
        let is_first = port.station() == StationId(0);
        let mut radio = port.radio(super::NETWORK).expect("programs command the radios");
        if is_first {
            radio.set_power(sextant_channel::Dbm(-70.0)).expect("it is less than before");
            radio.transmit_at(us(1000), to_all(b"one")).expect("it is free");
        } else {
            radio.receive();
        }
    }
}

#[test]
fn strength_and_quality_are_those_of_the_link() {
    let setup = super::setup(&[0.0, 1.0, 9.0], sextant_mac::program::ProgramConfig::default());
    let law = setup.networks[0].channel;
    let stations = network::run(setup, vec![Quality::default(), Quality::default(), Quality::default()]);
    for (place, x_m) in [(1, 1.0), (2, 9.0)] {
        let power_dbm = -70.0 - law.path_loss().loss(x_m).0;
        let [(lqi, rssi_dbm, airtime_us)] = stations.applications[place].0[..] else { panic!("one frame") };
        assert!((rssi_dbm - power_dbm).abs() < 1e-9, "{rssi_dbm} and {power_dbm}");
        // Noise is 0.403 dB below the sensitivity of -90 dBm. With the model `overlap` that is not followed, so the ratio is
        // that to the noise alone.
        assert_eq!(lqi, link_quality(sextant_channel::Db(power_dbm + 90.403)));
        assert_eq!(airtime_us, 640);
    }
    assert!(stations.applications[1].0[0].0 > stations.applications[2].0[0].0);
}
