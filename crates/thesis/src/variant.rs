//! A scenario that ships with the program, as it is or under a reading of the thesis.

/// A scenario that ships with the program, and the settings that a reading of the thesis gives other values.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Variant {
    /// Its file below the folder of scenarios.
    pub scenario: String,
    /// The reading in words; empty for the scenario as it ships.
    pub reading: String,
    /// The settings of the reading: `key=value`.
    pub set: Vec<String>,
}

impl Variant {
    /// The scenario as it ships.
    #[must_use]
    pub fn shipped(scenario: &str) -> Self {
        Self { scenario: scenario.to_owned(), reading: String::new(), set: Vec::new() }
    }

    /// Whether it is the scenario as it ships.
    #[must_use]
    pub fn is_shipped(&self) -> bool {
        self.set.is_empty()
    }

    /// The name of the table of its runs: `runs-SCENARIO.csv`, or `runs-SCENARIO--READING.csv`.
    #[must_use]
    pub fn table_name(&self) -> String {
        let scenario = flat_name(&self.scenario);
        if self.is_shipped() {
            format!("runs-{scenario}.csv")
        } else {
            format!("runs-{scenario}--{}.csv", self.slug())
        }
    }

    /// The reading in letters that every file system has.
    fn slug(&self) -> String {
        let mut slug = String::new();
        for letter in self.reading.chars() {
            match letter {
                'a'..='z' | '0'..='9' | '.' => slug.push(letter),
                'A'..='Z' => slug.push(letter.to_ascii_lowercase()),
                _ if slug.ends_with('-') => {}
                _ => slug.push('-'),
            }
        }
        slug.trim_matches('-').to_owned()
    }
}

/// The name of a scenario in one word, for files: its folder and its file.
pub(crate) fn flat_name(scenario: &str) -> String {
    scenario.trim_end_matches(".toml").replace('/', "-")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_of_a_reading_has_its_name() {
        let shipped = Variant::shipped("ml-tm/sphere.toml");
        assert_eq!(shipped.table_name(), "runs-ml-tm-sphere.csv");
        let set = vec!["channel.max_range_m=4.0".to_owned()];
        let reading = Variant { reading: "R_c: 4 m, lanes: 3.5 m".to_owned(), set, ..shipped };
        assert_eq!(reading.table_name(), "runs-ml-tm-sphere--r-c-4-m-lanes-3.5-m.csv");
    }
}
