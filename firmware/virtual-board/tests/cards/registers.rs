//! The values that the image writes into the chip's registers, against the page that gives the reasons.

use crate::bed::{board, product};
use rigless::mcu::{Mcu, Operate};
use rigless::soc::Width;
use rigless::time::VirtualNanos;
use std::collections::BTreeMap;
use virtual_board::board::Vesc6;

/// The instances whose registers are on the page.
const INSTANCES: [&str; 19] = [
    "RCC", "PWR", "FLASH", "GPIOA", "GPIOB", "GPIOC", "GPIOD", "TIM1", "TIM3", "TIM4", "TIM5", "ADC1",
    "ADC2", "ADC3", "C_ADC", "USART3", "CAN1", "EXTI", "DBG",
];
/// Registers whose value is an event or a state, not a setting.
const MOVING: [&str; 22] = [
    "CNT", "SR", "CCR1", "CCR2", "CCR3", "CCR4", "JDR1", "JDR2", "JDR3", "JDR4", "DR", "IDR", "ODR", "CSR",
    "TSR", "ESR", "MSR", "CIR", "DMAR", "BDCR", "KEYR", "OPTKEYR",
];

/// The registers that are not in `MOVING`, by name.
fn values(board: &mut Vesc6) -> BTreeMap<String, u32> {
    let chip = &mut board.chip;
    let mut found = BTreeMap::new();
    for instance in INSTANCES {
        let peripheral = *chip.bus().peripheral(instance).expect("an instance of the chip");
        for register in peripheral.registers.iter().filter(|register| !MOVING.contains(&register.name)) {
            // CAN's mailboxes carry frames.
            let frames = instance == "CAN1" && register.name.starts_with('T');
            let at = peripheral.base + u64::from(register.offset);
            // The chip has one register of this kind; the library's table names its two uses.
            let again = register.name.ends_with("_Input") && instance == "TIM1"
                || register.name.ends_with("_Output") && instance != "TIM1";
            if !frames && !again {
                let value = chip.peek(VirtualNanos(0), at, Width::W32).unwrap_or(0);
                found.insert(format!("{instance}.{}", register.name), value as u32);
            }
        }
    }
    found
}

/// The rows of docs/registers.md: register, value.
fn documented() -> BTreeMap<String, u32> {
    let page =
        std::fs::read_to_string(xtask::image::root().join("docs/registers.md")).expect("the page is there");
    page.lines()
        .filter_map(|line| {
            let mut cells = line.split('|').map(str::trim).skip(1);
            let (register, value) = (cells.next()?, cells.next()?);
            let value = u32::from_str_radix(value.strip_prefix("0x")?, 16).ok()?;
            Some((register.to_owned(), value))
        })
        .collect()
}

/// Situation: the product image, started.
/// Action: read every register that differs from its value at power-on.
/// Must hold: docs/registers.md has the same registers with the same values, each with the section of the manual that
/// explains it.
#[test]
fn the_registers_are_those_of_the_page() {
    let Some(image) = product() else { return };
    let mut bench = board(&image);
    let before = bench.with(values);
    bench.run_ms(300.0).expect("no gap");
    let mut written = bench.with(values);
    written.retain(|register, value| before.get(register) != Some(value));
    let documented = documented();
    let differ: Vec<String> = written
        .iter()
        .filter(|(register, value)| documented.get(*register) != Some(value))
        .map(|(register, value)| format!("| {register} | {value:#010x} |"))
        .collect();
    let missing: Vec<&String> =
        documented.keys().filter(|register| !written.contains_key(*register)).collect();
    assert!(written.len() > 40, "only {} registers", written.len());
    assert!(
        differ.is_empty() && missing.is_empty(),
        "not on the page:\n{}\nno longer set: {missing:?}",
        differ.join("\n")
    );
}
