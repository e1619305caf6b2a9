//! Why a chip started, and what it does with its last moments.

/// Why the chip started.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ResetCause {
    /// The supply came.
    PowerOn,
    /// The supply sagged.
    BrownOut,
    /// The reset pin was pulled.
    Pin,
    /// The program asked for it.
    Software,
    /// The watchdog was not fed.
    Watchdog,
    /// It went to a low-power mode that it is not allowed.
    LowPower,
}

/// What is still to be done when the supply is about to fail; the outputs are off already. Called from an interrupt.
pub fn brown_out() {}
