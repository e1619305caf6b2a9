//! Values of a scenario that can be given in two forms: by name or in place, as a value or as "none".

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Error, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::borrow::Cow;
use std::fmt;
use std::marker::PhantomData;

/// The word for a limit or a stop that is off.
pub const NONE: &str = "none";

/// Something that has a name or a file, or its content in place.
#[derive(Clone, Debug, PartialEq)]
pub enum Content<T> {
    /// A built-in name, or a file.
    Named(String),
    /// The content itself.
    Given(Box<T>),
}

impl<T> Content<T> {
    /// The name or file; `None` for content in place.
    pub fn name(&self) -> Option<&str> {
        match self {
            Self::Named(name) => Some(name),
            Self::Given(_) => None,
        }
    }
}

impl<T> From<&str> for Content<T> {
    fn from(name: &str) -> Self {
        Self::Named(name.into())
    }
}

impl<T: Serialize> Serialize for Content<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Named(name) => name.serialize(serializer),
            Self::Given(content) => content.serialize(serializer),
        }
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Content<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Either<T>(PhantomData<T>);
        impl<'de, T: Deserialize<'de>> Visitor<'de> for Either<T> {
            type Value = Content<T>;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a name, a file, or the content of a file in place")
            }
            fn visit_str<E: Error>(self, name: &str) -> Result<Content<T>, E> {
                Ok(Content::Named(name.into()))
            }
            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Content<T>, A::Error> {
                T::deserialize(MapAccessDeserializer::new(map)).map(|t| Content::Given(Box::new(t)))
            }
        }
        deserializer.deserialize_any(Either(PhantomData))
    }
}

impl<T> JsonSchema for Content<T> {
    fn schema_name() -> Cow<'static, str> {
        "Content".into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({"anyOf": [{"type": "string"}, {"type": "object"}],
            "description": "A built-in name or a file, or the content of a file in place."})
    }
}

/// A value, or the word "none", which switches it off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OrNone<T> {
    /// Off.
    Off,
    /// The value.
    At(T),
}

impl<T> OrNone<T> {
    /// The value; `None` if off.
    pub fn value(self) -> Option<T> {
        match self {
            Self::Off => None,
            Self::At(value) => Some(value),
        }
    }

    /// As a value of a scenario; `None` is off.
    pub fn new(value: Option<T>) -> Self {
        value.map_or(Self::Off, Self::At)
    }
}

impl<T: Serialize> Serialize for OrNone<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Off => NONE.serialize(serializer),
            Self::At(value) => value.serialize(serializer),
        }
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for OrNone<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Either<T>(PhantomData<T>);
        impl<'de, T: Deserialize<'de>> Visitor<'de> for Either<T> {
            type Value = OrNone<T>;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a value or \"none\"")
            }
            fn visit_str<E: Error>(self, word: &str) -> Result<OrNone<T>, E> {
                match word {
                    NONE => Ok(OrNone::Off),
                    _ => Err(E::invalid_value(serde::de::Unexpected::Str(word), &self)),
                }
            }
            fn visit_i64<E: Error>(self, x: i64) -> Result<OrNone<T>, E> {
                self.visit_f64(x as f64)
            }
            fn visit_u64<E: Error>(self, x: u64) -> Result<OrNone<T>, E> {
                self.visit_f64(x as f64)
            }
            fn visit_f64<E: Error>(self, x: f64) -> Result<OrNone<T>, E> {
                T::deserialize(serde::de::value::F64Deserializer::new(x)).map(OrNone::At)
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<OrNone<T>, A::Error> {
                let value = T::deserialize(SeqAccessDeserializer::new(&mut items))?;
                // toml 1.2 reads an array of fixed length from a longer one.
                match items.next_element::<IgnoredAny>()? {
                    None => Ok(OrNone::At(value)),
                    Some(_) => Err(A::Error::custom("invalid length: more elements than expected")),
                }
            }
            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<OrNone<T>, A::Error> {
                T::deserialize(MapAccessDeserializer::new(map)).map(OrNone::At)
            }
        }
        deserializer.deserialize_any(Either(PhantomData))
    }
}

impl<T: JsonSchema> JsonSchema for OrNone<T> {
    fn schema_name() -> Cow<'static, str> {
        format!("{}OrNone", T::schema_name()).into()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let value = generator.subschema_for::<T>();
        json_schema!({"anyOf": [{"const": NONE}, value]})
    }
}

/// In a schema: a name alone, or a table.
pub(super) struct NameOr<T>(PhantomData<T>);

impl<T: JsonSchema> JsonSchema for NameOr<T> {
    fn schema_name() -> Cow<'static, str> {
        format!("NameOr{}", T::schema_name()).into()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let table = generator.subschema_for::<T>();
        json_schema!({"anyOf": [{"type": "string"}, table]})
    }
}

/// Reads a table, or a name alone as the table with this name.
pub(super) fn name_or_table<'de, D, T>(deserializer: D) -> Result<T, D::Error>
where
    D: Deserializer<'de>,
    T: Deserialize<'de> + From<String>,
{
    struct Either<T>(PhantomData<T>);
    impl<'de, T: Deserialize<'de> + From<String>> Visitor<'de> for Either<T> {
        type Value = T;
        fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
            f.write_str("a name, a file, or a table")
        }
        fn visit_str<E: Error>(self, name: &str) -> Result<T, E> {
            Ok(T::from(name.to_owned()))
        }
        fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<T, A::Error> {
            T::deserialize(MapAccessDeserializer::new(map))
        }
    }
    deserializer.deserialize_any(Either(PhantomData))
}
