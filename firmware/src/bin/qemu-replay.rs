//! Image that runs the control step on recorded frames and writes its commands, to compare chip and host bit by bit.
//! Input `rides.bin`, output `commands.bin`.
#![no_std]
#![no_main]

use control::wire::{COMMAND_BYTES, FRAME_BYTES, decode_frame, encode_command};
use control::{State, step};
use cortex_m_semihosting::hprintln;
use firmware::board::Exit;
use firmware::board::recording::{BLOCK, Recording};
use firmware::board::semihosting::{File, exit};
use firmware::failure;
use static_cell::ConstStaticCell;

static FRAMES: ConstStaticCell<[[u8; FRAME_BYTES]; BLOCK]> = ConstStaticCell::new([[0; FRAME_BYTES]; BLOCK]);
static COMMANDS: ConstStaticCell<[[u8; COMMAND_BYTES]; BLOCK]> =
    ConstStaticCell::new([[0; COMMAND_BYTES]; BLOCK]);

#[cortex_m_rt::entry]
fn main() -> ! {
    hprintln!("{}", firmware::identity!());
    failure::enable();
    let (block, commands) = (FRAMES.take(), COMMANDS.take());
    let mut recording = Recording::open();
    let mut output = File::write_to(c"commands.bin");
    while let Some(mut ride) = recording.next_ride() {
        let mut state = State::default();
        loop {
            let frames = recording.next_block(&mut ride, block);
            if frames.is_empty() {
                break;
            }
            for (frame, command) in frames.iter().zip(commands.iter_mut()) {
                *command = encode_command(&step(&ride.plan, &mut state, &decode_frame(frame)));
            }
            output.write_all(commands[..frames.len()].as_flattened());
        }
    }
    exit(Exit::Success)
}
