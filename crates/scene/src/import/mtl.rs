//! Names in a Wavefront material library (.mtl). What the materials look like comes from the scene.
//!
//! Format: Wavefront Technologies, Advanced Visualizer Manual, appendix B2.

use crate::source::Source;

/// The names that `newmtl` defines.
pub(crate) fn material_names(source: &Source) -> Vec<String> {
    let names = source.text.lines().filter_map(|line| line.trim().strip_prefix("newmtl"));
    names.filter(|name| name.starts_with(char::is_whitespace)).map(|name| name.trim().to_owned()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_found_among_other_statements() {
        let text = "# newmtl no\r\nnewmtl  oak wood\r\nKd 1 1 1\n\tnewmtl\tb\nnewmtlx c\n".to_owned();
        let source = Source { path: "a.mtl".into(), text };
        assert_eq!(material_names(&source), ["oak wood", "b"]);
    }
}
