//! Flash adapter that reads whole words.
//!
//! `sequential-storage` determines a page's state from one read of its first and last words. In a half-erased page a
//! single byte can easily look like another marker; a whole word hardly can.

use embedded_storage_async::nor_flash::{ErrorType, NorFlash, ReadNorFlash};

pub(crate) struct WordFlash<F>(pub(crate) F);

impl<F: NorFlash> ErrorType for WordFlash<F> {
    type Error = F::Error;
}

impl<F: NorFlash> ReadNorFlash for WordFlash<F> {
    const READ_SIZE: usize = if F::READ_SIZE > F::WRITE_SIZE { F::READ_SIZE } else { F::WRITE_SIZE };

    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        self.0.read(offset, bytes).await
    }

    fn capacity(&self) -> usize {
        self.0.capacity()
    }
}

impl<F: NorFlash> NorFlash for WordFlash<F> {
    const WRITE_SIZE: usize = F::WRITE_SIZE;
    const ERASE_SIZE: usize = F::ERASE_SIZE;

    async fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        self.0.erase(from, to).await
    }

    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        self.0.write(offset, bytes).await
    }
}
