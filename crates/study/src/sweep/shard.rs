//! A part of the units of a sweep.

use std::str::FromStr;

/// Part `index` (from 1) of `count`: every `count`-th unit. Units are dealt in turn, so that parts take about as long.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    index: usize,
    count: usize,
}

impl Default for Shard {
    fn default() -> Self {
        Self { index: 1, count: 1 }
    }
}

impl Shard {
    /// Whether the unit with this index belongs to the shard.
    #[must_use]
    pub fn has(self, unit: usize) -> bool {
        unit % self.count == self.index - 1
    }

    /// The part of a file name that identifies the shard: `.2-of-3`; empty if there is only one shard.
    #[must_use]
    pub fn suffix(self) -> String {
        if self.count == 1 { String::new() } else { format!(".{}-of-{}", self.index, self.count) }
    }
}

impl FromStr for Shard {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let expected = "expected I/N with 1 <= I <= N, for example 2/3 for the second of three parts";
        let (index, count) = text.split_once('/').ok_or(expected)?;
        let (Ok(index), Ok(count)) = (index.trim().parse(), count.trim().parse()) else {
            return Err(expected);
        };
        if (1..=count).contains(&index) { Ok(Self { index, count }) } else { Err(expected) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_unit_belongs_to_one_shard() {
        for count in 1..6 {
            let shards: Vec<Shard> = (1..=count).map(|i| format!("{i}/{count}").parse().unwrap()).collect();
            for unit in 0..20 {
                assert_eq!(shards.iter().filter(|shard| shard.has(unit)).count(), 1);
            }
        }
        assert_eq!("2/3".parse::<Shard>().unwrap().suffix(), ".2-of-3");
        assert_eq!(Shard::default().suffix(), "");
    }

    #[test]
    fn invalid_shards_are_rejected() {
        for text in ["", "1", "0/2", "3/2", "1/0", "a/b", "-1/2"] {
            assert!(text.parse::<Shard>().is_err(), "{text}");
        }
    }
}
