//! What a form-factor method cannot do.

use super::Setting;

/// Why a method gives no value.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MethodError {
    /// No method has this name.
    #[error("there is no form-factor method {name:?}; choose one of {known}")]
    Unknown {
        /// Name asked for.
        name: String,
        /// All names, separated by commas.
        known: String,
    },
    /// A setting of another kind, or out of range.
    #[error("the method {method} takes {wanted}, not {got}")]
    Setting {
        /// Name of the method.
        method: &'static str,
        /// What it takes.
        wanted: String,
        /// The setting given.
        got: Setting,
    },
    /// A closed form without visibility, and something between the patches.
    #[error(
        "the method {method} knows no visibility and something stands between the patches; use point-polygon or auto"
    )]
    Occluded {
        /// Name of the method.
        method: &'static str,
    },
}
