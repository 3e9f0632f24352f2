//! Comparison of values whose types are not known.

use std::any::Any;

/// What can be compared with anything: whatever can be compared with its own kind.
pub trait Comparable {
    /// Whether `other` is of the same type, and equal.
    fn is_same(&self, other: &dyn Any) -> bool;
}

impl<T: PartialEq + Any> Comparable for T {
    fn is_same(&self, other: &dyn Any) -> bool {
        other.downcast_ref::<T>().is_some_and(|other| other == self)
    }
}
