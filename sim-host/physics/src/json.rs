//! JSON values as TOML values, so that a file in either format is read by one reader.

use toml::Value;

/// A JSON value as a TOML value; `None` for null. A null in a list is a missing number, NaN; any other is left out.
///
/// Written out because another crate in a build may enable serde_json 1.0's feature `arbitrary_precision`, with which
/// numbers are maps for any type except serde_json's own.
pub fn as_toml(value: serde_json::Value) -> Option<Value> {
    use serde_json::Value as Json;
    match value {
        Json::Null => None,
        Json::Bool(on) => Some(Value::Boolean(on)),
        Json::Number(n) => n.as_i64().map(Value::Integer).or(n.as_f64().map(Value::Float)),
        Json::String(text) => Some(Value::String(text)),
        Json::Array(items) => {
            let items = items.into_iter().map(|item| as_toml(item).unwrap_or(Value::Float(f64::NAN)));
            Some(Value::Array(items.collect()))
        }
        Json::Object(entries) => {
            let entries = entries.into_iter().filter_map(|(key, value)| Some((key, as_toml(value)?)));
            Some(Value::Table(entries.collect()))
        }
    }
}
