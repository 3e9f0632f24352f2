//! What a radio cannot do is refused with words, and changes nothing.

use sextant_channel::Dbm;
use sextant_kernel::StationId;
use sextant_mac::csma::CsmaConfig;
use sextant_mac::program::ProgramConfig;
use sextant_sim::{
    Application, Applications, Destination, FrameId, Network, Payload, Port, RadioError, RadioFrame, SendError,
    SendOutcome, Setup, Unobserved,
};

use super::{NETWORK, Step, log, run, script, to_all, us};
use crate::network;

#[test]
fn transmitting_while_a_frame_is_received_is_refused() {
    // The frame is on air from 1192 to 1832 us; its delimiter ends at 1352 us.
    let sender = script(&[(1000, |radio| radio.transmit(to_all(b"one")).map(drop))]);
    let other = script(&[
        (0, |radio| {
            radio.receive();
            Ok(())
        }),
        (1352, |radio| radio.transmit(to_all(b"two")).map(drop)),
        (1353, |radio| radio.tune(12).map(drop)),
        // It begins after the end of the frame, but the radio turns around before.
        (1600, |radio| radio.transmit_at(us(1792), to_all(b"two")).map(drop)),
        (1700, |radio| radio.transmit_at(us(2100), to_all(b"two")).map(drop)),
    ]);
    let setup = super::setup(&[0.0, 5.0], ProgramConfig { channels: vec![12], wake_up_us: None });
    let stations = network::run(setup, vec![sender, other]).applications;
    let words = "a frame is being received; turn the receiver off to give it up";
    assert_eq!(stations[1].refused, [words; 3]);
    let heard = [
        (192, "ready"),
        (1352, "began 1192"),
        (1832, "received one from 0"),
        (2740, "sent 2100"),
        (2740 + 192, "ready"),
    ];
    assert_eq!(log(&stations[1]), heard);
}

#[test]
fn commands_at_the_wrong_time_say_when_and_why() {
    let steps: [(u64, Step); 8] = [
        (1000, |radio| radio.transmit_at(us(1191), to_all(b"")).map(drop)),
        (1001, |radio| radio.transmit_at(us(7), to_all(b"")).map(drop)),
        (1002, |radio| radio.assess().map(drop)),
        (1003, |radio| radio.listen(Some(us(2000)), us(2000)).map(drop)),
        (1004, |radio| radio.transmit(to_all(b"")).map(drop)),
        (1005, |radio| radio.transmit(to_all(b"")).map(drop)),
        (1006, |radio| radio.tune(11).map(drop)),
        (1007, |radio| radio.listen(None, us(1100)).map(drop)),
    ];
    let stations = run(&[0.0], vec![script(&steps)]);
    let early = ", because the radio needs that time to turn around";
    assert_eq!(
        stations[0].refused,
        [
            format!("the instant is 0.001191000 s; allowed: 0.001192000 s or later{early}"),
            format!("the instant is 0.000007000 s; allowed: 0.001193000 s or later{early}"),
            "the receiver is not on during all of that time".to_owned(),
            "the window ends at 0.002000000 s; allowed: after its start at 0.002000000 s".to_owned(),
            // The frame goes out at 1196 us and takes 544 us.
            "the radio has a frame to send, or waits for its acknowledgement, until 0.001740000 s".to_owned(),
            "the window ends at 0.001100000 s; allowed: after its start at 0.001932000 s".to_owned(),
        ]
    );
    assert_eq!(log(&stations[0]), [(1740, "sent 1196")]);
}

#[test]
fn settings_out_of_range_are_refused() {
    let steps: [(u64, Step); 8] = [
        (0, |radio| radio.set_power(Dbm(0.1))),
        (1, |radio| radio.set_power(Dbm(f64::NAN))),
        (2, |radio| radio.set_threshold(Dbm(-201.0))),
        (3, |radio| radio.tune(27).map(drop)),
        (4, |radio| radio.assess_for(std::time::Duration::from_micros(15)).map(drop)),
        (5, |radio| radio.assess_for(std::time::Duration::from_micros(2049)).map(drop)),
        (6, |radio| radio.transmit(to_all(&[0; 117])).map(drop)),
        (7, |radio| {
            let frame = RadioFrame { acknowledged: true, ..to_all(b"") };
            radio.transmit(frame).map(drop)
        }),
    ];
    let stations = run(&[0.0], vec![script(&steps)]);
    assert_eq!(
        stations[0].refused,
        [
            "the transmit power is 0.1 dBm; allowed: -200 to 0 dBm, that of the settings",
            "the transmit power is NaN dBm; allowed: -200 to 0 dBm, that of the settings",
            "the threshold is -201 dBm; allowed: -200 to 100 dBm",
            "the channel is 27; allowed: `radio.channel`, and those of `mac.program.channels`",
            "the time to assess the channel is 15µs; allowed: 16µs to 2.048ms",
            "the time to assess the channel is 2.049ms; allowed: 16µs to 2.048ms",
            "the payload has 117 octets; allowed: at most 116",
            "a frame to all asks for an acknowledgement; allowed: a frame to one station",
        ]
    );
    let steps: [(u64, Step); 4] = [
        (0, |radio| {
            let itself = Destination::Station(StationId(0));
            radio.transmit(RadioFrame { to: itself, ..to_all(b"") }).map(drop)
        }),
        (1, |radio| radio.done(FrameId(0), SendOutcome::Sent)),
        (2, |radio| radio.transmit(RadioFrame { packet: Some(FrameId(3)), ..to_all(b"") }).map(drop)),
        (3, |radio| radio.set_ack_wait(std::time::Duration::from_micros(543))),
    ];
    let stations = run(&[0.0], vec![script(&steps)]);
    assert_eq!(
        stations[0].refused,
        [
            "station 0 cannot receive the frame",
            "there is no open packet number 0",
            "there is no open packet number 3",
            "the wait for an acknowledgement is 543µs; allowed: at least 544µs",
        ]
    );
}

/// Asks for its radio, and for channel access.
#[derive(Default)]
struct Asks {
    radio: Option<RadioError>,
    sends: Option<SendError>,
}

impl Application for Asks {
    fn started(&mut self, port: &mut Port<'_>) {
        self.radio = port.radio(NETWORK).err();
        self.sends = port.send(NETWORK, Destination::All, Payload::Octets(b"!")).err();
    }
}

#[test]
fn no_radio_has_two_masters() {
    let asks = |link: Network| {
        let setup = Setup {
            duration: Some(std::time::Duration::from_secs(1)),
            ..network::engine(&network::cluster(2), link, 1)
        };
        let stations = Applications::of_nodes(vec![Asks::default(), Asks::default()]);
        let (_, stations) = network::run_own(setup, stations, &mut Unobserved);
        let Asks { radio, sends } = stations.nodes.into_iter().next().expect("a node");
        (radio, sends)
    };
    assert_eq!(asks(network::link(10.0, CsmaConfig::default())), (Some(RadioError::NotProgrammed), None));
    assert_eq!(asks(super::link(ProgramConfig::default())), (None, Some(SendError::NoChannelAccess)));
    let outside = Network { members: Some(vec![false, true]), ..super::link(ProgramConfig::default()) };
    assert_eq!(asks(outside).0, Some(RadioError::NotThere));
}
