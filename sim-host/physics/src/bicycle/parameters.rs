//! The 25 parameters of the Whipple bicycle and gravity, in the symbols of Meijaard et al. 2007.
#![allow(non_snake_case, reason = "the symbols of the paper")]

/// A Whipple bicycle, Meijaard et al. 2007, Table 1.
///
/// Axes of the upright bicycle: origin at the rear contact, x forward, y right, z down. SI units, angles in
/// radians. Wheels are symmetric about their axles (`IRzz = IRxx`, `IFzz = IFxx`), frames about the plane y =
/// 0.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Parameters {
    /// Wheel base \[m\].
    pub w: f64,
    /// Trail \[m\].
    pub c: f64,
    /// Steer axis tilt \[rad\] (pi/2 minus head angle).
    pub lam: f64,
    /// Gravity \[m/s^2\].
    pub g: f64,
    /// Rear wheel radius \[m\].
    pub rR: f64,
    /// Rear wheel mass \[kg\].
    pub mR: f64,
    /// Rear wheel inertia about a diameter \[kg m^2\].
    pub IRxx: f64,
    /// Rear wheel inertia about the axle \[kg m^2\].
    pub IRyy: f64,
    /// Rear frame and rigid rider: centre of mass forward \[m\].
    pub xB: f64,
    /// Rear frame: centre of mass down, negative above the ground \[m\].
    pub zB: f64,
    /// Rear frame mass \[kg\].
    pub mB: f64,
    /// Rear frame inertia about its centre of mass \[kg m^2\].
    pub IBxx: f64,
    /// Rear frame inertia \[kg m^2\].
    pub IByy: f64,
    /// Rear frame inertia \[kg m^2\].
    pub IBzz: f64,
    /// Rear frame product of inertia, `-int x z dm` \[kg m^2\].
    pub IBxz: f64,
    /// Front frame (handlebar and fork): centre of mass forward \[m\].
    pub xH: f64,
    /// Front frame: centre of mass down \[m\].
    pub zH: f64,
    /// Front frame mass \[kg\].
    pub mH: f64,
    /// Front frame inertia about its centre of mass \[kg m^2\].
    pub IHxx: f64,
    /// Front frame inertia \[kg m^2\].
    pub IHyy: f64,
    /// Front frame inertia \[kg m^2\].
    pub IHzz: f64,
    /// Front frame product of inertia \[kg m^2\].
    pub IHxz: f64,
    /// Front wheel radius \[m\].
    pub rF: f64,
    /// Front wheel mass \[kg\].
    pub mF: f64,
    /// Front wheel inertia about a diameter \[kg m^2\].
    pub IFxx: f64,
    /// Front wheel inertia about the axle \[kg m^2\].
    pub IFyy: f64,
}

/// Names of the parameters in files, in the order of [`Parameters`].
pub const KEYS: [&str; 26] = [
    "w", "c", "lam", "g", "rR", "mR", "IRxx", "IRyy", "xB", "zB", "mB", "IBxx", "IByy", "IBzz", "IBxz", "xH",
    "zH", "mH", "IHxx", "IHyy", "IHzz", "IHxz", "rF", "mF", "IFxx", "IFyy",
];

impl Parameters {
    /// From values in the order of [`KEYS`].
    pub fn from_values(values: &[f64; 26]) -> Self {
        let [
            w,
            c,
            lam,
            g,
            rR,
            mR,
            IRxx,
            IRyy,
            xB,
            zB,
            mB,
            IBxx,
            IByy,
            IBzz,
            IBxz,
            xH,
            zH,
            mH,
            IHxx,
            IHyy,
            IHzz,
            IHxz,
            rF,
            mF,
            IFxx,
            IFyy,
        ] = *values;
        Self {
            w,
            c,
            lam,
            g,
            rR,
            mR,
            IRxx,
            IRyy,
            xB,
            zB,
            mB,
            IBxx,
            IByy,
            IBzz,
            IBxz,
            xH,
            zH,
            mH,
            IHxx,
            IHyy,
            IHzz,
            IHxz,
            rF,
            mF,
            IFxx,
            IFyy,
        }
    }

    /// The values in the order of [`KEYS`].
    pub fn to_values(&self) -> [f64; 26] {
        let p = self;
        [
            p.w, p.c, p.lam, p.g, p.rR, p.mR, p.IRxx, p.IRyy, p.xB, p.zB, p.mB, p.IBxx, p.IByy, p.IBzz,
            p.IBxz, p.xH, p.zH, p.mH, p.IHxx, p.IHyy, p.IHzz, p.IHxz, p.rF, p.mF, p.IFxx, p.IFyy,
        ]
    }
}
