//! Number formats of the window. Each quantity always has the same format, so that columns align and text does not
//! jump.
//!
//! A thin space precedes units and separates thousands. Negative numbers have a true minus sign (U+2212), which is as
//! wide as a digit in the monospace font. Non-finite values are written "NaN", "∞" and "−∞".

/// Separator between a number and its unit, and between thousands.
const THIN_SPACE: char = '\u{2009}';

/// Formats `value` with a fixed number of decimals.
pub(crate) fn fixed(value: f64, decimals: usize) -> String {
    special(value).unwrap_or_else(|| true_minus(&format!("{value:.decimals$}")))
}

/// Formats an edge function value: integers below 9·10¹⁵ with all digits, other values in scientific notation with nine
/// significant digits.
pub(crate) fn edge(value: f64) -> String {
    let whole = value.fract() == 0.0 && value.abs() < 9e15;
    special(value).unwrap_or_else(|| true_minus(&if whole { format!("{value:.0}") } else { format!("{value:.8e}") }))
}

/// Formats milliseconds with two decimals: "4.10 ms".
pub(crate) fn ms(milliseconds: f64) -> String {
    with_unit(fixed(milliseconds, 2), "ms")
}

/// Formats a fraction as a percentage with one decimal: 0.613 is "61.3 %".
pub(crate) fn percent(fraction: f64) -> String {
    with_unit(fixed(fraction * 100.0, 1), "%")
}

/// Formats an integer with thousands separators: "1 234 567".
pub(crate) fn count(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::with_capacity(2 * digits.len());
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push(THIN_SPACE);
        }
        text.push(digit);
    }
    text
}

/// Formats an integer in a few characters: below 10 000 with all digits, otherwise with three significant digits, such
/// as "14.9 k" for 14 860.
pub(crate) fn short_count(number: u64) -> String {
    let (divisor, prefix) = match number {
        0..10_000 => return count(number),
        // From 999 500 on, three digits would be rounded to 1000 k.
        10_000..999_500 => (1e3, "k"),
        999_500..999_500_000 => (1e6, "M"),
        _ => (1e9, "G"),
    };
    let value = number as f64 / divisor;
    let decimals = match value {
        _ if value < 9.995 => 2,
        _ if value < 99.95 => 1,
        _ => 0,
    };
    with_unit(fixed(value, decimals), prefix)
}

/// Formats a number of bytes in binary units: "512 B", "3.5 MiB".
pub(crate) fn bytes(bytes: u64) -> String {
    const UNITS: [&str; 6] = ["KiB", "MiB", "GiB", "TiB", "PiB", "EiB"];
    if bytes < 1024 {
        return with_unit(bytes.to_string(), "B");
    }
    let mut value = bytes as f64 / 1024.0;
    let mut unit = 0;
    // With one decimal, values from 1023.95 would be rounded to 1024.0.
    while value >= 1023.95 {
        value /= 1024.0;
        unit += 1;
    }
    with_unit(fixed(value, 1), UNITS[unit])
}

/// Formats an `f32` with nine significant digits, which parse back to the same value.
///
/// Decimal notation from 10⁻⁴ to below 10⁹, scientific notation outside: "0.999999881", "1.23456789e−7".
pub(crate) fn f32_full(value: f32) -> String {
    const SIGNIFICANT: i32 = 9;
    if let Some(text) = special(f64::from(value)) {
        return text;
    }
    let scientific = format!("{value:.8e}");
    let exponent = scientific.split_once('e').and_then(|(_, digits)| digits.parse::<i32>().ok()).unwrap_or(0);
    if (-4..SIGNIFICANT).contains(&exponent) {
        let decimals = (SIGNIFICANT - 1 - exponent) as usize;
        true_minus(&format!("{value:.decimals$}"))
    } else {
        true_minus(&scientific)
    }
}

/// Formats the bits of an `f32` in hexadecimal, for example "0x3F7FFFFE".
pub(crate) fn bits(value: f32) -> String {
    format!("0x{:08X}", value.to_bits())
}

fn with_unit(number: String, unit: &str) -> String {
    number + &THIN_SPACE.to_string() + unit
}

fn true_minus(text: &str) -> String {
    text.replace('-', "−")
}

/// Returns the text of NaN or an infinity; `None` for finite values.
fn special(value: f64) -> Option<String> {
    let text = match value {
        _ if value.is_nan() => "NaN",
        f64::INFINITY => "∞",
        f64::NEG_INFINITY => "−∞",
        _ => return None,
    };
    Some(text.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thin_space_precedes_units() {
        assert_eq!(ms(4.1), "4.10\u{2009}ms");
        assert_eq!(percent(0.6127), "61.3\u{2009}%");
        assert_eq!(bytes(512), "512\u{2009}B");
    }

    #[test]
    fn negative_numbers_have_a_true_minus_sign() {
        assert_eq!(fixed(-1.25, 1), "−1.2");
        assert_eq!(f32_full(-0.0), "−0.00000000");
        assert_eq!(f32_full(-1.5e-20), "−1.49999995e−20");
    }

    #[test]
    fn thousands_are_separated_from_the_right() {
        for (number, text) in [(0, "0"), (999, "999"), (1000, "1 000"), (1_234_567, "1 234 567")] {
            assert_eq!(count(number), text.replace(' ', "\u{2009}"));
        }
        assert_eq!(count(u64::MAX).chars().filter(char::is_ascii_digit).count(), 20);
    }

    #[test]
    fn short_counts_have_at_most_four_digits() {
        for (number, text) in [
            (0, "0"),
            (9_999, "9 999"),
            (14_860, "14.9 k"),
            (99_949, "99.9 k"),
            (99_950, "100 k"),
            (921_600, "922 k"),
            (999_499, "999 k"),
            (999_500, "1.00 M"),
            (1_843_200, "1.84 M"),
            (999_500_000, "1.00 G"),
        ] {
            assert_eq!(short_count(number), text.replace(' ', "\u{2009}"), "{number}");
        }
    }

    #[test]
    fn sizes_change_unit_before_they_need_four_digits() {
        for (size, text) in [
            (1023, "1023 B"),
            (1024, "1.0 KiB"),
            (1024 * 1024 - 1, "1.0 MiB"),
            (3_670_016, "3.5 MiB"),
            (u64::MAX, "16.0 EiB"),
        ] {
            assert_eq!(bytes(size), text.replace(' ', "\u{2009}"));
        }
    }

    #[test]
    fn nine_significant_digits_read_back_as_the_same_float() {
        for value in [0.1_f32, 0.999_999_9, 1.0, 123_456.79, 1e-4, 9.999_999e-5, 16_777_216.0, 1e9, 3.4e38, 1e-45] {
            let text = f32_full(value);
            let significant =
                text.split('e').next().map(|digits| digits.replace('.', "").trim_start_matches('0').chars().count());
            assert_eq!(significant, Some(9), "{text}");
            assert_eq!(text.replace('−', "-").parse::<f32>(), Ok(value), "{text}");
        }
    }

    #[test]
    fn non_finite_floats_are_written_as_words_or_symbols() {
        assert_eq!([f32::NAN, f32::INFINITY, f32::NEG_INFINITY].map(f32_full), ["NaN", "∞", "−∞"]);
        assert_eq!(ms(f64::INFINITY), "∞\u{2009}ms");
    }

    #[test]
    fn bits_are_eight_hexadecimal_digits() {
        assert_eq!(bits(0.999_999_9), "0x3F7FFFFE");
        assert_eq!(bits(1e-45), "0x00000001");
    }
}
