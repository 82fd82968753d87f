//! The known name that was probably meant.
//!
//! Distance of two words: the fewest insertions, deletions and replacements of a character that
//! turn one into the other (V. I. Levenshtein, Soviet Physics Doklady 10, 707, 1966).

/// Help for an unknown name: the nearest known one, then all of them. `plural` names what they are.
pub(crate) fn among<'a>(name: &str, known: impl IntoIterator<Item = &'a str>, plural: &str) -> String {
    let known: Vec<&str> = known.into_iter().collect();
    if known.is_empty() {
        return format!("there are no {plural}");
    }
    let list: Vec<String> = known.iter().map(|k| format!("`{k}`")).collect();
    let list = format!("known {plural}: {}", list.join(", "));
    match nearest(name, &known).or_else(|| foreign(name, &known)) {
        Some(near) => format!("did you mean `{near}`? {list}"),
        None => list,
    }
}

/// Names by which scene files of other programs, and the literature, know some keys.
const FOREIGN_KEYS: [(&str, &[&str]); 14] = [
    (
        "reflectance",
        &["albedo", "diffuse", "rho", "kd", "color", "colour", "base_color", "diffuse_reflectance"],
    ),
    (
        "exitance",
        &["emission", "emissive", "emittance", "emit", "ke", "radiosity", "light", "power", "intensity"],
    ),
    ("eye", &["position", "origin", "from", "location", "camera_position"]),
    ("target", &["look_at", "lookat", "at", "to", "center", "centre", "aim"]),
    ("up", &["up_vector", "world_up"]),
    ("vertical_fov_degrees", &["fov", "vfov", "yfov", "fov_degrees", "field_of_view", "angle"]),
    ("width", &["resolution", "image_width", "xres"]),
    ("height", &["image_height", "yres"]),
    ("surface", &["shape", "shapes", "object", "objects", "geometry", "mesh"]),
    ("materials", &["bsdf", "brdf"]),
    ("polygon", &["outline", "vertices", "points", "corners", "face"]),
    ("mesh", &["file", "filename", "path"]),
    ("box", &["cube", "cuboid"]),
    ("outline", &["vertices", "points", "corners"]),
];

/// The known name that has the meaning of one of [`FOREIGN_KEYS`].
fn foreign<'a>(name: &str, known: &[&'a str]) -> Option<&'a str> {
    let name = name.to_lowercase().replace('-', "_");
    let mut meant = FOREIGN_KEYS.iter().filter(|(_, others)| others.contains(&name.as_str()));
    meant.find_map(|(ours, _)| known.iter().copied().find(|known| known == ours))
}

fn nearest<'a>(name: &str, known: &[&'a str]) -> Option<&'a str> {
    let close = known.iter().map(|k| (distance(name, k), *k)).min_by_key(|(d, _)| *d);
    close.filter(|(d, k)| 3 * d <= k.chars().count().max(3)).map(|(_, k)| k)
}

fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(x != *y);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_of_known_pairs() {
        for (a, b, expected) in
            [("", "", 0), ("kitten", "sitting", 3), ("abc", "", 3), ("", "ab", 2), ("flaw", "lawn", 2)]
        {
            assert_eq!(distance(a, b), expected, "{a} {b}");
            assert_eq!(distance(b, a), expected, "{b} {a}");
        }
    }

    #[test]
    fn words_of_other_programs_are_known() {
        let camera = ["eye", "target", "up", "vertical_fov_degrees", "width", "height", "exposure"];
        for (word, meant) in [("position", "eye"), ("look_at", "target"), ("fov", "vertical_fov_degrees")] {
            assert!(among(word, camera, "keys").starts_with(&format!("did you mean `{meant}`?")), "{word}");
        }
        let material = ["reflectance", "exitance"];
        for (word, meant) in [("emission", "exitance"), ("Kd", "reflectance"), ("albedo", "reflectance")] {
            assert!(among(word, material, "keys").starts_with(&format!("did you mean `{meant}`?")), "{word}");
        }
        // What is no key here is not offered.
        assert_eq!(foreign("albedo", &camera), None);
    }

    #[test]
    fn far_names_are_not_suggested() {
        assert_eq!(nearest("reflectence", &["exitance", "reflectance"]), Some("reflectance"));
        assert_eq!(nearest("zebra", &["exitance", "reflectance"]), None);
        assert_eq!(among("x", [], "materials"), "there are no materials");
    }
}
