//! SPI words of the gate driver, on a chip simulated from its data sheet.

use devices::drv8301::*;
use devices::vesc6::GATE_DRIVER;

/// Registers, and the answer for the next transfer.
#[derive(Default)]
struct Chip {
    registers: [u16; 4],
    answer: u16,
}

impl Chip {
    fn new() -> Self {
        Self { registers: [0, 0x001, 0x400, 0x000], answer: 0 }
    }

    fn word(&mut self, word: u16) -> u16 {
        let answer = self.answer;
        let address = usize::from(word >> 11 & 0xf);
        let reads = word & 0x8000 != 0;
        if address > 3 {
            self.answer = 0x8000;
            return answer;
        }
        if !reads && address >= 2 {
            self.registers[address] = word & 0x7ff;
        }
        self.answer = (address as u16) << 11 | self.registers[address];
        answer
    }

    fn read_register(&mut self, register: Register) -> Option<u16> {
        self.word(read(register));
        data(register, self.word(read(register)))
    }
}

/// Situation: the chip after reset. Action: write the settings and read them back. Must hold: they are at the places
/// of the data sheet, and the other registers are unchanged.
#[test]
fn settings_arrive() {
    let mut chip = Chip::new();
    chip.word(write(Register::Control1, GATE_DRIVER.control1()));
    chip.word(write(Register::Control2, GATE_DRIVER.control2()));
    assert_eq!(
        chip.read_register(Register::Control1),
        Some(12 << 6 | 1 << 4),
        "step 12, latched, 6 inputs, 1.7 A"
    );
    assert_eq!(chip.read_register(Register::Control2), Some(1 << 2), "20 V/V, all faults reported");
    assert_eq!(chip.read_register(Register::Status1), Some(0));
    assert!(is_present(chip.read_register(Register::Status2).expect("an answer")));
}

/// Situation: no chip, an open or shorted wire, a damaged frame, an answer of another register. Must hold: none is
/// accepted as settings or as a present chip.
#[test]
fn a_missing_chip_is_detected() {
    for stuck in [0x0000, 0xffff] {
        assert_eq!(data(Register::Control1, stuck), None);
        assert_eq!(data(Register::Control2, stuck), None);
        assert_eq!(data(Register::Status2, stuck), None);
    }
    let mut chip = Chip::new();
    chip.word(read(Register::Status2));
    let answer = chip.word(read(Register::Status2));
    assert_eq!(data(Register::Status2, answer), Some(1));
    assert_eq!(data(Register::Status2, answer | 0x8000), None, "damaged");
    assert_eq!(data(Register::Control1, answer), None, "another register");
    assert!(!is_present(0) && !is_present(0xf));
}

/// Situation: every over-current voltage from zero to the maximum. Must hold: the largest threshold not above it is
/// used, and thresholds increase.
#[test]
fn over_current_is_never_above_the_requested() {
    assert!(OVER_CURRENT_MV.is_sorted());
    for over_current_mv in 0..3000 {
        let (step, mv) = Settings { over_current_mv, ..GATE_DRIVER }.over_current_step();
        assert_eq!(OVER_CURRENT_MV[usize::from(step)], mv);
        assert!(mv <= over_current_mv || step == 0, "{over_current_mv} gave {mv}");
        let next = OVER_CURRENT_MV.get(usize::from(step) + 1);
        assert!(next.is_none_or(|next| *next > over_current_mv), "{over_current_mv} gave {mv}");
    }
}

/// Situation: over-current in a phase's lower switch; then a too high gate supply. Must hold: exactly these names;
/// the device identifier is no fault.
#[test]
fn faults_have_names() {
    let names: Vec<_> = Status(1 << 10 | 1 << 4, 1).names().collect();
    assert_eq!(names, ["over-current low a", "fault"]);
    assert_eq!(Status(1 << 10, 0x81).names().collect::<Vec<_>>(), ["fault", "gate supply high"]);
    assert_eq!(Status(0, 1).names().count(), 0);
}
