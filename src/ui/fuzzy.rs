//! Fuzzy matching: the letters of each word must occur in the title in order. Adjacent letters and letters at the
//! beginnings of words score higher.

/// Match of a query against the title of a palette entry.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct FuzzyMatch {
    /// Score of the match; higher is better. Scores are comparable only for the same query.
    pub(crate) score: i32,
    /// Indices of the matched characters of the title.
    pub(crate) letters: Vec<usize>,
}

/// Score of a letter at the beginning of a word.
const AT_WORD: i32 = 8;

/// Score of a letter directly after the previous match.
const JOINED: i32 = 6;

/// Score of each letter skipped between two matches.
const GAP: i32 = -1;

/// Number of title characters that cost one point, so that the shorter of two equally good titles scores higher.
const LENGTH_OF_ONE: i32 = 8;

/// Matches all words of `typed` in `title`, in any order, ignoring case. Returns `None` if a word does not match; an
/// empty query matches everything.
pub(crate) fn fit(typed: &str, title: &str) -> Option<FuzzyMatch> {
    let title: Vec<char> = title.chars().map(lower).collect();
    let mut whole = FuzzyMatch { score: 0, letters: Vec::new() };
    for word in typed.split_whitespace() {
        let word: Vec<char> = word.chars().map(lower).collect();
        let fit = fit_word(&word, &title)?;
        whole.score += fit.score;
        whole.letters.extend(fit.letters);
    }
    if !whole.letters.is_empty() {
        whole.score -= title.len() as i32 / LENGTH_OF_ONE;
    }
    Some(whole)
}

/// Returns the best match of a word in the title, trying every occurrence of its first letter.
fn fit_word(word: &[char], title: &[char]) -> Option<FuzzyMatch> {
    let first = word.first()?;
    let starts = title.iter().enumerate().filter(|(_, letter)| *letter == first).map(|(place, _)| place);
    starts
        .filter_map(|start| fit_from(start, word, title))
        .max_by_key(|fit| (fit.score, std::cmp::Reverse(fit.letters[0])))
}

/// Matches a word with its first letter at the index `start` of the title. For each further letter, prefers the
/// adjacent position, then the next beginning of a word, then the next occurrence.
fn fit_from(start: usize, word: &[char], title: &[char]) -> Option<FuzzyMatch> {
    let mut letters = vec![start];
    let mut score = if begins_word(title, start) { AT_WORD } else { 0 };
    for letter in &word[1..] {
        let last = letters[letters.len() - 1];
        let next = (last + 1..title.len()).find(|place| title[*place] == *letter)?;
        let at_word = (next..title.len()).find(|place| title[*place] == *letter && begins_word(title, *place));
        let place = if next == last + 1 { next } else { at_word.unwrap_or(next) };
        score += match place - last {
            1 => JOINED,
            gap => (gap as i32 - 1) * GAP,
        };
        score += if begins_word(title, place) { AT_WORD } else { 0 };
        letters.push(place);
    }
    Some(FuzzyMatch { score, letters })
}

fn begins_word(title: &[char], place: usize) -> bool {
    place == 0 || !title[place - 1].is_alphanumeric()
}

fn lower(letter: char) -> char {
    letter.to_lowercase().next().unwrap_or(letter)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn best<'a>(typed: &str, titles: &[&'a str]) -> Option<&'a str> {
        let fits = titles.iter().filter_map(|title| Some((fit(typed, title)?.score, *title)));
        fits.rev().max_by_key(|(score, _)| *score).map(|(_, title)| title)
    }

    #[test]
    fn letters_fit_in_their_order_and_words_in_any() {
        assert!(fit("dpth", "Depth").is_some());
        assert!(fit("htpd", "Depth").is_none());
        assert!(fit("inclusive fill", "fill_rule = inclusive").is_some());
        assert!(fit("fill x", "fill_rule = inclusive").is_none());
        assert_eq!(fit("", "anything").map(|fit| fit.letters), Some(Vec::new()));
    }

    #[test]
    fn beginnings_of_words_and_whole_words_come_first() {
        let settings = ["culling = front", "fill_rule = inclusive", "filter = point", "depth_format = unorm16"];
        assert_eq!(best("fir", &settings), Some("fill_rule = inclusive"));
        assert_eq!(best("front", &settings), Some("culling = front"));
        assert_eq!(best("u16", &settings), Some("depth_format = unorm16"));
        assert_eq!(best("zz", &settings), None);
    }

    #[test]
    fn letters_are_counted_in_characters() {
        assert_eq!(fit("s", "λ on screen").map(|fit| fit.letters), Some(vec![5]));
        assert_eq!(fit("Λ", "λ on screen").map(|fit| fit.letters), Some(vec![0]));
    }
}
