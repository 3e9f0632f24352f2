//! How viewers show a recording while it plays: a layout for Foxglove, and a script for Rerun.

mod foxglove;
mod rerun;

use sextant_channel::{Bounds, Position};
use sextant_recording::{Inspection, RecordedWorld};

/// Names of nodes are shown in worlds of at most this many nodes: more cannot be read.
const MOST_NAMES: usize = 300;
/// A world lower than this share of its width is seen from above.
const FLAT: f64 = 0.1;

/// What a layout is made of. The same recording gives the same layout.
#[derive(Clone, Copy, Debug)]
pub struct Layout<'a> {
    /// Name of the file of the recording, without its folder.
    pub file: &'a str,
    /// What is in the recording.
    pub inspection: &'a Inspection,
    /// What has a place in it.
    pub drawn: &'a RecordedWorld,
}

impl Layout<'_> {
    /// The topics with messages of `schema`, in the order of their names.
    fn topics<'b>(&'b self, schema: &'b str) -> impl Iterator<Item = &'b str> {
        let topics = self.inspection.topics.iter().filter(move |topic| topic.schema == schema);
        topics.map(|topic| topic.topic.as_str())
    }

    fn has(&self, topic: &str) -> bool {
        self.inspection.topics.iter().any(|other| other.topic == topic)
    }

    fn shows_names(&self) -> bool {
        self.drawn.nodes.len() <= MOST_NAMES
    }

    /// The map that is shown at first: the first one.
    fn first_map(&self) -> Option<String> {
        self.drawn.maps.first().map(|(name, _)| format!("/map/{name}"))
    }

    /// The box around everything that stands in the world (m).
    fn bounds(&self) -> Bounds {
        let drawn = self.drawn;
        let nodes = drawn.nodes.values().chain(drawn.sinks.values()).copied();
        let solids = drawn.obstacles.iter().flat_map(|solid| solid.vertices.iter().copied());
        let paths = drawn.paths.iter().flat_map(|(_, places)| places.iter().copied());
        Bounds::of(nodes.chain(solids).chain(paths))
            .unwrap_or(Bounds { min: Position::ORIGIN, max: Position::ORIGIN })
    }

    /// Whether it is seen best from above.
    fn is_flat(&self) -> bool {
        let Bounds { min, max } = self.bounds();
        let size = max - min;
        size.z_m <= FLAT * size.x_m.max(size.y_m)
    }
}
