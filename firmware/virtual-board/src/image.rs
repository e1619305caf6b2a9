//! Image file: check that it is for this chip, and its function symbols.

use crate::chip::memory::{FLASH, RAM};
use object::{Architecture, Object, ObjectSegment, ObjectSymbol, SymbolKind};
use std::ops::Range;

/// Address ranges of the image's functions, by start address.
#[derive(Clone, Debug, Default)]
pub(crate) struct Functions(Vec<(Range<u32>, String)>);

impl Functions {
    /// Reads the image in these bytes.
    ///
    /// # Errors
    /// The reason: not an ELF file, another machine, a vector table that is invalid for this chip, or no symbols.
    pub(crate) fn read(image: &[u8]) -> Result<Self, String> {
        let file = object::File::parse(image).map_err(|error| match image {
            [0x7f, b'E', b'L', b'F', ..] => format!("an ELF file that is damaged or cut short: {error}"),
            _ => "not an ELF file".into(),
        })?;
        if file.architecture() != Architecture::Arm || file.is_64() {
            return Err(format!("built for {:?}, not for a 32-bit Arm core", file.architecture()));
        }
        check_vectors(&file)?;
        let mut functions: Vec<_> = file
            .symbols()
            .filter(|symbol| symbol.kind() == SymbolKind::Text && symbol.size() > 0)
            .filter_map(|symbol| {
                let start = symbol.address() as u32 & !1;
                let name = format!("{:#}", rustc_demangle::demangle(symbol.name().ok()?));
                Some((start..start + symbol.size() as u32, name))
            })
            .collect();
        if functions.is_empty() {
            return Err("no symbols in it".into());
        }
        functions.sort_by_key(|(range, _)| range.start);
        Ok(Self(functions))
    }

    /// The function at this address.
    pub(crate) fn at(&self, address: u32) -> Option<&str> {
        let after = self.0.partition_point(|(range, _)| range.start <= address);
        let (range, name) = self.0.get(after.checked_sub(1)?)?;
        range.contains(&address).then_some(name)
    }

    /// Address of the only function of this name.
    ///
    /// # Errors
    /// No function has this name, or several.
    pub(crate) fn start(&self, name: &str) -> Result<u32, String> {
        let mut starts = self.0.iter().filter(|(_, other)| other == name).map(|(range, _)| range.start);
        match (starts.next(), starts.next()) {
            (Some(start), None) => Ok(start),
            (None, _) => Err(format!("the image has no function {name}")),
            (Some(_), Some(_)) => Err(format!("the image has several functions {name}")),
        }
    }
}

/// First two words of the flash: initial stack pointer in RAM, program start in flash with the Thumb bit.
fn check_vectors(file: &object::File<'_>) -> Result<(), String> {
    let words = file.segments().find_map(|segment| {
        let offset = FLASH.start.checked_sub(segment.address())? as usize;
        let bytes = segment.data().ok()?.get(offset..offset + 8)?;
        Some([0, 4].map(|at| u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])))
    });
    let Some([stack, start]) = words else {
        return Err(format!("no vector table at {:#010x}, where the flash begins", FLASH.start));
    };
    if !(RAM.start + 1..=RAM.end).contains(&u64::from(stack)) || !stack.is_multiple_of(4) {
        let Range { start, end } = RAM;
        return Err(format!(
            "its stack begins at {stack:#010x}, outside this chip's RAM, {start:#010x} to {end:#010x}"
        ));
    }
    if start & 1 == 0 || !FLASH.contains(&u64::from(start)) {
        return Err(format!(
            "its program begins at {start:#010x}, which is no Thumb code in this chip's flash"
        ));
    }
    Ok(())
}
