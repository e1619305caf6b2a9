//! The parameters and the encoder's offset in flash: kept whole, read back with suspicion.
//!
//! A configuration is stored as one item of `sequential-storage`: after a loss of power there is the old one
//! or the new one, never a mixture that nobody checked (a motor's old sign with the new "polarity checked").
//! After it its number is stored. A record with a smaller number than that is an old one, laid bare by
//! damage to a newer, and is not believed. The same holds of the encoder's offset, in two items of its own.

use crate::alignment::Alignment;
use crate::record::{self, Applied, NoRecord, RECORD_BYTES, Record};
use crate::word_flash::WordFlash;
use control::Config;
use control::param::ParamError;
use core::fmt;
use core::ops::Range;
use embedded_storage_async::nor_flash::NorFlash;
use sequential_storage::cache::{Cache, Uncached};
use sequential_storage::map::{MapConfig, MapStorage};

/// The keys of two items: what is kept, and the number of the newest that was stored to the end.
#[derive(Clone, Copy)]
struct Keys {
    kept: u8,
    newest: u8,
}

const PARAMETERS: Keys = Keys { kept: 1, newest: 2 };
const ALIGNMENT: Keys = Keys { kept: 3, newest: 4 };

/// Bytes of a page beside the items, and of the items beside the record, at words of up to 32 bytes.
const OVERHEAD: usize = 512;
/// Bytes that a page must have: two records, so that one can be carried over beside a new one.
pub const MIN_PAGE: usize = 2 * RECORD_BYTES + OVERHEAD;

/// Pages that a store must have. With two, an erase that was interrupted could take the only copy with it: the
/// half-erased page may still look whole, and would then be copied over the good one. With three, the page that is
/// erased holds nothing but what is out of date.
pub const MIN_PAGES: usize = 3;

/// What the store works in; beside the stack, as it is large.
#[derive(Debug)]
pub struct Room {
    record: [u8; RECORD_BYTES],
    item: [u8; RECORD_BYTES + 64],
}

impl Room {
    /// Empty.
    pub const fn new() -> Self {
        Self { record: [0; RECORD_BYTES], item: [0; RECORD_BYTES + 64] }
    }
}

impl Default for Room {
    fn default() -> Self {
        Self::new()
    }
}

/// Why what is stored is not believed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Doubt {
    /// The flash, or its pages, can't be read.
    Unreadable,
    /// The newest record is gone, perhaps leaving an older one.
    Lost,
    /// It is no record.
    NoRecord(NoRecord),
    /// Its values do not fit together.
    Unfit(ParamError),
}

/// What was found at start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Found {
    /// Nothing was ever stored, or everything was erased.
    Nothing,
    /// A record. When any value of it was refused, or one of the calibration is missing, the polarity
    /// check is to be passed anew.
    Record(Applied),
    /// Something that is not believed: these are the defaults.
    Doubt(Doubt),
}

impl fmt::Display for Found {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Found::Nothing => write!(f, "none stored, defaults"),
            Found::Record(applied) => {
                write!(f, "stored ones")?;
                if let Some(first) = &applied.first_refused {
                    write!(f, "; {} refused, first {first}", applied.refused)?;
                }
                if applied.missing > 0 {
                    write!(f, "; {} not among them have their defaults", applied.missing)?;
                }
                if applied.unknown > 0 {
                    write!(f, "; {} of another version ignored", applied.unknown)?;
                }
                Ok(())
            }
            Found::Doubt(Doubt::Unreadable) => write!(f, "flash can't be read, defaults"),
            Found::Doubt(Doubt::Lost) => write!(f, "the newest ones are lost, defaults"),
            Found::Doubt(Doubt::NoRecord(NoRecord::Layout(layout))) => {
                write!(f, "stored in layout {layout}, which is not known, defaults")
            }
            Found::Doubt(Doubt::NoRecord(NoRecord::Malformed)) => {
                write!(f, "stored ones are damaged, defaults")
            }
            Found::Doubt(Doubt::Unfit(error)) => {
                write!(f, "stored ones do not fit together: {error}; defaults")
            }
        }
    }
}

/// Why nothing was stored. What was stored before still is, unless the flash took nothing beside it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NotStored {
    /// The configuration would not be accepted.
    Refused(ParamError),
    /// More parameters than a record holds.
    TooMany,
    /// The flash can't be written, or does not give back what was written.
    Flash,
}

/// Parameters and the encoder's offset in a range of flash.
pub struct Store<F: NorFlash> {
    map: MapStorage<u8, WordFlash<F>, Cache<Uncached, Uncached, Uncached, u8>>,
}

impl<F: NorFlash> Store<F> {
    /// In a range of whole pages, at least [`MIN_PAGES`] of at least [`MIN_PAGE`] bytes each; `None` for any other.
    pub fn new(flash: F, range: Range<u32>) -> Option<Self> {
        let length = range.end.saturating_sub(range.start) as usize;
        let large = F::ERASE_SIZE >= MIN_PAGE && length / F::ERASE_SIZE >= MIN_PAGES;
        let fits = large && range.end as usize <= flash.capacity();
        let config = fits.then(|| MapConfig::try_new(range).ok()).flatten()?;
        Some(Self { map: MapStorage::new(WordFlash(flash), config, Cache::new_uncached()) })
    }

    /// The flash back.
    pub fn into_flash(self) -> F {
        self.map.destroy().0.0
    }

    /// The stored configuration, or `defaults`. Always one that `Config::plan` accepts if it accepts `defaults`;
    /// on any doubt it says that no polarity check was passed, so that it does not engage.
    pub async fn load(&mut self, defaults: &Config, room: &mut Room) -> (Config, Found) {
        let mut unchecked = defaults.clone();
        unchecked.calibration.polarity_checked = false;
        let mut config = unchecked.clone();
        let found = match self.newest(&mut room.item).await {
            Ok(None) => Found::Nothing,
            Err(doubt) => Found::Doubt(doubt),
            Ok(Some(record)) => {
                let applied = record.apply(&mut config);
                if applied.refused > 0 || applied.calibration_missing {
                    config.calibration.polarity_checked = false;
                }
                match config.clone().plan() {
                    Ok(_) => Found::Record(applied),
                    Err(error) => Found::Doubt(Doubt::Unfit(error)),
                }
            }
        };
        (if matches!(found, Found::Record(_)) { config } else { unchecked }, found)
    }

    /// Stores a configuration, and reads it back.
    ///
    /// Where that fails because of damage, everything but the encoder's offset is erased and it is tried once more. The
    /// chip stands still for as long as the flash erases; never call it while torque may flow.
    ///
    /// # Errors
    /// As of [`NotStored`].
    pub async fn save(&mut self, config: &Config, room: &mut Room) -> Result<(), NotStored> {
        config.clone().plan().map_err(NotStored::Refused)?;
        let Room { record: bytes, item } = room;
        let newest = self.number(PARAMETERS, item).await.ok().flatten().unwrap_or_default();
        let before = self.record(item).await.ok().flatten();
        let number = before.map_or(0, |before| before.number).max(newest).wrapping_add(1);
        let used = record::encode(config, number, before.as_ref(), bytes).ok_or(NotStored::TooMany)?;
        let bytes = bytes.get(..used).ok_or(NotStored::TooMany)?;
        // Before the write, after which damage may hide it.
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

    /// The newest alignment of the encoder; `None` if none was ever stored.
    ///
    /// # Errors
    /// Why what is stored is not believed.
    pub async fn alignment(&mut self, room: &mut Room) -> Result<Option<Alignment>, Doubt> {
        let numbered = self.numbered_alignment(&mut room.item).await?;
        Ok(numbered.map(|(_, alignment)| alignment))
    }

    /// Stores an alignment of the encoder, and reads it back.
    ///
    /// Where that fails because of damage, everything but parameters that are believed is erased and it is tried once
    /// more. The chip stands still as of [`Store::save`].
    ///
    /// # Errors
    /// [`NotStored::Flash`].
    pub async fn save_alignment(&mut self, alignment: &Alignment, room: &mut Room) -> Result<(), NotStored> {
        let Room { record: parameters, item } = room;
        let newest = self.number(ALIGNMENT, item).await.ok().flatten().unwrap_or_default();
        let before = self.kept_alignment(item).await.ok().flatten();
        let number = before.map_or(0, |(number, _)| number).max(newest).wrapping_add(1);
        let bytes = alignment.encode(number);
        // Before the write, after which damage may hide them.
        let believed = self.newest(item).await.ok().flatten().map(|record| record.number);
        let copied = self.copy(PARAMETERS, item, parameters).await;
        if self.write(ALIGNMENT, number, &bytes, item).await.is_ok() {
            return Ok(());
        }
        self.erase().await?;
        if let (Some(number), Some(parameters)) = (believed, copied) {
            self.write(PARAMETERS, number, parameters, item).await?;
        }
        self.write(ALIGNMENT, number, &bytes, item).await
    }

    /// Writes an item and its number, and reads both back.
    async fn write(
        &mut self,
        keys: Keys,
        number: u32,
        bytes: &[u8],
        item: &mut [u8],
    ) -> Result<(), NotStored> {
        self.map.store_item(item, &keys.kept, &bytes).await.map_err(|_| NotStored::Flash)?;
        self.map.store_item(item, &keys.newest, &number).await.map_err(|_| NotStored::Flash)?;
        let numbered = self.number(keys, item).await == Ok(Some(number));
        match self.kept(keys, item).await {
            Ok(Some(kept)) if numbered && kept == bytes => Ok(()),
            _ => Err(NotStored::Flash),
        }
    }

    /// Erases everything, values of other versions included.
    ///
    /// # Errors
    /// The flash can't be erased.
    pub async fn erase(&mut self) -> Result<(), NotStored> {
        self.map.erase_all().await.map_err(|_| NotStored::Flash)
    }

    /// The newest record, if it may be believed.
    async fn newest<'r>(&mut self, item: &'r mut [u8]) -> Result<Option<Record<'r>>, Doubt> {
        let newest = self.number(PARAMETERS, item).await?;
        let record = self.record(item).await?;
        believed(record, |record| record.number, newest)
    }

    /// The newest alignment and its number, if it may be believed.
    async fn numbered_alignment(&mut self, item: &mut [u8]) -> Result<Option<(u32, Alignment)>, Doubt> {
        let newest = self.number(ALIGNMENT, item).await?;
        let kept = self.kept_alignment(item).await?;
        believed(kept, |(number, _)| *number, newest)
    }

    async fn record<'r>(&mut self, item: &'r mut [u8]) -> Result<Option<Record<'r>>, Doubt> {
        let bytes = self.kept(PARAMETERS, item).await?;
        bytes.map(|bytes| record::decode(bytes).map_err(Doubt::NoRecord)).transpose()
    }

    async fn kept_alignment(&mut self, item: &mut [u8]) -> Result<Option<(u32, Alignment)>, Doubt> {
        let bytes = self.kept(ALIGNMENT, item).await?;
        bytes.map(|bytes| Alignment::decode(bytes).map_err(Doubt::NoRecord)).transpose()
    }

    async fn kept<'r>(&mut self, keys: Keys, item: &'r mut [u8]) -> Result<Option<&'r [u8]>, Doubt> {
        self.map.fetch_item::<&[u8]>(item, &keys.kept).await.map_err(|_| Doubt::Unreadable)
    }

    async fn number(&mut self, keys: Keys, item: &mut [u8]) -> Result<Option<u32>, Doubt> {
        self.map.fetch_item::<u32>(item, &keys.newest).await.map_err(|_| Doubt::Unreadable)
    }

    /// Copies what is kept; `None` if nothing is, or it can't be read or is too long.
    async fn copy<'t>(&mut self, keys: Keys, item: &mut [u8], to: &'t mut [u8]) -> Option<&'t [u8]> {
        let kept = self.kept(keys, item).await.ok().flatten()?;
        let to = to.get_mut(..kept.len())?;
        to.copy_from_slice(kept);
        Some(to)
    }
}

/// What was found, unless it is older than the newest that was stored to the end.
fn believed<T>(
    found: Option<T>,
    number: impl Fn(&T) -> u32,
    newest: Option<u32>,
) -> Result<Option<T>, Doubt> {
    match (found, newest) {
        (Some(found), Some(newest)) if number(&found) < newest => Err(Doubt::Lost),
        (None, Some(_)) => Err(Doubt::Lost),
        (found, _) => Ok(found),
    }
}
