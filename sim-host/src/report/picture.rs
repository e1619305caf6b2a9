//! Writes figures to SVG and PNG with the configuration inside.

use super::tool::Tool;
use serde::Serialize;

/// Caption of a figure: the program and the full configuration.
pub fn caption(config: &impl Serialize) -> String {
    let tool = Tool::this();
    let config = serde_json::to_string(config).unwrap_or_default();
    format!("{} {} commit {} {config}", tool.name, tool.version, tool.commit)
}

/// An SVG with the caption as its `<desc>`, right after the opening tag.
pub fn svg_with_caption(svg: &str, caption: &str) -> String {
    let escaped = caption.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    match svg.find("<svg").and_then(|at| svg[at..].find('>').map(|end| at + end + 1)) {
        Some(at) => format!("{}<desc>{escaped}</desc>{}", &svg[..at], &svg[at..]),
        None => svg.into(),
    }
}

/// A PNG with the caption in a `tEXt` chunk (PNG specification 11.3.4.3) after the header chunk.
pub fn png_with_caption(png: &[u8], caption: &str) -> Vec<u8> {
    // Signature 8 bytes, IHDR 25 bytes: length, type, 13 bytes of data, checksum.
    const HEADER: usize = 33;
    let mut chunk = b"tEXtDescription\0".to_vec();
    // The chunk holds Latin-1; the configuration is ASCII except for names of files.
    chunk.extend(caption.chars().map(|c| u8::try_from(u32::from(c)).unwrap_or(b'?')));
    let (head, rest) = png.split_at(HEADER.min(png.len()));
    let mut out = head.to_vec();
    out.extend(((chunk.len() - 4) as u32).to_be_bytes());
    out.extend(&chunk);
    out.extend(crc32fast::hash(&chunk).to_be_bytes());
    out.extend(rest);
    out
}
