//! Parts of pictures: axes, ticks, curves, bars, cells of colour, views of the world, and the sheet that holds them.

pub(crate) mod axes;
pub(crate) mod bars;
pub(crate) mod cells;
pub(crate) mod contour;
pub(crate) mod curves;
pub(crate) mod density;
pub(crate) mod sheet;
pub(crate) mod silhouette;
pub(crate) mod stacks;
pub(crate) mod ticks;
pub(crate) mod view;
