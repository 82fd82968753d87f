//! Comma-separated values (RFC 4180), with rows that end in a line feed.

use std::borrow::Cow;
use std::io::{self, Write};

use crate::number::Number;

/// A text as a field of a row: in quotes, inner quotes doubled, where it holds a comma, a quote or
/// a line end.
pub(crate) fn quoted(text: &str) -> Cow<'_, str> {
    if text.contains([',', '"', '\n', '\r']) {
        Cow::Owned(format!("\"{}\"", text.replace('"', "\"\"")))
    } else {
        Cow::Borrowed(text)
    }
}

/// Writes the fixed column names, then each quantity in each band, band by band:
/// `q1_b1,q2_b1,q1_b2,q2_b2`.
pub(crate) fn header(
    out: &mut dyn Write,
    fixed: &str,
    quantities: &[&str],
    bands: &[String],
) -> io::Result<()> {
    out.write_all(fixed.as_bytes())?;
    for band in bands {
        for quantity in quantities {
            write!(out, ",{}", quoted(&format!("{quantity}_{band}")))?;
        }
    }
    writeln!(out)
}

/// Writes `,x` for each number.
pub(crate) fn numbers(out: &mut dyn Write, values: impl IntoIterator<Item = f64>) -> io::Result<()> {
    values.into_iter().try_for_each(|value| write!(out, ",{}", Number(value)))
}

/// A row that was read.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Row {
    /// The line on which it begins, from 1.
    pub(crate) line: usize,
    pub(crate) fields: Vec<String>,
}

/// Splits a table into rows of fields by the grammar of RFC 4180. Empty lines are left out; a
/// carriage return before a line feed is no part of a field. `None` where a quote is not closed.
pub(crate) fn rows(text: &str) -> Option<Vec<Row>> {
    let (mut rows, mut line, mut begun) = (Vec::new(), 1, 1);
    let (mut fields, mut field) = (Vec::new(), String::new());
    let (mut inside, mut chars) = (false, text.chars().peekable());
    let mut end = |fields: &mut Vec<String>, mut field: String, line: usize| {
        if field.ends_with('\r') {
            field.pop();
        }
        fields.push(field);
        let fields = std::mem::take(fields);
        if fields.len() > 1 || !fields[0].is_empty() {
            rows.push(Row { line, fields });
        }
    };
    while let Some(c) = chars.next() {
        line += usize::from(c == '\n');
        match c {
            '"' if inside && chars.peek() == Some(&'"') => field.extend(chars.next()),
            '"' => inside = !inside,
            ',' if !inside => fields.push(std::mem::take(&mut field)),
            '\n' if !inside => {
                end(&mut fields, std::mem::take(&mut field), begun);
                begun = line;
            }
            c => field.push(c),
        }
    }
    if !field.is_empty() || !fields.is_empty() {
        end(&mut fields, field, begun);
    }
    (!inside).then_some(rows)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// The fields of all rows of a table that ends in a line feed.
    pub(crate) fn parse(text: &str) -> Vec<Vec<String>> {
        assert!(text.ends_with('\n'), "the last row must end in a line feed");
        rows(text).unwrap().into_iter().map(|row| row.fields).collect()
    }

    /// The numbers of one row, from column `first` on.
    pub(crate) fn values(row: &[String], first: usize) -> Vec<f64> {
        row[first..].iter().map(|text| text.parse().unwrap()).collect()
    }

    #[test]
    fn awkward_texts_survive() {
        for text in ["plain", "a,b", "say \"so\"", "two\nlines", "", "ends\r"] {
            let line = format!("{},x\n", quoted(text));
            assert_eq!(parse(&line), [[text, "x"]]);
        }
    }

    #[test]
    fn columns_go_band_by_band() {
        let mut out = Vec::new();
        header(&mut out, "a", &["e", "b"], &["r".into(), "g,h".into()]).unwrap();
        assert_eq!(parse(&String::from_utf8(out).unwrap()), [["a", "e_r", "b_r", "e_g,h", "b_g,h"]]);
    }
}
