//! Parses gain and speed from a recording's name by a pattern such as `gain{gain}_speed{speed_kmh}kmh_{n}`.

/// Placeholders allowed in braces.
const NAMES: [&str; 4] = ["gain", "speed_kmh", "speed_m_s", "n"];

/// Pattern of a name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pattern {
    text: String,
    parts: Vec<Part>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Part {
    Word(String),
    Number(&'static str),
}

/// Values from a name.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Label {
    /// The controller's gain.
    pub gain: Option<f64>,
    /// Forward speed \[m/s\].
    pub speed_m_s: Option<f64>,
}

/// A text that is no pattern; each with the text.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PatternError {
    /// A brace is not closed.
    #[error("`{0}`: a brace is not closed")]
    Brace(String),
    /// An unknown placeholder.
    #[error("`{0}`: the names in braces are {known}", known = NAMES.map(|name| format!("{{{name}}}")).join(", "))]
    Name(String),
    /// Two placeholders without text between them.
    #[error("`{0}`: two numbers need text between them")]
    Adjacent(String),
}

impl Pattern {
    /// Parses a pattern.
    ///
    /// # Errors
    /// States the brace that is not closed or the unknown placeholder.
    pub fn new(text: &str) -> Result<Self, PatternError> {
        let (mut parts, mut rest) = (Vec::new(), text);
        while let Some((word, after)) = rest.split_once('{') {
            let (name, after) = after.split_once('}').ok_or_else(|| PatternError::Brace(text.into()))?;
            let name = NAMES.into_iter().find(|known| *known == name);
            let name = name.ok_or_else(|| PatternError::Name(text.into()))?;
            parts.extend((!word.is_empty()).then(|| Part::Word(word.into())));
            if matches!((parts.last(), word), (Some(Part::Number(_)), "")) {
                return Err(PatternError::Adjacent(text.into()));
            }
            parts.push(Part::Number(name));
            rest = after;
        }
        parts.extend((!rest.is_empty()).then(|| Part::Word(rest.into())));
        Ok(Self { text: text.into(), parts })
    }

    /// The pattern's text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Values from `name`, a file's name without its extension; `None` if it does not match.
    pub fn read(&self, name: &str) -> Option<Label> {
        let (mut label, mut rest) = (Label::default(), name);
        for part in &self.parts {
            match part {
                Part::Word(word) => rest = rest.strip_prefix(word.as_str())?,
                Part::Number(what) => {
                    let end = rest.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(rest.len());
                    let value: f64 = rest[..end].parse().ok()?;
                    rest = &rest[end..];
                    match *what {
                        "gain" => label.gain = Some(value),
                        "speed_kmh" => label.speed_m_s = Some(value / 3.6),
                        "speed_m_s" => label.speed_m_s = Some(value),
                        _ => {}
                    }
                }
            }
        }
        rest.is_empty().then_some(label)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read() {
        let pattern = Pattern::new("gain{gain}_speed{speed_kmh}kmh_{n}").unwrap();
        let label = pattern.read("gain8_speed14.4kmh_1").unwrap();
        assert_eq!(label, Label { gain: Some(8.0), speed_m_s: Some(4.0) });
        for name in
            ["", "gain8_speed14kmh", "gain8_speed14kmh_1b", "gainx_speed14kmh_1", "gain8_speed1.4.4kmh_1"]
        {
            assert_eq!(pattern.read(name), None, "{name}");
        }
        let plain = Pattern::new("v{speed_m_s}-").unwrap();
        assert_eq!(plain.read("v3.9-"), Some(Label { gain: None, speed_m_s: Some(3.9) }));
        for wrong in ["{", "{speed}", "a{gain}{n}"] {
            assert!(Pattern::new(wrong).is_err(), "{wrong}");
        }
    }
}
