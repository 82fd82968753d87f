//! Times as people say them.

use std::time::Duration;

/// Units, their seconds, and the number of seconds from which on they are used.
const UNITS: [(&str, f64, f64); 5] = [
    ("year", 31_557_600.0, 63_115_200.0),
    ("day", 86_400.0, 172_800.0),
    ("hour", 3600.0, 5400.0),
    ("minute", 60.0, 90.0),
    ("second", 1.0, 0.95),
];

/// About how long a number of seconds is, with one or two digits.
pub(crate) fn in_words(seconds: f64) -> String {
    let Some((name, unit, _)) = UNITS.iter().find(|(_, _, from)| seconds >= *from) else {
        return "less than a second".to_owned();
    };
    let count = (seconds / unit).round().max(1.0);
    let shown = if count < 100.0 { format!("{count}") } else { format!("{count:.1e}") };
    let plural = if count > 1.0 { "s" } else { "" };
    format!("about {shown} {name}{plural}")
}

/// The time of one thread, and where there are more that of all.
pub(crate) fn on_threads(seconds: f64, threads: usize) -> String {
    let shared = if threads > 1 {
        format!(", {} on {threads}", in_words(seconds / threads as f64))
    } else {
        String::new()
    };
    format!("{} on one thread{shared}", in_words(seconds))
}

/// Reads a time: a number of seconds, or a number with `s`, `min` or `h`.
pub(crate) fn parse(text: &str) -> Result<Duration, String> {
    let number = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let unit = match text[number.len()..].trim() {
        "" | "s" => Some(1.0),
        "min" => Some(60.0),
        "h" => Some(3600.0),
        _ => None,
    };
    let seconds = unit.and_then(|unit| Some(number.trim().parse::<f64>().ok()? * unit));
    seconds
        .filter(|seconds| *seconds > 0.0)
        .and_then(|seconds| Duration::try_from_secs_f64(seconds).ok())
        .ok_or_else(|| "must be a time above 0, such as 30s, 10min or 2h".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_is_read_in_seconds_minutes_or_hours() {
        for (text, seconds) in
            [("30", 30.0), ("0.5s", 0.5), ("30 s", 30.0), ("10min", 600.0), ("2h", 7200.0), ("1e3", 1000.0)]
        {
            assert_eq!(parse(text), Ok(Duration::from_secs_f64(seconds)), "{text}");
        }
        for text in ["", "0", "-1", "s", "5 m", "3 hours", "nan", "inf", "1e99"] {
            assert!(parse(text).is_err(), "{text}");
        }
    }

    #[test]
    fn times_are_told_in_the_unit_that_suits_them() {
        for (seconds, words) in [
            (0.2, "less than a second"),
            (1.2, "about 1 second"),
            (75.0, "about 75 seconds"),
            (200.0, "about 3 minutes"),
            (4000.0, "about 67 minutes"),
            (10_000.0, "about 3 hours"),
            (5e5, "about 6 days"),
            (1e8, "about 3 years"),
            (1e12, "about 3.2e4 years"),
        ] {
            assert_eq!(in_words(seconds), words, "{seconds}");
        }
    }
}
