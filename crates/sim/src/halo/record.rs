//! What was simulated.

/// What was simulated of the nodes' traffic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SimulatedPart {
    /// All, as asked for.
    All,
    /// All, though only what is near the listeners was asked for.
    AllBecause(AllSimulated),
    /// What is near the listeners.
    NearListeners {
        /// Radius of the halos (m).
        halo_m: f64,
    },
}

/// Why all nodes are simulated, though only those near the listeners were asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AllSimulated {
    /// Nobody listens.
    NoListener,
    /// Nodes have applications of their own, which answer what they hear.
    NodeApplications,
    /// Nodes are saturated: when a frame is due depends on all before it.
    Saturated,
    /// Nodes send in superframes, whose beacons they follow.
    Superframes,
    /// Nodes send nothing unless they are asked to, as in sector sweeps.
    OnlyAnswers,
    /// Sinks receive: the study is of all nodes, also of those that no sink hears.
    Sinks,
    /// Nodes wait for acknowledgements: who is not heard sends each frame again.
    Acknowledged,
    /// Nodes have batteries, which run empty sooner if they send more.
    Batteries,
    /// There are so few nodes that none need rest.
    FewNodes,
    /// All nodes are within a halo, wherever its listener is among them.
    AllWithin,
}

impl AllSimulated {
    /// The reason, in a few words that follow "because".
    #[must_use]
    pub fn reason(self) -> &'static str {
        match self {
            Self::NoListener => "nobody listens",
            Self::NodeApplications => "nodes have applications that answer what they hear",
            Self::Saturated => "nodes are saturated",
            Self::Superframes => "nodes follow the beacons of superframes",
            Self::OnlyAnswers => "nodes send only when they are asked",
            Self::Sinks => "sinks count the packets of all nodes",
            Self::Acknowledged => "nodes send frames again that nobody acknowledges",
            Self::Batteries => "nodes have batteries",
            Self::FewNodes => "there are few nodes",
            Self::AllWithin => "the halo covers all nodes",
        }
    }
}
