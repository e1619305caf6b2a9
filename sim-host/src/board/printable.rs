//! Text received from a board, made safe for a terminal.

/// The text with its control characters, except line ends, as escapes (`\\u{1b}`), so that a board cannot send terminal
/// commands.
pub fn printable(text: &str) -> String {
    let shown = |c: char| {
        let plain = c == '\n' || !c.is_control();
        if plain { c.to_string() } else { c.escape_default().to_string() }
    };
    text.chars().map(shown).collect()
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_terminal_is_not_commanded() {
        let shown = super::printable("gain \u{1b}[2J\r\u{9b}1m °\nnext");
        assert_eq!(shown, "gain \\u{1b}[2J\\r\\u{9b}1m °\nnext");
    }
}
