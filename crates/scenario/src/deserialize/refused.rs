//! Errors of settings during deserialization.

use std::fmt;

use serde::de::{self, Expected, Unexpected};

use crate::document::key_path::PathStep;
use crate::refusal::Refusal;

/// An error, and the steps of the path to it in reverse order.
#[derive(Debug)]
pub(super) struct Refused(pub(super) Box<(Refusal, Vec<PathStep>)>);

impl Refused {
    /// Adds the step above the error to its path.
    pub(super) fn below(mut self, step: PathStep) -> Self {
        self.0.1.push(step);
        self
    }
}

impl From<Refusal> for Refused {
    fn from(refusal: Refusal) -> Self {
        Self(Box::new((refusal, Vec::new())))
    }
}

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.0.0 {
            Refusal::UnknownField { field, .. } => write!(f, "unknown key `{field}`"),
            Refusal::UnknownVariant { variant, .. } => write!(f, "unknown choice `{variant}`"),
            Refusal::MissingField(field) => write!(f, "`{field}` is missing"),
            Refusal::Unfit { found, expected } => write!(f, "{found}; allowed: {expected}"),
            Refusal::SeveralChoices(choices) => write!(f, "{} choices", choices.len()),
            Refusal::Other(message) => f.write_str(message),
        }
    }
}

impl std::error::Error for Refused {}

impl de::Error for Refused {
    fn custom<T: fmt::Display>(message: T) -> Self {
        Refusal::Other(message.to_string()).into()
    }

    fn invalid_type(unexpected: Unexpected<'_>, expected: &dyn Expected) -> Self {
        Refusal::Unfit { found: found(unexpected), expected: expected.to_string() }.into()
    }

    fn invalid_value(unexpected: Unexpected<'_>, expected: &dyn Expected) -> Self {
        Self::invalid_type(unexpected, expected)
    }

    fn invalid_length(length: usize, expected: &dyn Expected) -> Self {
        Refusal::Unfit { found: array_of(length), expected: expected.to_string() }.into()
    }

    fn unknown_variant(variant: &str, expected: &'static [&'static str]) -> Self {
        Refusal::UnknownVariant { variant: variant.to_owned(), expected }.into()
    }

    fn unknown_field(field: &str, expected: &'static [&'static str]) -> Self {
        Refusal::UnknownField { field: field.to_owned(), expected }.into()
    }

    fn missing_field(field: &'static str) -> Self {
        Refusal::MissingField(field).into()
    }
}

/// What was found, in the terms of TOML.
pub(super) fn found(unexpected: Unexpected<'_>) -> String {
    match unexpected {
        Unexpected::Bool(value) => format!("the boolean {value}"),
        Unexpected::Unsigned(value) => format!("the integer {value}"),
        Unexpected::Signed(value) => format!("the integer {value}"),
        Unexpected::Float(value) => format!("the number {value}"),
        Unexpected::Str(value) => format!("the text \"{value}\""),
        Unexpected::Seq => "an array".to_owned(),
        Unexpected::Map => "a table".to_owned(),
        other => other.to_string(),
    }
}

pub(super) fn array_of(length: usize) -> String {
    format!("an array of {length}")
}
