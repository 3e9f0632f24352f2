//! Sums of structs, field by field.

/// Adds structs field by field. All fields are named, so that none is forgotten.
#[macro_export]
macro_rules! sum_fields {
    ($sum:ident { $($field:ident),* $(,)? }) => {
        impl std::ops::AddAssign for $sum {
            fn add_assign(&mut self, other: Self) {
                let Self { $($field),* } = other;
                $(self.$field += $field;)*
            }
        }

        impl std::iter::Sum for $sum {
            fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
                all.fold(Self::default(), |mut sum, one| {
                    sum += one;
                    sum
                })
            }
        }
    };
}
