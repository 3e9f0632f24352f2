//! Settings of ML-TM: valid ones have their effect, invalid ones are rejected.

use sextant_channel::{EvenSectorsConfig, LogError, Position, Reception, SectorConfig, SectorTable};
use sextant_kernel::Unwatched;
use sextant_mapper::{
    MapError, MlTm, MlTmConfig, ProfileConfig, SectorLayoutConfig, SectorTolerance, SectorsConfig, TrapezoidConfig,
};

use super::{entry, log, ml_tm};

#[test]
fn sectors_come_from_the_settings_or_from_the_log_and_must_be_known() {
    // Heard at two stops of a lane, each time to the left: the mirror image on the right is ruled out.
    let stops = [-1.0, 0.0, 1.0].map(|x| Position::new(x, 0.0, 0.0));
    let heard = |sector| [0, 2].map(|stop| Reception { sector: Some(sector), ..entry(0, stop, 1, 1) }).to_vec();
    let profile = ProfileConfig::Trapezoid(TrapezoidConfig::new(0.9, 0.5, 4.0));
    let even = EvenSectorsConfig { azimuth_sectors: 4, first_azimuth_deg: 0.0, elevations_deg: vec![[-90.0, 90.0]] };
    let layout = Some(SectorLayoutConfig::Even(even.clone()));
    let with = |sectors| ml_tm(MlTmConfig { sectors, ..MlTmConfig::new(0.25, profile.clone()) });
    let y_m = |map: sextant_mapper::TopologyMap| map.estimates[0].as_ref().map(|estimate| estimate.position.y_m);
    let (left, right) = (log(1, &stops, heard(1)), log(1, &stops, heard(3)));
    let by_settings = with(Some(SectorsConfig { layout: layout.clone(), ..SectorsConfig::default() }));
    let [on_left, on_right] = [&left, &right].map(|log| y_m(by_settings.map(log, &Unwatched).unwrap()).unwrap());
    assert!(on_left > 0.5 && on_right < -0.5, "{on_left}, {on_right}");
    let told = left.clone().with_sectors(SectorTable::try_from(even).unwrap()).unwrap();
    assert_eq!(with(None).map(&told, &Unwatched).unwrap(), by_settings.map(&left, &Unwatched).unwrap());
    // Without a table, or without limit, sectors say nothing.
    assert_eq!(with(None).map(&left, &Unwatched).unwrap(), with(None).map(&right, &Unwatched).unwrap());
    let unlimited =
        with(Some(SectorsConfig { tolerance: SectorTolerance::Unlimited, layout, ..SectorsConfig::default() }));
    assert_eq!(unlimited.map(&told, &Unwatched).unwrap(), with(None).map(&right, &Unwatched).unwrap());
    let error = by_settings.map(&log(1, &stops, heard(7)), &Unwatched).unwrap_err();
    assert!(matches!(error, MapError::Log(LogError::UnknownSector { sector: 7, stop: 0, .. })));
    let expected = "node `n0` at stop 0 was heard in sector 7; the listener's sectors are 0 to 3";
    assert_eq!(error.to_string(), expected);
    let list = vec![SectorConfig {
        sector: 0,
        azimuth_from_deg: 0.0,
        azimuth_to_deg: f64::NAN,
        elevation_from_deg: -90.0,
        elevation_to_deg: 90.0,
    }];
    let sectors = Some(SectorsConfig { layout: Some(SectorLayoutConfig::List(list)), ..SectorsConfig::default() });
    let error = MlTm::try_from(MlTmConfig { sectors, ..MlTmConfig::new(0.25, profile) }).unwrap_err();
    assert_eq!(error.key, "sectors.layout.list[0].azimuth_to_deg");
}

#[test]
fn invalid_settings_are_rejected_with_their_key() {
    let profile = ProfileConfig::Trapezoid(TrapezoidConfig::new(0.9, 1.0, 3.0));
    let good = MlTmConfig::new(0.25, profile);
    assert!(MlTm::try_from(good.clone()).is_ok());
    let bad_profile = ProfileConfig::Trapezoid(TrapezoidConfig::new(0.9, 4.0, 3.0));
    let bad = [
        (MlTmConfig { grid_step_m: 0.0, ..good.clone() }, "grid_step_m"),
        (MlTmConfig { grid_step_m: f64::NAN, ..good.clone() }, "grid_step_m"),
        (MlTmConfig { grid_step_m: 3.5, ..good.clone() }, "grid_step_m"),
        (MlTmConfig { profile: bad_profile, ..good.clone() }, "profile.trapezoid.plateau_m"),
        (MlTmConfig { z_range_m: Some([1.0, 0.0]), ..good.clone() }, "z_range_m"),
        (MlTmConfig { z_range_m: Some([0.0, f64::INFINITY]), ..good.clone() }, "z_range_m"),
        (MlTmConfig { max_memory_mb: Some(0), ..good.clone() }, "max_memory_mb"),
    ];
    for (config, key) in bad {
        assert_eq!(MlTm::try_from(config).unwrap_err().key, key);
    }
    let fine = MlTm::try_from(MlTmConfig { grid_step_m: 1e-5, ..good }).unwrap();
    let error = fine.map(&log(1, &[Position::ORIGIN], vec![entry(0, 0, 1, 1)]), &Unwatched).unwrap_err();
    assert!(matches!(error, MapError::GridTooLarge { .. }));
    assert!(error.to_string().contains("a grid_step_m of"), "{error}");
}
