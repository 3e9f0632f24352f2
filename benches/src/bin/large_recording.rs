//! Writes the recording of a large survey, to see how much memory `sextant map` needs for it.
//!
//! Usage: `large_recording OUT.mcap [NODES]`, by default 35 000 nodes, of which 10⁷ receptions are recorded.

use sextant_benches::workload;
use sextant_recording::FileRecorder;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("usage: large_recording OUT.mcap [NODES]")?;
    let nodes = arguments.next().map_or(Ok(35_000), |nodes| nodes.parse())?;
    let workload = workload::field(nodes);
    let mut recorder = FileRecorder::create(path.as_ref())?;
    recorder.log(&workload.log)?;
    recorder.finish()?;
    eprintln!("{} receptions at {} stops", workload.log.receptions().len(), workload.log.stops().len());
    Ok(())
}
