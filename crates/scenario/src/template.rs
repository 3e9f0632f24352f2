//! Templates: scenarios to begin with, each explained by its comments, and a log of a robot.

use std::path::Path;

use super::shell;

/// A scenario to begin with, or a log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Template {
    /// Its name.
    pub name: &'static str,
    /// What it is, in one line.
    pub summary: &'static str,
    /// Its files: one, or several that belong into a folder.
    pub files: &'static [TemplateFile],
    /// Commands of `sextant` for the folder: `{}` is its path, and `{NAME}` that of a file in it.
    commands: &'static [&'static str],
}

/// A file of a template.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TemplateFile {
    /// Its name.
    pub name: &'static str,
    /// Its text.
    pub text: &'static str,
}

/// A template of one scenario: a name, and a line about it.
macro_rules! scenario {
    ($name:literal, $summary:literal) => {
        Template {
            name: $name,
            summary: $summary,
            files: &[TemplateFile {
                name: concat!($name, ".toml"),
                text: include_str!(concat!("../templates/", $name, ".toml")),
            }],
            commands: &[],
        }
    };
}

/// All templates.
const TEMPLATES: &[Template] = &[
    scenario!("survey", "a robot drives through a network, listens, and its log becomes a map of the nodes"),
    scenario!(
        "building",
        "walls with doors and windows, two storeys: a robot looks into the rooms and maps the nodes"
    ),
    scenario!(
        "ranges",
        "a robot measures ranges, as ultra-wideband does, and its log becomes a map: biases included"
    ),
    scenario!("mac", "nodes send packets to a sink by CSMA-CA: deliveries, delays, collisions, retries"),
    scenario!("network", "nodes on batteries send over several hops to a sink: a tree, its changes, lifetimes"),
    scenario!("mmwave", "a robot with a 60 GHz antenna maps nodes by the sectors in which they answer"),
    scenario!("distributed", "no robot: nodes work out their own places from messages of those that know theirs"),
    scenario!("search", "nodes detect a moving target, and a robot is led to it"),
    scenario!("seek", "a robot drives to where a field is strong, by what the nodes measure"),
    Template {
        name: "log",
        summary: "a folder with the log of a robot, to map without a simulation",
        files: &[
            TemplateFile { name: "README.txt", text: include_str!("../templates/log/README.txt") },
            TemplateFile { name: "stops.csv", text: include_str!("../templates/log/stops.csv") },
            TemplateFile { name: "receptions.csv", text: include_str!("../templates/log/receptions.csv") },
            TemplateFile { name: "nodes.csv", text: include_str!("../templates/log/nodes.csv") },
        ],
        commands: &["map {}", "map {} --truth {nodes.csv}", "inspect {}"],
    },
    Template {
        name: "track",
        summary: "a folder with ranges between a tag that moves and receivers, to track at once, and their scenario",
        files: &[
            TemplateFile { name: "README.txt", text: include_str!("../templates/track/README.txt") },
            TemplateFile { name: "ranges.csv", text: include_str!("../templates/track/ranges.csv") },
            TemplateFile { name: "receivers.csv", text: include_str!("../templates/track/receivers.csv") },
            TemplateFile { name: "true-path.csv", text: include_str!("../templates/track/true-path.csv") },
            TemplateFile { name: "track.toml", text: include_str!("../templates/track/track.toml") },
        ],
        commands: &["map {} --track --known {receivers.csv} --truth {true-path.csv}"],
    },
];

impl Template {
    /// All templates; the first one is for those who do not choose.
    #[must_use]
    pub fn all() -> &'static [Self] {
        TEMPLATES
    }

    /// The template of this name.
    #[must_use]
    pub fn named(name: &str) -> Option<&'static Self> {
        TEMPLATES.iter().find(|template| template.name == name)
    }

    /// The scenario, if it is one and not a folder of files.
    #[must_use]
    pub fn scenario(&self) -> Option<TemplateFile> {
        match self.files {
            [scenario] => Some(*scenario),
            _ => None,
        }
    }

    /// What to go on with after its files were written into `folder`: commands, one a line.
    #[must_use]
    pub fn commands_at(&self, folder: &Path) -> Vec<String> {
        let with_paths = |command: &&str| {
            let words =
                command.split(' ').map(|word| match word.strip_prefix('{').and_then(|word| word.strip_suffix('}')) {
                    Some("") => shell::path(folder),
                    Some(file) => shell::path(&folder.join(file)),
                    None => word.to_owned(),
                });
            words.fold("sextant".to_owned(), |line, word| line + " " + &word)
        };
        self.commands.iter().map(with_paths).collect()
    }
}

impl TemplateFile {
    /// Its text for a file at `path`: the commands in its comments name that file.
    #[must_use]
    pub fn text_at(&self, path: &Path) -> String {
        let Some((stem, _)) = self.name.rsplit_once('.') else { return self.text.to_owned() };
        let (Some(file), Some(new_stem)) = (path.file_name(), path.file_stem()) else { return self.text.to_owned() };
        // A name could end the comment that it stands in.
        if shell::has_controls(&file.to_string_lossy()) {
            return self.text.to_owned();
        }
        let recording = Path::new(new_stem).with_added_extension("mcap");
        self.text
            .replace(self.name, &shell::path(Path::new(file)))
            .replace(&format!("{stem}.mcap"), &shell::path(&recording))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_template_is_written_in_toml_and_has_its_name() {
        for template in Template::all().iter().filter(|template| template.files.len() == 1) {
            let scenario: toml::Table = template.files[0].text.parse().expect(template.name);
            assert_eq!(scenario["name"].as_str(), Some(template.name));
        }
    }

    #[test]
    fn the_commands_in_a_template_name_its_file() {
        let survey = Template::named("survey").and_then(|template| template.scenario()).unwrap();
        let text = survey.text_at(Path::new("some/where/mine.toml"));
        assert!(text.contains("sextant run mine.toml --out mine.mcap") && !text.contains("survey.toml"));
        assert_eq!(survey.text_at(Path::new("survey.toml")), survey.text);
        let quoted = survey.text_at(Path::new("my $(id).toml"));
        assert!(quoted.contains("sextant run 'my $(id).toml' --out 'my $(id).mcap'"), "{quoted}");
        for name in ["a\nb.toml", "a\rb.toml", "a\u{2028}b.toml"] {
            assert_eq!(survey.text_at(Path::new(name)), survey.text, "{name:?}");
        }
        assert!(Template::named("log").unwrap().scenario().is_none());
        assert_eq!(Template::named("nothing"), None);
        let commands = Template::named("track").unwrap().commands_at(Path::new("my track"));
        let command =
            "sextant map 'my track' --track --known 'my track/receivers.csv' --truth 'my track/true-path.csv'";
        assert_eq!(commands, [command]);
    }
}
