//! A colour for the line of each band.
//!
//! Up to eight bands take colours that most colour-blind readers can tell apart (M. Okabe, K. Ito, "Color universal
//! design", 2008); more bands run from blue to red in their order.

/// Black, yellow and white aside, the set of Okabe and Ito, with a grey as the eighth.
const DISTINCT: [&str; 8] =
    ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7a5c3e", "#555555"];

/// The colour of band `index`, as a CSS colour.
pub(crate) fn line_colour(bands: &[String], index: usize) -> String {
    let name = bands.get(index).map_or("", String::as_str).to_ascii_lowercase();
    match name.as_str() {
        "r" | "red" => "#c8281e".to_owned(),
        "g" | "green" => "#22943a".to_owned(),
        "b" | "blue" => "#2456c4".to_owned(),
        _ if bands.len() <= DISTINCT.len() => DISTINCT[index % DISTINCT.len()].to_owned(),
        _ => rainbow(index as f64 / (bands.len() - 1) as f64),
    }
}

/// From blue at 0 through green to red at 1, of even darkness.
fn rainbow(t: f64) -> String {
    let hue = 240.0 * (1.0 - t);
    let channel = |offset: f64| {
        let distance = ((hue - offset + 540.0) % 360.0 - 180.0).abs();
        (40.0 + 170.0 * (2.0 - distance / 60.0).clamp(0.0, 1.0)) as u8
    };
    format!("#{:02x}{:02x}{:02x}", channel(0.0), channel(120.0), channel(240.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn bands_have_colours_of_their_own() {
        for count in [1, 3, 8, 9, 40] {
            let bands: Vec<String> = (0..count).map(|i| format!("{i}")).collect();
            let colours: BTreeSet<String> = (0..count).map(|i| line_colour(&bands, i)).collect();
            assert_eq!(colours.len(), count);
            assert!(colours.iter().all(|c| c.len() == 7 && c.starts_with('#')));
        }
        assert_eq!((rainbow(0.0), rainbow(1.0)), ("#2828d2".to_owned(), "#d22828".to_owned()));
    }
}
