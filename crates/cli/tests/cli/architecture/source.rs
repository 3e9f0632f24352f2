//! The references of one source file to other modules: `mod` lines, `use` lines, and paths in code.

use proc_macro2::{TokenStream, TokenTree};
use syn::visit::{self, Visit};
use syn::{Attribute, Block, ImplItemFn, Item, ItemMod, ItemUse, Macro, Meta, Path, UseTree};

/// What changes files and folders, by the last two steps of its path.
pub(super) const CHANGES_OF_FILES: [&str; 13] = [
    "fs::write",
    "fs::rename",
    "fs::copy",
    "fs::hard_link",
    "fs::remove_file",
    "fs::remove_dir",
    "fs::remove_dir_all",
    "fs::create_dir",
    "fs::create_dir_all",
    "fs::set_permissions",
    "File::create",
    "File::create_new",
    "File::options",
];

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
    pub(super) fn read(name: &str, text: &str) -> Self {
        let file = syn::parse_file(text).unwrap_or_else(|error| panic!("{name} is not Rust: {error}"));
        let mut reader = Reader::default();
        reader.visit_file(&file);
        reader.source
    }
}

/// Walks through the syntax of a file and collects its references.
#[derive(Default)]
struct Reader {
    source: Source,
    /// Inline modules around the present place.
    inner: usize,
    /// Blocks of code around the present place.
    blocks: usize,
}

impl Reader {
    fn path(&mut self, path: Vec<String>) {
        if path.len() > 1 {
            self.source.paths.push((self.inner, path));
        }
    }

    /// Collects the paths in tokens without syntax: those of a macro or an attribute.
    fn tokens(&mut self, tokens: TokenStream) {
        let mut path = Vec::new();
        let mut colons = 0;
        // What a macro has for other crates, `$crate::..`, is no path of this one.
        let mut dollar = "";
        for token in tokens {
            let before = std::mem::take(&mut dollar);
            match token {
                TokenTree::Ident(word) => {
                    if colons != 2 {
                        self.path(std::mem::take(&mut path));
                    }
                    path.push(format!("{before}{word}"));
                    colons = 0;
                }
                TokenTree::Punct(mark) if mark.as_char() == '$' => {
                    self.path(std::mem::take(&mut path));
                    (colons, dollar) = (0, "$");
                }
                TokenTree::Punct(mark) if mark.as_char() == ':' => colons += 1,
                other => {
                    self.path(std::mem::take(&mut path));
                    colons = 0;
                    if let TokenTree::Group(group) = other {
                        self.tokens(group.stream());
                    }
                }
            }
        }
        self.path(path);
    }
}

impl<'ast> Visit<'ast> for Reader {
    fn visit_item(&mut self, item: &'ast Item) {
        if !is_test(attributes(item)) {
            visit::visit_item(self, item);
        } else if let Item::Mod(module) = item {
            self.source.test_modules.push(module.ident.to_string());
        }
    }

    fn visit_impl_item_fn(&mut self, function: &'ast ImplItemFn) {
        if !is_test(&function.attrs) {
            visit::visit_impl_item_fn(self, function);
        }
    }

    fn visit_item_mod(&mut self, module: &'ast ItemMod) {
        self.inner += 1;
        visit::visit_item_mod(self, module);
        self.inner -= 1;
    }

    fn visit_block(&mut self, block: &'ast Block) {
        self.blocks += 1;
        visit::visit_block(self, block);
        self.blocks -= 1;
    }

    fn visit_item_use(&mut self, line: &'ast ItemUse) {
        for import in imports(&line.tree, &[]) {
            self.path(import.path.clone());
            if self.inner == 0 && self.blocks == 0 {
                self.source.imports.push(import);
            }
        }
    }

    fn visit_path(&mut self, path: &'ast Path) {
        self.path(path.segments.iter().map(|segment| segment.ident.to_string()).collect());
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, call: &'ast Macro) {
        visit::visit_macro(self, call);
        self.tokens(call.tokens.clone());
    }

    fn visit_attribute(&mut self, attribute: &'ast Attribute) {
        visit::visit_attribute(self, attribute);
        if let Meta::List(list) = &attribute.meta {
            self.tokens(list.tokens.clone());
        }
    }
}

/// Whether the attributes have `#[cfg(test)]`.
fn is_test(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        attribute.path().is_ident("cfg") && attribute.parse_args::<Path>().is_ok_and(|path| path.is_ident("test"))
    })
}

/// The attributes of an item that may be there for tests only.
fn attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(item) => &item.attrs,
        Item::Enum(item) => &item.attrs,
        Item::Fn(item) => &item.attrs,
        Item::Impl(item) => &item.attrs,
        Item::Macro(item) => &item.attrs,
        Item::Mod(item) => &item.attrs,
        Item::Static(item) => &item.attrs,
        Item::Struct(item) => &item.attrs,
        Item::Trait(item) => &item.attrs,
        Item::Type(item) => &item.attrs,
        Item::Use(item) => &item.attrs,
        _ => &[],
    }
}

/// The names that a `use` tree imports below `prefix`.
fn imports(tree: &UseTree, prefix: &[String]) -> Vec<Import> {
    let below = |name: String| [prefix, &[name]].concat();
    match tree {
        UseTree::Path(path) => imports(&path.tree, &below(path.ident.to_string())),
        UseTree::Name(name) => vec![import(name.ident.to_string(), below(name.ident.to_string()))],
        UseTree::Rename(rename) => vec![import(rename.rename.to_string(), below(rename.ident.to_string()))],
        UseTree::Glob(_) => vec![import("*".to_owned(), prefix.to_vec())],
        UseTree::Group(group) => group.items.iter().flat_map(|tree| imports(tree, prefix)).collect(),
    }
}

/// An import of the item at `path`; `a::{self}` imports `a` by its name.
fn import(mut name: String, mut path: Vec<String>) -> Import {
    if path.len() > 1 && path.last().is_some_and(|last| last == "self") {
        path.pop();
        if name == "self" {
            name = path.last().cloned().unwrap_or_default();
        }
    }
    Import { name, path }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_imports_and_test_modules_of_a_file_are_found() {
        let source = Source::read(
            "file.rs",
            "//! crate::in_a_comment::A\nuse crate::a::{B, c::{self, D as E}};\npub(super) use super::f::*;\n\
             fn g<'a>(x: &'a str) -> crate::h::I { \"crate::text::J\"; r#\"crate::raw::K\"#; '\"'; super::l::m(x) }\n\
             mod inner { use super::n::O; }\n#[cfg(test)]\nmod tests;\n#[cfg(test)]\nmod more { use crate::p::Q; }\n\
             macro_rules! e { () => { $crate::v::X } }\n\
             fn r() { assert!([crate::s::t(), 1 + u::v].is_empty(), \"crate::w::X\"); }\n\
             #[derive(crate::y::Z)] struct S;\nimpl S { #[cfg(test)] fn h() { crate::p::i() } }",
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
                "1 super::n::O",
                "0 $crate::v::X",
                "0 crate::s::t",
                "0 u::v",
                "0 crate::y::Z",
            ]
        );
        let names: Vec<&str> = source.imports.iter().map(|import| import.name.as_str()).collect();
        assert_eq!(names, ["B", "c", "E", "*"]);
        assert_eq!(source.test_modules, ["tests", "more"]);
    }
}
