//! A shard: part of the cells, for one of several machines.

/// Part `number` of `of`, counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    number: usize,
    of: usize,
}

/// A text that is no shard.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is not I/N, I from 1 to N, for example 2/3")]
pub struct ShardError(pub String);

impl Shard {
    /// All cells.
    pub const WHOLE: Self = Self { number: 1, of: 1 };

    /// Parses `I/N`.
    ///
    /// # Errors
    /// The text has another form, or I is outside 1 to N.
    pub fn parse(text: &str) -> Result<Self, ShardError> {
        let numbers = text.split_once('/').and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
        match numbers {
            Some((number, of)) if 1 <= number && number <= of => Ok(Self { number, of }),
            _ => Err(ShardError(text.into())),
        }
    }

    /// Indices of this shard's `identities`: every N-th in increasing order. Shards are similar in size and
    /// content, and the machines need no communication.
    pub fn of(&self, identities: &[String]) -> Vec<usize> {
        let mut places: Vec<usize> = (0..identities.len()).collect();
        places.sort_by_key(|&i| &identities[i]);
        let mut mine: Vec<usize> = places.into_iter().skip(self.number - 1).step_by(self.of).collect();
        mine.sort_unstable();
        mine
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_are_disjoint_and_together_all() {
        let identities: Vec<String> = (0..17).map(|i| format!("{:02}", i * 7 % 17)).collect();
        for n in 1..20 {
            let shards = (1..=n).map(|i| Shard::parse(&format!("{i}/{n}")).unwrap().of(&identities));
            let mut all: Vec<usize> = shards.flatten().collect();
            all.sort_unstable();
            assert_eq!(all, (0..17).collect::<Vec<_>>());
        }
        for text in ["", "1", "0/2", "3/2", "a/2", "1/0", "-1/2"] {
            assert!(Shard::parse(text).is_err(), "{text}");
        }
    }
}
