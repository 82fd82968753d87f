//! JSON (RFC 8259) whose values know where they stand, so that errors about their meaning name a
//! place.

use std::ops::Range;

use crate::error::{ErrorKind, SceneError};
use crate::source::Source;

/// Deepest nesting: no mesh file has a reason for more.
const DEEPEST_NESTING: usize = 64;

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    Null,
    Bool(bool),
    Number(f64),
    Text(String),
    List(Vec<Json>),
    Table(Vec<(String, Json)>),
}

/// A value and the bytes it stands at.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Json {
    pub value: Value,
    pub span: Range<usize>,
}

impl Json {
    /// The value of a key of a table.
    pub fn get(&self, key: &str) -> Option<&Self> {
        let Value::Table(entries) = &self.value else { return None };
        entries.iter().find(|(name, _)| name == key).map(|(_, value)| value)
    }

    pub fn list(&self) -> Option<&[Self]> {
        if let Value::List(values) = &self.value { Some(values) } else { None }
    }

    pub fn text(&self) -> Option<&str> {
        if let Value::Text(text) = &self.value { Some(text) } else { None }
    }

    pub fn number(&self) -> Option<f64> {
        if let Value::Number(number) = self.value { Some(number) } else { None }
    }

    /// A whole number, 0 or more.
    pub fn whole(&self) -> Option<usize> {
        self.number().filter(|x| x.fract() == 0.0 && (0.0..9e15).contains(x)).map(|x| x as usize)
    }

    pub fn bool(&self) -> Option<bool> {
        if let Value::Bool(value) = self.value { Some(value) } else { None }
    }

    /// A list of as many finite numbers.
    pub fn numbers<const N: usize>(&self) -> Option<[f64; N]> {
        let values: Option<Vec<f64>> =
            self.list()?.iter().map(|value| value.number().filter(|x| x.is_finite())).collect();
        values?.try_into().ok()
    }
}

/// Reads a text that begins at byte `base` of the file.
pub(super) fn parse(source: &Source, text: &str, base: usize) -> Result<Json, SceneError> {
    let mut reader = Reader { source, text, base, at: 0 };
    let value = reader.value(0)?;
    reader.blanks();
    if reader.at < text.len() {
        return Err(reader.error("something stands behind the end of the JSON value", "remove it"));
    }
    Ok(value)
}

struct Reader<'a> {
    source: &'a Source,
    text: &'a str,
    base: usize,
    at: usize,
}

impl Reader<'_> {
    fn error(&self, what: impl AsRef<str>, help: &str) -> SceneError {
        let at = self.base + self.at;
        self.source.error(ErrorKind::Syntax, at..at + 1, what, help)
    }

    fn peek(&self) -> Option<u8> {
        self.text.as_bytes().get(self.at).copied()
    }

    fn blanks(&mut self) {
        while self.peek().is_some_and(|byte| matches!(byte, b' ' | b'\t' | b'\r' | b'\n')) {
            self.at += 1;
        }
    }

    fn expect(&mut self, byte: u8) -> Result<(), SceneError> {
        self.blanks();
        if self.peek() == Some(byte) {
            self.at += 1;
            return Ok(());
        }
        let what = match self.peek() {
            Some(_) => format!("`{}` should stand here", char::from(byte)),
            None => format!("the JSON text ends where `{}` should be", char::from(byte)),
        };
        Err(self.error(what, "mend the JSON here, or write the file anew"))
    }

    fn value(&mut self, depth: usize) -> Result<Json, SceneError> {
        self.blanks();
        if depth > DEEPEST_NESTING {
            return Err(
                self.error(format!("nested deeper than {DEEPEST_NESTING} levels"), "flatten the file")
            );
        }
        let start = self.at;
        let value = match self.peek() {
            Some(b'{') => Value::Table(self.table(depth)?),
            Some(b'[') => Value::List(self.list(depth)?),
            Some(b'"') => Value::Text(self.string()?),
            _ => self.plain()?,
        };
        Ok(Json { value, span: self.base + start..self.base + self.at })
    }

    fn table(&mut self, depth: usize) -> Result<Vec<(String, Json)>, SceneError> {
        let mut entries = vec![];
        self.expect(b'{')?;
        self.blanks();
        if self.peek() == Some(b'}') {
            self.at += 1;
            return Ok(entries);
        }
        loop {
            self.blanks();
            let key = self.string()?;
            self.expect(b':')?;
            entries.push((key, self.value(depth + 1)?));
            self.blanks();
            if self.peek() != Some(b',') {
                break;
            }
            self.at += 1;
        }
        self.expect(b'}')?;
        Ok(entries)
    }

    fn list(&mut self, depth: usize) -> Result<Vec<Json>, SceneError> {
        let mut values = vec![];
        self.expect(b'[')?;
        self.blanks();
        if self.peek() == Some(b']') {
            self.at += 1;
            return Ok(values);
        }
        loop {
            values.push(self.value(depth + 1)?);
            self.blanks();
            if self.peek() != Some(b',') {
                break;
            }
            self.at += 1;
        }
        self.expect(b']')?;
        Ok(values)
    }

    fn string(&mut self) -> Result<String, SceneError> {
        self.expect(b'"')?;
        let start = self.at;
        let bytes = self.text.as_bytes();
        let end = (start..bytes.len()).find(|&i| bytes[i] == b'"' && !is_escaped(&bytes[start..i]));
        let end = end.ok_or_else(|| self.error("a text without an end", "close it with a quotation mark"))?;
        self.at = end + 1;
        let quoted = self.text.get(start - 1..=end).unwrap_or_default();
        serde_json::from_str(quoted).map_err(|error| {
            let span = self.base + start..self.base + end;
            let what = format!("this is no JSON text: {error}");
            self.source.error(ErrorKind::Syntax, span, what, "mend the text, or write the file anew")
        })
    }

    fn plain(&mut self) -> Result<Value, SceneError> {
        let rest = &self.text[self.at..];
        let ends = |c: char| matches!(c, ',' | ']' | '}' | ':') || c.is_whitespace();
        let word = &rest[..rest.find(ends).unwrap_or(rest.len())];
        let value = match word {
            "null" => Value::Null,
            "true" => Value::Bool(true),
            "false" => Value::Bool(false),
            _ => match word.parse::<f64>().ok().filter(|x| x.is_finite()) {
                Some(number) => Value::Number(number),
                None if word.is_empty() => {
                    return Err(
                        self.error("a value should stand here", "mend the JSON here, or write the file anew")
                    );
                }
                None => {
                    let what = format!("`{word}` is no JSON value");
                    return Err(self
                        .error(what, "write a finite number, a text, true, false, null, a list or a table"));
                }
            },
        };
        self.at += word.len();
        Ok(value)
    }
}

/// Whether an odd number of backslashes stands at the end.
fn is_escaped(before: &[u8]) -> bool {
    before.iter().rev().take_while(|&&byte| byte == b'\\').count() % 2 == 1
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Json, SceneError> {
        parse(&Source::of("a.gltf".as_ref(), text.to_owned()), text, 0)
    }

    #[test]
    fn values_know_where_they_stand() {
        let text = r#" {"a" : [1, -2.5e1, "q\"\\", true, null], "b": {}} "#;
        let json = read(text).unwrap();
        let list = json.get("a").and_then(Json::list).unwrap();
        assert_eq!(&text[list[1].span.clone()], "-2.5e1");
        assert_eq!(list[1].number(), Some(-25.0));
        assert_eq!(list[2].text(), Some("q\"\\"));
        assert_eq!((list[3].bool(), &list[4].value), (Some(true), &Value::Null));
        assert_eq!(json.get("b").unwrap().value, Value::Table(vec![]));
    }

    #[test]
    fn what_is_no_json_is_refused_at_its_place() {
        for text in ["", "{", "[1,", "{\"a\" 1}", "[1] 2", "\"a", "nan", "[1e999]", "\"\\x\"", "{,}"] {
            let error = read(text).unwrap_err();
            assert!(error.place().is_some() && !error.help().is_empty(), "{text}: {error}");
        }
        assert!(read(&"[".repeat(100_000)).unwrap_err().to_string().contains("nested deeper"));
    }
}
