//! A share of the units of a sweep.

use std::str::FromStr;

/// Share `index` (from 1) of `count`: every `count`-th unit.
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
    /// Whether the unit of this index is in it.
    #[must_use]
    pub fn has(self, unit: usize) -> bool {
        unit % self.count == self.index - 1
    }

    /// What stands in the name of a file to keep it apart from those of other shards: `.2-of-3`; nothing for the whole.
    #[must_use]
    pub fn suffix(self) -> String {
        if self.count == 1 { String::new() } else { format!(".{}-of-{}", self.index, self.count) }
    }
}

impl FromStr for Shard {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let expected = "expected I/N, for example 2/3: the second of three shares, 1 <= I <= N";
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
    fn the_shards_share_out_all_units() {
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
    fn what_is_no_shard_is_refused() {
        for text in ["", "1", "0/2", "3/2", "1/0", "a/b", "-1/2"] {
            assert!(text.parse::<Shard>().is_err(), "{text}");
        }
    }
}
