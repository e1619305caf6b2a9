//! A motor's first-order response, in closed form over a step of any length.

/// Longest step at a jump of the torque, relative to the time constant, and its growth with the time since then.
const START: f64 = 0.25;
const GROWTH: f64 = 0.15;

/// A torque over some time, at its start, middle and end \[N m\].
pub(super) type Parabola = [f64; 3];

/// The torque after a fraction `part` of the time.
pub(super) fn between([start, middle, end]: &Parabola, part: f64) -> f64 {
    let curved = 2.0 * (start - 2.0 * middle + end);
    start + part * (end - start - curved * (1.0 - part))
}

/// A first-order response.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lag {
    /// Its time constant, above zero \[s\].
    pub(super) time_constant_s: f64,
}

impl Lag {
    /// Longest step `elapsed_s` after a jump of the torque, to which the response is an exponential that fades \[s\].
    pub(super) fn longest_step_s(&self, elapsed_s: f64) -> f64 {
        START * self.time_constant_s + GROWTH * elapsed_s.max(0.0)
    }

    /// The response after `elapsed_s` in which the torque behaved as `torque_nm`, if it `began_nm` \[N m\].
    #[inline(always)]
    pub(super) fn after(&self, began_nm: f64, torque_nm: &Parabola, elapsed_s: f64) -> f64 {
        if elapsed_s <= 0.0 {
            return began_nm;
        }
        let [start, middle, end] = torque_nm;
        let constants = self.time_constant_s / elapsed_s;
        let (change, curved) = (end - start, 2.0 * (start - 2.0 * middle + end));
        // The response once its start is forgotten, at the start and at the end: torque - T torque' + T^2 torque''.
        let forgotten =
            |torque_nm: f64, slope_nm: f64| torque_nm - constants * (slope_nm - 2.0 * constants * curved);
        let left = libm::exp(-1.0 / constants);
        forgotten(*end, change + curved) + (began_nm - forgotten(*start, change - curved)) * left
    }
}

#[cfg(test)]
mod tests {
    use super::{Lag, between};

    /// A torque that is a parabola over 15 ms, time constants from a twentieth of it to a hundredfold: Euler steps of a millionth of
    /// that time give the same response within their error, and the response after two parts is that after the whole.
    #[test]
    fn the_response_is_exact_for_a_parabola() {
        const WHOLE_S: f64 = 15e-3;
        let torque_nm = [1.0, -2.0, 0.5];
        for time_constant_s in [0.75e-3, 5e-3, 40e-3, 1.5] {
            let lag = Lag { time_constant_s };
            let whole = lag.after(3.0, &torque_nm, WHOLE_S);
            let h = WHOLE_S / 1e6;
            let small = (0..1_000_000).fold(3.0, |now, i| {
                now + h / time_constant_s * (between(&torque_nm, (f64::from(i) + 0.5) / 1e6) - now)
            });
            assert!((whole - small).abs() < 1e-4, "{whole} for {small} N m with {time_constant_s} s");
            let part =
                |from: f64, to: f64| [0.0, 0.5, 1.0].map(|s| between(&torque_nm, from + s * (to - from)));
            let first = lag.after(3.0, &part(0.0, 0.3), 0.3 * WHOLE_S);
            let both = lag.after(first, &part(0.3, 1.0), 0.7 * WHOLE_S);
            assert!((whole - both).abs() < 1e-11, "{whole} and in two parts {both} N m");
        }
    }
}
