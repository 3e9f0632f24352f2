//! Ways to write a log that leave what it says as it is.

use sextant_channel::{Position, Reception, ReceptionLog, Stop};
use sextant_kernel::{NodeId, Purpose, Seed, SimTime};

/// A way to write a log differently.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Change {
    Shift,
    Turn37,
    Turn90,
    Mirror,
    SwapXY,
    OtherOrderOfStops,
    OtherOrderOfNodes,
    NewNames,
    SilentFarStop,
    UnheardNode,
    /// Coordinates that were written as latitude and longitude with nine digits.
    FromDegrees,
    /// A shift, a turn, a mirror image, another order of all, new names, a silent far stop and an unheard node.
    AllAtOnce,
}

/// A log that is written differently.
pub(super) struct Changed {
    pub(super) log: ReceptionLog,
    /// Where a place of the log lies.
    pub(super) place: fn(Position) -> Position,
    /// The number of each node of the log.
    pub(super) node_of: Vec<usize>,
}

/// Turned by an angle (degrees).
fn turned(place: Position, angle_deg: f64) -> Position {
    let (sin, cos) = angle_deg.to_radians().sin_cos();
    Position::new(cos * place.x_m - sin * place.y_m, sin * place.x_m + cos * place.y_m, place.z_m)
}

/// Rounded to latitudes and longitudes of 10⁻⁹ degrees.
fn from_degrees(place: Position) -> Position {
    let round = |along_m: f64| {
        let degrees_m = 111_194.926_6;
        (along_m / degrees_m * 1e9).round() * 1e-9 * degrees_m
    };
    Position::new(round(place.x_m), round(place.y_m), place.z_m)
}

impl Change {
    pub(super) const ALL: [Self; 12] = [
        Self::Shift,
        Self::Turn37,
        Self::Turn90,
        Self::Mirror,
        Self::SwapXY,
        Self::OtherOrderOfStops,
        Self::OtherOrderOfNodes,
        Self::NewNames,
        Self::SilentFarStop,
        Self::UnheardNode,
        Self::FromDegrees,
        Self::AllAtOnce,
    ];

    fn place(self) -> fn(Position) -> Position {
        match self {
            Self::Shift => |place| place + Position::new(1234.5, -987.25, 0.0),
            Self::Turn37 => |place| turned(place, 37.0),
            Self::Turn90 => |place| Position::new(-place.y_m, place.x_m, place.z_m),
            Self::Mirror => |place| Position { x_m: -place.x_m, ..place },
            Self::SwapXY => |place| Position::new(place.y_m, place.x_m, place.z_m),
            Self::FromDegrees => from_degrees,
            Self::AllAtOnce => {
                |place| turned(Position { x_m: -place.x_m, ..place }, 127.0) + Position::new(-31.7, 250.0, 0.0)
            }
            Self::OtherOrderOfStops
            | Self::OtherOrderOfNodes
            | Self::NewNames
            | Self::SilentFarStop
            | Self::UnheardNode => |place| place,
        }
    }

    fn is(self, one: Self) -> bool {
        self == one || self == Self::AllAtOnce && one != Self::FromDegrees
    }

    /// `log`, written so.
    pub(super) fn of(self, log: &ReceptionLog) -> Changed {
        let place = self.place();
        let stop_of = order(log.stops().len(), self.is(Self::OtherOrderOfStops), 1);
        let node_of = order(log.node_count(), self.is(Self::OtherOrderOfNodes), 2);
        let mut stops: Vec<Option<Stop>> = vec![None; stop_of.len()];
        for (number, stop) in log.stops().iter().enumerate() {
            // The path is told by the time.
            let time = SimTime::from_nanos(1_000_000_000 * number as u64);
            stops[stop_of[number]] = Some(Stop { position: place(stop.position), time, ..*stop });
        }
        let mut stops: Vec<Stop> = stops.into_iter().flatten().collect();
        if self.is(Self::SilentFarStop) {
            let position = place(far(log));
            let time = SimTime::from_nanos(1_000_000_000 * stops.len() as u64);
            stops.push(Stop { time, ..Stop::at(position) });
        }
        let mut names: Vec<String> = vec![String::new(); node_of.len()];
        for (number, name) in log.names().iter().enumerate() {
            names[node_of[number]] =
                if self.is(Self::NewNames) { format!("z{:04}", 7 * number) } else { name.clone() };
        }
        if self.is(Self::UnheardNode) {
            names.push("unheard".to_owned());
        }
        let unheard =
            self.is(Self::UnheardNode).then(|| (0..).take(stops.len()).map(|stop| silent(log.node_count(), stop)));
        let moved = log.receptions().iter().map(|reception| Reception {
            node: NodeId::from_index(node_of[reception.node.index()]),
            stop: u32::try_from(stop_of[reception.stop as usize]).expect("few stops"),
            ..reception
        });
        let receptions = moved.chain(unheard.into_iter().flatten()).collect();
        let log = ReceptionLog::new(names, stops, receptions, log.contacts().to_vec()).expect("a log");
        Changed { log, place, node_of }
    }
}

fn silent(node: usize, stop: u32) -> Reception {
    let node = NodeId::from_index(node);
    Reception::heard(node, stop, 0, 3)
}

/// A place 20 extents away from the stops.
fn far(log: &ReceptionLog) -> Position {
    let first = log.stops()[0].position;
    let extent_m = log.stops().iter().map(|stop| stop.position.distance_m(first)).fold(0.0, f64::max);
    first + Position::new(20.0 * extent_m, 3.0 * extent_m, 0.0)
}

/// New numbers, in another order if that is wanted.
fn order(count: usize, is_other: bool, what: u64) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    if is_other {
        let key = |number: usize| Seed(what).uniform(Purpose::new(3), [number as u64, what, 0]);
        order.sort_by(|&a, &b| key(a).total_cmp(&key(b)));
    }
    order
}
