//! The JSON Schema of scene files, generated from the types that read them.

use schemars::generate::SchemaSettings;
use schemars::transform::RecursiveTransform;
use schemars::{JsonSchema, Schema};
use serde_json::{Value, json};

use crate::{format, waves};

/// The JSON Schema (draft 2020-12) of a scene file, for editors and validators.
///
/// ```
/// let schema = fredholm_scene::schema();
/// assert_eq!(schema["title"], "Fredholm scene");
/// assert_eq!(schema["additionalProperties"], false);
/// ```
#[must_use]
pub fn schema() -> Value {
    of::<format::SceneEntry>()
}

/// The JSON Schema (draft 2020-12) of a scene of waves.
///
/// ```
/// let schema = fredholm_scene::wave_schema();
/// assert_eq!(schema["title"], "Fredholm scene of waves");
/// assert_eq!(schema["additionalProperties"], false);
/// ```
#[must_use]
pub fn wave_schema() -> Value {
    of::<waves::SceneEntry>()
}

fn of<T: JsonSchema>() -> Value {
    let settings = SchemaSettings::draft2020_12().with_transform(RecursiveTransform(without_null));
    settings.into_generator().into_root_schema_for::<T>().to_value()
}

/// A key that may be left out is not one that may be null: TOML has no null.
fn without_null(schema: &mut Schema) {
    if let Some(Value::Array(types)) = schema.get_mut("type") {
        types.retain(|name| name != "null");
        if let [name] = &types[..] {
            let name = name.clone();
            schema.insert("type".to_owned(), name);
        }
    }
    if let Some(Value::Array(choices)) = schema.get_mut("anyOf") {
        choices.retain(|choice| *choice != json!({ "type": "null" }));
    }
}
