//! Detects accesses of the program that are not modelled.

use crate::board::Vesc6;
use crate::chip::memory::FLASH;
use rigless::session::Session;

/// The first unmodelled access, and its instruction if known.
pub(crate) fn gap(session: &Session<Vesc6>) -> Option<(String, Option<u32>)> {
    let by = session.board().troubled_by;
    // Stores into the flash array are handled by the array.
    let unmapped = session.unmapped().into_iter().find(|at| !FLASH.contains(&at.address));
    let unmapped =
        unmapped.map(|at| (format!("no register at {:#010x}", at.address), Some(at.program_counter as u32)));
    let refused = session.refused().iter().next().map(|(at, fault)| (format!("{at:#010x}: {fault}"), by));
    let unimplemented = session.unimplemented().iter().next().map(|(at, access)| {
        let what = format!("{}.{} at {at:#010x} has no model", access.instance, access.register);
        (what, Some(access.program_counter as u32))
    });
    let reason = session.told().next();
    let reason =
        reason.map(|reason| (format!("{}.{}: {}", reason.instance, reason.register, reason.reason), by));
    unmapped.or(refused).or(unimplemented).or(reason)
}
