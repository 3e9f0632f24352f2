use super::*;

const DAY_S: f64 = 86_400.0;

fn assert_close(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() < tolerance, "{found}, not {expected}");
}

/// A battery at 1 V, so that powers are currents.
fn battery(mah: f64, model: DischargeConfig, self_discharge_per_year: Option<f64>) -> Battery {
    let capacity = Capacity { capacity_mah: Some(mah), capacity_j: None };
    let settings = BatterySettings {
        capacity,
        voltage_v: Some(1.0),
        self_discharge_per_year,
        model,
        ..BatterySettings::default()
    };
    Battery::try_from(settings).expect("a good battery")
}

fn kibam() -> Battery {
    // 5.5 A min (Jongerden and Haverkort 2009).
    let model = DischargeConfig::Kibam(KibamConfig { available_share: 0.166, rate_per_min: 0.122 });
    battery(5500.0 / 60.0, model, None)
}

/// Time until a battery is empty under currents (A), each for a minute, over and over again (min).
fn lifetime_min(battery: &Battery, currents_a: &[f64]) -> f64 {
    let minute = Duration::from_secs(60);
    let mut charge = battery.full();
    let mut passed_min = 0.0;
    for &current_a in currents_a.iter().cycle() {
        let after = |span: Duration| {
            let mut charge = charge;
            battery.draw(&mut charge, current_a * span.as_secs_f64(), span);
            charge
        };
        if after(minute).is_empty() {
            let (mut low, mut high) = (Duration::ZERO, minute);
            while high - low > Duration::from_micros(1) {
                let middle = (low + high) / 2;
                if after(middle).is_empty() { high = middle } else { low = middle }
            }
            return passed_min + low.as_secs_f64() / 60.0;
        }
        charge = after(minute);
        passed_min += 1.0;
    }
    unreachable!("the currents never end")
}

#[test]
fn a_linear_battery_lasts_capacity_over_current_and_less_with_self_discharge() {
    let years = |battery: &Battery| battery.lifetime_s(26.36e-6) / (365.0 * DAY_S);
    let plain = battery(2500.0, DischargeConfig::Linear, None);
    assert_close(years(&plain), 10.83, 0.005);
    let leaking = battery(2500.0, DischargeConfig::Linear, Some(0.02));
    assert_close(years(&leaking), 9.79, 0.005);
    // Always listening: CC2420 and nRF52840.
    assert_close(plain.lifetime_s(18.8e-3) / DAY_S, 5.54, 0.005);
    assert_close(plain.lifetime_s(6.53e-3) / DAY_S, 15.95, 0.005);
    assert!(plain.lifetime_s(0.0).is_infinite());
}

#[test]
fn steps_of_any_length_end_where_the_closed_form_does() {
    for battery in [
        battery(100.0, DischargeConfig::Linear, Some(0.5)),
        battery(100.0, DischargeConfig::Peukert(PeukertConfig { rated_h: 20.0, exponent: 1.3 }), None),
        kibam(),
    ] {
        let power_w = 0.25;
        let lifetime_s = battery.lifetime_s(power_w);
        let mut charge = battery.full();
        let steps = 1000;
        for step in 0..steps {
            assert!(!charge.is_empty(), "{battery:?}: step {step}");
            // It cannot be empty sooner than promised, and the promise is kept at the end.
            let left_s = lifetime_s * f64::from(steps - step) / f64::from(steps);
            assert!(battery.lasts_at_least_s(&charge, power_w) <= left_s + 1e-4);
            let span = Duration::from_secs_f64(lifetime_s / f64::from(steps));
            battery.draw(&mut charge, power_w * span.as_secs_f64(), span);
        }
        assert!(charge.left_c() >= -1e-6 * battery.capacity_c());
        let mut late = charge;
        battery.draw(&mut late, power_w * 0.1, Duration::from_millis(100));
        assert!(late.is_empty(), "{battery:?}");
    }
}

#[test]
fn the_law_of_peukert_takes_more_above_the_rated_current_and_never_gives_more() {
    let battery = battery(2500.0, DischargeConfig::Peukert(PeukertConfig { rated_h: 20.0, exponent: 1.2 }), None);
    let hours = |current_a| battery.lifetime_s(current_a) / 3600.0;
    assert_close(hours(0.2), 11.379, 0.0005);
    // At and below 125 mA it is linear: the law alone would promise 180.3 h and 2858 h.
    assert_close(hours(0.125), 20.0, 1e-9);
    assert_close(hours(0.020), 125.0, 1e-9);
    assert_close(hours(0.002), 1250.0, 1e-9);
}

/// The lifetimes of Jongerden and Haverkort (DSN 2009).
#[test]
fn the_kinetic_model_lasts_as_long_as_published() {
    let battery = kibam();
    for (currents_ma, expected_min) in [
        (&[250.0][..], 4.53),
        (&[500.0], 2.02),
        (&[500.0, 250.0], 2.58),
        (&[250.0, 0.0], 10.80),
        (&[500.0, 0.0], 4.30),
        (&[500.0, 0.0, 250.0, 0.0], 4.80),
        (&[250.0, 0.0, 0.0], 21.86),
        (&[500.0, 0.0, 0.0], 6.53),
    ] {
        let currents_a: Vec<f64> = currents_ma.iter().map(|ma| ma * 1e-3).collect();
        assert_close(lifetime_min(&battery, &currents_a), expected_min, 0.006);
    }
    for (current_ma, delivered) in [(250.0, 1.1315), (100.0, 1.8258), (10.0, 5.0882), (1.0, 5.4588)] {
        let minutes = battery.lifetime_s(1e-3 * current_ma) / 60.0;
        assert_close(minutes * 1e-3 * current_ma, delivered, 0.00006);
    }
}

/// Nothing is lost in the kinetic model: both wells together lose what the load gets.
#[test]
fn the_kinetic_model_keeps_its_charge_and_recovers_in_a_rest() {
    let battery = kibam();
    let mut charge = battery.full();
    battery.draw(&mut charge, 0.5 * 60.0, Duration::from_secs(60));
    assert_close(battery.capacity_c() - charge.left_c(), 30.0, 1e-9);
    let before = charge.available_c();
    battery.draw(&mut charge, 0.0, Duration::from_secs(60));
    assert!(charge.available_c() > before + 1.0, "{charge:?}");
    assert_close(battery.capacity_c() - charge.left_c(), 30.0, 1e-9);
}

#[test]
fn cells_have_capacities_and_given_numbers_go_first() {
    let of = |cell| BatterySettings { cell: Some(cell), ..BatterySettings::default() };
    let made = |settings| Battery::try_from(settings).expect("a good battery");
    for (cell, joules) in
        [(Cell::AaAlkalinePair, 27_000.0), (Cell::Cr2032, 2430.0), (Cell::AaLithiumThionyl, 31_104.0)]
    {
        assert_close(made(of(cell)).capacity_j(), joules, 1e-6);
    }
    let own = Capacity { capacity_mah: None, capacity_j: Some(18_720.0) };
    assert_close(made(BatterySettings { capacity: own, ..of(Cell::Cr2032) }).capacity_j(), 18_720.0, 1e-9);
    let days = |settings| made(settings).lifetime_s(1e-3) / DAY_S;
    let leaking = BatterySettings { self_discharge_per_year: Some(0.2), ..of(Cell::Cr2032) };
    assert!(days(leaking) < days(of(Cell::Cr2032)));
}

#[test]
fn invalid_batteries_are_refused_with_their_key() {
    let capacity = Capacity { capacity_mah: Some(100.0), capacity_j: None };
    let good = BatterySettings { capacity, ..BatterySettings::default() };
    let key =
        |settings: BatterySettings| Battery::try_from(settings).map_or_else(|error| error.key, |_| String::new());
    assert_eq!(key(good), "");
    assert_eq!(key(BatterySettings::default()), "capacity_mah");
    let both = Capacity { capacity_mah: Some(100.0), capacity_j: Some(1.0) };
    assert_eq!(key(BatterySettings { capacity: both, ..good }), "capacity_j");
    let none = Capacity { capacity_mah: Some(0.0), capacity_j: None };
    assert_eq!(key(BatterySettings { capacity: none, ..good }), "capacity_mah");
    assert_eq!(key(BatterySettings { voltage_v: Some(-3.0), ..good }), "voltage_v");
    assert_eq!(key(BatterySettings { self_discharge_per_year: Some(1.0), ..good }), "self_discharge_per_year");
    let peukert = |rated_h, exponent| DischargeConfig::Peukert(PeukertConfig { rated_h, exponent });
    assert_eq!(key(BatterySettings { model: peukert(0.0, 1.2), ..good }), "model.peukert.rated_h");
    assert_eq!(key(BatterySettings { model: peukert(20.0, 0.9), ..good }), "model.peukert.exponent");
    let kibam = |available_share, rate_per_min| DischargeConfig::Kibam(KibamConfig { available_share, rate_per_min });
    assert_eq!(key(BatterySettings { model: kibam(1.0, 0.1), ..good }), "model.kibam.available_share");
    assert_eq!(key(BatterySettings { model: kibam(0.2, f64::NAN), ..good }), "model.kibam.rate_per_min");
    let leaking = BatterySettings { self_discharge_per_year: Some(0.01), model: kibam(0.2, 0.1), ..good };
    assert_eq!(key(leaking), "self_discharge_per_year");
}
