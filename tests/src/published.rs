//! Published values: `data/published.toml`, each entry with its source, and its tolerance with the reason for it.

use toml::{Table, Value};

const PUBLISHED: &str = include_str!("../../data/published.toml");

/// One entry of the file.
pub struct Published {
    name: String,
    table: Table,
}

/// The names of all entries.
pub fn names() -> Vec<String> {
    entries().into_iter().map(|(name, _)| name).collect()
}

/// The entry called `name`.
///
/// # Panics
/// If there is none.
pub fn entry(name: &str) -> Published {
    match entries().remove(name) {
        Some(Value::Table(table)) => Published { name: name.into(), table },
        _ => panic!("no entry {name} in data/published.toml"),
    }
}

fn entries() -> Table {
    PUBLISHED.parse().expect("data/published.toml is valid TOML")
}

impl Published {
    /// The tolerance of comparisons with the entry's values.
    pub fn tolerance(&self) -> f64 {
        self.number("tolerance")
    }

    /// Whether it has a key.
    pub fn has(&self, key: &str) -> bool {
        self.table.contains_key(key)
    }

    /// A text: `source`, `reason`.
    pub fn text(&self, key: &str) -> &str {
        self.get(key).as_str().unwrap_or_else(|| panic!("{}.{key} is no text", self.name))
    }

    /// A number.
    pub fn number(&self, key: &str) -> f64 {
        self.float(key, self.get(key))
    }

    /// A row of numbers.
    pub fn row<const N: usize>(&self, key: &str) -> [f64; N] {
        self.floats(key, self.get(key))
    }

    /// Rows of `N` numbers each.
    pub fn rows<const N: usize>(&self, key: &str) -> Vec<[f64; N]> {
        self.list(key, self.get(key)).iter().map(|row| self.floats(key, row)).collect()
    }

    /// A 2 x 2 matrix, row by row.
    pub fn matrix(&self, key: &str) -> [[f64; 2]; 2] {
        self.rows(key).try_into().unwrap_or_else(|_| panic!("{}.{key} is no 2 x 2 matrix", self.name))
    }

    fn get(&self, key: &str) -> &Value {
        self.table.get(key).unwrap_or_else(|| panic!("no {}.{key} in data/published.toml", self.name))
    }

    fn list<'a>(&self, key: &str, value: &'a Value) -> &'a [Value] {
        value.as_array().unwrap_or_else(|| panic!("{}.{key} is no list", self.name))
    }

    fn floats<const N: usize>(&self, key: &str, value: &Value) -> [f64; N] {
        let list: Vec<f64> = self.list(key, value).iter().map(|v| self.float(key, v)).collect();
        list.try_into().unwrap_or_else(|_| panic!("{}.{key} has no {N} numbers", self.name))
    }

    fn float(&self, key: &str, value: &Value) -> f64 {
        value.as_float().unwrap_or_else(|| panic!("{}.{key} is no decimal number", self.name))
    }
}
