//! What is in a battery.

/// What is in a battery (C).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Charge {
    available_c: f64,
    bound_c: f64,
}

impl Charge {
    pub(super) const fn new(available_c: f64, bound_c: f64) -> Self {
        Self { available_c, bound_c }
    }

    /// What a load can have at once (C): at or below zero if the battery is empty.
    pub(super) const fn available_c(&self) -> f64 {
        self.available_c
    }

    /// What becomes available with time (C); nothing but in the kinetic model.
    pub(super) const fn bound_c(&self) -> f64 {
        self.bound_c
    }

    /// All of it (C).
    #[must_use]
    pub fn left_c(&self) -> f64 {
        self.available_c + self.bound_c
    }

    /// Whether a load can have no more.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.available_c <= 0.0
    }
}
