//! How well typed letters fit a title: each word as letters in their order, better the closer together and the nearer to
//! the beginnings of words.

/// A title that what was typed fits.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fit {
    /// Higher is better; only to be compared with other titles for the same letters.
    pub score: i32,
    /// The letters of the title that fit, counted in characters.
    pub letters: Vec<usize>,
}

/// For a letter that begins a word.
const AT_WORD: i32 = 8;

/// For a letter right after the one before.
const JOINED: i32 = 6;

/// For each letter passed over between two that fit.
const GAP: i32 = -1;

/// So many letters of the title count one less: of two that fit alike, the shorter one was meant.
const LENGTH_OF_ONE: i32 = 8;

/// Finds all words of `typed` in `title`, in any order and without regard to case. Nothing typed fits everything.
pub fn fit(typed: &str, title: &str) -> Option<Fit> {
    let title: Vec<char> = title.chars().map(lower).collect();
    let mut whole = Fit { score: 0, letters: Vec::new() };
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

/// The best of the fits that begin at each place where the first letter stands.
fn fit_word(word: &[char], title: &[char]) -> Option<Fit> {
    let first = word.first()?;
    let starts = title.iter().enumerate().filter(|(_, letter)| *letter == first).map(|(place, _)| place);
    starts
        .filter_map(|start| fit_from(start, word, title))
        .max_by_key(|fit| (fit.score, std::cmp::Reverse(fit.letters[0])))
}

/// Takes for each letter the next one, but rather the beginning of a later word that goes on with the letters after it.
fn fit_from(start: usize, word: &[char], title: &[char]) -> Option<Fit> {
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
    Some(Fit { score, letters })
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
