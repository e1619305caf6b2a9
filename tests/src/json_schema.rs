//! The part of JSON Schema (draft 2020-12) that the committed schemas use, and stricter: an unknown key in a document
//! and an unknown keyword in a schema are violations too.

use serde_json::Value;

/// Keywords that do not affect which documents are valid.
const REMARKS: [&str; 6] = ["$schema", "$defs", "title", "description", "format", "default"];

/// Places and kinds of the violations of `schema` by `document`; empty if it is valid.
pub fn violations(schema: &Value, document: &Value) -> Vec<String> {
    let mut found = Vec::new();
    check(schema, schema, document, "$", &mut found);
    found
}

fn check(root: &Value, schema: &Value, value: &Value, at: &str, found: &mut Vec<String>) {
    let Some(rules) = schema.as_object() else {
        found.push(format!("{at}: no schema"));
        return;
    };
    for (keyword, rule) in rules {
        let fits = match keyword.as_str() {
            "$ref" => {
                let pointer = rule.as_str().unwrap_or_default().trim_start_matches('#');
                check(root, root.pointer(pointer).unwrap_or(&Value::Null), value, at, found);
                true
            }
            "anyOf" => list(rule).iter().any(|one| fits_alone(root, one, value, at)),
            "oneOf" => list(rule).iter().filter(|one| fits_alone(root, one, value, at)).count() == 1,
            "type" => match rule {
                Value::Array(kinds) => kinds.iter().any(|kind| is(value, kind)),
                kind => is(value, kind),
            },
            "const" => value == rule,
            "enum" => list(rule).contains(value),
            "minimum" => value.as_f64().is_none_or(|x| x >= rule.as_f64().unwrap_or(f64::NAN)),
            "maximum" => value.as_f64().is_none_or(|x| x <= rule.as_f64().unwrap_or(f64::NAN)),
            "minItems" => value.as_array().is_none_or(|a| a.len() as u64 >= rule.as_u64().unwrap_or(0)),
            "maxItems" => value.as_array().is_none_or(|a| a.len() as u64 <= rule.as_u64().unwrap_or(0)),
            "items" => {
                for (i, item) in list(value).iter().enumerate() {
                    check(root, rule, item, &format!("{at}[{i}]"), found);
                }
                true
            }
            "prefixItems" => {
                for (i, (item, rule)) in list(value).iter().zip(list(rule)).enumerate() {
                    check(root, rule, item, &format!("{at}[{i}]"), found);
                }
                true
            }
            "required" => list(rule).iter().all(|key| value.get(key.as_str().unwrap_or_default()).is_some()),
            "properties" | "additionalProperties" => true,
            remark if REMARKS.contains(&remark) => true,
            _ => false,
        };
        if !fits {
            found.push(format!("{at}: {keyword} {rule}, but {value}"));
        }
    }
    check_keys(root, schema, value, at, found);
}

/// Whether a value fits a schema by itself.
fn fits_alone(root: &Value, schema: &Value, value: &Value, at: &str) -> bool {
    let mut misfits = Vec::new();
    check(root, schema, value, at, &mut misfits);
    misfits.is_empty()
}

/// Every key of an object by its own rule, or by the rule for all others.
fn check_keys(root: &Value, schema: &Value, value: &Value, at: &str, found: &mut Vec<String>) {
    let closed = schema.get("properties").or(schema.get("additionalProperties")).is_some();
    for (key, item) in value.as_object().into_iter().flatten().filter(|_| closed) {
        let own = schema.get("properties").and_then(|p| p.get(key));
        match own.or(schema.get("additionalProperties")) {
            Some(rule) => check(root, rule, item, &format!("{at}.{key}"), found),
            None => found.push(format!("{at}.{key}: not in the schema")),
        }
    }
}

fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

fn is(value: &Value, kind: &Value) -> bool {
    match kind.as_str() {
        Some("null") => value.is_null(),
        Some("boolean") => value.is_boolean(),
        Some("number") => value.is_number(),
        Some("integer") => value.is_i64() || value.is_u64(),
        Some("string") => value.is_string(),
        Some("array") => value.is_array(),
        Some("object") => value.is_object(),
        _ => false,
    }
}
