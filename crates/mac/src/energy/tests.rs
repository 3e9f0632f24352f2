//! Energies against data sheets and worked by hand.

use std::time::Duration;

use super::*;

const PHY: Phy = Phy::Oqpsk2450;

#[test]
fn energies_are_added_taken_off_and_multiplied_part_by_part() {
    let spent = EnergySpent { tx_j: 2.0, rx_j: 3.0, idle_j: 5.0, sleep_j: 7.0 };
    let twice = EnergySpent { tx_j: 4.0, rx_j: 6.0, idle_j: 10.0, sleep_j: 14.0 };
    let mut sum = spent;
    sum += spent;
    assert_eq!((sum, spent * 2.0, twice - spent), (twice, twice, spent));
    assert!((spent.total_j() - 17.0).abs() < 1e-12);
}

/// Energy of `span` in `state` (uJ).
fn microjoules(radio: &RadioStates, state: RadioState, tx_dbm: f64, span: Duration) -> f64 {
    1e6 * radio.power_w(state, Dbm(tx_dbm)) * span.as_secs_f64()
}

fn assert_close(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() < tolerance, "{found}, not {expected}");
}

#[test]
fn frames_use_the_energy_of_the_data_sheets() {
    use RadioState::{Receive, Transmit, Turnaround};
    let (short, long) = (PHY.airtime(20), PHY.airtime(127));
    let ti = RadioStates::cc2420();
    assert_close(microjoules(&ti, Transmit, 0.0, short), 43.4, 0.05);
    assert_close(microjoules(&ti, Receive, 0.0, short), 46.9, 0.05);
    assert_close(microjoules(&ti, Transmit, 0.0, long), 222.2, 0.05);
    assert_close(microjoules(&ti, Receive, 0.0, long), 240.0, 0.05);
    assert_close(microjoules(&ti, Receive, 0.0, PHY.cca()), 7.22, 0.005);
    assert_close(microjoules(&ti, Turnaround, 0.0, PHY.turnaround()), 10.83, 0.005);
    assert_close(1e-3 * microjoules(&ti, Receive, 0.0, Duration::from_secs(1)), 56.4, 0.05);
    let microchip = RadioStates::at86rf233();
    assert_close(microjoules(&microchip, Transmit, 4.0, short), 34.4, 0.05);
    assert_close(microjoules(&microchip, Receive, 4.0, short), 29.5, 0.05);
    assert_close(microjoules(&microchip, Transmit, 4.0, long), 176.2, 0.05);
    assert_close(microjoules(&microchip, Receive, 4.0, long), 150.7, 0.05);
    assert_close(microjoules(&microchip, Receive, 4.0, PHY.cca()), 4.53, 0.005);
    assert_close(microjoules(&microchip, Turnaround, 4.0, PHY.turnaround()), 6.80, 0.005);
}

#[test]
fn sector_sweeps_use_the_assumed_energy_of_a_60_ghz_radio() {
    use crate::dmg::SectorLayout;
    use crate::dmg::timing::{SBIFS, SSW_AIRTIME};
    let radio = RadioStates::try_from(EnergyConfig::Mmwave60Ghz).expect("a known radio");
    assert_close(microjoules(&radio, RadioState::Transmit, 20.0, SSW_AIRTIME), 8.9, 0.05);
    assert_close(microjoules(&radio, RadioState::Receive, 20.0, SSW_AIRTIME), 6.0, 0.05);
    // Eight frames with gaps; one sweep of 64 sectors heard to its end.
    let sweep = microjoules(&radio, RadioState::Transmit, 20.0, SSW_AIRTIME * 8)
        + microjoules(&radio, RadioState::Idle, 20.0, SBIFS * 7);
    assert_close(sweep, 71.9, 0.05);
    let heard = SectorLayout::new(&[64]).expect("a good layout").sweep_duration();
    assert_close(microjoules(&radio, RadioState::Receive, 20.0, heard), 407.0, 0.5);
}

#[test]
fn the_usual_chip_of_each_physical_layer_is_one_of_its_band() {
    // By the data sheets: transmitting at 0 dBm, and receiving (mA).
    let (low, high) = (["at86rf212b", "18.0", "9.2"], ["cc2420", "17.4", "18.8"]);
    for phy in Phy::ALL {
        let chip = EnergyConfig::usual(phy);
        let states = RadioStates::try_from(chip).expect("a known chip");
        let ma = |state| format!("{:.1}", 1e3 * states.power_w(state, Dbm(0.0)) / 3.0);
        let expected = if phy == Phy::Oqpsk2450 { high } else { low };
        let found = [chip.name().to_owned(), ma(RadioState::Transmit), ma(RadioState::Receive)];
        assert_eq!(found, expected, "{phy:?}");
        assert_eq!(chip.other_bands(phy), None, "{phy:?}");
        let is_low = phy != Phy::Oqpsk2450;
        assert_eq!(EnergyConfig::Cc2420.other_bands(phy), is_low.then_some("2.4 GHz"));
        assert_eq!(EnergyConfig::At86rf212b.other_bands(phy), (!is_low).then_some("868 and 915 MHz"));
    }
}

/// Energy of 50 octets on air by hand: preamble, delimiter, length and MPDU at the rate of the data, with 54 mW of the
/// AT86RF212B at 5 dBm and 52.2 mW of the CC2420 at 0 dBm.
#[test]
fn fifty_octets_take_what_airtime_and_current_say() {
    for (phy, dbm, airtime_us, uj) in [
        (Phy::Bpsk868, 5.0, 22_400, 1209.6),
        (Phy::Bpsk915, 5.0, 11_200, 604.8),
        (Phy::Ask868, 5.0, 1_872, 101.1),
        (Phy::Ask915, 5.0, 1_772, 95.7),
        (Phy::Oqpsk868, 5.0, 4_480, 241.9),
        (Phy::Oqpsk915, 5.0, 1_792, 96.8),
        (Phy::Oqpsk2450, 0.0, 1_792, 93.5),
    ] {
        let radio = RadioStates::try_from(EnergyConfig::usual(phy)).expect("a known chip");
        assert_eq!(phy.airtime(50), Duration::from_micros(airtime_us), "{phy:?}");
        assert_close(microjoules(&radio, RadioState::Transmit, dbm, phy.airtime(50)), uj, 0.06);
    }
}

#[test]
fn a_chip_says_what_it_has_no_number_for() {
    for phy in Phy::ALL {
        let is_ask = matches!(phy, Phy::Ask868 | Phy::Ask915);
        assert_eq!(EnergyConfig::At86rf212b.gap(phy).is_some(), is_ask, "{phy:?}");
        assert_eq!(EnergyConfig::Cc2420.gap(phy), None);
    }
    assert!(EnergyConfig::Nrf52840.gap(PHY).is_some_and(|gap| gap.contains("idle")));
}

#[test]
fn chips_of_today_draw_what_their_makers_say() {
    use RadioState::{Idle, Receive, Sleep, Transmit};
    for (chip, states) in [
        (
            EnergyConfig::Nrf52840,
            [(Transmit, 0.0, 6.4), (Transmit, 8.0, 16.4), (Receive, 0.0, 6.53), (Sleep, 0.0, 0.0015)],
        ),
        (EnergyConfig::Cc2538, [(Transmit, 7.0, 34.0), (Receive, 0.0, 20.0), (Idle, 0.0, 0.6), (Sleep, 0.0, 0.0013)]),
    ] {
        let radio = RadioStates::try_from(chip).expect("a known chip");
        for (state, dbm, ma) in states {
            assert_close(1e3 * radio.power_w(state, Dbm(dbm)) / 3.0, ma, 1e-9);
        }
    }
    // Of a radio that sends at -10 dBm, receiving takes most; at 8 dBm, sending does.
    assert_close(1e3 * RadioStates::cc2420().most_w(Dbm(-10.0)) / 3.0, 18.8, 1e-9);
    assert_close(1e3 * RadioStates::nrf52840().most_w(Dbm(8.0)) / 3.0, 16.4, 1e-9);
}

#[test]
fn a_power_uses_the_lowest_level_that_reaches_it() {
    let radio = RadioStates::cc2420();
    let current_ma = |dbm| 1e3 * radio.power_w(RadioState::Transmit, Dbm(dbm)) / 3.0;
    assert_close(current_ma(-50.0), 8.5, 1e-9);
    assert_close(current_ma(-10.0), 11.2, 1e-9);
    assert_close(current_ma(-9.0), 12.5, 1e-9);
    assert_close(current_ma(20.0), 17.4, 1e-9);
}

#[test]
fn a_custom_radio_needs_a_voltage_and_no_negative_current() {
    let good = CustomRadioConfig { supply_v: 3.0, tx_ma: 1.0, rx_ma: 1.0, idle_ma: 0.0, sleep_ma: 0.0 };
    let key = |custom| RadioStates::try_from(EnergyConfig::Custom(custom)).err().map(|error| error.key);
    assert_eq!(key(good), None);
    assert_eq!(key(CustomRadioConfig { supply_v: 0.0, ..good }).as_deref(), Some("custom.supply_v"));
    assert_eq!(key(CustomRadioConfig { rx_ma: f64::NAN, ..good }).as_deref(), Some("custom.rx_ma"));
}
