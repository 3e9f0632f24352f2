//! Nodes and a sink whose links are written in a table.

use std::path::Path;

use sextant::Scenario;

/// Nodes `n0`, `n1`, .. and a sink, with the tables `rest`. With `links`, each of which receives a share of the frames from one
/// station to another, there are no others.
pub(crate) fn network(folder: &Path, nodes: usize, links: Option<&[(&str, &str, f64)]>, rest: &str) -> Scenario {
    let places: Vec<String> = (0..nodes).map(|node| format!("[{node}.0, 1.0]")).collect();
    let mut trace = "";
    if let Some(links) = links {
        let rows: String = links.iter().map(|(from, to, share)| format!("0,{from},{to},{share}\n")).collect();
        std::fs::write(folder.join("links.csv"), format!("t_s,from,to,prr\n{rows}")).expect("a file");
        trace = "link_trace.file = \"links.csv\"";
    }
    let text = format!(
        r#"
name = "linked"
{trace}
world.nodes.explicit.positions_m = [{}]
reception.overlap = {{}}
radio.tx_power_dbm = 0.0
radio.sensitivity_dbm = -90.0
{rest}
[[sinks]]
name = "sink"
position_m = [-1.0, 0.0]
"#,
        places.join(", ")
    );
    std::fs::write(folder.join("scenario.toml"), text).expect("a file");
    Scenario::load(folder.join("scenario.toml")).expect("a scenario")
}

/// A chain from `n0` to the sink with so many hops, each of which receives these shares of the frames up and down.
pub(crate) fn chain(folder: &Path, hops: usize, [up, down]: [f64; 2], rest: &str) -> Scenario {
    let names: Vec<String> = (0..hops).map(|node| format!("n{node}")).chain(["sink".to_owned()]).collect();
    let pairs = names.windows(2);
    let links: Vec<_> = pairs.flat_map(|pair| [(&*pair[0], &*pair[1], up), (&*pair[1], &*pair[0], down)]).collect();
    network(folder, hops, Some(&links), rest)
}
