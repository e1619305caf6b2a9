//! Cortex-M4 exception registers as text: ARMv7-M Architecture Reference Manual (DDI 0403), B1.5.2 and B3.2.15 to
//! B3.2.18.

use schemars::JsonSchema;
use serde::Serialize;

/// An exception with the meaning of its registers.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Exception {
    /// Its number.
    pub number: u32,
    /// Its name.
    pub name: String,
    /// Meaning of the set bits of CFSR and HFSR.
    pub status: Vec<String>,
    /// Configurable fault status register, hexadecimal like the registers below.
    pub cfsr: String,
    /// Hard fault status register.
    pub hfsr: String,
    /// Bus fault address register.
    pub bfar: String,
    /// Stack pointer.
    pub sp: String,
    /// Program counter.
    pub pc: String,
    /// Link register.
    pub lr: String,
}

const CFSR: [(u32, &str); 19] = [
    (0, "IACCVIOL: instruction fetched where none may be"),
    (1, "DACCVIOL: data access where none may be"),
    (3, "MUNSTKERR: memory fault when an exception returned"),
    (4, "MSTKERR: memory fault when an exception was entered"),
    (5, "MLSPERR: memory fault when floating-point state was kept"),
    (7, "MMARVALID: the address of the memory fault is known"),
    (8, "IBUSERR: bus error when an instruction was fetched"),
    (9, "PRECISERR: bus error of the instruction at PC"),
    (10, "IMPRECISERR: bus error of an earlier instruction"),
    (11, "UNSTKERR: bus error when an exception returned"),
    (12, "STKERR: bus error when an exception was entered, as by a stack that ran out"),
    (13, "LSPERR: bus error when floating-point state was kept"),
    (15, "BFARVALID: BFAR is the address of the bus fault"),
    (16, "UNDEFINSTR: undefined instruction"),
    (17, "INVSTATE: jump to an address without the Thumb bit"),
    (18, "INVPC: invalid return from an exception"),
    (19, "NOCP: coprocessor or floating-point unit switched off"),
    (24, "UNALIGNED: access that is not aligned"),
    (25, "DIVBYZERO: division by zero"),
];
const HFSR: [(u32, &str); 3] = [
    (1, "VECTTBL: the vector table can't be read"),
    (30, "FORCED: a fault that could not have its own exception"),
    (31, "DEBUGEVT: debug event"),
];
const NAMES: [(u32, &str); 8] = [
    (2, "non-maskable interrupt"),
    (3, "hard fault"),
    (4, "memory management fault"),
    (5, "bus fault"),
    (6, "usage fault"),
    (11, "supervisor call"),
    (14, "pended system call"),
    (15, "system tick"),
];

impl Exception {
    /// From the exception number and the registers CFSR, HFSR, BFAR, SP, PC, LR.
    pub fn new(number: u32, registers: [u32; 6]) -> Self {
        let [cfsr, hfsr, bfar, sp, pc, lr] = registers.map(|register| format!("{register:08x}"));
        let status = bits(&CFSR, registers[0]).chain(bits(&HFSR, registers[1])).collect();
        Self { number, name: name(number), status, cfsr, hfsr, bfar, sp, pc, lr }
    }
}

fn name(number: u32) -> String {
    match NAMES.iter().find(|(of, _)| *of == number) {
        Some((_, name)) => (*name).to_owned(),
        None if number >= 16 => format!("interrupt {}", number - 16),
        None => "reserved".to_owned(),
    }
}

fn bits(known: &'static [(u32, &'static str)], register: u32) -> impl Iterator<Item = String> {
    known.iter().filter(move |(bit, _)| register >> bit & 1 == 1).map(|(_, meaning)| (*meaning).to_owned())
}
