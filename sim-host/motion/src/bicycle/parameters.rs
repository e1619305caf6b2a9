//! The 25 parameters of the Whipple bicycle and gravity, in the symbols of Meijaard et al. 2007.
#![allow(non_snake_case, reason = "the symbols of the paper")]

/// Declares every parameter once: its field, its name in files, its unit and its allowed range.
macro_rules! parameters {
    ($($(#[$doc:meta])* $name:ident: $unit:literal, $min:literal to $max:literal;)*) => {
        /// A Whipple bicycle, Meijaard et al. 2007, Table 1.
        ///
        /// Axes of the upright bicycle: origin at the rear contact, x forward, y right, z down. SI units, angles in
        /// radians. Wheels are symmetric about their axles (`IRzz = IRxx`, `IFzz = IFxx`), frames about the plane y =
        /// 0.
        #[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
        #[serde(deny_unknown_fields)]
        pub struct Parameters {
            $($(#[$doc])* pub $name: f64,)*
        }

        /// Names of the parameters in files, in the order of [`Parameters`].
        pub const KEYS: [&str; 26] = [$(stringify!($name)),*];

        /// Unit and allowed range of each parameter, in the order of [`KEYS`].
        pub const RANGES: [(&str, f64, f64); 26] = [$(($unit, $min, $max)),*];

        impl Parameters {
            /// From values in the order of [`KEYS`].
            pub fn from_values(values: &[f64; 26]) -> Self {
                let [$($name),*] = *values;
                Self { $($name),* }
            }

            /// The values in the order of [`KEYS`].
            pub fn to_values(&self) -> [f64; 26] {
                [$(self.$name),*]
            }
        }
    };
}

parameters! {
    /// Wheel base \[m\].
    w: "m", 0.1 to 5.0;
    /// Trail \[m\].
    c: "m", -1.0 to 1.0;
    /// Steer axis tilt \[rad\] (pi/2 minus head angle).
    lam: "rad", -1.0 to 1.4;
    /// Gravity \[m/s^2\].
    g: "m/s^2", 0.01 to 30.0;
    /// Rear wheel radius \[m\].
    rR: "m", 0.02 to 1.5;
    /// Rear wheel mass \[kg\].
    mR: "kg", 1e-6 to 100.0;
    /// Rear wheel inertia about a diameter \[kg m^2\].
    IRxx: "kg m^2", 1e-9 to 100.0;
    /// Rear wheel inertia about the axle \[kg m^2\].
    IRyy: "kg m^2", 1e-9 to 100.0;
    /// Rear frame and rigid rider: centre of mass forward \[m\].
    xB: "m", -3.0 to 5.0;
    /// Rear frame: centre of mass down, negative above the ground \[m\].
    zB: "m", -5.0 to -1e-3;
    /// Rear frame mass \[kg\].
    mB: "kg", 1e-3 to 1000.0;
    /// Rear frame inertia about its centre of mass \[kg m^2\].
    IBxx: "kg m^2", 1e-9 to 1000.0;
    /// Rear frame inertia \[kg m^2\].
    IByy: "kg m^2", 1e-9 to 1000.0;
    /// Rear frame inertia \[kg m^2\].
    IBzz: "kg m^2", 1e-9 to 1000.0;
    /// Rear frame product of inertia, `-int x z dm` \[kg m^2\].
    IBxz: "kg m^2", -1000.0 to 1000.0;
    /// Front frame (handlebar and fork): centre of mass forward \[m\].
    xH: "m", -3.0 to 5.0;
    /// Front frame: centre of mass down \[m\].
    zH: "m", -5.0 to -1e-3;
    /// Front frame mass \[kg\].
    mH: "kg", 1e-3 to 1000.0;
    /// Front frame inertia about its centre of mass \[kg m^2\].
    IHxx: "kg m^2", 1e-9 to 1000.0;
    /// Front frame inertia \[kg m^2\].
    IHyy: "kg m^2", 1e-9 to 1000.0;
    /// Front frame inertia \[kg m^2\].
    IHzz: "kg m^2", 1e-9 to 1000.0;
    /// Front frame product of inertia \[kg m^2\].
    IHxz: "kg m^2", -1000.0 to 1000.0;
    /// Front wheel radius \[m\].
    rF: "m", 0.02 to 1.5;
    /// Front wheel mass \[kg\].
    mF: "kg", 1e-6 to 100.0;
    /// Front wheel inertia about a diameter \[kg m^2\].
    IFxx: "kg m^2", 1e-9 to 100.0;
    /// Front wheel inertia about the axle \[kg m^2\].
    IFyy: "kg m^2", 1e-9 to 100.0;
}

/// Unit and range of a parameter, as text.
pub fn describe(key: &str) -> String {
    let Some(i) = KEYS.iter().position(|k| *k == key) else { return String::new() };
    let (unit, min, max) = RANGES[i];
    format!("it must be a number from {min} to {max} {unit}")
}
