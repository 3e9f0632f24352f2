//! Places: the columns that hold them, the plane of latitudes and longitudes, and files of places (areas, true positions, maps).

pub(crate) mod area;
pub(crate) mod distance;
mod geojson;
pub(crate) mod local_plane;
pub(crate) mod map;
pub(crate) mod place_columns;
pub(crate) mod truth;
pub(crate) mod without_fix;
