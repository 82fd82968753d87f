//! Names of a scene inside a page, where they must be nothing but text.

/// A text as it stands in a script element of JSON: no character can end the element or begin a
/// comment, and the value is the same to whoever parses the JSON (RFC 8259, section 7).
pub(super) fn json(value: &impl serde::Serialize) -> serde_json::Result<String> {
    let text = serde_json::to_string(value)?;
    Ok(text.chars().fold(String::with_capacity(text.len()), |mut out, c| {
        match c {
            // These occur within strings only.
            '<' => out.push_str("\\u003c"),
            '>' => out.push_str("\\u003e"),
            '&' => out.push_str("\\u0026"),
            '\u{2028}' => out.push_str("\\u2028"),
            '\u{2029}' => out.push_str("\\u2029"),
            c => out.push(c),
        }
        out
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn json_is_harmless_in_a_script_and_the_same_value() {
        let hostile = "</script><script>alert(1)</script><!-- & \u{2028} \" \\ ]]>";
        let text = json(&hostile).unwrap();
        assert!(!text.contains(['<', '>', '&', '\u{2028}']), "{text}");
        assert_eq!(serde_json::from_str::<String>(&text).unwrap(), hostile);
    }
}
