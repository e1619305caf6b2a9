//! Numbers of things as text.

use std::fmt::Display;

/// A number with the name of what is counted, for one and for any other number: "1 frame", "2 frames".
pub(crate) fn counted(number: impl TryInto<u64> + Display + Copy, one: &str, several: &str) -> String {
    format!("{number} {}", if number.try_into().is_ok_and(|number| number == 1) { one } else { several })
}

#[cfg(test)]
mod tests {
    use super::counted;

    #[test]
    fn one_is_singular() {
        let texts = [0_u32, 1, 2].map(|number| counted(number, "time back", "times back"));
        assert_eq!(texts, ["0 times back", "1 time back", "2 times back"]);
    }
}
