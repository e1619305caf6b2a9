//! Warnings about a rider on a bicycle for which its gains are not made.

use super::RiderTable;
use crate::bicycle::catalogue::{self, Bicycle};

/// A rear frame lighter than this includes no rider \[kg\]: the heaviest shipped frame without a rider has
/// 22.9 kg; the lightest with part of one, legs, has 33 kg.
const EMPTY_KG: f64 = 30.0;

/// Warnings about a rider's gains on a bicycle, as text.
pub fn compatibility_warnings(bicycle: &Bicycle, rider: &RiderTable) -> Vec<String> {
    let Bicycle { name, parameters, rider_included, .. } = bicycle;
    let empty = match rider_included {
        Some(false) => Some(format!("bicycle {name} has no rider's body (rider_included = false)")),
        None if parameters.mB < EMPTY_KG => Some(format!(
            "bicycle {name} may have no rider's body: its rear frame weighs {} kg",
            parameters.mB
        )),
        _ => None,
    };
    let empty = empty.map(|what| format!("{what}, but rider {} steers it", rider.name));
    let other = rider.bicycle.as_ref().filter(|made_for| !is_same(bicycle, made_for)).map(|made_for| {
        format!("the gains of rider {} are made for bicycle {made_for}, not for {name}", rider.name)
    });
    empty.into_iter().chain(other).collect()
}

/// Whether a bicycle has the given name, or the values of the bicycle with that name.
fn is_same(bicycle: &Bicycle, name: &str) -> bool {
    bicycle.name == name || catalogue::load(name).is_ok_and(|named| named.parameters == bicycle.parameters)
}
