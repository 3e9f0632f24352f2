//! Every physical layer carries frames, with its own spans; bit errors are known for one only.

use std::time::Duration;

use sextant_kernel::{SettingError, SimTime, StationId};
use sextant_mac::Phy;
use sextant_sim::{
    Destination, FrameOutcome, Radio, RadioConfig, ReceptionConfig, ReceptionModel, SendOutcome, Setup,
    ThresholdConfig,
};

use crate::network::{self, Ended};
use crate::on_air::OnAir;
use crate::scripted::Scripted;

/// Two nodes in range of each other with these radios.
fn setup(phy: Phy, reception: ReceptionModel) -> Setup {
    let radio = Radio::try_from(RadioConfig { phy, ..network::radio(0.0) }).expect("good settings");
    let mut link = network::link(10.0, network::prompt());
    let settings = network::ieee802154(&mut link);
    settings.radio = radio.with_reception(reception);
    network::engine(&network::grid(2, 1), link, 1)
}

/// A frame with `payload` from the first node to the second one.
fn carry(phy: Phy, reception: ReceptionModel, payload: &[u8]) -> (Ended<Scripted>, OnAir) {
    let sender = Scripted::listener().and_sends(Duration::ZERO, Destination::Station(StationId(1)), payload);
    let mut on_air = OnAir::default();
    (network::run_watched(setup(phy, reception), vec![sender, Scripted::listener()], &mut on_air), on_air)
}

#[test]
fn each_physical_layer_carries_frames_of_all_sizes_at_its_own_rate() {
    let capture = ReceptionModel::try_from(ReceptionConfig::SinrThreshold(ThresholdConfig { threshold_db: 3.0 }));
    for phy in Phy::ALL {
        for payload in [&[][..], &[9; 20], &[9; 116]] {
            for reception in [ReceptionModel::Overlap, capture.clone().expect("a good threshold")] {
                let (ended, on_air) = carry(phy, reception, payload);
                let start = phy.cca() + phy.turnaround();
                let end = start + phy.airtime(u8::try_from(payload.len()).unwrap() + 11);
                let answered = end + phy.turnaround() + phy.ack_airtime();
                let [received] = &ended.applications[1].received[..] else { panic!("{phy:?}: one frame") };
                assert_eq!((received.at, &received.payload[..]), (SimTime::ZERO + end, payload), "{phy:?}");
                let [(at, report)] = ended.applications[0].reports[..] else { panic!("{phy:?}: one report") };
                assert_eq!((at, report.outcome), (SimTime::ZERO + answered, SendOutcome::Acknowledged), "{phy:?}");
                let micros = |span: Duration| u64::try_from(span.as_micros()).unwrap();
                let span = (0, micros(start), micros(end), FrameOutcome::Received);
                assert_eq!(on_air.frames(false), [span], "{phy:?}");
            }
        }
    }
}

#[test]
fn a_frame_of_20_octets_takes_as_long_as_its_bits_and_its_header() {
    // Symbols of header and of 20 octets, and their length: IEEE 802.15.4-2006, clause 6.
    let expected_us = [
        (Phy::Oqpsk2450, (12 + 40) * 16),
        (Phy::Bpsk868, (48 + 160) * 50),
        (Phy::Bpsk915, (48 + 160) * 25),
        (Phy::Ask868, 912),
        (Phy::Ask915, 812),
        (Phy::Oqpsk868, (12 + 40) * 40),
        (Phy::Oqpsk915, (12 + 40) * 16),
    ];
    assert_eq!(expected_us.map(|(phy, _)| phy), Phy::ALL);
    for (phy, airtime_us) in expected_us {
        let (_, on_air) = carry(phy, ReceptionModel::Overlap, &[9; 9]);
        let [(_, from_us, to_us, _)] = on_air.frames(false)[..] else { panic!("{phy:?}: one frame") };
        assert_eq!(to_us - from_us, airtime_us, "{phy:?}");
    }
}

#[test]
fn bit_errors_are_refused_for_physical_layers_other_than_that_of_their_rate() {
    let refusal = |setup: Setup| network::refusal(setup, vec![Scripted::listener(); 2]);
    for phy in Phy::ALL {
        let found = refusal(setup(phy, ReceptionModel::Ber));
        if phy == Phy::Oqpsk2450 {
            assert_eq!(found, None);
            continue;
        }
        let allowed = "only `phy = \"oqpsk2450\"`, whose bit error rate is known; with others \
                       `reception.sinr_threshold`, `reception.sir_threshold` or `reception.overlap`";
        let expected =
            SettingError::new("reception.ber", format!("set for a radio with `phy = \"{}\"`", phy.name()), allowed);
        assert_eq!(found, Some(expected));
        // The second network of an engine is named.
        let mut two = setup(phy, ReceptionModel::Overlap);
        two.networks.extend(setup(phy, ReceptionModel::Ber).networks);
        assert_eq!(refusal(two).map(|error| error.key).as_deref(), Some("networks[1].reception.ber"));
    }
}
