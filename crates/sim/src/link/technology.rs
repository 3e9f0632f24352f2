//! The technologies of links.

use std::ops::Range;
use std::time::Duration;

use sextant_channel::{Db, Dbm};
use sextant_kernel::{Files, SimTime, StationId};
use sextant_mac::{MessageEnergy, RadioStates};

use super::antennas::Antennas;
use super::books::Books;
use super::capture::FrameFormat;
use super::config::{LinkConfig, LinkError, MacConfig};
use super::ieee80211ad::{self, Ieee80211ad};
use super::ieee802154::{self, Ieee802154};
use super::links::{Cut, NetworkLinks};
use super::programmed::{self, Programmed};
use super::settings::{KnownTree, LinkSettings, Placement};
use super::sleeping::{self, Sleeping};
use super::transmitter::Transmitter;
use super::tsch::{self, Tsch};
use crate::event::link::LinkEvent;
use crate::observer::Observer;
use crate::scene::Scene;
use crate::service::due_frames::DueFrames;
use crate::service::packets::Packets;
use crate::service::report::{Destination, FrameId, Payload, SendError};
use crate::service::sweep::{SweepAnswer, SweepError, SweepKind};
use crate::world::layout::PlacedNode;

/// Makes the enums of all technologies: of their settings, and of the links of a network. Each technology is
/// one line: the channel access of a scenario that chooses it, its name, its settings, its folder.
macro_rules! technologies {
    ($d:tt $($(#[$doc:meta])+ $mac:pat => $name:ident($settings:ty) in $folder:ident;)+) => {
        /// The technology of the links of a network, with its settings.
        #[derive(Clone, Debug)]
        pub enum Technology {
            $($(#[$doc])+ $name($settings),)+
        }

        /// The links of a network, of any technology.
        pub(crate) enum Links {
            $($(#[$doc])+ $name($folder::Links),)+
        }

        /// Asks the links of whatever technology: no call is indirect.
        macro_rules! ask {
            ($d links:expr, $d of:ident => $d question:expr) => {
                match $d links { $(Links::$name($d of) => $d question,)+ }
            };
        }

        impl Technology {
            /// The technology that a scenario describes, with the antenna files in `folder`. Groups of nodes are looked up in
            /// `nodes`; they are not part of it if the nodes are not known.
            ///
            /// # Errors
            /// All that is wrong with its tables.
            pub fn read(config: &LinkConfig<'_>, nodes: Option<&[PlacedNode]>, files: &Files) -> Result<Self, Vec<LinkError>> {
                match config.mac {
                    $($mac => <$folder::Settings>::read(config, nodes, files).map(|settings| Self::$name(settings.into())),)+
                }
            }

            /// The links of all stations of `scene`.
            pub(crate) fn links(&self, placement: Placement, scene: &mut Scene) -> Links {
                match self {
                    $(Self::$name(settings) => Links::$name($folder::Links::new(settings, placement, scene)),)+
                }
            }

            pub(crate) fn settings(&self) -> &dyn LinkSettings {
                match self {
                    $(Self::$name(settings) => { let settings: &$folder::Settings = settings; settings })+
                }
            }

            pub(crate) fn settings_mut(&mut self) -> &mut dyn LinkSettings {
                match self {
                    $(Self::$name(settings) => { let settings: &mut $folder::Settings = settings; settings })+
                }
            }
        }

        impl Links {
            /// Handles an event of a station's link.
            #[inline]
            pub(crate) fn handle(&mut self, station: StationId, event: LinkEvent, scene: &mut Scene, observer: &mut impl Observer) {
                match (self, event) {
                    $((Self::$name(links), LinkEvent::$name(event)) => links.handle(station, event, scene, observer),)+
                    _ => unreachable!("a network has events of its own technology"),
                }
            }

            /// Whether an event is the end of the frame that a station has on air.
            pub(crate) fn ends_frame(&self, station: StationId, event: LinkEvent) -> bool {
                match (self, event) {
                    $((Self::$name(links), LinkEvent::$name(event)) => links.ends_frame(station, event),)+
                    _ => unreachable!("a network has events of its own technology"),
                }
            }
        }
    };
}

technologies! {$
    /// IEEE 802.15.4.
    MacConfig::CsmaUnslotted(_) | MacConfig::BeaconEnabled(_) => Ieee802154(Ieee802154) in ieee802154;
    /// Radios of IEEE 802.15.4 that programs command.
    MacConfig::Program(_) => Programmed(Programmed) in programmed;
    /// IEEE 802.15.4 with time-slotted channel hopping.
    MacConfig::Tsch(_) => Tsch(Box<Tsch>) in tsch;
    /// IEEE 802.15.4 whose stations sleep between checks of the channel.
    MacConfig::Sleep(_) => Sleeping(Box<Sleeping>) in sleeping;
    /// Sector sweeps of IEEE 802.11ad.
    MacConfig::SectorSweep(_) => Ieee80211ad(Box<Ieee80211ad>) in ieee80211ad;
}

impl Technology {
    /// The settings of IEEE 802.15.4, if that is the technology.
    #[must_use]
    pub fn ieee802154(&self) -> Option<&Ieee802154> {
        if let Self::Ieee802154(settings) = self { Some(settings) } else { None }
    }

    /// Whether programs command the radios.
    #[must_use]
    pub fn is_programmed(&self) -> bool {
        matches!(self, Self::Programmed(_))
    }

    /// Whether stations send and listen in slots, on one channel after the other.
    #[must_use]
    pub fn has_slots(&self) -> bool {
        matches!(self, Self::Tsch(_))
    }

    /// Whether stations agree with each other on when they send.
    #[must_use]
    pub fn has_negotiated_cells(&self) -> bool {
        matches!(self, Self::Tsch(links) if links.tsch.msf().is_some())
    }

    /// The settings of stations that sleep between checks of the channel, if that is the technology.
    #[must_use]
    pub fn sleeping(&self) -> Option<&Sleeping> {
        if let Self::Sleeping(settings) = self { Some(settings) } else { None }
    }

    /// Along which tree packets go. Called before a simulation is set up.
    pub fn know_tree(&mut self, tree: &KnownTree) {
        self.settings_mut().know_tree(tree);
    }

    /// Transmit power, without antennas; but for groups of nodes.
    #[must_use]
    pub fn tx_power(&self) -> Dbm {
        self.settings().radio().tx_power()
    }

    /// The frequency whose wavelength is that of fades in space (Hz): the same for all radio channels of a band.
    #[must_use]
    pub fn reference_hz(&self) -> f64 {
        let settings = self.settings();
        settings.radio().fading_band(settings.spectrum().channel).reference_hz
    }

    /// Minimum power of a frame that can be received; but for groups of nodes.
    #[must_use]
    pub fn sensitivity(&self) -> Dbm {
        self.settings().radio().sensitivity()
    }

    /// The antennas with sectors, which sweep them; `None` if all antennas are omnidirectional.
    #[must_use]
    pub fn antennas(&self) -> Option<&Antennas> {
        self.settings().antennas()
    }

    /// Gain of both antennas of a link together where the best sector points along it, in the weaker direction of a sweep.
    #[must_use]
    pub fn link_gain(&self) -> Db {
        self.settings().link_gain()
    }

    /// Whether nodes wait for the beacons of a coordinator before they send.
    #[must_use]
    pub fn has_coordinator(&self) -> bool {
        self.settings().has_coordinator()
    }

    /// How its frames are written into a capture.
    #[must_use]
    pub fn frame_format(&self) -> FrameFormat {
        self.settings().radio().frame_format()
    }

    /// Size of the frame to all that carries a payload of this size (octets).
    #[must_use]
    pub fn frame_octets(&self, payload_octets: u16) -> u16 {
        self.settings().radio().frame_octets(payload_octets)
    }

    /// Time on air of a frame of this size (octets); `None` if no frame is so long.
    #[must_use]
    pub fn airtime(&self, frame_octets: u16) -> Option<Duration> {
        self.settings().radio().airtime(frame_octets)
    }

    /// Power at or above which carrier sense finds the channel busy; but for groups of nodes.
    #[must_use]
    pub fn carrier_sense_threshold(&self) -> Dbm {
        self.settings().radio().busy_from(None)
    }

    /// Probability that a robot receives a frame of this size (octets) that arrives with `power`, undisturbed.
    #[must_use]
    pub fn reception_probability(&self, power: Dbm, frame_octets: u16) -> f64 {
        let (rules, airtime) =
            (self.settings().radio().reception_rules(), self.settings().radio().airtime(frame_octets));
        let airtime = airtime.unwrap_or_default();
        rules.first().map_or(0.0, |rules| rules.reception_alone(power.to_milliwatts(), airtime))
    }

    /// Energy to send and to receive a frame of this size (octets); `None` if no frame is so long.
    #[must_use]
    pub fn frame_energy(&self, states: &RadioStates, frame_octets: u16) -> Option<MessageEnergy> {
        let airtime = self.settings().radio().airtime(frame_octets)?;
        Some(MessageEnergy::of_airtime(states, self.tx_power(), airtime))
    }
}

impl Links {
    /// The radios, if programs command them.
    pub(crate) fn programmed(&mut self) -> Option<&mut programmed::Links> {
        if let Self::Programmed(links) = self { Some(links) } else { None }
    }
}

/// A question of [`NetworkLinks`], to the links of whatever technology.
macro_rules! question {
    (@[$($receiver:tt)+] $this:ident $question:ident($($argument:ident: $type:ty),*) $(-> $answer:ty)?) => {
        #[inline]
        pub(crate) fn $question($($receiver)+ $(, $argument: $type)*) $(-> $answer)? {
            ask!($this, links => links.$question($($argument),*))
        }
    };
    ($question:ident(&mut $this:ident $(, $($arguments:tt)+)?) $($answer:tt)*) => {
        question!(@[&mut $this] $this $question($($($arguments)+)?) $($answer)*);
    };
    ($question:ident(&$this:ident $(, $($arguments:tt)+)?) $($answer:tt)*) => {
        question!(@[&$this] $this $question($($($arguments)+)?) $($answer)*);
    };
    ($question:ident($this:ident $(, $($arguments:tt)+)?) $($answer:tt)*) => {
        question!(@[$this] $this $question($($($arguments)+)?) $($answer)*);
    };
}

impl Links {
    question!(trace(&mut self));
    question!(leave_pending(&mut self, scene: &mut Scene));
    question!(begin(&mut self, station: StationId, scene: &mut Scene));
    question!(begin_schedule(&mut self, scene: &mut Scene));
    question!(catch_up(&mut self, cut: Cut, scene: &mut Scene) -> SimTime);
    question!(count_from(&mut self, instant: SimTime));
    question!(restart_meters(&mut self, now: SimTime));
    question!(offer(&mut self, station: StationId, to: Destination, payload: Payload<'_>, scene: &mut Scene) -> Result<FrameId, SendError>);
    question!(skip(&mut self, station: StationId, frames: u64));
    question!(take_time_from(&mut self, station: StationId, parent: StationId));
    question!(follow(&mut self, station: StationId, parent: Option<StationId>, scene: &mut Scene));
    question!(note_due(&mut self, station: StationId, due: DueFrames));
    question!(sweeps_sectors(&self) -> bool);
    question!(turns_antennas(&self) -> bool);
    question!(sectors(&self, station: StationId) -> Option<u8>);
    question!(transmitter(&self, station: StationId) -> Option<Transmitter>);
    question!(sweep(&mut self, station: StationId, kind: SweepKind, scene: &mut Scene) -> Result<(), SweepError>);
    question!(take_answers(&mut self, station: StationId) -> Vec<SweepAnswer>);
    question!(listen(&mut self, station: StationId, span: Duration, scene: &mut Scene));
    question!(metered_j(&mut self, station: StationId, scene: &mut Scene) -> f64);
    question!(die(&mut self, station: StationId, scene: &mut Scene));
    question!(moves(&self, station: StationId, scene: &mut Scene));
    question!(take_payload(&mut self) -> (Vec<u8>, Range<usize>));
    question!(give_back(&mut self, frame: Vec<u8>));
    question!(packets(&self) -> &[Packets]);
    question!(finish(self, now: SimTime) -> Books);
}
