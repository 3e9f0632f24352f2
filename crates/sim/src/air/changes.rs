//! What changes links in time and over fractions of a wavelength: fading, bursts of loss, bodies in the way, and links as they
//! were measured.

use sextant_channel::{
    Bursts, ChannelLaw, Db, Dbm, Fading, FadingBand, FadingEnd, LinkState, LinkTrace, Position, Traced,
};
use sextant_kernel::{Seed, SimTime, StationId};

use super::listener::Listener;
use super::screens::Screens;
use super::signal::Signal;

/// What changes the links of one band.
pub(crate) struct Changes {
    fading: Option<Fading>,
    bursts: Option<Bursts>,
    trace: Option<LinkTrace>,
    screens: Option<Screens>,
    /// Number of stations; other sources are noise, which no trace knows.
    stations: usize,
}

/// The links that change: those between so many stations, with draws from a seed.
pub(crate) struct Links {
    /// That of all bands.
    pub(crate) seed: Seed,
    pub(crate) stations: usize,
    /// The links as they were measured, ...
    pub(crate) trace: Option<LinkTrace>,
    /// ... and the bodies that hide them.
    pub(crate) screens: Option<Screens>,
}

impl Changes {
    /// What changes the links of a radio channel; `None` if nothing does.
    pub(crate) fn of(law: &ChannelLaw, band: FadingBand, links: Links) -> Option<Self> {
        let Links { seed, stations, trace, screens } = links;
        let fading = law.fading().map(|&law| Fading::new(law, band, seed));
        let bursts = law.bursts().map(|&law| Bursts::new(law, seed));
        let changes = fading.is_some() || bursts.is_some() || trace.is_some() || screens.is_some();
        changes.then_some(Self { fading, bursts, trace, screens, stations })
    }

    /// The bodies that hide links, if any does.
    pub(super) fn screens(&self) -> Option<&Screens> {
        self.screens.as_ref()
    }

    /// The same, to move them.
    pub(super) fn screens_mut(&mut self) -> Option<&mut Screens> {
        self.screens.as_mut()
    }

    /// Whether links are as they were measured.
    pub(super) fn has_trace(&self) -> bool {
        self.trace.is_some()
    }

    /// What was measured on the link of a signal.
    pub(super) fn traced(&self, signal: &Signal, station: StationId) -> Traced {
        match &self.trace {
            Some(trace) if signal.source.index() < self.stations => trace.at(signal.source, station, signal.start),
            Some(_) | None => Traced::Law,
        }
    }

    /// The strength of a link that was measured; `None` if nothing is heard over it.
    pub(super) fn strength(&self, traced: Traced) -> Option<Dbm> {
        match traced {
            Traced::Measured(link) => self.trace.as_ref()?.strength(link),
            Traced::Silent | Traced::Law => None,
        }
    }

    /// Gain at the start of a signal, by fading and bursts.
    pub(super) fn gain(&mut self, signal: &Signal, listener: &Listener<Position>) -> Db {
        self.fade(signal, listener) + self.burst_gain(signal.source, listener.station, signal.start)
    }

    /// Gain by fading alone.
    pub(super) fn fade(&mut self, signal: &Signal, listener: &Listener<Position>) -> Db {
        let Some(fading) = &mut self.fading else { return Db(0.0) };
        let sender = FadingEnd { station: signal.source, place: signal.position };
        fading.gain(sender, FadingEnd { station: listener.station, place: listener.place }, signal.start)
    }

    /// Whether fading is the same at all times between stations that stand.
    pub(super) fn fades_for_good(&self) -> bool {
        self.fading.as_ref().is_some_and(|fading| !fading.law().changes_in_time())
    }

    fn burst_gain(&self, from: StationId, to: StationId, now: SimTime) -> Db {
        match &self.bursts {
            Some(bursts) if bursts.state(from, to, now) == LinkState::Bad => Db(0.0) - bursts.law().bad_loss(),
            Some(_) | None => Db(0.0),
        }
    }

    /// Share of the frames that begin at `now` and are received otherwise that arrive over a link.
    pub(super) fn success(&self, from: StationId, to: StationId, now: SimTime) -> f64 {
        let traced = self.trace.as_ref().map_or(Traced::Law, |trace| trace.at(from, to, now));
        match (traced, &self.bursts) {
            (Traced::Measured(link), _) => link.share.unwrap_or(1.0),
            (Traced::Silent | Traced::Law, Some(bursts)) => bursts.law().success(bursts.state(from, to, now)),
            (Traced::Silent | Traced::Law, None) => 1.0,
        }
    }
}
