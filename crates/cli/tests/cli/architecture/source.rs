//! The references of one source file to other modules: `mod` lines, `use` lines, and paths in code.

/// A token of Rust code, as far as paths need it.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Token {
    Word(String),
    /// `::`
    Step,
    Mark(char),
}

/// A name that a `use` line imports.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Import {
    /// The name; `*` if the line imports all names of a module.
    pub(super) name: String,
    /// The path, as written.
    pub(super) path: Vec<String>,
}

/// The references of a source file to other modules. Code under `#[cfg(test)]` is ignored, because tests may use
/// everything.
#[derive(Clone, Debug, Default)]
pub(super) struct Source {
    /// Modules that exist for tests only.
    pub(super) test_modules: Vec<String>,
    /// The `use` lines of the module itself.
    pub(super) imports: Vec<Import>,
    /// Every path in `use` lines and code with more than one step, and the number of inline modules around it.
    pub(super) paths: Vec<(usize, Vec<String>)>,
}

impl Source {
    /// Reads the text of a file.
    pub(super) fn read(text: &str) -> Self {
        let mut reader = Reader { tokens: tokens(text), at: 0, inner: Vec::new(), depth: 0, source: Self::default() };
        while reader.at < reader.tokens.len() {
            reader.step();
        }
        reader.source
    }
}

struct Reader {
    tokens: Vec<Token>,
    at: usize,
    /// The depths of braces at which the current inline modules began.
    inner: Vec<usize>,
    depth: usize,
    source: Source,
}

impl Reader {
    fn word(&self, ahead: usize) -> Option<&str> {
        match self.tokens.get(self.at + ahead) {
            Some(Token::Word(word)) => Some(word),
            _ => None,
        }
    }

    fn is(&self, ahead: usize, mark: char) -> bool {
        self.tokens.get(self.at + ahead) == Some(&Token::Mark(mark))
    }

    fn step(&mut self) {
        if self.is(0, '#') && self.is(1, '[') && self.word(2) == Some("cfg") && self.word(4) == Some("test") {
            return self.skip_item();
        }
        match self.tokens[self.at].clone() {
            Token::Mark('{') => self.depth += 1,
            Token::Mark('}') => {
                self.depth = self.depth.saturating_sub(1);
                if self.inner.last() == Some(&self.depth) {
                    self.inner.pop();
                }
            }
            Token::Word(word) if word == "mod" && self.is(2, '{') => {
                self.inner.push(self.depth);
                self.depth += 1;
                self.at += 2;
            }
            Token::Word(word) if word == "use" => {
                self.at += 1;
                let top = self.depth == 0;
                for import in self.tree(&[]) {
                    self.source.paths.push((self.inner.len(), import.path.clone()));
                    if top {
                        self.source.imports.push(import);
                    }
                }
                return;
            }
            Token::Word(_) => return self.path(),
            _ => {}
        }
        self.at += 1;
    }

    /// Skips the item after `#[cfg(test)]`.
    fn skip_item(&mut self) {
        while !self.is(0, ']') {
            self.at += 1;
        }
        self.at += 1;
        let first = self.at;
        while self.at < self.tokens.len() && !self.is(0, ';') && !self.is(0, '{') {
            self.at += 1;
        }
        if self.is(0, ';') {
            if let [.., Token::Word(keyword), Token::Word(name)] = &self.tokens[first..self.at]
                && keyword == "mod"
            {
                self.source.test_modules.push(name.clone());
            }
            self.at += 1;
            return;
        }
        let mut open = 0;
        while self.at < self.tokens.len() {
            open = if self.is(0, '{') {
                open + 1
            } else if self.is(0, '}') {
                open - 1
            } else {
                open
            };
            self.at += 1;
            if open == 0 {
                return;
            }
        }
    }

    /// The names that the `use` tree imports which begins here, after `prefix`.
    fn tree(&mut self, prefix: &[String]) -> Vec<Import> {
        let mut path = prefix.to_vec();
        loop {
            match self.tokens.get(self.at) {
                Some(Token::Word(word)) => {
                    path.push(word.clone());
                    self.at += 1;
                }
                Some(Token::Mark('*')) => {
                    self.at += 1;
                    return vec![Import { name: "*".to_owned(), path }];
                }
                Some(Token::Mark('{')) => {
                    self.at += 1;
                    let mut imports = Vec::new();
                    while !self.is(0, '}') {
                        imports.extend(self.tree(&path));
                        if self.is(0, ',') {
                            self.at += 1;
                        }
                    }
                    self.at += 1;
                    return imports;
                }
                _ => {}
            }
            if self.tokens.get(self.at) == Some(&Token::Step) {
                self.at += 1;
                continue;
            }
            if path.last().is_some_and(|last| last == "self") && path.len() > 1 {
                path.pop();
            }
            let mut name = path.last().cloned().unwrap_or_default();
            if self.word(0) == Some("as") {
                name = self.word(1).unwrap_or("_").to_owned();
                self.at += 2;
            }
            return vec![Import { name, path }];
        }
    }

    /// Reads a path in code.
    fn path(&mut self) {
        let mut path = Vec::new();
        while let Some(word) = self.word(0) {
            path.push(word.to_owned());
            self.at += 1;
            if self.tokens.get(self.at) != Some(&Token::Step) {
                break;
            }
            self.at += 1;
        }
        if path.len() > 1 {
            self.source.paths.push((self.inner.len(), path));
        }
    }
}

/// The tokens of a text, without comments, strings, numbers and lifetimes.
fn tokens(text: &str) -> Vec<Token> {
    let mut tokens = Vec::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let length = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            rest.find("*/").map_or(rest.len(), |end| end + 2)
        } else if let Some(length) = raw_text(rest) {
            length
        } else if first == '"' {
            quoted(rest, '"')
        } else if first == '\'' {
            character(rest)
        } else if rest.starts_with("::") {
            tokens.push(Token::Step);
            2
        } else if first.is_alphanumeric() || first == '_' {
            let length = rest.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(rest.len());
            if !first.is_ascii_digit() {
                tokens.push(Token::Word(rest[..length].to_owned()));
            }
            length
        } else {
            if !first.is_whitespace() {
                tokens.push(Token::Mark(first));
            }
            first.len_utf8()
        };
        rest = &rest[length..];
    }
    tokens
}

/// Length of the quoted string that begins here, with its escapes.
fn quoted(rest: &str, quote: char) -> usize {
    let mut is_escaped = false;
    for (at, c) in rest.char_indices().skip(1) {
        if c == quote && !is_escaped {
            return at + c.len_utf8();
        }
        is_escaped = c == '\\' && !is_escaped;
    }
    rest.len()
}

/// Length of the character literal or lifetime that begins here.
fn character(rest: &str) -> usize {
    let mut letters = rest[1..].chars();
    match (letters.next(), letters.next()) {
        (Some('\\'), _) => quoted(rest, '\''),
        (Some(letter), Some('\'')) => letter.len_utf8() + 2,
        _ => 1 + rest[1..].find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(rest.len() - 1),
    }
}

/// Length of the raw string, `r#".."#`, that begins here.
fn raw_text(rest: &str) -> Option<usize> {
    let after = rest.strip_prefix("br").or_else(|| rest.strip_prefix('r'))?;
    let marks = after.len() - after.trim_start_matches('#').len();
    if !after[marks..].starts_with('"') {
        return None;
    }
    let end = format!("\"{}", "#".repeat(marks));
    let begin = rest.len() - after.len() + marks + 1;
    rest[begin..].find(&end).map(|at| begin + at + end.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_imports_and_test_modules_of_a_file_are_found() {
        let source = Source::read(
            "//! crate::in_a_comment::A\nuse crate::a::{B, c::{self, D as E}};\npub(super) use super::f::*;\n\
             fn g<'a>(x: &'a str) -> crate::h::I { \"crate::text::J\"; r#\"crate::raw::K\"#; '\"'; super::l::m(x) }\n\
             mod inner { use super::n::O; }\n#[cfg(test)]\nmod tests;\n#[cfg(test)]\nmod more { use crate::p::Q; }\n",
        );
        let paths: Vec<String> =
            source.paths.iter().map(|(inner, path)| format!("{inner} {}", path.join("::"))).collect();
        assert_eq!(
            paths,
            [
                "0 crate::a::B",
                "0 crate::a::c",
                "0 crate::a::c::D",
                "0 super::f",
                "0 crate::h::I",
                "0 super::l::m",
                "1 super::n::O"
            ]
        );
        let names: Vec<&str> = source.imports.iter().map(|import| import.name.as_str()).collect();
        assert_eq!(names, ["B", "c", "E", "*"]);
        assert_eq!(source.test_modules, ["tests"]);
    }
}
