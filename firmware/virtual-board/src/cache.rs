//! Data cache of the flash: whether it can contain erased data.
//!
//! RM0090 rev 22, 3.5.2 and 3.6.4: programming a word updates the cache, erasing a sector does not; DCRST empties the
//! cache, only while DCEN is off. Single lines are not modelled: a cache that was on can contain any of them.

use rigless::soc::stm32f427::generated::flash::acr;

/// Possible content of the cache.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct DataCache {
    on: bool,
    /// Whether it was on since it was emptied.
    filled: bool,
    /// Whether a sector was erased since then.
    stale: bool,
}

impl DataCache {
    /// Off and empty.
    pub(crate) const fn new() -> Self {
        Self { on: false, filled: false, stale: false }
    }

    /// Updates the state after a write to register ACR, with its new value.
    pub(crate) fn control(&mut self, register: u64) {
        if acr::DCRST.is_set(register) {
            (self.filled, self.stale) = (false, false);
        }
        self.on = acr::DCEN.is_set(register);
        self.filled |= self.on;
    }

    /// Updates the state after an erase.
    pub(crate) fn erased(&mut self) {
        self.stale = self.filled;
    }

    /// Updates the state after a reset of the chip.
    pub(crate) fn reset(&mut self) {
        *self = Self::new();
    }

    /// Whether a read can return erased data.
    pub(crate) fn answers_with_erased(self) -> bool {
        self.on && self.stale
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ON: u64 = 1 << 10;
    const EMPTIED: u64 = 1 << 12;

    /// Situation: a cache that is on, or off. Action: an erase, with the cache emptied before, after, or not at all.
    /// Must hold: the cache returns erased data only if it was on before, and is on again without having been emptied
    /// after.
    #[test]
    fn only_emptying_after_the_erase_helps() {
        let answers = |writes: &[Option<u64>]| {
            let mut cache = DataCache::new();
            writes.iter().for_each(|write| match write {
                Some(register) => cache.control(*register),
                None => cache.erased(),
            });
            cache.answers_with_erased()
        };
        assert!(answers(&[Some(ON), None]));
        assert!(answers(&[Some(ON), Some(0), None, Some(ON)]));
        assert!(answers(&[Some(ON), Some(0), Some(EMPTIED), Some(ON), None]));
        assert!(!answers(&[Some(ON), Some(0), None, Some(EMPTIED), Some(0), Some(ON)]));
        assert!(!answers(&[Some(ON), Some(0), None]));
        assert!(!answers(&[Some(0), None, Some(ON)]));
    }
}
