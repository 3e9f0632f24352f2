//! Paths of keys with `[]` for the entries of lists.

/// The last part of `path`, without `[]`.
pub(super) fn last(path: &str) -> &str {
    path.rsplit('.').next().unwrap_or(path).trim_end_matches("[]")
}

/// The parts of `path`, without `[]`.
pub(super) fn parts(path: &str) -> impl DoubleEndedIterator<Item = &str> {
    path.split('.').map(|part| part.trim_end_matches("[]"))
}

/// `path` and the key `name` below it.
pub(super) fn below(path: &str, name: &str) -> String {
    if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") }
}

/// The entries of the list at `path`.
pub(super) fn entries(path: &str) -> String {
    format!("{path}[]")
}

/// Whether `path` ends in `parts`.
pub(super) fn ends_in(path: &str, ending: &[&str]) -> bool {
    let mut parts = parts(path).rev();
    ending.iter().rev().all(|wanted| parts.next() == Some(wanted))
}
