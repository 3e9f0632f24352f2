//! The documents of tables: sweeps and reproductions.

use std::collections::BTreeMap;

use sextant_report::{Report, ReportError, SweepValues};

use super::{file, folder};

const SWEEP: &str = "cell,replicate,seed,a.kind,b.rate,map,error,mac.prr,other,mapped\n\
                     0,0,1,x,10,p,,0.5,,3\n0,0,1,x,10,q,,0.5,,4\n0,1,2,x,10,q,,0.7,,5\n1,0,1,y,2.5,,boom,,,\n";
const TABLE: &str = "what,published,unit,mean,half_width_95,runs,result,source\n\
                     ML-TM,5,%,6.5,0.25,10,,table 3.6\na < b,6 < 19,points,1.5,0.5,10,holds,table 3.6\n";

fn titles() -> BTreeMap<String, String> {
    [("3.6".to_owned(), "Comparison".to_owned())].into()
}

#[test]
fn columns_of_a_sweep_are_numbers_or_texts() {
    let folder = folder();
    let report = Report::of_table(&file(&folder, "t.csv", SWEEP), &titles()).expect("a table");
    let sweep = report.sweep.expect("a sweep");
    let names: Vec<_> = sweep.settings.iter().chain(&sweep.measures).map(|column| column.name.as_str()).collect();
    assert_eq!(names, ["a.kind", "b.rate", "mac.prr", "p.mapped", "q.mapped"], "empty measures are left out");
    let SweepValues::Numbers(mapped) = &sweep.measures[2].values else { panic!("numbers") };
    let mapped = mapped.to_vec();
    assert!(
        sweep.rows == 3 && mapped.len() == 3 && mapped[..2] == [4.0, 5.0] && mapped[2].is_nan(),
        "a row is a run"
    );
    assert!(matches!(&sweep.settings[0].values, SweepValues::Texts { words, .. } if words == &["x", "y"]));
    let SweepValues::Numbers(rates) = &sweep.settings[1].values else { panic!("numbers") };
    assert_eq!(rates.to_vec(), [10.0, 10.0, 2.5]);
    assert_eq!((sweep.failed, sweep.failure.as_deref(), sweep.across), (1, Some("boom"), Some(1)));
    assert_eq!(sweep.measures[0].label.as_deref(), Some("packet reception ratio"));
}

#[test]
fn intervals_use_the_quantiles_of_student() {
    let folder = folder();
    let report = Report::of_table(&file(&folder, "t.csv", SWEEP), &titles()).expect("a table");
    let quantiles = report.sweep.expect("a sweep").students_t_975.to_vec();
    // Tables of Student's t: 12.706 with one degree of freedom, 4.303 with two.
    assert!((quantiles[0] - 12.706).abs() < 1e-3 && (quantiles[1] - 4.303).abs() < 1e-3, "{quantiles:?}");
}

#[test]
fn a_folder_of_a_reproduction_is_read_in_the_order_of_its_numbers() {
    let folder = folder();
    file(&folder, "3.10.csv", TABLE);
    file(&folder, "3.6.csv", TABLE);
    file(&folder, "runs-smoke.csv", SWEEP);
    assert!(Report::is_reproduction(folder.path()));
    let report = Report::of_reproduction(folder.path(), &titles()).expect("tables");
    let experiments = report.reproduction.expect("a reproduction").experiments;
    let found: Vec<_> = experiments.iter().map(|claims| (claims.id.as_str(), claims.title.as_deref())).collect();
    assert_eq!(found, [("3.6", Some("Comparison")), ("3.10", None)]);
    assert_eq!(experiments[0].rows[1][6], "holds");
}

#[test]
fn another_table_is_refused_with_its_columns() {
    let folder = folder();
    let error = Report::of_table(&file(&folder, "t.csv", "a,b\n1,2\n"), &titles()).expect_err("another table");
    assert!(matches!(error, ReportError::NotATable { .. }));
    assert!(error.to_string().contains("its columns are a, b;"), "{error}");
    let error = Report::of_table(&folder.path().join("absent.csv"), &titles()).expect_err("no file");
    assert!(error.to_string().contains("cannot be read"), "{error}");
}
