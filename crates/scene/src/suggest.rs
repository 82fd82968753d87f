//! The known name that was probably meant.
//!
//! Distance of two words: the fewest insertions, deletions and replacements of a character that turn one into the
//! other (V. I. Levenshtein, Soviet Physics Doklady 10, 707, 1966).

/// Help for an unknown name: the nearest known one, then all of them. `plural` names what they are.
pub(crate) fn among<'a>(name: &str, known: impl IntoIterator<Item = &'a str>, plural: &str) -> String {
    let known: Vec<&str> = known.into_iter().collect();
    if known.is_empty() {
        return format!("there are no {plural}");
    }
    let list: Vec<String> = known.iter().map(|k| format!("`{k}`")).collect();
    let list = format!("known {plural}: {}", list.join(", "));
    match nearest(name, &known) {
        Some(near) => format!("did you mean `{near}`? {list}"),
        None => list,
    }
}

fn nearest<'a>(name: &str, known: &[&'a str]) -> Option<&'a str> {
    let close = known.iter().map(|k| (distance(name, k), *k)).min_by_key(|(d, _)| *d);
    close.filter(|(d, k)| 3 * d <= k.chars().count().max(3)).map(|(_, k)| k)
}

fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(x != *y);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_of_known_pairs() {
        for (a, b, expected) in
            [("", "", 0), ("kitten", "sitting", 3), ("abc", "", 3), ("", "ab", 2), ("flaw", "lawn", 2)]
        {
            assert_eq!(distance(a, b), expected, "{a} {b}");
            assert_eq!(distance(b, a), expected, "{b} {a}");
        }
    }

    #[test]
    fn far_names_are_not_suggested() {
        assert_eq!(nearest("reflectence", &["exitance", "reflectance"]), Some("reflectance"));
        assert_eq!(nearest("zebra", &["exitance", "reflectance"]), None);
        assert_eq!(among("x", [], "materials"), "there are no materials");
    }
}
