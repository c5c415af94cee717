//! Division of an experiment into shards, which several processes or machines run independently of each other.

use std::fmt::{self, Display, Formatter};
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use super::machine::Machine;

/// Largest number of shards of an experiment.
const MAX_COUNT: u32 = 100_000;

/// Share of an experiment: every `count`-th of its units, such as cases or runs. Written as `2/4`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Shard {
    /// Number of the shard, from 1 to `count`.
    index: u32,
    /// Number of shards.
    count: u32,
}

impl Shard {
    /// The whole experiment as a single shard.
    pub const WHOLE: Self = Self { index: 1, count: 1 };

    /// Returns the number of shards of the experiment.
    pub fn count(self) -> u32 {
        self.count
    }

    /// Returns all shards of the experiment, in order.
    pub fn all(self) -> impl Iterator<Item = Self> {
        (1..=self.count).map(move |index| Self { index, ..self })
    }

    /// Whether the shard contains a unit, counted from 0. Each unit belongs to exactly one of the shards, and neighbours
    /// belong to different ones, because neighbours often cost about the same.
    pub fn owns(self, unit: usize) -> bool {
        unit % self.count as usize == self.index as usize - 1
    }
}

impl Display for Shard {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parsed = text.split_once('/').and_then(|(i, n)| Some((i.trim().parse().ok()?, n.trim().parse().ok()?)));
        match parsed {
            None => Err("expected a shard as I/N, such as 2/4 for the second of four".to_owned()),
            Some((_, count)) if !(1..=MAX_COUNT).contains(&count) => {
                Err(format!("the number of shards is 1 to {MAX_COUNT}"))
            }
            Some((index, count)) if !(1..=count).contains(&index) => {
                Err(format!("shards of {count} are numbered from 1 to {count}"))
            }
            Some((index, count)) => Ok(Self { index, count }),
        }
    }
}

impl TryFrom<String> for Shard {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

impl From<Shard> for String {
    fn from(shard: Shard) -> Self {
        shard.to_string()
    }
}

/// Results of one shard of an experiment.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct ShardRun<R> {
    /// Shard that was run.
    pub shard: Shard,
    /// Machine that ran it.
    pub machine: Machine,
    /// Whether the run was cancelled before everything was measured.
    pub partial: bool,
    /// Results of the units of the shard.
    pub results: R,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_unit_belongs_to_exactly_one_shard() {
        for count in 1..9 {
            let shards: Vec<Shard> = Shard { index: 1, count }.all().collect();
            assert_eq!(shards.len(), count as usize);
            for unit in 0..40 {
                assert_eq!(shards.iter().filter(|shard| shard.owns(unit)).count(), 1, "{unit} of {count}");
            }
        }
        assert!((0..9).all(|unit| Shard::WHOLE.owns(unit)));
    }

    #[test]
    fn shards_are_read_as_they_are_written_and_others_are_refused_in_words() {
        for text in ["1/1", "2/4", "100/100"] {
            assert_eq!(text.parse::<Shard>().unwrap().to_string(), text);
        }
        for (text, reason) in [
            ("0/3", "shards of 3 are numbered from 1 to 3"),
            ("4/3", "shards of 3 are numbered from 1 to 3"),
            ("1/0", "the number of shards is 1 to 100000"),
            ("a/b", "expected a shard as I/N, such as 2/4 for the second of four"),
            ("3", "expected a shard as I/N, such as 2/4 for the second of four"),
            ("-1/3", "expected a shard as I/N, such as 2/4 for the second of four"),
        ] {
            assert_eq!(text.parse::<Shard>(), Err(reason.to_owned()), "{text}");
        }
    }
}
