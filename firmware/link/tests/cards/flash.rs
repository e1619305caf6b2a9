//! Simulated NOR flash with power failures at any word or in the middle of an erase.

use embassy_futures::block_on;
use embedded_storage_async::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};
use link::Store;
use link::alignment::Alignment;
use link::record::InvalidRecord;
use link::store::{Found, NotStored, StoreBuffers};

/// Page size \[bytes\]: a few records, so that pages change often.
pub(crate) const PAGE: usize = 8192;
pub(crate) const PAGES: usize = 3;
/// Steps per erase.
const ERASE_STEPS: u64 = 8;

/// Effect of the step that the power failure interrupts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Tear {
    /// A word is written or not; an erase has reached some place of its page.
    Whole,
    /// A random subset of the changing bits of the word or page, by this seed.
    Bits(u64),
}

/// Pages of words whose bits are cleared individually and set only by an erase.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Flash {
    pub(crate) bytes: Vec<u8>,
    /// Steps until the power failure; a step is a word written or a part of a page erased.
    pub(crate) left: Option<u64>,
    pub(crate) tear: Tear,
    /// Steps done.
    pub(crate) steps: u64,
    pub(crate) erases: u64,
    /// Number of words written without an erase before.
    pub(crate) overwritten: u64,
}

/// Power failure, or an invalid access.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct FlashError;

impl NorFlashError for FlashError {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

/// SplitMix64.
pub(crate) fn random(seed: &mut u64) -> u64 {
    *seed = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (*seed ^ (*seed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

impl Flash {
    pub(crate) fn new() -> Self {
        Self {
            bytes: vec![0xff; PAGE * PAGES],
            left: None,
            tear: Tear::Whole,
            steps: 0,
            erases: 0,
            overwritten: 0,
        }
    }

    /// The same flash with a power failure after a number of further steps.
    pub(crate) fn cut(&self, after: u64, tear: Tear) -> Self {
        Self { left: Some(after), tear, ..self.clone() }
    }

    /// The same flash with power.
    pub(crate) fn restarted(&self) -> Self {
        Self { left: None, ..self.clone() }
    }

    /// One step, or the power failure.
    fn step(&mut self) -> Result<(), FlashError> {
        match &mut self.left {
            Some(0) => return Err(FlashError),
            Some(left) => *left -= 1,
            None => {}
        }
        self.steps += 1;
        Ok(())
    }
}

impl ErrorType for Flash {
    type Error = FlashError;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = 1;

    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FlashError> {
        let from = self.bytes.get(offset as usize..offset as usize + bytes.len()).ok_or(FlashError)?;
        bytes.copy_from_slice(from);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.bytes.len()
    }
}

impl NorFlash for Flash {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = PAGE;

    async fn erase(&mut self, from: u32, to: u32) -> Result<(), FlashError> {
        assert!(
            (from as usize).is_multiple_of(PAGE) && (to as usize).is_multiple_of(PAGE),
            "erases whole pages"
        );
        for page in (from as usize..to as usize).step_by(PAGE) {
            let part = PAGE / ERASE_STEPS as usize;
            for at in (page..page + PAGE).step_by(part) {
                if self.step().is_err() {
                    if let Tear::Bits(mut seed) = self.tear
                        && self.left == Some(0)
                    {
                        self.bytes[page..page + PAGE].iter_mut().for_each(|b| *b |= random(&mut seed) as u8);
                    }
                    self.tear = Tear::Whole;
                    return Err(FlashError);
                }
                if self.tear == Tear::Whole || self.left.is_none() {
                    self.bytes[at..at + part].fill(0xff);
                }
            }
            self.bytes[page..page + PAGE].fill(0xff);
            self.erases += 1;
        }
        Ok(())
    }

    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FlashError> {
        assert!(offset.is_multiple_of(4) && bytes.len().is_multiple_of(4), "writes whole words");
        for (i, word) in bytes.chunks(4).enumerate() {
            let at = offset as usize + 4 * i;
            let mut keep = 0_u64;
            let done = self.step();
            if done.is_err() {
                let Tear::Bits(mut seed) = self.tear else { return Err(FlashError) };
                keep = random(&mut seed);
                self.tear = Tear::Whole;
            }
            let place = &mut self.bytes[at..at + 4];
            self.overwritten += u64::from(place != [0xff; 4]);
            for ((old, new), keep) in place.iter_mut().zip(word).zip(keep.to_le_bytes()) {
                *old &= new | keep;
            }
            done?;
        }
        Ok(())
    }
}

/// Configuration found at a start, and the resulting flash.
pub(crate) fn load(flash: Flash, defaults: &control::Config) -> (control::Config, Found, Flash) {
    let range = 0..flash.bytes.len() as u32;
    let mut store = Store::new(flash, range).expect("a range of pages");
    let (config, found) = block_on(store.load(defaults, &mut StoreBuffers::new()));
    (config, found, store.into_flash())
}

/// Stores a configuration; returns the resulting flash.
pub(crate) fn save(flash: Flash, config: &control::Config) -> (Result<(), NotStored>, Flash) {
    let range = 0..flash.bytes.len() as u32;
    let mut store = Store::new(flash, range).expect("a range of pages");
    let done = block_on(store.save(config, &mut StoreBuffers::new()));
    (done, store.into_flash())
}

/// Alignment found at a start, and the resulting flash.
pub(crate) fn load_alignment(flash: Flash) -> (Result<Option<Alignment>, InvalidRecord>, Flash) {
    let range = 0..flash.bytes.len() as u32;
    let mut store = Store::new(flash, range).expect("a range of pages");
    let found = block_on(store.alignment(&mut StoreBuffers::new()));
    (found, store.into_flash())
}

/// Stores an alignment; returns the resulting flash.
pub(crate) fn save_alignment(flash: Flash, alignment: &Alignment) -> (Result<(), NotStored>, Flash) {
    let range = 0..flash.bytes.len() as u32;
    let mut store = Store::new(flash, range).expect("a range of pages");
    let done = block_on(store.save_alignment(alignment, &mut StoreBuffers::new()));
    (done, store.into_flash())
}
