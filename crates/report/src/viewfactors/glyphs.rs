//! Digits for pictures, 3 × 5 pixels a character, drawn at twice the size.

/// Pixels of a glyph's pixel.
const SCALE: usize = 2;
/// Width of a character with the gap behind it, pixels.
pub(crate) const ADVANCE: usize = 4 * SCALE;
/// Height of a character, pixels.
pub(crate) const HEIGHT: usize = 5 * SCALE;

/// Rows from the top, the left pixel in the highest of three bits. What has no glyph is blank.
fn glyph(c: char) -> [u8; 5] {
    match c {
        '0' => [7, 5, 5, 5, 7],
        '1' => [2, 6, 2, 2, 7],
        '2' => [7, 1, 7, 4, 7],
        '3' => [7, 1, 7, 1, 7],
        '4' => [5, 5, 7, 1, 1],
        '5' => [7, 4, 7, 1, 7],
        '6' => [7, 4, 7, 5, 7],
        '7' => [7, 1, 1, 1, 1],
        '8' => [7, 5, 7, 5, 7],
        '9' => [7, 5, 7, 1, 7],
        'e' => [0, 7, 7, 4, 7],
        '-' => [0, 0, 7, 0, 0],
        _ => [0; 5],
    }
}

/// The pixels of a text, relative to its upper left corner.
pub(crate) fn pixels(text: &str) -> impl Iterator<Item = (usize, usize)> + '_ {
    let lit = |c: char, x: usize, y: usize| glyph(c)[y / SCALE] >> (2 - x / SCALE) & 1 == 1;
    text.chars().enumerate().flat_map(move |(k, c)| {
        let cells = (0..HEIGHT).flat_map(|y| (0..3 * SCALE).map(move |x| (x, y)));
        cells.filter(move |&(x, y)| lit(c, x, y)).map(move |(x, y)| (k * ADVANCE + x, y))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_minus_is_a_bar_in_the_middle() {
        let found: Vec<_> = pixels("x-").collect();
        let expected: Vec<_> = (4..6).flat_map(|y| (8..14).map(move |x| (x, y))).collect();
        assert_eq!(found, expected);
    }
}
