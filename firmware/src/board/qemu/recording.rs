//! Reads recorded rides from the host's file `rides.bin`: per ride a configuration record, the number of frames (u32,
//! little-endian) and the frames, as in [`control::wire`].

use super::Exit;
use super::semihosting::{File, exit};
use control::wire::{CONFIG_BYTES, FRAME_BYTES, decode_config};
use control::{Config, Plan};
use cortex_m_semihosting::hprintln;

/// Frames per read: a call to the host costs as much as hundreds of steps.
pub const BLOCK: usize = 256;

/// Raw frames of one block.
pub type Block = [[u8; FRAME_BYTES]; BLOCK];

/// File of recorded rides.
pub struct Recording(File);

/// One recorded ride.
pub struct Ride {
    /// Checked configuration of the recording.
    pub plan: Plan,
    frames_left: usize,
}

impl Recording {
    /// Opens the file.
    pub fn open() -> Self {
        Self(File::read_from(c"rides.bin"))
    }

    /// The next ride, or `None` at the end of the file.
    pub fn next_ride(&mut self) -> Option<Ride> {
        let mut record = [0; CONFIG_BYTES];
        let mut frames = [0; 4];
        if !self.0.read_exact(&mut record) {
            return None;
        }
        self.must(&mut frames);
        match decode_config(&record).and_then(Config::plan) {
            Ok(plan) => Some(Ride { plan, frames_left: u32::from_le_bytes(frames) as usize }),
            Err(wrong) => {
                hprintln!("configuration rejected: {}", wrong);
                exit(Exit::Input)
            }
        }
    }

    /// The ride's next frames, at most [`BLOCK`]; none when it is over.
    pub fn next_block<'a>(&mut self, ride: &mut Ride, block: &'a mut Block) -> &'a [[u8; FRAME_BYTES]] {
        let frames = &mut block[..ride.frames_left.min(BLOCK)];
        ride.frames_left -= frames.len();
        self.must(frames.as_flattened_mut());
        frames
    }

    fn must(&mut self, bytes: &mut [u8]) {
        if !self.0.read_exact(bytes) {
            hprintln!("rides.bin ends within a ride");
            exit(Exit::Input)
        }
    }
}
