//! Links that change in time: what `check` and `explain-link` say of them.

use crate::two_nodes::told_in;

fn told(more: &str, words: &[&str]) -> (Option<i32>, String) {
    told_in(tempfile::tempdir().expect("there is room").path(), more, words)
}

#[test]
fn wrong_values_are_refused_with_what_is_allowed() {
    for (more, message) in [
        ("[channel.fading]\nlaw.rician.k_db = 40.0\n", "`channel.fading.law.rician.k_db` is 40; allowed: -20 to 25"),
        ("[channel.fading]\nlaw.nakagami.m = 0.7\n", "is 0.7; allowed: a multiple of 0.5 from 0.5 to 20"),
        ("[channel.fading]\ndoppler_hz = -1.0\n", "`channel.fading.doppler_hz` is -1; allowed: 0 to"),
        ("[channel.fading]\ndelay_spread_ns = -1.0\n", "`channel.fading.delay_spread_ns` is -1; allowed: 0 to"),
        ("[channel.fading]\nblock_s = 0.0\n", "`channel.fading.block_s` is 0; allowed:"),
        ("[channel.fading]\nblock_s = 1.0\ndoppler_hz = 1.0\n", "keep one of the two"),
        ("[channel.fading]\nlaw = \"rice\"\n", "choices: `rayleigh`, `rician`, `nakagami`"),
        ("[channel.bursts]\ngood_s = 1.0\nbad_s = 0.0\nbad_loss_db = 3.0\n", "`channel.bursts.bad_s` is 0; allowed:"),
        ("[channel.bursts]\ngood_s = 1.0\nbad_s = 1.0\n", "`channel.bursts.bad_loss_db` is missing"),
        (
            "[channel.bursts]\ngood_s = 1.0\nbad_s = 1.0\nbad_success = 2.0\n",
            "`channel.bursts.bad_success` is 2; allowed: 0 to 1",
        ),
        ("[link_trace]\nfile = \"none.csv\"\n", "a text file that can be read"),
    ] {
        let (code, text) = told(more, &["check", "a.toml"]);
        assert_eq!(code, Some(2), "{more}: {text}");
        assert!(text.contains(message), "{more}: {text}");
    }
}

#[test]
fn a_file_of_measured_links_is_refused_at_its_line() {
    let folder = tempfile::tempdir().expect("there is room");
    std::fs::write(folder.path().join("links.csv"), "t_s,from,to,prr\n0,a,sink,1\n0,c,sink,1\n")
        .expect("there is room");
    let (code, text) = told_in(folder.path(), "[link_trace]\nfile = \"links.csv\"\n", &["check", "a.toml"]);
    assert_eq!(code, Some(2));
    assert!(text.contains("line 3: `c` in the column `from`; allowed: the name of a node or a sink"), "{text}");
}

#[test]
fn fading_that_is_too_fast_for_frames_and_robots_without_rows_are_warned_of() {
    let (code, text) = told("[channel.fading]\ndoppler_hz = 500.0\n", &["check", "a.toml"]);
    assert_eq!(code, Some(0), "{text}");
    assert!(
        text.contains("`channel.fading.doppler_hz`: frames last 0.83 ms, and links stay as they are for 0.20 ms"),
        "{text}"
    );
    let (_, text) = told("[channel.fading]\ndoppler_hz = 50.0\n", &["check", "a.toml"]);
    assert!(!text.contains("frames last"), "{text}");
    let folder = tempfile::tempdir().expect("there is room");
    std::fs::write(folder.path().join("links.csv"), "t_s,from,to,prr\n0,a,sink,1\n").expect("there is room");
    let robot = "[[robots]]\nname = \"rover\"\nstart_m = [1, 1]\n[robots.controller.waypoints]\nplaces_m = [[1, 1], [9, 1]]\n";
    let trace = "[link_trace]\nfile = \"links.csv\"\n";
    let (_, text) = told_in(folder.path(), &format!("{trace}{robot}"), &["check", "a.toml"]);
    assert!(text.contains("`link_trace.others`: measured links have no rows for robots"), "{text}");
    let (_, text) = told_in(folder.path(), &format!("{trace}others = \"law\"\n{robot}"), &["check", "a.toml"]);
    assert!(!text.contains("no rows for robots"), "{text}");
}

#[test]
fn a_link_says_what_fading_bursts_and_measurements_add() {
    let (_, text) = told("[channel.fading]\nlaw.rician.k_db = 6.0\n", &["explain-link", "a.toml", "a", "sink"]);
    assert!(
        text.contains("fading of this link") && text.contains("(Rician, K 6 dB) is that of the two places"),
        "{text}"
    );
    let bursts = "[channel.bursts]\ngood_s = 3.0\nbad_s = 1.0\nbad_loss_db = 9.0\nbad_success = 0.5\n";
    let (_, text) = told(bursts, &["explain-link", "a.toml", "a", "sink"]);
    assert!(
        text.contains("The link is bad for 25.0 % of the time, when it has 9 dB less power; 87.5 % of the frames"),
        "{text}"
    );
    let folder = tempfile::tempdir().expect("there is room");
    std::fs::write(folder.path().join("links.csv"), "t_s,from,to,prr,rssi_dbm\n0,a,sink,0.5,-80\n")
        .expect("there is room");
    let trace = "[link_trace]\nfile = \"links.csv\"\n";
    let (_, text) = told_in(folder.path(), trace, &["explain-link", "a.toml", "a", "sink"]);
    assert!(text.contains("measured instead 50.0 %, -80.0 dBm 0.0 %"), "{text}");
}
