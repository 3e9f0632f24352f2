//! Which part of the world is simulated, as asked for.

mod needs;
mod reach;

use sextant_kernel::SettingError;

pub use reach::Reach;

/// So many nodes are many: it may take long to simulate those that nobody hears. Fewer take about as long as the maps of
/// them, even if a survey lasts for hours.
pub const MANY_NODES: usize = 1000;

/// What is simulated.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum SimulatedRegion {
    /// All nodes, all the time.
    #[default]
    All,
    /// All nodes of a network that has fewer than [`MANY_NODES`]; otherwise those within the halo of a listener.
    NearListenersIfMany,
    /// Nodes within the halo of a listener.
    Listeners {
        /// Radius of the halo (m); `None` if it follows from the reach of signals.
        halo_m: Option<f64>,
    },
}

impl SimulatedRegion {
    /// Radius of the halo (m); `None` if all is simulated.
    ///
    /// # Errors
    /// If the halo is smaller than the reach of a frame. The key is `halo_m`.
    pub fn halo_m(self, reach: Reach) -> Result<Option<f64>, SettingError> {
        match self {
            Self::All => Ok(None),
            Self::NearListenersIfMany | Self::Listeners { halo_m: None } => {
                Ok(Some(reach.halo_m()).filter(|halo_m| halo_m.is_finite()))
            }
            Self::Listeners { halo_m: Some(halo_m) } => {
                if halo_m >= reach.reception_m {
                    return Ok(Some(halo_m));
                }
                let allowed =
                    format!("at least {:.6}, because frames are received from so far (m)", reach.reception_m);
                Err(SettingError::new("halo_m", halo_m, allowed))
            }
        }
    }
}
