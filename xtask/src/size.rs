//! Measures the use of flash and RAM by the images.

use crate::image::IMAGES;
use crate::paths;
use crate::process::capture;
use crate::{Result, setup};
use std::process::Command;
use std::time::Duration;

/// Size of the stack in memory.x \[bytes\].
const STACK: u32 = 32 * 1024;

/// An image's sections \[bytes\].
#[derive(Clone, Copy, Debug)]
pub struct Size {
    /// The image's name.
    pub name: &'static str,
    /// Code and constants.
    pub text: u32,
    /// Initialised variables, stored in flash and copied to RAM.
    pub data: u32,
    /// Zero-initialised variables.
    pub bss: u32,
    /// Flash budget.
    pub flash_budget: u32,
    /// RAM budget, stack included.
    pub ram_budget: u32,
}

impl Size {
    /// Used flash \[bytes\].
    pub fn flash(&self) -> u32 {
        self.text + self.data
    }
    /// Used RAM \[bytes\], including the whole stack.
    pub fn ram(&self) -> u32 {
        STACK + self.data + self.bss
    }
    /// Whether it exceeds a budget.
    pub fn is_over(&self) -> bool {
        self.flash() > self.flash_budget || self.ram() > self.ram_budget
    }
}

/// The sizes of all images, which must be built.
///
/// # Errors
/// The size tool or an image is missing.
pub fn sizes() -> Result<Vec<Size>> {
    IMAGES
        .iter()
        .map(|image| {
            let mut tool = Command::new("arm-none-eabi-size");
            let outcome = capture(tool.arg(paths::path(image.name)), Duration::from_secs(600))
                .map_err(|error| format!("{error}\n{}", setup::missing().join("\n")))?;
            let row = outcome.stdout.lines().nth(1).unwrap_or_default();
            let mut numbers = row.split_whitespace().map_while(|word| word.parse().ok());
            match [numbers.next(), numbers.next(), numbers.next()] {
                [Some(text), Some(data), Some(bss)] => Ok(Size {
                    name: image.name,
                    text,
                    data,
                    bss,
                    flash_budget: image.flash,
                    ram_budget: image.ram,
                }),
                _ => Err(format!("{}: {}", image.name, outcome.stderr)),
            }
        })
        .collect()
}
