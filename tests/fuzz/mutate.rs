//! Unusual numbers, and random mutations of bytes and JSON values.

use fastrand::Rng;
use serde_json::{Map, Value, json};

/// Unusual numbers, and text that only resembles numbers.
const ODD_NUMBERS: [&str; 32] = [
    "nan",
    "-nan(ind)",
    "inf",
    "-inf",
    "1e39",
    "-1e39",
    "3.4e38",
    "1e400",
    "1e-46",
    "1e-39",
    "-0",
    "0",
    "1",
    "-1",
    "+1",
    "0.5",
    ".5",
    "5.",
    "1e",
    "0x10",
    "1,5",
    "1_0",
    "255",
    "256",
    "65536",
    "2147483648",
    "-2147483649",
    "4294967295",
    "4294967296",
    "18446744073709551616",
    "16777217",
    "0.1000000000000000055511151231257827",
];

/// Returns a number as text: mostly small, sometimes of any magnitude, sometimes unusual.
pub(crate) fn number(rng: &mut Rng) -> String {
    match rng.u8(..10) {
        0 => word(rng, &ODD_NUMBERS).to_owned(),
        1 => format!("{:e}", f32::from_bits(rng.u32(..))),
        2..=4 => rng.i32(-3..12).to_string(),
        _ => format!("{:.3}", rng.f32() * 4.0 - 2.0),
    }
}

/// Returns a random item. Panics if there are none.
pub(crate) fn pick<'a, T>(rng: &mut Rng, items: &'a [T]) -> &'a T {
    &items[rng.usize(..items.len())]
}

/// Returns a random word. Panics if there are none.
pub(crate) fn word<'a>(rng: &mut Rng, words: &[&'a str]) -> &'a str {
    words[rng.usize(..words.len())]
}

/// Applies one to four random changes, each to a bit, a byte, a run of bytes, a line, a number, or the end.
pub(crate) fn bytes(rng: &mut Rng, bytes: &mut Vec<u8>) {
    for _ in 0..rng.usize(1..=4) {
        change_bytes(rng, bytes);
    }
}

fn change_bytes(rng: &mut Rng, bytes: &mut Vec<u8>) {
    if bytes.is_empty() {
        bytes.push(rng.u8(..));
        return;
    }
    let at = rng.usize(..bytes.len());
    let run = at..bytes.len().min(at + 1 + rng.usize(..16));
    match rng.u8(..9) {
        0 => bytes[at] ^= 1 << rng.u8(..8),
        1 => bytes[at] = *pick(rng, &[0, 1, 0x7F, 0x80, 0xFF, b' ', b'\n', b'\\', b'"', b'/', b'-', b'#']),
        2 => drop(bytes.drain(run)),
        3 => bytes.truncate(at),
        4 => {
            let copy = bytes[run].to_vec();
            let to = rng.usize(..=bytes.len());
            bytes.splice(to..to, copy);
        }
        5 => {
            let new: Vec<_> = (0..rng.usize(1..6)).map(|_| rng.u8(..)).collect();
            bytes.splice(at..at, new);
        }
        6 | 7 => replace_number(rng, bytes, at),
        _ => move_line(rng, bytes),
    }
}

/// Replaces the first number at or after `at` by a random one.
fn replace_number(rng: &mut Rng, bytes: &mut Vec<u8>, at: usize) {
    let is_part = |byte: &u8| byte.is_ascii_digit() || b"+-.".contains(byte);
    let Some(start) = bytes[at..].iter().position(is_part).map(|offset| at + offset) else { return };
    let length = bytes[start..].iter().take_while(|byte| is_part(byte)).count();
    bytes.splice(start..start + length, number(rng).into_bytes());
}

/// Removes a line and, in half of the cases, inserts it elsewhere.
fn move_line(rng: &mut Rng, bytes: &mut Vec<u8>) {
    let mut lines: Vec<_> = bytes.split_inclusive(|byte| *byte == b'\n').map(<[u8]>::to_vec).collect();
    let line = lines.remove(rng.usize(..lines.len()));
    if rng.bool() {
        lines.insert(rng.usize(..=lines.len()), line);
    }
    *bytes = lines.concat();
}

/// Changes one to three values of a JSON tree.
pub(crate) fn json(rng: &mut Rng, tree: &mut Value) {
    for _ in 0..rng.usize(1..=3) {
        let depth = rng.usize(..6);
        change_json(rng, tree, depth);
    }
}

/// Changes `value`, or a value at most `depth` levels below it.
fn change_json(rng: &mut Rng, value: &mut Value, depth: usize) {
    match value {
        Value::Object(fields) if depth > 0 && !fields.is_empty() => {
            let index = rng.usize(..fields.len());
            if let Some(inner) = fields.values_mut().nth(index) {
                change_json(rng, inner, depth - 1);
            }
        }
        Value::Array(items) if depth > 0 && !items.is_empty() => {
            let index = rng.usize(..items.len());
            change_json(rng, &mut items[index], depth - 1);
        }
        Value::Object(fields) if rng.bool() => change_fields(rng, fields),
        Value::Array(items) if rng.bool() => change_items(rng, items),
        Value::String(text) if rng.bool() => {
            let mut changed = text.clone().into_bytes();
            change_bytes(rng, &mut changed);
            *text = String::from_utf8_lossy(&changed).into_owned();
        }
        _ => *value = other_value(rng, value),
    }
}

fn change_fields(rng: &mut Rng, fields: &mut Map<String, Value>) {
    let names: Vec<_> = fields.keys().cloned().collect();
    if names.is_empty() || rng.u8(..4) == 0 {
        let unknown = other_value(rng, &Value::Null);
        fields.insert("unknown".to_owned(), unknown);
        return;
    }
    let removed = fields.remove(pick(rng, &names)).unwrap_or_default();
    // Half of the removed fields return under the name of another field.
    if rng.bool() {
        fields.insert(pick(rng, &names).clone(), removed);
    }
}

fn change_items(rng: &mut Rng, items: &mut Vec<Value>) {
    match rng.u8(..4) {
        0 => items.clear(),
        1 if !items.is_empty() => drop(items.remove(rng.usize(..items.len()))),
        2 if !items.is_empty() => {
            let copies = *pick(rng, &[1, 2, 300]);
            let copy = pick(rng, items).clone();
            items.extend(std::iter::repeat_n(copy, copies));
        }
        _ => items.push(other_value(rng, &Value::Null)),
    }
}

/// Returns another value, of the same kind in most cases.
fn other_value(rng: &mut Rng, value: &Value) -> Value {
    match value {
        Value::Number(_) if rng.u8(..8) > 0 => match rng.u8(..5) {
            0 => json!(rng.i64(-20..60)),
            1 => json!(f64::from(f32::from_bits(rng.u32(..)))),
            2 => json!(rng.f64() * 40.0 - 4.0),
            3 => serde_json::from_str(word(rng, &ODD_NUMBERS)).unwrap_or_else(|_| json!(1e300)),
            _ => json!(word(rng, &["NaN", "Infinity", "-Infinity"])),
        },
        Value::Bool(value) if rng.bool() => json!(!value),
        _ => match rng.u8(..6) {
            0 => Value::Null,
            1 => json!([]),
            2 => json!({}),
            3 => json!(rng.bool()),
            4 => json!(word(rng, &["", "x", "\u{0}\u{1b}[2J", "../../etc", "\u{202e}", "ff"])),
            _ => json!([[[[rng.i8(..)]]]]),
        },
    }
}

/// Reduces numbers that may be picture sizes or line lengths to less than 256, so that drawing takes milliseconds.
/// Keeps numbers above the pixel count of any picture, which the program must reject.
pub(crate) fn shrink_sizes(tree: &mut Value) {
    /// Largest number of pixels of a picture.
    const MOST: f64 = (1 << 25) as f64;
    match tree {
        Value::Number(number) => {
            let size = number.as_f64().unwrap_or_default();
            if (257.0..=MOST).contains(&size.abs()) {
                *tree = if size.fract() == 0.0 { json!((size % 256.0) as i64) } else { json!(size % 256.0) };
            }
        }
        Value::Array(items) => items.iter_mut().for_each(shrink_sizes),
        Value::Object(fields) => fields.values_mut().for_each(shrink_sizes),
        _ => {}
    }
}
