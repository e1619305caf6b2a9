//! Steers and motors that were measured.

use super::{ActuatorConfig, Friction};

/// An actuator by name.
#[derive(Clone, Copy, Debug)]
pub struct Preset {
    /// Its name.
    pub name: &'static str,
    /// What it is and where the values come from.
    pub source: &'static str,
    /// The values.
    pub config: fn() -> ActuatorConfig,
}

/// All of them.
pub const PRESETS: [Preset; 3] = [
    Preset {
        name: "none",
        source: "gives the torque it is asked for, without friction",
        config: ActuatorConfig::default,
    },
    Preset {
        name: "davis",
        source: "steer friction of the Davis instrumented bicycle: 0.34 (sd 0.04) N m s/rad viscous, 0.15 (sd 0.05) N m Coulomb; J. K. Moore, Human Control of a Bicycle, 2012, chapter Davis Instrumented Bicycle",
        config: || ActuatorConfig { friction: DAVIS, ..ActuatorConfig::default() },
    },
    Preset {
        name: "gazelle",
        source: "balance-assist prototype on a Gazelle Grenoble: 7 N m; mechmotum/fall-probability-paper. Its friction and bandwidth are not published",
        config: || ActuatorConfig { limit_nm: Some(7.0), ..ActuatorConfig::default() },
    },
];

const DAVIS: Friction = Friction { viscous_nm_s_rad: 0.34, coulomb_nm: 0.15, creep_rad_s: 0.01 };

/// The actuator of a name.
pub fn preset(name: &str) -> Option<&'static Preset> {
    PRESETS.iter().find(|preset| preset.name == name)
}
