//! The FMU: a zip archive of the model description, the library and the resources.

use super::description::{About, Version, xml};
use super::{ModelFile, Part};
use crate::report::tool::Tool;
use crate::scenario::Scenario;
use fmi::{MODEL_FILE, Setup, token};
use std::env::consts::{ARCH, DLL_SUFFIX, OS};
use std::io::{Cursor, Write};
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

/// The bytes of an FMU of `part` with its `library`; `scenario` reproduces it. The same input gives the same bytes.
///
/// # Errors
/// The setup is wrong.
pub fn archive(
    version: Version,
    part: Part,
    (setup, scenario): (&Setup, &Scenario),
    library: &[u8],
) -> Result<Vec<u8>, Box<dyn std::error::Error>> {
    let table = setup.table()?;
    let file = ModelFile { tool: Tool::this(), scenario, model: setup, variables: table.fingerprint() };
    let file = serde_json::to_vec_pretty(&file)?;
    let (name, token) = (part.name(), token(&file));
    let identifier = format!("steer_assist_{name}");
    let about = About {
        name: &format!("steer-assist {name}"),
        identifier: &identifier,
        token: &token,
        step_s: setup.step_s()?,
        stop_s: scenario.time_limit_s,
    };
    let description = xml(version, about, &table)?;
    let binary = format!("binaries/{}/{identifier}{DLL_SUFFIX}", platform(version));
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    let plain = SimpleFileOptions::default();
    let executable = plain.unix_permissions(0o755);
    let resource = format!("resources/{MODEL_FILE}");
    for (path, content, options) in [
        ("modelDescription.xml", description.as_slice(), plain),
        (resource.as_str(), file.as_slice(), plain),
        (binary.as_str(), library, executable),
    ] {
        zip.start_file(path, options)?;
        zip.write_all(content)?;
    }
    Ok(zip.finish()?.into_inner())
}

/// Name of this platform's folder.
fn platform(version: Version) -> String {
    let darwin = OS == "macos";
    match version {
        Version::Two => {
            let (system, bits) = (
                if darwin {
                    "darwin"
                } else if OS == "windows" {
                    "win"
                } else {
                    "linux"
                },
                usize::BITS,
            );
            format!("{system}{bits}")
        }
        Version::Three => format!("{ARCH}-{}", if darwin { "darwin" } else { OS }),
    }
}
