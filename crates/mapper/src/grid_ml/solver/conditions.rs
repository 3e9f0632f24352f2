//! Conditions for a vertex to be in the sectors of several receptions.

/// A condition of one reception that is not a half-space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Residual {
    pub(super) place: [f64; 3],
    pub(super) kind: ResidualKind,
}

#[derive(Clone, Copy, Debug)]
pub(super) enum ResidualKind {
    Reflex([[f64; 2]; 2]),
    Cone([f64; 2]),
    /// The margin of this sector depends on the distance.
    Margin(u8),
}

impl Residual {
    /// Bounds of how far the places of a box are inside.
    pub(super) fn range(&self, low: [f64; 3], high: [f64; 3]) -> (f64, f64) {
        let near = [0, 1, 2].map(|axis| low[axis] - self.place[axis]);
        let far = [0, 1, 2].map(|axis| high[axis] - self.place[axis]);
        let product = |factor: f64, axis: usize| {
            let (a, b) = (factor * near[axis], factor * far[axis]);
            if a < b { (a, b) } else { (b, a) }
        };
        match self.kind {
            ResidualKind::Margin(_) => (f64::NEG_INFINITY, f64::INFINITY),
            ResidualKind::Reflex(edges) => {
                let [first, second] = edges.map(|[x, y]| {
                    let (along_x, along_y) = (product(x, 0), product(y, 1));
                    (along_x.0 + along_y.0, along_x.1 + along_y.1)
                });
                // One of the two suffices.
                (first.0.max(second.0), first.1.max(second.1))
            }
            ResidualKind::Cone([alpha, beta]) => {
                let (mut nearest, mut farthest) = (0.0, 0.0);
                for axis in 0..2 {
                    let outside = near[axis].max(-far[axis]).max(0.0);
                    let across = (-near[axis]).max(far[axis]);
                    nearest += outside * outside;
                    farthest += across * across;
                }
                let (a, b) = (alpha * nearest.sqrt(), alpha * farthest.sqrt());
                let rise = product(beta, 2);
                (a.min(b) + rise.0, a.max(b) + rise.1)
            }
        }
    }
}

/// A half-space: places whose product with the normal is at least a value.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plane {
    pub(crate) normal: [f64; 3],
    pub(crate) least: f64,
}

impl Plane {
    pub(crate) fn along(&self, place: [f64; 3]) -> f64 {
        self.normal[0] * place[0] + self.normal[1] * place[1] + self.normal[2] * place[2]
    }

    pub(crate) fn holds(&self, place: [f64; 3]) -> bool {
        self.along(place) >= self.least
    }

    /// Whether the half-space is almost parallel to a row.
    pub(crate) fn is_along_rows(&self) -> bool {
        self.normal[0].abs() < 1e-6
    }

    /// Cuts an interval of x to the half-space in the row through y and z; leaves it unchanged if the row is almost
    /// parallel to the edge, so that it never cuts off too much.
    pub(crate) fn cut(&self, y: f64, z: f64, low: &mut f64, high: &mut f64) {
        let [nx, ny, nz] = self.normal;
        let rest = self.least - ny * y - nz * z;
        if !self.is_along_rows() {
            let edge = rest / nx;
            if nx > 0.0 {
                *low = low.max(edge);
            } else {
                *high = high.min(edge);
            }
        } else if nx.abs() <= 0.0 && rest > 0.0 {
            *high = f64::NEG_INFINITY;
        }
    }

    /// Tightens a box to the part of it in the half-space, as far as a box can be.
    pub(crate) fn tighten(&self, low: &mut [f64; 3], high: &mut [f64; 3]) {
        let most = [0, 1, 2].map(|axis| (self.normal[axis] * low[axis]).max(self.normal[axis] * high[axis]));
        for axis in 0..3 {
            let n = self.normal[axis];
            if n.abs() > 1e-6 {
                let others = most[(axis + 1) % 3] + most[(axis + 2) % 3];
                let edge = (self.least - others) / n;
                if n > 0.0 {
                    low[axis] = low[axis].max(edge);
                } else {
                    high[axis] = high[axis].min(edge);
                }
            }
        }
    }
}
