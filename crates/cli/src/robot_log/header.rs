//! The header of a CSV file: which columns are known, which are ignored.

/// The columns of a file.
#[derive(Default)]
pub(super) struct Header {
    columns: Vec<String>,
    ignored: Vec<String>,
}

impl Header {
    /// Checks the names of columns. A name that is not known is ignored, unless it looks like a known column that is
    /// absent: a misspelt `sent` would silently count as absent.
    pub(super) fn new(
        names: &csv::StringRecord,
        required: &[&'static str],
        optional: &[&'static str],
    ) -> Result<Self, String> {
        let columns: Vec<String> = names.iter().map(|name| name.trim().to_owned()).collect();
        let known = [required, optional].concat();
        let absent: Vec<&str> =
            known.iter().copied().filter(|name| !columns.iter().any(|column| column == name)).collect();
        let mut ignored = Vec::new();
        for (at, name) in columns.iter().enumerate() {
            if !known.contains(&name.as_str()) {
                if let Some(near) = nearest(name, &absent) {
                    let known = known.join(", ");
                    return Err(format!(
                        "unknown column `{name}`; did you mean `{near}`? Otherwise rename or remove it; known columns: {known}"
                    ));
                }
                ignored.push(name.clone());
            } else if columns[..at].contains(name) {
                return Err(format!("column `{name}` appears twice"));
            }
        }
        if let Some(missing) = required.iter().find(|name| absent.contains(name)) {
            return Err(format!(
                "column `{missing}` is missing; the first line must name the columns: {}",
                required.join(",")
            ));
        }
        Ok(Self { columns, ignored })
    }

    /// The index of the column `name`.
    pub(super) fn find(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| column == name)
    }

    /// The names of the columns that are ignored, if any has one.
    pub(super) fn ignored_names(&self) -> Option<String> {
        let names: Vec<String> =
            self.ignored.iter().filter(|name| !name.is_empty()).map(|name| format!("`{name}`")).collect();
        (!names.is_empty()).then(|| names.join(", "))
    }
}

/// The name among `absent` that `name` was probably meant to be: it differs in at most two letters (one, if either name has
/// fewer than four), or `name` is its beginning.
fn nearest<'a>(name: &str, absent: &[&'a str]) -> Option<&'a str> {
    let name = name.to_lowercase();
    let distance = |candidate: &&str| strsim::damerau_levenshtein(&name, candidate);
    let is_near = |candidate: &&str| {
        let allowed = if name.len().min(candidate.len()) < 4 { 1 } else { 2 };
        !name.is_empty() && (distance(candidate) <= allowed || candidate.starts_with(name.as_str()))
    };
    absent.iter().copied().filter(is_near).min_by_key(distance)
}
