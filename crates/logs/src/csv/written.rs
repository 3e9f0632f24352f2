//! How the tables of a log are written, where that is not as usual: other names of columns, times without a zone.

use crate::options::field_names::FieldNames;
use crate::options::form_options::FormOptions;
use crate::time::time_zone::TimeZone;

/// How a table is written.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Written {
    /// The names of the user for its columns.
    pub(crate) names: FieldNames,
    /// The zone of times that do not say theirs.
    pub(crate) time_zone: Option<TimeZone>,
}

impl Written {
    /// How lists of packets and receptions are written.
    pub(crate) fn of_packets(form: &FormOptions) -> Self {
        Self { names: FieldNames::of_packets(form.packet_fields.as_ref()), time_zone: form.time_zone }
    }

    /// How ranges are written.
    pub(crate) fn of_ranges(form: &FormOptions) -> Self {
        Self { names: FieldNames::of_ranges(form.range_fields.as_ref()), time_zone: form.time_zone }
    }

    /// How paths, stops and wide tables are written.
    pub(crate) fn of_places(form: &FormOptions) -> Self {
        Self { names: FieldNames::of_places(form.path_fields.as_ref()), time_zone: form.time_zone }
    }
}
