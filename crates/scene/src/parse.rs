//! From the text of a scene file to its entries; what the TOML reader says becomes a
//! [`SceneError`].
//!
//! TOML 1.1: <https://toml.io/en/v1.1.0>.

use std::ops::Range;

use serde::de::DeserializeOwned;
use toml::de::{DeTable, Deserializer, Error};

use crate::error::{ErrorKind, SceneError};
use crate::source::Source;
use crate::suggest::among;

/// Types as the reader calls them, and in plain words.
const PLAIN_TYPE_NAMES: [(&str, &str); 10] = [
    ("expected f64", "expected a number"),
    ("expected u64", "expected a whole number, 0 or more"),
    ("expected u32", "expected a whole number from 0 to 4294967295"),
    ("expected usize", "expected a whole number, 0 or more"),
    ("expected a sequence", "expected a list"),
    ("expected a map", "expected a table"),
    ("expected an array of length", "expected a list of"),
    ("invalid type: map", "invalid type: table"),
    ("invalid type: sequence", "invalid type: list"),
    ("expected a boolean", "expected true or false"),
];

/// Keys that belong elsewhere, or that scene files had once, and what to do about them.
const MISPLACED_KEYS: [(&str, &str); 2] = [
    ("wave", "this is a scene of waves: `fredholm waves` computes its fields, `fredholm check` tells of it"),
    (
        "shadow",
        "write method = \"physical-optics\", \"mfie\" (was shadow = \"exact\"), \"dual-surface-mfie\" (was \
         \"exact-dual\") or \"thesis\", and for physical optics shadows = \"geometric\" or \"radiated\"",
    ),
];

/// The entries of a scene file of light or of waves.
pub(crate) fn parse<T: DeserializeOwned>(source: &Source) -> Result<T, SceneError> {
    let table = DeTable::parse(&source.text).map_err(|e| syntax(source, &e))?;
    T::deserialize(Deserializer::from(table)).map_err(|e| meaning(source, &e))
}

fn syntax(source: &Source, error: &Error) -> SceneError {
    let help = "correct the TOML here; brackets and quotes must be closed, and no key may be given twice";
    source.error(ErrorKind::Syntax, span(source, error), error.message(), help)
}

fn meaning(source: &Source, error: &Error) -> SceneError {
    let (span, message) = (span(source, error), error.message());
    if let Some(rest) = message.strip_prefix("unknown field ") {
        return unknown_key(source, span, rest);
    }
    if let Some(key) = message.strip_prefix("missing field ") {
        let what = format!("the key {key} is missing here");
        return source.error(
            ErrorKind::MissingKey,
            span,
            what,
            format!("add a line {} = …", key.trim_matches('`')),
        );
    }
    if let Some(rest) = message.strip_prefix("unknown variant ") {
        let what = format!("unknown value {}", rest.split(", expected").next().unwrap_or(rest));
        let (name, known) = names(rest);
        return source.error(ErrorKind::Value, span, what, among(name, known, "values"));
    }
    if message.ends_with("number overflowed") {
        let help = "write a number between -1.7e308 and 1.7e308";
        return source.error(ErrorKind::Value, span, "the number is too large", help);
    }
    if let Some(key) = table_as_list(source, &span) {
        let help = format!("write {key} = {{ {} }}", form(key));
        return source.error(ErrorKind::Type, span, format!("`{key}` is a table, not a list"), help);
    }
    let message = PLAIN_TYPE_NAMES.iter().fold(message.to_owned(), |m, (from, to)| m.replace(from, to));
    source.error(ErrorKind::Type, span, message, "write a value of the type that is expected here")
}

/// Shapes that are tables, and what is in them.
const SHAPE_FORMS: [(&str, &str); 5] = [
    ("polygon", "outline = [[x, y, z], …]"),
    ("box", "min = [x, y, z], max = [x, y, z]"),
    ("sphere", "centre = [x, y, z], radius = …"),
    ("disc", "centre = [x, y, z], normal = [x, y, z], radius = …"),
    ("cylinder", "base = [x, y, z], axis = [x, y, z], radius = …"),
];

fn form(shape: &str) -> &'static str {
    SHAPE_FORMS.iter().find(|(name, _)| *name == shape).map_or("", |(_, form)| form)
}

/// The shape that a line gives as a list, where the piece at `span` is in it: the reader takes a
/// list for the values of the table in their order, and complains of one of them.
fn table_as_list(source: &Source, span: &Range<usize>) -> Option<&'static str> {
    let before = source.text.get(..span.start)?;
    let line = &source.text[before.rfind('\n').map_or(0, |end| end + 1)..];
    let (key, value) = line.split_once('=')?;
    let (name, _) = SHAPE_FORMS.iter().find(|(name, _)| *name == key.trim())?;
    value.trim_start().starts_with('[').then_some(name)
}

fn unknown_key(source: &Source, span: Range<usize>, rest: &str) -> SceneError {
    let (key, known) = names(rest);
    if let Some((_, help)) = MISPLACED_KEYS.iter().find(|(old, _)| *old == key) {
        return source.error(ErrorKind::UnknownKey, span, format!("unknown key `{key}`"), help);
    }
    source.error(ErrorKind::UnknownKey, span, format!("unknown key `{key}`"), among(key, known, "keys"))
}

/// The names in backquotes: the first, and the others.
fn names(message: &str) -> (&str, Vec<&str>) {
    let (unknown, known) = message.split_once(", expected ").unwrap_or((message, ""));
    let known = known.split('`').skip(1).step_by(2).collect();
    (unknown.trim_matches('`'), known)
}

fn span(source: &Source, error: &Error) -> Range<usize> {
    error.span().unwrap_or(source.text.len()..source.text.len())
}
