//! The names of the files of parts.

use super::NumberRange;

/// The name of a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct PartName {
    /// The numbers of its runs.
    pub range: NumberRange,
    /// The number of the process that does it, from 1, unless the part is finished.
    pub unfinished: Option<u32>,
}

impl PartName {
    /// Its file. Numbers are padded, so that a listing is in their order.
    pub(super) fn text(self) -> String {
        let NumberRange { start, end } = self.range;
        let unfinished = self.unfinished.map_or_else(String::new, |number| format!(".unfinished-{number:03}"));
        format!("{start:09}-{end:09}{unfinished}.csv")
    }

    pub(super) fn parse(text: &str) -> Option<Self> {
        let stem = text.strip_suffix(".csv")?;
        let (numbers, unfinished) = match stem.split_once(".unfinished-") {
            Some((numbers, number)) => (numbers, Some(number.parse().ok()?)),
            None => (stem, None),
        };
        let (start, end) = numbers.split_once('-')?;
        let range = NumberRange { start: start.parse().ok()?, end: end.parse().ok()? };
        (!range.is_empty()).then_some(Self { range, unfinished })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_read_as_it_is_written() {
        let range = NumberRange { start: 64, end: 1000 };
        for (unfinished, text) in
            [(None, "000000064-000001000.csv"), (Some(2), "000000064-000001000.unfinished-002.csv")]
        {
            let name = PartName { range, unfinished };
            assert_eq!(name.text(), text);
            assert_eq!(PartName::parse(text), Some(name));
        }
        for other in ["a.csv", "1-2.txt", "2-1.csv", "1-2.unfinished-x.csv"] {
            assert_eq!(PartName::parse(other), None, "{other}");
        }
    }
}
