//! An input that is several texts, each after a line with its name.

/// What begins a line with a name.
const MARK: &str = "=== ";

/// A text and its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct NamedText<'a> {
    pub(crate) name: &'a str,
    pub(crate) text: &'a str,
}

/// The texts of `input`, at most `most`. What comes before the first name is called `first`.
pub(crate) fn split<'a>(input: &'a str, first: &'a str, most: usize) -> Vec<NamedText<'a>> {
    let mut texts = Vec::new();
    let (mut name, mut start, mut at) = (first, 0, 0);
    for line in input.split_inclusive('\n') {
        if let Some(next) = line.strip_prefix(MARK) {
            if at > start {
                texts.push(NamedText { name, text: &input[start..at] });
            }
            (name, start) = (next.trim(), at + line.len());
        }
        at += line.len();
    }
    if at > start {
        texts.push(NamedText { name, text: &input[start..] });
    }
    texts.truncate(most);
    texts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_have_the_names_before_them() {
        let texts = split("a\n=== one\nb\nc\n=== two\n=== three\nd", "zero", 3);
        let expected = [("zero", "a\n"), ("one", "b\nc\n"), ("three", "d")];
        assert_eq!(texts, expected.map(|(name, text)| NamedText { name, text }));
        assert_eq!(split("a\n=== one\nb", "zero", 1).len(), 1);
        assert_eq!(split("", "zero", 3), []);
    }
}
