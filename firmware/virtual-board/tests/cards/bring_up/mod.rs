//! The bring-up of docs/hardware.md, step by step: the page states the actions and what must be shown; these tests do
//! them.

mod actions;
mod monitor;
mod page;
mod pattern;
mod table;

use crate::bed::built;
use actions::ACTIONS;
use page::{Check, checks};
use pattern::is_shown;
use std::ops::RangeInclusive;
use table::Table;

/// Longest time until the expected text is shown \[ms\]: an alignment, and the second between two reports.
const HEARTBEAT_TIMEOUT_MS: u32 = 4700;
/// Period of the look-up \[ms\].
const LOOK_MS: u32 = 5;

/// Does the checks of these steps, in the order of the page.
fn bring_up(steps: RangeInclusive<u32>) {
    let (Some(product), Some(align)) = (built("board-vesc6"), built("board-vesc6-align")) else {
        return;
    };
    let mut table = Table::new([product, align]);
    for Check { step, action, shows } in checks().iter().filter(|check| steps.contains(&check.step)) {
        if let Some(implementation) = implementation(action) {
            table.begin();
            implementation(&mut table);
        }
        let mut missing = Vec::new();
        for _ in 0..HEARTBEAT_TIMEOUT_MS / LOOK_MS {
            (0..LOOK_MS).for_each(|_| table.step());
            let shown = table.shown();
            missing = shows.iter().filter(|text| !is_shown(text, &shown)).collect();
            if missing.is_empty() {
                break;
            }
        }
        let shown: Vec<String> = table.shown().into_iter().take(12).map(|line| line.text).collect();
        assert!(missing.is_empty(), "step {step}: {action} -> no {missing:?} in\n{}", shown.join("\n"));
        assert_eq!(table.bench().resets().len(), 0, "step {step}: {action}");
        println!("step {step}, {:.1} s: {action}", table.bench().now_ms() * 1e-3);
    }
}

/// The implementation of an action of the page.
fn implementation(action: &str) -> Option<fn(&mut Table)> {
    let known = ACTIONS.iter().find(|(text, _)| *text == action);
    known.unwrap_or_else(|| panic!("docs/hardware.md: no implementation knows how to: {action}")).1
}

/// Situation: the page and the implemented actions.
/// Action: compare.
/// Must hold: each action of the page is implemented, and each implemented action is on the page.
#[test]
fn actions_and_page_are_the_same() {
    let checks = checks();
    for check in &checks {
        let _ = implementation(&check.action);
    }
    for (text, _) in ACTIONS {
        assert!(checks.iter().any(|check| check.action == *text), "not in docs/hardware.md: {text}");
    }
}

/// Situation: a board on the table at 24 V, its encoder wired, no motor on its bridge. Action and what must hold: steps 1 to 11 of
/// docs/hardware.md.
#[test]
fn the_board_is_brought_up_as_documented() {
    bring_up(1..=11);
}

/// Situation: the motor connected, the handlebar free.
/// Action and what must hold: steps 12 to 15 of docs/hardware.md, from the alignment to the first torque, the flash
/// unchanged between the images.
#[test]
#[ignore = "slow: cargo xtask test --all"]
fn the_motor_is_brought_up_as_documented() {
    bring_up(12..=15);
}
