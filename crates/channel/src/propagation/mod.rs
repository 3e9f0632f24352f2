//! What becomes of power on its way: path loss, gas, materials, shadowing, and the law that joins them.

#[cfg_attr(not(feature = "obstacles"), expect(dead_code, reason = "fields are those of rays among obstacles"))]
pub(crate) mod complex;
pub(crate) mod environment;
#[cfg(feature = "obstacles")]
pub(crate) mod fresnel;
pub(crate) mod gas;
pub(crate) mod law;
#[cfg_attr(not(feature = "obstacles"), expect(dead_code, reason = "materials are those of obstacles"))]
pub(crate) mod material;
#[cfg(feature = "obstacles")]
pub(crate) mod path_budget;
pub(crate) mod path_loss;
pub(crate) mod reflection;
pub(crate) mod screen;
pub(crate) mod shadowing;
