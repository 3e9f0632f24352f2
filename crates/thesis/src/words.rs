//! The words of a table: texts in which `{name}` stands for the item of a list, and `{name.field}` for one of its fields.

use std::collections::BTreeMap;

use serde::Deserialize;

use super::error::TableError;

/// The lists and texts that the entries of a table refer to.
#[derive(Clone, Debug, Default)]
pub(crate) struct Words {
    /// Lists of items by name.
    pub(crate) lists: BTreeMap<String, Vec<Item>>,
    /// Texts by name.
    pub(crate) texts: BTreeMap<String, String>,
}

/// An item of a list: its `id`, and its other fields.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(from = "WrittenItem")]
pub(crate) struct Item(BTreeMap<String, String>);

/// As in the file.
#[derive(Deserialize)]
#[serde(untagged)]
enum WrittenItem {
    Id(String),
    Fields(BTreeMap<String, String>),
}

impl From<WrittenItem> for Item {
    fn from(written: WrittenItem) -> Self {
        match written {
            WrittenItem::Id(id) => Self::of(id),
            WrittenItem::Fields(fields) => Self(fields),
        }
    }
}

impl Item {
    fn of(id: String) -> Self {
        Self(BTreeMap::from([("id".to_owned(), id)]))
    }

    pub(crate) fn id(&self) -> &str {
        self.0.get("id").map_or("", String::as_str)
    }
}

/// Which items the variables of an entry may have; no condition for variables that are not named.
pub(crate) type Only = BTreeMap<String, Vec<String>>;

/// The items that variables stand for, and the conditions on them.
#[derive(Clone, Debug)]
pub(crate) struct Scope<'a> {
    words: &'a Words,
    bound: Vec<Variable>,
    conditions: Vec<&'a Only>,
}

/// A variable with its item, and the list that this comes from; none for a plain value.
#[derive(Clone, Debug)]
struct Variable {
    name: String,
    list: Option<String>,
    item: Item,
}

/// Texts refer to each other no deeper than this.
const DEPTH: usize = 8;

impl<'a> Scope<'a> {
    /// No variables.
    pub(crate) fn new(words: &'a Words) -> Self {
        Self { words, bound: Vec::new(), conditions: Vec::new() }
    }

    /// The same with one more condition.
    pub(crate) fn only(mut self, condition: &'a Only) -> Self {
        if !condition.is_empty() {
            self.conditions.push(condition);
        }
        self
    }

    /// All combinations of the items of lists, the last one the fastest. A variable has the name of its list, or another one:
    /// `other: subject`.
    pub(crate) fn each(&self, variables: &[String]) -> Result<Vec<Self>, TableError> {
        let Some((first, rest)) = variables.split_first() else { return Ok(vec![self.clone()]) };
        let (name, list) = first.split_once(": ").unwrap_or((first, first));
        let list = self.fill(list)?;
        let items = self.words.lists.get(&list).ok_or_else(|| TableError::NoList { list: list.clone() })?;
        let mut scopes = Vec::new();
        for item in items {
            scopes.extend(self.bound_to(name, Some(&list), item.clone()).each(rest)?);
        }
        Ok(scopes)
    }

    /// The same with these variables bound, each to the item with this id. A variable without a list has a plain value.
    pub(crate) fn with(&self, values: &BTreeMap<String, String>) -> Result<Self, TableError> {
        let mut scope = self.clone();
        for (name, value) in values {
            let id = self.fill(value)?;
            let list = self.variable(name).map_or(Some(name), |variable| variable.list.as_ref());
            let items = list.and_then(|list| self.words.lists.get(list).map(|items| (list, items)));
            scope = match items {
                None => scope.bound_to(name, None, Item::of(id)),
                Some((list, items)) => {
                    let item = items.iter().find(|item| item.id() == id);
                    let item = item.ok_or_else(|| TableError::NoItem { id, list: list.clone() })?;
                    scope.bound_to(name, Some(list), item.clone())
                }
            };
        }
        Ok(scope)
    }

    fn bound_to(&self, name: &str, list: Option<&String>, item: Item) -> Self {
        let mut scope = self.clone();
        scope.bound.push(Variable { name: name.to_owned(), list: list.cloned(), item });
        scope
    }

    fn variable(&self, name: &str) -> Option<&Variable> {
        self.bound.iter().rev().find(|variable| variable.name == name)
    }

    /// The id of the item of a variable.
    pub(crate) fn id(&self, name: &str) -> Option<&str> {
        self.variable(name).map(|variable| variable.item.id())
    }

    /// Whether the variables keep all conditions.
    pub(crate) fn is_meant(&self) -> Result<bool, TableError> {
        self.conditions.iter().try_fold(true, |is, condition| Ok(is & self.keeps(condition)?))
    }

    /// Whether the variables keep a condition.
    pub(crate) fn keeps(&self, condition: &Only) -> Result<bool, TableError> {
        let mut keeps = true;
        for (name, ids) in condition {
            let variable = self.variable(name).ok_or_else(|| self.unknown(name, "only"))?;
            if let Some(list) = &variable.list {
                let items = &self.words.lists[list];
                if let Some(id) = ids.iter().find(|id| items.iter().all(|item| item.id() != id.as_str())) {
                    return Err(TableError::NoItem { id: id.clone(), list: list.clone() });
                }
            }
            keeps &= ids.iter().any(|id| id == variable.item.id());
        }
        Ok(keeps)
    }

    /// A text with its variables filled in. `{runs}` stays: a figure fills it in when it is drawn.
    pub(crate) fn fill(&self, text: &str) -> Result<String, TableError> {
        self.filled(text, DEPTH)
    }

    fn filled(&self, text: &str, depth: usize) -> Result<String, TableError> {
        let mut filled = String::with_capacity(text.len());
        let mut rest = text;
        while let Some((before, after)) = rest.split_once('{') {
            let (name, after) = after.split_once('}').ok_or_else(|| self.unknown(after, text))?;
            filled.push_str(before);
            match self.value(name) {
                _ if name == RUNS => filled.push_str(&format!("{{{RUNS}}}")),
                Some(value) if depth > 0 => filled.push_str(&self.filled(value, depth - 1)?),
                _ => return Err(self.unknown(name, text)),
            }
            rest = after;
        }
        filled.push_str(rest);
        Ok(filled)
    }

    fn value(&self, name: &str) -> Option<&str> {
        let (variable, field) = name.split_once('.').unwrap_or((name, "id"));
        match self.variable(variable) {
            Some(variable) => variable.item.0.get(field).map(String::as_str),
            None => self.words.texts.get(name).map(String::as_str),
        }
    }

    fn unknown(&self, name: &str, text: &str) -> TableError {
        let known = self.bound.iter().map(|variable| variable.name.clone()).chain(self.words.texts.keys().cloned());
        TableError::NoVariable {
            name: name.to_owned(),
            text: text.to_owned(),
            known: known.collect::<Vec<_>>().join(", "),
        }
    }
}

/// The number of runs in the note of a figure.
pub(crate) const RUNS: &str = "runs";

#[cfg(test)]
mod tests {
    use super::*;

    fn words() -> Words {
        let fields = |fields: &[(&str, &str)]| {
            Item(fields.iter().map(|&(key, value)| (key.to_owned(), value.to_owned())).collect())
        };
        let room = [("hall", "the hall"), ("yard", "a yard")];
        let rooms = room.map(|(id, name)| fields(&[("id", id), ("name", name), ("file", "{room}-{speed}")])).to_vec();
        let speeds = ["slow", "fast"].map(|id| Item::of(id.to_owned())).to_vec();
        Words {
            lists: BTreeMap::from([("room".to_owned(), rooms), ("speed".to_owned(), speeds)]),
            texts: BTreeMap::from([("place".to_owned(), "{room.name}: ".to_owned())]),
        }
    }

    fn names(names: &[&str]) -> Vec<String> {
        names.iter().map(|&name| name.to_owned()).collect()
    }

    fn filled(scopes: &[Scope<'_>], text: &str) -> Vec<String> {
        scopes.iter().map(|scope| scope.fill(text).unwrap()).collect()
    }

    #[test]
    fn the_last_list_turns_fastest_and_fields_and_texts_are_filled_in() {
        let words = words();
        let scopes = Scope::new(&words).each(&names(&["room", "speed"])).unwrap();
        let shown = ["the hall: hall-slow", "the hall: hall-fast", "a yard: yard-slow", "a yard: yard-fast"];
        assert_eq!(filled(&scopes, "{place}{room.file}"), shown);
        let pairs = Scope::new(&words).each(&names(&["room", "other: room"])).unwrap();
        assert_eq!(filled(&pairs, "{room} {other.name}")[1], "hall a yard");
    }

    #[test]
    fn conditions_choose_items_of_bound_variables() {
        let words = words();
        let only = Only::from([("room".to_owned(), names(&["yard"])), ("speed".to_owned(), names(&["slow"]))]);
        let scopes = Scope::new(&words).only(&only).each(&names(&["room", "speed"])).unwrap();
        let meant: Vec<_> = scopes.into_iter().filter(|scope| scope.is_meant().unwrap()).collect();
        assert_eq!(filled(&meant, "{room} {speed}"), ["yard slow"]);
    }

    #[test]
    fn a_variable_is_bound_to_an_item_or_to_a_plain_value() {
        let words = words();
        let value = |name: &str, value: &str| BTreeMap::from([(name.to_owned(), value.to_owned())]);
        let scope = Scope::new(&words).with(&value("room", "yard")).unwrap().with(&value("turn", "{room}")).unwrap();
        assert_eq!(scope.fill("{room.name}, {turn}").unwrap(), "a yard, yard");
    }

    #[test]
    fn what_does_not_exist_is_named() {
        let words = words();
        let scope = Scope::new(&words);
        let yard = scope.with(&BTreeMap::from([("room".to_owned(), "yard".to_owned())])).unwrap();
        let no_room = Only::from([("room".to_owned(), names(&["garden"]))]);
        let no_variable = Only::from([("speed".to_owned(), names(&["slow"]))]);
        let endless = Words {
            texts: BTreeMap::from([("a".to_owned(), "{b}".to_owned()), ("b".to_owned(), "{a}".to_owned())]),
            ..Words::default()
        };
        for (error, part) in [
            (yard.fill("{room.size}").unwrap_err(), "`room.size`"),
            (yard.fill("{room").unwrap_err(), "`room`"),
            (scope.fill("in {house}").unwrap_err(), "`house`"),
            (scope.each(&names(&["house"])).unwrap_err(), "`house`"),
            (scope.with(&BTreeMap::from([("room".to_owned(), "attic".to_owned())])).unwrap_err(), "`attic`"),
            (yard.keeps(&no_room).unwrap_err(), "`garden`"),
            (yard.keeps(&no_variable).unwrap_err(), "`speed`"),
            (Scope::new(&endless).fill("{a}").unwrap_err(), "`a`"),
        ] {
            assert!(error.to_string().contains(part), "{error}");
        }
    }
}
