//! Letters of 5 × 7 px for names in pictures. They need no font file, so that pictures are equal on every machine.

use crate::image::{Image, Rgba8};

/// Width of a letter and of the gap after it, in pixels of the letters.
const ADVANCE: u32 = 6;

/// Height of a letter, in pixels of the letters.
pub(super) const HEIGHT: u32 = 7;

/// Letters with their rows from top to bottom; the highest of five bits is the left pixel.
#[rustfmt::skip]
const LETTERS: [(char, [u8; 7]); 50] = [
    ('A', [0b01110, 0b10001, 0b10001, 0b11111, 0b10001, 0b10001, 0b10001]),
    ('B', [0b11110, 0b10001, 0b10001, 0b11110, 0b10001, 0b10001, 0b11110]),
    ('C', [0b01110, 0b10001, 0b10000, 0b10000, 0b10000, 0b10001, 0b01110]),
    ('D', [0b11110, 0b10001, 0b10001, 0b10001, 0b10001, 0b10001, 0b11110]),
    ('E', [0b11111, 0b10000, 0b10000, 0b11110, 0b10000, 0b10000, 0b11111]),
    ('F', [0b11111, 0b10000, 0b10000, 0b11110, 0b10000, 0b10000, 0b10000]),
    ('G', [0b01110, 0b10001, 0b10000, 0b10111, 0b10001, 0b10001, 0b01111]),
    ('H', [0b10001, 0b10001, 0b10001, 0b11111, 0b10001, 0b10001, 0b10001]),
    ('I', [0b01110, 0b00100, 0b00100, 0b00100, 0b00100, 0b00100, 0b01110]),
    ('J', [0b00111, 0b00010, 0b00010, 0b00010, 0b00010, 0b10010, 0b01100]),
    ('K', [0b10001, 0b10010, 0b10100, 0b11000, 0b10100, 0b10010, 0b10001]),
    ('L', [0b10000, 0b10000, 0b10000, 0b10000, 0b10000, 0b10000, 0b11111]),
    ('M', [0b10001, 0b11011, 0b10101, 0b10101, 0b10001, 0b10001, 0b10001]),
    ('N', [0b10001, 0b11001, 0b10101, 0b10011, 0b10001, 0b10001, 0b10001]),
    ('O', [0b01110, 0b10001, 0b10001, 0b10001, 0b10001, 0b10001, 0b01110]),
    ('P', [0b11110, 0b10001, 0b10001, 0b11110, 0b10000, 0b10000, 0b10000]),
    ('Q', [0b01110, 0b10001, 0b10001, 0b10001, 0b10101, 0b10010, 0b01101]),
    ('R', [0b11110, 0b10001, 0b10001, 0b11110, 0b10100, 0b10010, 0b10001]),
    ('S', [0b01111, 0b10000, 0b10000, 0b01110, 0b00001, 0b00001, 0b11110]),
    ('T', [0b11111, 0b00100, 0b00100, 0b00100, 0b00100, 0b00100, 0b00100]),
    ('U', [0b10001, 0b10001, 0b10001, 0b10001, 0b10001, 0b10001, 0b01110]),
    ('V', [0b10001, 0b10001, 0b10001, 0b10001, 0b10001, 0b01010, 0b00100]),
    ('W', [0b10001, 0b10001, 0b10001, 0b10101, 0b10101, 0b11011, 0b10001]),
    ('X', [0b10001, 0b10001, 0b01010, 0b00100, 0b01010, 0b10001, 0b10001]),
    ('Y', [0b10001, 0b10001, 0b01010, 0b00100, 0b00100, 0b00100, 0b00100]),
    ('Z', [0b11111, 0b00001, 0b00010, 0b00100, 0b01000, 0b10000, 0b11111]),
    ('0', [0b01110, 0b10001, 0b10011, 0b10101, 0b11001, 0b10001, 0b01110]),
    ('1', [0b00100, 0b01100, 0b00100, 0b00100, 0b00100, 0b00100, 0b01110]),
    ('2', [0b01110, 0b10001, 0b00001, 0b00110, 0b01000, 0b10000, 0b11111]),
    ('3', [0b11110, 0b00001, 0b00001, 0b01110, 0b00001, 0b00001, 0b11110]),
    ('4', [0b00010, 0b00110, 0b01010, 0b10010, 0b11111, 0b00010, 0b00010]),
    ('5', [0b11111, 0b10000, 0b11110, 0b00001, 0b00001, 0b10001, 0b01110]),
    ('6', [0b00110, 0b01000, 0b10000, 0b11110, 0b10001, 0b10001, 0b01110]),
    ('7', [0b11111, 0b00001, 0b00010, 0b00100, 0b01000, 0b01000, 0b01000]),
    ('8', [0b01110, 0b10001, 0b10001, 0b01110, 0b10001, 0b10001, 0b01110]),
    ('9', [0b01110, 0b10001, 0b10001, 0b01111, 0b00001, 0b00010, 0b01100]),
    (' ', [0; 7]),
    ('.', [0b00000, 0b00000, 0b00000, 0b00000, 0b00000, 0b01100, 0b01100]),
    (',', [0b00000, 0b00000, 0b00000, 0b00000, 0b01100, 0b00100, 0b01000]),
    (':', [0b00000, 0b01100, 0b01100, 0b00000, 0b01100, 0b01100, 0b00000]),
    ('-', [0b00000, 0b00000, 0b00000, 0b11111, 0b00000, 0b00000, 0b00000]),
    ('–', [0b00000, 0b00000, 0b00000, 0b11111, 0b00000, 0b00000, 0b00000]),
    ('+', [0b00000, 0b00100, 0b00100, 0b11111, 0b00100, 0b00100, 0b00000]),
    ('×', [0b00000, 0b10001, 0b01010, 0b00100, 0b01010, 0b10001, 0b00000]),
    ('/', [0b00001, 0b00001, 0b00010, 0b00100, 0b01000, 0b10000, 0b10000]),
    ('=', [0b00000, 0b00000, 0b11111, 0b00000, 0b11111, 0b00000, 0b00000]),
    ('(', [0b00010, 0b00100, 0b01000, 0b01000, 0b01000, 0b00100, 0b00010]),
    (')', [0b01000, 0b00100, 0b00010, 0b00010, 0b00010, 0b00100, 0b01000]),
    ('%', [0b11000, 0b11001, 0b00010, 0b00100, 0b01000, 0b10011, 0b00011]),
    ('&', [0b01100, 0b10010, 0b10100, 0b01000, 0b10101, 0b10010, 0b01101]),
];

/// Rows of a character that has no letter: a box.
const UNKNOWN: [u8; 7] = [0b11111, 0b10001, 0b10001, 0b10001, 0b10001, 0b10001, 0b11111];

/// Text in a picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lettering<'a> {
    /// Text, which is written in capitals.
    pub(super) text: &'a str,
    /// Left top corner, in pixels of the picture.
    pub(super) corner: [u32; 2],
    /// Side of a pixel of the letters, in pixels of the picture.
    pub(super) size: u32,
    pub(super) color: Rgba8,
}

impl Lettering<'_> {
    /// Draws the text. What lies beyond the picture is left out.
    pub(super) fn draw(&self, picture: &mut Image<Rgba8>) {
        for (number, letter) in (0..).zip(self.text.chars().flat_map(char::to_uppercase)) {
            let left = self.corner[0] + number * ADVANCE * self.size;
            if left >= picture.width() {
                return;
            }
            let rows = LETTERS.iter().find(|(known, _)| *known == letter).map_or(UNKNOWN, |(_, rows)| *rows);
            for (row, bits) in (0..).zip(rows) {
                let columns = (0..5).filter(|column| bits >> (4 - column) & 1 == 1);
                columns.for_each(|column| {
                    self.fill(picture, [left + column * self.size, self.corner[1] + row * self.size]);
                });
            }
        }
    }

    /// Fills a pixel of a letter.
    fn fill(&self, picture: &mut Image<Rgba8>, [left, top]: [u32; 2]) {
        let (width, height) = picture.size();
        for y in top..(top + self.size).min(height) {
            for x in left..(left + self.size).min(width) {
                picture.set(x, y, self.color);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::upscale::Upscaling;

    #[test]
    fn letters_are_drawn_at_their_place_and_clipped() {
        let draw = |text, corner| {
            let mut picture = Image::filled(14, 8, [0; 4]);
            Lettering { text, corner, size: 1, color: [255; 4] }.draw(&mut picture);
            (0..8)
                .map(|y| (0..14).map(|x| if picture.at(x, y)[0] == 0 { '.' } else { '#' }).collect())
                .collect::<Vec<String>>()
        };
        let expected = [
            "..............",
            ".#####..###...",
            "...#...#...#..",
            "...#.......#..",
            "...#.....##...",
            "...#....#.....",
            "...#...#......",
            "...#...#####..",
        ];
        assert_eq!(draw("t2", [1, 1]), expected);
        assert_eq!(draw("TTTTTT", [12, 6])[6], "............##", "the second letter lies beyond the picture");
    }

    #[test]
    fn every_method_can_be_named() {
        let mut seen = std::collections::HashSet::new();
        assert!(LETTERS.iter().all(|(letter, rows)| seen.insert(*letter) && rows.iter().all(|row| *row < 32)));
        for upscaler in Upscaling::every() {
            let label = upscaler.label();
            let unknown: Vec<_> =
                label.chars().flat_map(char::to_uppercase).filter(|letter| !seen.contains(letter)).collect();
            assert!(unknown.is_empty(), "{label}: {unknown:?}");
        }
    }
}
