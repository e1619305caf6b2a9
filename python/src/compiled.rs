//! Compiled functions as laws: machine code of numba, of a C library, or of another compiler, at an address that the
//! package has from Python. The only calls of foreign code.
#![allow(unsafe_code, reason = "what is at an address is known to its author only")]

use std::num::NonZeroUsize;

/// A function of two numbers to one, with C's calling convention: roll rate \[rad/s\] and speed \[m/s\] to a torque \[N m\].
type Code = unsafe extern "C" fn(f64, f64) -> f64;

/// A compiled function.
#[derive(Clone, Copy)]
pub(crate) struct Compiled(Code);

impl Compiled {
    /// The function at an address, which the package has from a pointer whose result and arguments are declared as doubles.
    pub(crate) fn at(address: NonZeroUsize) -> Self {
        let code = std::ptr::with_exposed_provenance::<()>(address.get());
        // SAFETY: not null; function pointers and data pointers have the same size. That there is a function, and of this
        // type, is the declaration of the pointer in Python.
        Self(unsafe { std::mem::transmute::<*const (), Code>(code) })
    }

    /// The torque \[N m\] at a roll rate \[rad/s\] and a speed \[m/s\], whatever number it is.
    pub(crate) fn torque_nm(self, roll_rate_rad_s: f64, speed_m_s: f64) -> f64 {
        // SAFETY: whoever passes a compiled function as a law promises (docs/python.md) that it is pure, that is, depends
        // on its two arguments only and changes nothing; that it can be called from any thread, from several at once, and
        // without the interpreter's lock; and that no exception leaves it. Whoever calls this keeps the owner of the code.
        unsafe { (self.0)(roll_rate_rad_s, speed_m_s) }
    }
}
