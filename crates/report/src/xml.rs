//! Text inside XML.

/// A text fit for XML content and for attributes in double quotes; control characters, which XML
/// forbids, become spaces.
pub(crate) fn escaped(text: &str) -> String {
    text.chars().fold(String::with_capacity(text.len()), |mut out, c| {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
        out
    })
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// The start tags of a document, as (name, attribute text), after checking that tags nest and
    /// close properly and that no bare `&` or `<` is left.
    pub(crate) fn tags(text: &str) -> Vec<(String, String)> {
        let (mut open, mut found, mut rest) = (Vec::<String>::new(), Vec::new(), text);
        while let Some(start) = rest.find('<') {
            check_entities(&rest[..start]);
            let end = start + rest[start..].find('>').expect("a tag must close");
            let tag = &rest[start + 1..end];
            rest = &rest[end + 1..];
            if tag.starts_with('?') {
                continue;
            }
            if let Some(name) = tag.strip_prefix('/') {
                assert_eq!(open.pop().as_deref(), Some(name));
                continue;
            }
            let (name, attributes) = tag.trim_end_matches('/').split_once(' ').unwrap_or((tag, ""));
            check_entities(attributes);
            assert_eq!(attributes.matches('"').count() % 2, 0, "{attributes}");
            found.push((name.trim_end_matches('/').to_owned(), attributes.to_owned()));
            if !tag.ends_with('/') {
                open.push(name.to_owned());
            }
        }
        assert!(open.is_empty(), "unclosed: {open:?}");
        found
    }

    fn check_entities(text: &str) {
        for piece in text.split('&').skip(1) {
            let known = ["amp;", "lt;", "gt;", "quot;"].iter().any(|entity| piece.starts_with(entity));
            assert!(known, "bare & before {piece:?}");
        }
    }

    /// The value of an attribute.
    pub(crate) fn attribute<'a>(attributes: &'a str, name: &str) -> &'a str {
        let start = attributes.find(&format!("{name}=\"")).expect(name) + name.len() + 2;
        attributes[start..].split('"').next().unwrap()
    }

    #[test]
    fn markup_becomes_text() {
        assert_eq!(escaped("a<b & \"c\">\u{1}"), "a&lt;b &amp; &quot;c&quot;&gt; ");
        assert_eq!(tags("<?xml?><a x=\"1\"><b/>t</a>").len(), 2);
    }
}
