//! How fast simulated time passes.

/// Simulated seconds in a second; `None` for as fast as possible.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Speed(pub(crate) Option<f64>);

impl Speed {
    /// The speed that a text says.
    pub(crate) fn read(text: &str) -> Result<Self, &'static str> {
        if text == "max" {
            return Ok(Self(None));
        }
        match text.parse::<f64>() {
            Ok(0.0) => Ok(Self(None)),
            Ok(speed) if (1e-6..=1e9).contains(&speed) => Ok(Self(Some(speed))),
            _ => Err("allowed: 0.000001 to 1000000000; 0 or max for as fast as possible"),
        }
    }
}
