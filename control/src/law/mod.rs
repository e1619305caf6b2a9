//! Roll-rate laws: the gain in `T = +gain(v) * roll_rate`, which steers into the fall.
//!
//! The thesis gives the feedback gain `K_phi_d(v)` in the Basu-Mandal axes, where steering into the fall is a negative
//! gain. Here `gain = -K_phi_d`, converted once, in this file.

pub mod capsize;
pub mod dead_band;
pub mod gain_schedule;
pub mod path_tracking;
pub mod real;

use crate::law::gain_schedule::GainSchedule;
use crate::law::real::Real;
use crate::param::{ParamError, ParamSpec, ParamVisitor};
use core::fmt;
use core::str::FromStr;

/// Declaration of a law: all but its formula.
#[derive(Clone, Copy, Debug)]
pub struct LawSpec {
    /// Name in options, files and lists.
    pub name: &'static str,
    /// Parameter of a law `NAME:VALUE` \[N s^2/rad\]; `None` for a law without one.
    pub parameter: Option<ParamSpec>,
    /// Builds the law from its parameter or its table, neither validated.
    pub build: fn(f32, GainSchedule) -> Law,
}

impl LawSpec {
    /// Whether the law is a table, whose points its name does not contain.
    pub fn is_table(&self) -> bool {
        matches!((self.build)(0.0, GainSchedule::default()), Law::Table(_))
    }
}

/// Every law. Its index is its number on the wire, which is permanent: a new law is appended.
pub static LAWS: [LawSpec; 9] = [
    LawSpec { name: "none", parameter: None, build: |_, _| Law::None },
    LawSpec { name: "h", parameter: None, build: |_, _| Law::H { cut: false } },
    LawSpec { name: "h-cut", parameter: None, build: |_, _| Law::H { cut: true } },
    LawSpec { name: "f", parameter: None, build: |_, _| Law::F },
    LawSpec { name: "g", parameter: None, build: |_, _| Law::G },
    LawSpec { name: "cl1", parameter: None, build: |_, _| Law::Cl1 },
    LawSpec { name: "cl2", parameter: Some(slope("cl2.k")), build: |k, _| Law::Cl2 { k } },
    LawSpec { name: "table", parameter: None, build: |_, table| Law::Table(table) },
    LawSpec {
        name: "balance-assist",
        parameter: Some(slope("balance-assist.kappa")),
        build: |kappa, _| Law::BalanceAssist { kappa },
    },
];

/// Names of [`LAWS`].
pub const LAW_NAMES: &[&str] = &{
    let mut names = [""; LAWS.len()];
    let mut i = 0;
    while i < names.len() {
        names[i] = LAWS[i].name;
        i += 1;
    }
    names
};

/// The law by its name, as a parameter.
pub const LAW: ParamSpec = ParamSpec::new("", "law", 0.0, (LAWS.len() - 1) as f32);

/// Slope of a gain over speed.
const fn slope(name: &'static str) -> ParamSpec {
    ParamSpec::new("law", name, 1e-3, 20.0)
}

/// Speed at and above which the balance assist is off \[m/s\].
const BALANCE_OFF_M_S: f64 = 4.7;
/// Speed up to which the balance assist grows with speed \[m/s\].
const BALANCE_FULL_M_S: f64 = 1.5;
/// Speed of the minimum of `f` \[m/s\], its vertex, where it is still positive.
const F_LEAST_M_S: f32 = 12.0 / 1.76;

/// A roll-rate law. Gains in N m s/rad, speeds in m/s. Formulas are the sources' `K_phi_d`, the negative of the gain,
/// except where a gain is stated.
#[derive(Clone, Debug, Default, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "no allocator to box the table with")]
pub enum Law {
    /// No assist.
    #[default]
    None,
    /// `h(v) = (4 v - 30) exp(-0.03 v^2)` (Kuipers 2020, eq. 3.13), the choice of the thesis. Its gain changes sign at
    /// 7.5 m/s and steers out of the fall above; `cut` makes it zero there.
    H {
        /// Zero above 7.5 m/s, as the thesis suggests.
        cut: bool,
    },
    /// `f(v) = -0.88 v^2 + 12 v - 41` (eq. 3.11).
    F,
    /// `g(v) = (v - 40) exp(-0.35 v)` (eq. 3.12).
    G,
    /// Gain `5.97 (6.7 - v)` below 6.7 m/s, zero above (eqs 3.6-3.7).
    Cl1,
    /// Gain `k (10 - v)` below 10 m/s, zero above (section 3.4.2), k > 0 in N s^2/rad.
    Cl2 {
        /// Slope of the gain over speed \[N s^2/rad\], 0.001..=20.
        k: f32,
    },
    /// A user's table.
    Table(GainSchedule),
    /// Gain `kappa (4.7 - v)` from 1.5 to 4.7 m/s, zero above; below 1.5 m/s linear from zero at rest. The balance
    /// assist of the Gazelle and TU Delft prototype (mechmotum/fall-probability-paper).
    BalanceAssist {
        /// Slope of the gain over speed \[N s^2/rad\], 0.001..=20; published 3.9 and 5.2.
        kappa: f32,
    },
}

impl Law {
    /// The gain at a forward speed \[m/s\], positive where the law steers into the fall.
    ///
    /// Finite for every speed within +-30 m/s, the range of the wheel speeds that [`crate::sensors::validation`]
    /// accepts.
    #[inline]
    pub fn gain<R: Real + PartialOrd>(&self, speed_m_s: R) -> R {
        let v = speed_m_s;
        let zero = R::lit(0.0);
        match self {
            Law::None => zero,
            Law::H { cut } => {
                if *cut && v >= R::lit(7.5) {
                    zero
                } else {
                    h(v)
                }
            }
            Law::F => f(v),
            Law::G => g(v),
            Law::Cl1 if v < R::lit(6.7) => R::lit(5.97) * (R::lit(6.7) - v),
            Law::Cl2 { k } if v < R::lit(10.0) => R::lit(f64::from(*k)) * (R::lit(10.0) - v),
            Law::BalanceAssist { kappa } if v > zero && v < R::lit(BALANCE_OFF_M_S) => {
                let kappa = R::lit(f64::from(*kappa));
                if v < R::lit(BALANCE_FULL_M_S) {
                    kappa * R::lit((BALANCE_OFF_M_S - BALANCE_FULL_M_S) / BALANCE_FULL_M_S) * v
                } else {
                    kappa * (R::lit(BALANCE_OFF_M_S) - v)
                }
            }
            Law::Cl1 | Law::Cl2 { .. } | Law::BalanceAssist { .. } => zero,
            Law::Table(table) => table.gain(v),
        }
    }

    /// The gain of a law that is one formula at every speed, as [`Law::gain`]; `None` for the others.
    #[inline(always)]
    pub fn formula<R: Real>(&self, speed_m_s: R) -> Option<R> {
        match self {
            Law::None => Some(R::lit(0.0)),
            Law::H { cut: false } => Some(h(speed_m_s)),
            Law::F => Some(f(speed_m_s)),
            Law::G => Some(g(speed_m_s)),
            _ => None,
        }
    }

    /// The gain of smallest magnitude between two speeds \[m/s\], in either order: 0 if the gain changes sign there.
    /// For a speed known only to be within bounds, no larger gain is safe at every speed.
    ///
    /// Two equal speeds give the bits of [`Law::gain`]. Exact except for the rounding of `gain`.
    pub fn gain_towards_zero(&self, one_m_s: f32, other_m_s: f32) -> f32 {
        let (low, high) = if one_m_s < other_m_s { (one_m_s, other_m_s) } else { (other_m_s, one_m_s) };
        // Here the gain falls with speed and stays positive. One evaluation of these laws takes as long as the rest of
        // this function.
        match self {
            // The derivative is zero at -1.79 and 9.29 m/s, the gain at 7.5 m/s.
            Law::H { .. } if low >= -1.7 && high <= 7.5 => return h(high),
            // The derivative is zero at 42.9 m/s, the gain at 40 m/s.
            Law::G if high <= 40.0 => return g(high),
            _ if low == high => return self.gain(high),
            _ => {}
        }
        let least = nearer_zero(self.gain(one_m_s), self.gain(other_m_s));
        let inside = |v: f32| low < v && v < high;
        // Every other law has its smallest magnitude at the ends of the range, at a zero crossing, or at these points.
        match self {
            Law::F if inside(F_LEAST_M_S) => nearer_zero(least, self.gain(F_LEAST_M_S)),
            Law::Table(table) => {
                let kinks = table.points().iter().filter(|(v, _)| inside(*v));
                kinks.fold(least, |least, (_, gain)| nearer_zero(least, *gain))
            }
            _ => least,
        }
    }

    /// The law's number on the wire: its index in [`LAW_NAMES`].
    pub fn number(&self) -> u8 {
        match self {
            Law::None => 0,
            Law::H { cut: false } => 1,
            Law::H { cut: true } => 2,
            Law::F => 3,
            Law::G => 4,
            Law::Cl1 => 5,
            Law::Cl2 { .. } => 6,
            Law::Table(_) => 7,
            Law::BalanceAssist { .. } => 8,
        }
    }

    /// Slope of the gain \[N s^2/rad\]; 0 for a law without a slope.
    pub fn slope(&self) -> f32 {
        match self {
            Law::Cl2 { k } => *k,
            Law::BalanceAssist { kappa } => *kappa,
            _ => 0.0,
        }
    }

    /// Declaration of this law.
    pub fn spec(&self) -> &'static LawSpec {
        let [none, ..] = &LAWS;
        LAWS.get(usize::from(self.number())).unwrap_or(none)
    }

    /// The law with this number, not validated; `None` for an unknown number.
    pub fn numbered(number: u8, slope: f32, table: GainSchedule) -> Option<Self> {
        LAWS.get(usize::from(number)).map(|spec| (spec.build)(slope, table))
    }

    /// Visits the law by its name, then its parameter, if it has one. A table keeps its points, which are no parameters.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        let (mut number, mut slope) = (self.number(), self.slope());
        let table = match self {
            Law::Table(table) => core::mem::take(table),
            _ => GainSchedule::default(),
        };
        to.choice(&LAW, LAW_NAMES, &mut number);
        if let Some(parameter) = LAWS.get(usize::from(number)).and_then(|spec| spec.parameter) {
            to.number(&parameter, &mut slope);
        }
        *self = Law::numbered(number, slope, table).unwrap_or_default();
    }

    /// Checks the law's own parameters.
    ///
    /// # Errors
    /// The parameter, its value and the allowed range.
    pub fn validate(&self) -> Result<(), ParamError> {
        if let Law::Table(table) = self {
            table.validate()?;
        }
        self.spec().parameter.map_or(Ok(()), |parameter| parameter.check(self.slope()))
    }
}

/// Writes `NAME`, or `NAME:VALUE` for a law with a parameter: [`Law::from_str`] reads it back, except a table.
impl fmt::Display for Law {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let LawSpec { name, parameter, .. } = self.spec();
        match parameter {
            Some(_) => write!(f, "{name}:{}", self.slope()),
            None => f.write_str(name),
        }
    }
}

/// Reason for which a text is not a law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LawError {
    /// No law has this name, or it is a table, which needs its points.
    Unknown,
    /// The law has this parameter, which is missing or not a number.
    NotANumber(ParamSpec),
    /// The law has no parameter.
    NoParameter,
    /// The parameter is outside its range.
    OutOfRange(ParamError),
}

impl FromStr for Law {
    type Err = LawError;

    /// Reads and validates `NAME` or `NAME:VALUE`.
    fn from_str(text: &str) -> Result<Self, LawError> {
        let (name, value) = text.split_once(':').map_or((text, None), |(name, value)| (name, Some(value)));
        let spec = LAWS.iter().find(|spec| spec.name == name && !spec.is_table()).ok_or(LawError::Unknown)?;
        let slope = match (spec.parameter, value) {
            (None, None) => 0.0,
            (None, Some(_)) => return Err(LawError::NoParameter),
            (Some(parameter), value) => {
                let number = value.and_then(|value| value.parse().ok());
                number.ok_or(LawError::NotANumber(parameter))?
            }
        };
        let law = (spec.build)(slope, GainSchedule::default());
        law.validate().map_err(LawError::OutOfRange)?;
        Ok(law)
    }
}

/// Gain of [`Law::H`] without the cut.
#[inline(always)]
fn h<R: Real>(v: R) -> R {
    (R::lit(30.0) - R::lit(4.0) * v) * (R::lit(-0.03) * v * v).exp()
}

/// Gain of [`Law::F`].
#[inline(always)]
fn f<R: Real>(v: R) -> R {
    R::lit(0.88) * v * v - R::lit(12.0) * v + R::lit(41.0)
}

/// Gain of [`Law::G`].
#[inline(always)]
fn g<R: Real>(v: R) -> R {
    (R::lit(40.0) - v) * (R::lit(-0.35) * v).exp()
}

/// The gain of smaller magnitude, or 0 if the signs differ.
fn nearer_zero(a: f32, b: f32) -> f32 {
    if (a > 0.0 && b < 0.0) || (a < 0.0 && b > 0.0) {
        0.0
    } else if b.abs() < a.abs() {
        b
    } else {
        a
    }
}
