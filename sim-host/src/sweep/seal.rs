//! Hashes that identify a result's inputs and detect damaged files.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

/// Content with its hash, as written.
#[derive(Serialize, Deserialize)]
struct Sealed<U> {
    sha256: String,
    unit: U,
}

/// SHA-256 in hexadecimal.
pub fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// SHA-256 of a value's JSON, in hexadecimal.
pub(super) fn hash(value: &impl Serialize) -> String {
    sha256(&serde_json::to_vec(value).unwrap_or_default())
}

/// Contents of a file with a value and its hash.
pub(super) fn sealed(unit: &impl Serialize) -> String {
    serde_json::to_string_pretty(&Sealed { sha256: hash(unit), unit }).unwrap_or_default() + "\n"
}

/// The value in a file's contents; `None` if they are damaged.
pub(super) fn unsealed<U: Serialize + DeserializeOwned>(bytes: &[u8]) -> Option<U> {
    let Sealed { sha256, unit } = serde_json::from_slice::<Sealed<U>>(bytes).ok()?;
    (sha256 == hash(&unit)).then_some(unit)
}
