//! Invalid images and runs: their errors.

use crate::boards::{ALIGN, image};
use std::path::Path;
use std::time::Duration;
use virtual_board::chip::gpio::Port;
use virtual_board::inject::BRANCH_TO_ITSELF;
use virtual_board::wiring::Wiring;
use virtual_board::{Bench, Options};

/// The error of power-on for an image.
fn power_on_error(image: &Path) -> String {
    match Bench::power_on(image, Options::default(), Wiring::new()) {
        Ok(_) => panic!("{} runs", image.display()),
        Err(error) => error.to_string(),
    }
}

/// The aligning image with some of its bytes changed, in a file of its own.
fn changed(change: impl FnOnce(&mut Vec<u8>)) -> String {
    let mut bytes = std::fs::read(image(ALIGN)).expect("`cargo xtask firmware` builds the images");
    change(&mut bytes);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("image");
    std::fs::write(&path, bytes).unwrap();
    power_on_error(&path)
}

/// Place of the vector table in the file: the stack's top, then the program's start in flash, with the bit of Thumb
/// code.
fn vectors(bytes: &[u8]) -> usize {
    let is_table = |bytes: &[u8]| {
        let word = |at: usize| u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]);
        word(0) == 0x2000_8000 && word(4) >> 16 == 0x0801 && word(4) & 1 == 1
    };
    bytes.windows(8).position(is_table).expect("a vector table")
}

/// Must hold: an image that cannot run on this chip is rejected by a sentence that names the file and the reason.
#[test]
fn an_image_for_another_chip_is_rejected() {
    let missing = power_on_error(Path::new("/no/such/image"));
    assert!(missing.starts_with("/no/such/image: No such file"), "{missing}");
    let text = changed(|bytes| *bytes = b"no image".to_vec());
    assert!(text.ends_with(": not an ELF file"), "{text}");
    for length in [40, 100_000] {
        let cut = changed(|bytes| bytes.truncate(length));
        assert!(cut.contains(": an ELF file that is damaged or cut short: "), "{length} bytes: {cut}");
    }
    let host = power_on_error(&std::env::current_exe().unwrap());
    assert!(host.ends_with(", not for a 32-bit Arm core"), "{host}");
    let other = changed(|bytes| {
        let at = vectors(bytes);
        bytes[at..at + 4].copy_from_slice(&0x2003_0000_u32.to_le_bytes());
    });
    assert!(
        other.contains("its stack begins at 0x20030000, outside this chip's RAM, 0x20000000 to 0x20020000"),
        "{other}"
    );
    let start = changed(|bytes| {
        let at = vectors(bytes) + 4;
        bytes[at..at + 4].copy_from_slice(&0x0000_0101_u32.to_le_bytes());
    });
    assert!(start.contains("its program begins at 0x00000101, which is no Thumb code"), "{start}");
    let nothing = changed(|bytes| {
        // No sections: neither symbols nor the table of the log.
        bytes[32..36].fill(0);
        bytes[48..52].fill(0);
    });
    assert!(nothing.ends_with(": no symbols in it"), "{nothing}");
    let silent = changed(|bytes| {
        // The names of the sections come after everything else that could have such bytes.
        let at = bytes.windows(7).rposition(|word| word == b".defmt\0").expect("the section's name");
        bytes[at + 1] = b'x';
    });
    assert!(silent.contains(".defmt"), "{silent}");
}

/// Situation: the aligning image.
/// Action: the motor's interrupt reads a register that no model has.
/// Must hold: the run ends, with the register's address, the instant, the instruction and its function.
#[test]
fn a_register_without_a_model_ends_the_run() {
    // movw r0, #0x5c00; movt r0, #0x4001; ldr r0, [r0]: a reserved address (RM0090 rev 22, table 1).
    const READ_0X40015C00: [u16; 5] = [0xf645, 0x4000, 0xf2c4, 0x0001, 0x6800];
    let mut bench = Bench::power_on(&image(ALIGN), Options::default(), Wiring::new()).unwrap();
    bench.damage("_defmt_acquire", &READ_0X40015C00).unwrap();
    let error = bench.run_ms(5.0).unwrap_err().to_string();
    let parts = ["at ", "no register at 0x40015c00", "at the instruction 0x080", "in _defmt_acquire"];
    assert!(parts.iter().all(|part| error.contains(part)), "{error}");

    // movw r0, #0x7c00; movt r0, #0x4000; ldr r0, [r0]: a peripheral whose clock is off.
    const READ_0X40007C00: [u16; 5] = [0xf647, 0x4000, 0xf2c4, 0x0000, 0x6800];
    let mut bench = Bench::power_on(&image(ALIGN), Options::default(), Wiring::new()).unwrap();
    bench.damage("_defmt_acquire", &READ_0X40007C00).unwrap();
    let error = bench.run_ms(5.0).unwrap_err().to_string();
    let parts =
        ["at ", "0x40007c00: UART8.SR is gated by RCC", "at the instruction 0x080", "in _defmt_acquire"];
    assert!(parts.iter().all(|part| error.contains(part)), "{error}");
}

/// Situation: the aligning image, converting. Action: the pins of port A are as after a reset, digital inputs. Must hold: the
/// run ends within 2 ms and names the register of the channels and the motor's interrupt.
#[test]
fn a_conversion_of_a_pin_that_is_not_analog_ends_the_run() {
    let mut bench = Bench::power_on(&image(ALIGN), Options::default(), Wiring::new()).unwrap();
    bench.run_ms(300.0).unwrap();
    bench.with(|board| board.chip.wiring.ports[0] = Port::new(0));
    let error = bench.run_ms(2.0).unwrap_err().to_string();
    let parts = ["at 30", "ADC1.JSQR", "whose pin is not analog", "in ADC"];
    assert!(parts.iter().all(|part| error.contains(part)), "{error}");
}

/// Situation: the aligning image with the switch open.
/// Must hold: a wait that never ends is abandoned after its limit, with the instant, the awaited condition and the
/// program's position, also if it never left its first instruction; likewise a step that takes the emulator too long.
#[test]
fn an_endless_wait_is_abandoned() {
    let mut bench = Bench::power_on(&image(ALIGN), Options::default(), Wiring::new()).unwrap();
    let waited = bench
        .run_until(10.0, "closed bridge", |bench| bench.with(|board| board.chip.wiring.tim1.main_output()));
    let error = waited.unwrap_err().to_string();
    let parts = [
        "at 10.0",
        "still no closed bridge",
        "the program is at the instruction 0x080",
        "at the instruction 0x080",
        " in ",
    ];
    assert!(parts.iter().all(|part| error.contains(part)), "{error}");

    let mut bench = Bench::power_on(&image(ALIGN), Options::default(), Wiring::new()).unwrap();
    bench.damage("Reset", &[BRANCH_TO_ITSELF]).unwrap();
    let error = bench.run_until(10.0, "log", |bench| !bench.log().is_empty()).unwrap_err().to_string();
    let parts = [
        "at 10.0",
        "still no log",
        "the program is at the instruction 0x080",
        " in Reset, the last access to a register was nowhere",
    ];
    assert!(parts.iter().all(|part| error.contains(part)), "{error}");

    let hasty = Options { timeout: Duration::from_nanos(1), ..Options::default() };
    let stuck = Bench::power_on(&image(ALIGN), hasty, Wiring::new()).and_then(|mut bench| bench.run_ms(5.0));
    let error = stuck.unwrap_err().to_string();
    assert!(error.contains("the emulator did not come back within 1ns"), "{error}");
}
