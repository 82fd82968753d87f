//! Numbers and shares as they stand in sentences.

/// A number of three significant digits, with powers of ten where it is very large or small.
pub(crate) fn number(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !value.is_finite() {
        return "not a finite number".to_owned();
    }
    let text = format!("{value:.2e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    if (-3..6).contains(&exponent) {
        let decimals = usize::try_from(2 - exponent).unwrap_or(0);
        let text = shortened(&format!("{value:.decimals$}"));
        return minus(&if exponent > 3 { grouped(&text) } else { text });
    }
    match shortened(mantissa).as_str() {
        "1" => format!("10{}", raised(exponent)),
        mantissa => format!("{} × 10{}", minus(mantissa), raised(exponent)),
    }
}

/// A share in per cent.
pub(crate) fn percent(share: f64) -> String {
    format!("{} %", number(100.0 * share))
}

/// Without zeros at the end of its decimals.
fn shortened(text: &str) -> String {
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text.to_owned()
    }
}

fn minus(text: &str) -> String {
    text.replace('-', "−")
}

pub(crate) fn raised(exponent: i32) -> String {
    let digit = |c: char| match c.to_digit(10) {
        Some(d) => ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][d as usize],
        None => '⁻',
    };
    exponent.to_string().chars().map(digit).collect()
}

/// Digits in groups of three.
fn grouped(digits: &str) -> String {
    let groups = digits.as_bytes().rchunks(3).rev();
    let groups: Vec<&str> = groups.map(|group| std::str::from_utf8(group).unwrap_or_default()).collect();
    groups.join("\u{202f}")
}

/// A number of things.
pub(crate) fn count(number: u64, one: &str, more: &str) -> String {
    format!("{} {}", grouped(&number.to_string()), if number == 1 { one } else { more })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        for (value, text) in [
            (0.0, "0"),
            (1.0, "1"),
            (-0.012_345, "−0.0123"),
            (999.6, "1000"),
            (123_456.0, "123\u{202f}456"),
            (1e-9, "10⁻⁹"),
            (-2.5e17, "−2.5 × 10¹⁷"),
            (f64::NAN, "not a finite number"),
        ] {
            assert_eq!(number(value), text);
        }
        assert_eq!(percent(0.012_34), "1.23 %");
        assert_eq!(count(1, "element", "elements"), "1 element");
        assert_eq!(count(1_234_567, "element", "elements"), "1\u{202f}234\u{202f}567 elements");
    }
}
