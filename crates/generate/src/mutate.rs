//! Damaged files: what editors, programs and disks do to text.

use crate::dice::Dice;

/// What is put into numbers, names and lines.
const PIECES: [&str; 28] = [
    "",
    "-",
    "0",
    "1",
    "-1",
    "1e400",
    "-1e308",
    "1e-320",
    "nan",
    "inf",
    "99999999999999999999",
    "4294967296",
    "\"",
    "[",
    "]",
    "{",
    "}",
    "=",
    ",",
    "#",
    "\n",
    "\r\n",
    "\t",
    "\u{0}",
    "é",
    "true",
    "[[surface]]\n",
    "\\",
];

/// A text with one to four random damages.
#[must_use]
pub fn mutated(text: &str, seed: u64) -> String {
    let mut dice = Dice::new(seed);
    let mut text = text.to_owned();
    for _ in 0..dice.pick(&[1, 1, 1, 2, 4]) {
        text = damaged(&text, &mut dice);
    }
    text
}

fn damaged(text: &str, dice: &mut Dice) -> String {
    match dice.below(10) {
        0 => with_other_number(text, dice),
        1 | 2 => with_number(text, dice),
        3 => with_line(text, dice, |line| vec![line, line]),
        4 => with_line(text, dice, |_| vec![]),
        5 => lines_exchanged(text, dice),
        6 => text[..place(text, dice)].to_owned(),
        7 => with_word(text, dice),
        _ => {
            let at = place(text, dice);
            let end = text.floor_char_boundary((at + dice.below(4)).min(text.len())).max(at);
            format!("{}{}{}", &text[..at], dice.pick(&PIECES), &text[end..])
        }
    }
}

fn place(text: &str, dice: &mut Dice) -> usize {
    text.floor_char_boundary(dice.below(text.len() + 1))
}

/// Where the numbers stand.
fn numbers(text: &str) -> Vec<(usize, usize)> {
    let part = |c: char| c.is_ascii_digit() || matches!(c, '.' | '-' | '+' | 'e');
    let mut found = vec![];
    let mut start = None;
    for (i, c) in text.char_indices().chain([(text.len(), ' ')]) {
        match (start, part(c)) {
            (None, true) => start = Some(i),
            (Some(from), false) => {
                if text[from..i].parse::<f64>().is_ok() {
                    found.push((from, i));
                }
                start = None;
            }
            _ => {}
        }
    }
    found
}

fn replaced(text: &str, (from, to): (usize, usize), by: &str) -> String {
    format!("{}{by}{}", &text[..from], &text[to..])
}

/// A number becomes another number of the text, so that the text often stays valid.
fn with_other_number(text: &str, dice: &mut Dice) -> String {
    let numbers = numbers(text);
    if numbers.is_empty() {
        return text.to_owned();
    }
    let (from, to) = dice.pick(&numbers);
    replaced(text, dice.pick(&numbers), &text[from..to])
}

/// A number becomes an odd one.
fn with_number(text: &str, dice: &mut Dice) -> String {
    let numbers = numbers(text);
    if numbers.is_empty() {
        return text.to_owned();
    }
    let at = dice.pick(&numbers);
    let old = text[at.0..at.1].parse::<f64>().unwrap_or(0.0);
    let new = match dice.below(8) {
        0 => 0.0,
        1 => -old,
        2 => old * 10_f64.powf(dice.between(-30.0, 30.0)),
        3 => old * (1.0 + 1e-9),
        4 => old.round(),
        5 => 10_f64.powf(dice.between(-308.0, 308.0)),
        6 => old + dice.between(-1.0, 1.0),
        _ => return replaced(text, at, dice.pick(&PIECES)),
    };
    replaced(text, at, &format!("{new:?}"))
}

/// A word becomes another word of the text.
fn with_word(text: &str, dice: &mut Dice) -> String {
    let words: Vec<&str> =
        text.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|w| !w.is_empty()).collect();
    if words.is_empty() {
        return text.to_owned();
    }
    let (old, new) = (dice.pick(&words), dice.pick(&words));
    let start = place(text, dice);
    let from = text[start..].find(old).map_or_else(|| text.find(old).unwrap_or(0), |i| start + i);
    replaced(text, (from, from + old.len()), new)
}

fn with_line(text: &str, dice: &mut Dice, change: impl Fn(&str) -> Vec<&str>) -> String {
    let lines: Vec<&str> = text.split_inclusive('\n').collect();
    if lines.is_empty() {
        return text.to_owned();
    }
    let chosen = dice.below(lines.len());
    let changed =
        lines.iter().enumerate().flat_map(|(i, line)| if i == chosen { change(line) } else { vec![*line] });
    changed.collect()
}

fn lines_exchanged(text: &str, dice: &mut Dice) -> String {
    let mut lines: Vec<&str> = text.split_inclusive('\n').collect();
    if lines.is_empty() {
        return text.to_owned();
    }
    let (a, b) = (dice.below(lines.len()), dice.below(lines.len()));
    lines.swap(a, b);
    lines.concat()
}
