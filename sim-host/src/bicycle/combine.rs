//! Combines a bicycle with a rider's body, as the Python package BicycleParameters does (`combine_bike_rider`).

use super::Parameters;

/// Keys of a rider's body, in the bicycle's axes: mass \[kg\], centre of mass \[m\], inertia about the centre
/// of mass \[kg m^2\].
pub const RIDER_KEYS: [&str; 8] = ["mB", "xB", "yB", "zB", "IBxx", "IBxz", "IByy", "IBzz"];

/// The bicycle with a rider's body (in the order of [`RIDER_KEYS`]) fixed to its rear frame.
pub fn combined(bicycle: &Parameters, rider: &[f64; RIDER_KEYS.len()]) -> Parameters {
    let p = *bicycle;
    let [m, x, y, z, xx, xz, yy, zz] = *rider;
    let mass = m + p.mB;
    let middle = |rider: f64, frame: f64| (m * rider + p.mB * frame) / mass;
    let (cx, cy, cz) = (middle(x, p.xB), middle(y, 0.0), middle(z, p.zB));
    // Parallel-axis theorem; the frame's centre is taken in the plane y = 0 of the whole, as in the package.
    let (r, f) = ((x - cx, y - cy, z - cz), (p.xB - cx, 0.0, p.zB - cz));
    let sum = |of: fn((f64, f64, f64)) -> f64| m * of(r) + p.mB * of(f);
    Parameters {
        mB: mass,
        xB: cx,
        zB: cz,
        IBxx: xx + p.IBxx + sum(|(_, y, z)| y * y + z * z),
        IBxz: xz + p.IBxz - sum(|(x, _, z)| x * z),
        IByy: yy + p.IByy + sum(|(x, _, z)| x * x + z * z),
        IBzz: zz + p.IBzz + sum(|(x, y, _)| x * x + y * y),
        ..p
    }
}
