//! The likelihood of one node at the vertices of its window.

use sextant_channel::Position;
use sextant_kernel::maths::{ln, ln_each};

use super::counts::CountedLink;
use super::model::{Logarithms, Model};
use super::window::VertexWindow;

/// Maximum number of packets whose probabilities are multiplied before a logarithm is taken. 10⁻⁶ to this power is
/// still a normal number.
const CHUNK: u32 = 40;

/// A likelihood at each vertex of a window: the exponential of a logarithm, times a product of probabilities.
#[derive(Debug, Default)]
pub(super) struct WindowLikelihood {
    logarithms: Vec<f64>,
    product: Vec<f64>,
    /// Packets in the product.
    packets: u32,
}

impl WindowLikelihood {
    /// Sets the number of vertices, and the likelihood of each to 1.
    pub(super) fn clear(&mut self, vertices: usize) {
        self.logarithms.clear();
        self.logarithms.resize(vertices, 0.0);
        self.product.clear();
        self.product.resize(vertices, 1.0);
        self.packets = 0;
    }

    /// Multiplies by the likelihood of the packets of a link. `probability` is that of a reception if the node is at
    /// a place.
    pub(super) fn add(&mut self, window: &VertexWindow, link: &CountedLink, probability: impl Fn(Position) -> f64) {
        let sent = link.sent();
        if self.packets.saturating_add(sent) > CHUNK {
            self.take_logarithms();
        }
        self.packets += sent.min(CHUNK);
        let Self { logarithms, product, .. } = self;
        // One loop for all cases: with one for each, `probability` is no longer inlined, and takes twice as long.
        window.each(|vertex, place| {
            let p = probability(place);
            match (link.received, link.missed) {
                (0, 1) => product[vertex] *= 1.0 - p,
                (1, 0) => product[vertex] *= p,
                (received, missed) if sent <= CHUNK => product[vertex] *= power(p, received) * power(1.0 - p, missed),
                (received, missed) => {
                    logarithms[vertex] += f64::from(received) * ln(p) + f64::from(missed) * ln(1.0 - p);
                }
            }
        });
    }

    /// The same for a clear link by tables of logarithms, which is faster for several packets.
    pub(super) fn add_logarithms(
        &mut self,
        window: &VertexWindow,
        link: &CountedLink,
        model: &Model,
        logarithms: &Logarithms,
    ) {
        let (received, missed) = (f64::from(link.received), f64::from(link.missed));
        let of_stop = logarithms.of_stop(link.stop as usize);
        window.each(|vertex, place| {
            let [ln_received, ln_missed] = of_stop[model.bin(place.distance_m(link.place))];
            self.logarithms[vertex] += received * ln_received + missed * ln_missed;
        });
    }

    /// Multiplies by a factor of each place, at least 10⁻⁶.
    pub(super) fn multiply(&mut self, window: &VertexWindow, factor: impl Fn(Position) -> f64) {
        if self.packets >= CHUNK {
            self.take_logarithms();
        }
        self.packets += 1;
        window.each(|vertex, place| self.product[vertex] *= factor(place));
    }

    /// Moves the product to the logarithms.
    pub(super) fn take_logarithms(&mut self) {
        ln_each(&mut self.product);
        for (sum, product) in self.logarithms.iter_mut().zip(&mut self.product) {
            *sum += *product;
            *product = 1.0;
        }
        self.packets = 0;
    }

    /// The log-likelihood at each vertex, once all logarithms are taken.
    pub(super) fn logarithms(&self) -> &[f64] {
        &self.logarithms
    }

    /// The first of the likeliest vertices, and its log-likelihood.
    pub(super) fn highest(&self) -> (usize, f64) {
        let mut best = (0, f64::NEG_INFINITY);
        for (vertex, &value) in self.logarithms.iter().enumerate() {
            if value > best.1 {
                best = (vertex, value);
            }
        }
        best
    }
}

/// `p` to the power `times`, at most [`CHUNK`].
fn power(p: f64, times: u32) -> f64 {
    p.powi(times.cast_signed())
}
