//! Store of the parameters and the encoder's offset in flash: written atomically, validated when read.
//!
//! A configuration is one item of `sequential-storage`: after a power failure there is the old or the new one, never an
//! unchecked mixture (for example a motor's old sign with the new `polarity_checked`). Its record number is stored
//! after it. A record with a smaller number than that is an old one that damage to a newer one exposed; it is
//! invalid. The encoder's offset is stored in the same way, in two items of its own.

use crate::alignment::Alignment;
use crate::record::{self, Applied, InvalidRecord, NoRecord, RECORD_BYTES, Record};
use crate::requests::check_rate;
use crate::word_flash::WordFlash;
use control::Config;
use control::param::ParamError;
use core::fmt;
use core::ops::Range;
use embedded_storage_async::nor_flash::NorFlash;
use sequential_storage::cache::{Cache, Uncached};
use sequential_storage::map::{MapConfig, MapStorage};

/// Keys of two items: the record, and the number of the newest completely stored record.
#[derive(Clone, Copy)]
struct Keys {
    stored: u8,
    newest: u8,
}

const PARAMETERS: Keys = Keys { stored: 1, newest: 2 };
const ALIGNMENT: Keys = Keys { stored: 3, newest: 4 };

/// Overhead of a page beside its items, and of items beside their records, for words of up to 32 bytes \[bytes\].
const OVERHEAD: usize = 512;
/// Smallest page \[bytes\]: two records, so that one can be moved beside a new one.
pub const MIN_PAGE: usize = 2 * RECORD_BYTES + OVERHEAD;

/// Smallest number of pages. With two, an interrupted erase could destroy the only copy: the half-erased page can still
/// look valid and would be copied over the good one. With three, an erased page holds only outdated data.
pub const MIN_PAGES: usize = 3;

/// Work memory of the store; kept outside the stack because of its size.
#[derive(Debug)]
pub struct StoreBuffers {
    record: [u8; RECORD_BYTES],
    item: [u8; RECORD_BYTES + 64],
}

impl StoreBuffers {
    /// Zeroed memory.
    pub const fn new() -> Self {
        Self { record: [0; RECORD_BYTES], item: [0; RECORD_BYTES + 64] }
    }
}

impl Default for StoreBuffers {
    fn default() -> Self {
        Self::new()
    }
}

/// Result of loading the parameters at start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Found {
    /// Nothing is stored.
    Nothing,
    /// A valid record. If a value was rejected, or a calibration parameter is missing, the polarity check must be
    /// repeated.
    Record(Applied),
    /// An invalid record: the defaults are used.
    Invalid(InvalidRecord),
}

impl fmt::Display for Found {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Found::Nothing => write!(f, "none stored, defaults"),
            Found::Record(applied) => {
                write!(f, "stored ones")?;
                if let Some(first) = &applied.first_rejected {
                    write!(f, "; {} rejected, first {first}", applied.rejected)?;
                }
                if applied.missing > 0 {
                    write!(f, "; {} not among them have their defaults", applied.missing)?;
                }
                if applied.unknown > 0 {
                    write!(f, "; {} of another version ignored", applied.unknown)?;
                }
                Ok(())
            }
            Found::Invalid(InvalidRecord::Unreadable) => write!(f, "flash can't be read, defaults"),
            Found::Invalid(InvalidRecord::Lost) => write!(f, "the newest ones are lost, defaults"),
            Found::Invalid(InvalidRecord::NoRecord(NoRecord::Layout(layout))) => {
                write!(f, "stored in layout {layout}, which is not known, defaults")
            }
            Found::Invalid(InvalidRecord::NoRecord(NoRecord::Malformed)) => {
                write!(f, "stored ones are damaged, defaults")
            }
            Found::Invalid(InvalidRecord::Inconsistent(error)) => {
                write!(f, "stored ones do not fit together: {error}; defaults")
            }
        }
    }
}

/// Error of storing. The previous record stays, unless the flash did not accept anything beside it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NotStored {
    /// The configuration is invalid.
    Rejected(ParamError),
    /// More parameters than a record can hold.
    TooMany,
    /// Writing the flash failed, or it read back different data.
    Flash,
}

/// Parameters and the encoder's offset in a range of flash.
pub struct Store<F: NorFlash> {
    map: MapStorage<u8, WordFlash<F>, Cache<Uncached, Uncached, Uncached, u8>>,
}

impl<F: NorFlash> Store<F> {
    /// Uses a range of whole pages, at least [`MIN_PAGES`] of at least [`MIN_PAGE`] bytes each; `None` for any other
    /// range.
    pub fn new(flash: F, range: Range<u32>) -> Option<Self> {
        let length = range.end.saturating_sub(range.start) as usize;
        let large = F::ERASE_SIZE >= MIN_PAGE && length / F::ERASE_SIZE >= MIN_PAGES;
        let fits = large && range.end as usize <= flash.capacity();
        let config = fits.then(|| MapConfig::try_new(range).ok()).flatten()?;
        Some(Self { map: MapStorage::new(WordFlash(flash), config, Cache::new_uncached()) })
    }

    /// Returns the flash.
    pub fn into_flash(self) -> F {
        self.map.destroy().0.0
    }

    /// Loads the stored configuration, or `defaults`. The result passes `Config::plan` if `defaults` does.
    /// `polarity_checked` is cleared, so that the controller requires a new check, if the record is missing or invalid,
    /// if one of its values is rejected, or if it lacks a calibration parameter.
    pub async fn load(&mut self, defaults: &Config, buffers: &mut StoreBuffers) -> (Config, Found) {
        let mut unchecked = defaults.clone();
        unchecked.calibration.polarity_checked = false;
        let mut config = unchecked.clone();
        let found = match self.newest(&mut buffers.item).await {
            Ok(None) => Found::Nothing,
            Err(invalid) => Found::Invalid(invalid),
            Ok(Some(record)) => {
                let mut applied = record.apply(&mut config);
                if let Err(error) = check_rate(&config, defaults.rate_hz) {
                    config.rate_hz = defaults.rate_hz;
                    applied.rejected += 1;
                    applied.first_rejected = applied.first_rejected.or(Some(error));
                }
                if applied.rejected > 0 || applied.calibration_missing {
                    config.calibration.polarity_checked = false;
                }
                match config.clone().plan() {
                    Ok(_) => Found::Record(applied),
                    Err(error) => Found::Invalid(InvalidRecord::Inconsistent(error)),
                }
            }
        };
        (if matches!(found, Found::Record(_)) { config } else { unchecked }, found)
    }

    /// Stores a configuration and reads it back.
    ///
    /// If damage prevents this, everything but the encoder's offset is erased and storing is repeated once. The chip
    /// halts while the flash erases: never call this while torque can flow.
    ///
    /// # Errors
    /// As of [`NotStored`].
    pub async fn save(&mut self, config: &Config, buffers: &mut StoreBuffers) -> Result<(), NotStored> {
        config.clone().plan().map_err(NotStored::Rejected)?;
        let StoreBuffers { record: bytes, item } = buffers;
        let newest = self.number(PARAMETERS, item).await.ok().flatten().unwrap_or_default();
        let before = self.record(item).await.ok().flatten();
        let number = before.map_or(0, |before| before.number).max(newest).wrapping_add(1);
        let used = record::encode(config, number, before.as_ref(), bytes).ok_or(NotStored::TooMany)?;
        let bytes = bytes.get(..used).ok_or(NotStored::TooMany)?;
        // Before the write: afterwards damage can hide it.
        let aligned = self.numbered_alignment(item).await.ok().flatten();
        if self.write(PARAMETERS, number, bytes, item).await.is_ok() {
            return Ok(());
        }
        self.erase().await?;
        if let Some((number, alignment)) = aligned {
            self.write(ALIGNMENT, number, &alignment.encode(number), item).await?;
        }
        self.write(PARAMETERS, number, bytes, item).await
    }

    /// The newest alignment of the encoder; `None` if none is stored.
    ///
    /// # Errors
    /// The reason why the stored alignment is invalid.
    pub async fn alignment(
        &mut self,
        buffers: &mut StoreBuffers,
    ) -> Result<Option<Alignment>, InvalidRecord> {
        let numbered = self.numbered_alignment(&mut buffers.item).await?;
        Ok(numbered.map(|(_, alignment)| alignment))
    }

    /// Stores an alignment of the encoder and reads it back.
    ///
    /// If damage prevents this, everything but valid parameters is erased and storing is repeated once. The chip
    /// halts as in [`Store::save`].
    ///
    /// # Errors
    /// [`NotStored::Flash`].
    pub async fn save_alignment(
        &mut self,
        alignment: &Alignment,
        buffers: &mut StoreBuffers,
    ) -> Result<(), NotStored> {
        let StoreBuffers { record: parameters, item } = buffers;
        let newest = self.number(ALIGNMENT, item).await.ok().flatten().unwrap_or_default();
        let before = self.stored_alignment(item).await.ok().flatten();
        let number = before.map_or(0, |(number, _)| number).max(newest).wrapping_add(1);
        let bytes = alignment.encode(number);
        // Before the write: afterwards damage can hide them.
        let valid = self.newest(item).await.ok().flatten().map(|record| record.number);
        let copied = self.copy(PARAMETERS, item, parameters).await;
        if self.write(ALIGNMENT, number, &bytes, item).await.is_ok() {
            return Ok(());
        }
        self.erase().await?;
        if let (Some(number), Some(parameters)) = (valid, copied) {
            self.write(PARAMETERS, number, parameters, item).await?;
        }
        self.write(ALIGNMENT, number, &bytes, item).await
    }

    /// Writes a record and its number, and reads both back.
    async fn write(
        &mut self,
        keys: Keys,
        number: u32,
        bytes: &[u8],
        item: &mut [u8],
    ) -> Result<(), NotStored> {
        self.map.store_item(item, &keys.stored, &bytes).await.map_err(|_| NotStored::Flash)?;
        self.map.store_item(item, &keys.newest, &number).await.map_err(|_| NotStored::Flash)?;
        let numbered = self.number(keys, item).await == Ok(Some(number));
        match self.stored(keys, item).await {
            Ok(Some(stored)) if numbered && stored == bytes => Ok(()),
            _ => Err(NotStored::Flash),
        }
    }

    /// Erases everything, values of other versions included.
    ///
    /// # Errors
    /// Erasing the flash failed.
    pub async fn erase(&mut self) -> Result<(), NotStored> {
        self.map.erase_all().await.map_err(|_| NotStored::Flash)
    }

    /// The newest record, if valid.
    async fn newest<'r>(&mut self, item: &'r mut [u8]) -> Result<Option<Record<'r>>, InvalidRecord> {
        let newest = self.number(PARAMETERS, item).await?;
        let record = self.record(item).await?;
        newest_only(record, |record| record.number, newest)
    }

    /// The newest alignment and its number, if valid.
    async fn numbered_alignment(
        &mut self,
        item: &mut [u8],
    ) -> Result<Option<(u32, Alignment)>, InvalidRecord> {
        let newest = self.number(ALIGNMENT, item).await?;
        let stored = self.stored_alignment(item).await?;
        newest_only(stored, |(number, _)| *number, newest)
    }

    async fn record<'r>(&mut self, item: &'r mut [u8]) -> Result<Option<Record<'r>>, InvalidRecord> {
        let bytes = self.stored(PARAMETERS, item).await?;
        bytes.map(|bytes| record::decode(bytes).map_err(InvalidRecord::NoRecord)).transpose()
    }

    async fn stored_alignment(&mut self, item: &mut [u8]) -> Result<Option<(u32, Alignment)>, InvalidRecord> {
        let bytes = self.stored(ALIGNMENT, item).await?;
        bytes.map(|bytes| Alignment::decode(bytes).map_err(InvalidRecord::NoRecord)).transpose()
    }

    async fn stored<'r>(
        &mut self,
        keys: Keys,
        item: &'r mut [u8],
    ) -> Result<Option<&'r [u8]>, InvalidRecord> {
        self.map.fetch_item::<&[u8]>(item, &keys.stored).await.map_err(|_| InvalidRecord::Unreadable)
    }

    async fn number(&mut self, keys: Keys, item: &mut [u8]) -> Result<Option<u32>, InvalidRecord> {
        self.map.fetch_item::<u32>(item, &keys.newest).await.map_err(|_| InvalidRecord::Unreadable)
    }

    /// Copies the stored record into `to`; `None` if there is none, it can't be read or is too long.
    async fn copy<'t>(&mut self, keys: Keys, item: &mut [u8], to: &'t mut [u8]) -> Option<&'t [u8]> {
        let stored = self.stored(keys, item).await.ok().flatten()?;
        let to = to.get_mut(..stored.len())?;
        to.copy_from_slice(stored);
        Some(to)
    }
}

/// The record found, unless it is older than the newest completely stored one.
fn newest_only<T>(
    found: Option<T>,
    number: impl Fn(&T) -> u32,
    newest: Option<u32>,
) -> Result<Option<T>, InvalidRecord> {
    match (found, newest) {
        (Some(found), Some(newest)) if number(&found) < newest => Err(InvalidRecord::Lost),
        (None, Some(_)) => Err(InvalidRecord::Lost),
        (found, _) => Ok(found),
    }
}
