//! `report.html`: a result as one page that opens from disk and needs no network.
//!
//! The page is written whole by Rust: title, picture, warnings, stated errors, tables and
//! provenance are plain HTML, which is read and printed without scripts. A script that was bundled
//! beforehand (crates/report/viewer) turns the surfaces in three dimensions, draws curves and sorts
//! tables. Elements and values are packed with 16 bits ([`pack`]). A policy in the page forbids all
//! connections, and every script but this one by its SHA-256 (Content Security Policy, level 2), so
//! that a name in a scene can neither reach the network nor run.

mod escape;
mod model;
mod pack;
mod page;
mod plot;
mod records;
mod run;
mod studies;
mod table;
mod waves;

pub use model::{ElementLinks, ElementPhasors, ElementValues, FieldStep, ReportModel};
pub use page::{ReportBadge, ReportPage};
pub use plot::{ReportAxis, ReportPlot, ReportPolar, ReportSeries};
pub use records::face_quantities;
pub use studies::face_scores;
pub use table::{ReportCell, ReportColumn, ReportTable};
pub use waves::{WaveReport, current_phasors};

#[cfg(test)]
mod tests {
    use super::pack::tests::{read_varints, read_words, unpacked};
    use super::*;
    use crate::field::tests::{grid, names, sample};
    use crate::run::tests::record;
    use crate::{Field, Picture, RunRecord, View};
    use fredholm_mesh::{Mesh, MeshBuilder, Patch, Vec3};
    use serde_json::Value;

    const HOSTILE: &str = "</script><script>alert(\"&\")</script><img src=x onerror=alert(1)><!--";

    fn text(page: &ReportPage<'_>) -> String {
        let mut out = Vec::new();
        page.write(&mut out).unwrap();
        String::from_utf8(out).unwrap()
    }

    /// The text of the element of a name.
    fn element<'a>(html: &'a str, id: &str) -> &'a str {
        let start = html.find(&format!("id=\"{id}\">")).unwrap() + id.len() + 6;
        html[start..].split("</script>").next().unwrap()
    }

    fn described(html: &str) -> Value {
        serde_json::from_str(element(html, "page")).unwrap()
    }

    /// The page of a field with exitance, and its description.
    fn page(mesh: &Mesh, bands: &[&str], [e, b, m]: [&[f64]; 3]) -> (String, Value) {
        let bands = names(bands);
        let field = Field::new(mesh, &bands, e, b).unwrap().with_exitance(m).unwrap();
        let (view, run) = (View::framing(&field), record());
        let html = text(&ReportPage::of_run("t", &field, &run, ReportModel::lit(&field, &view), None));
        let described = described(&html);
        (html, described)
    }

    #[test]
    fn names_of_a_scene_are_nothing_but_text() {
        let mut builder = MeshBuilder::default();
        builder.surface(HOSTILE, 0);
        grid(&mut builder, &[0.0, 1.0, 2.0], &[0.0, 1.0]);
        let (mesh, bands) = (builder.build(), names(&[HOSTILE]));
        let field = Field::new(&mesh, &bands, &[1.0, 2.0], &[0.5, 1.0]).unwrap();
        let view = View::framing(&field);
        let run = RunRecord {
            bands: bands.clone(),
            scene: HOSTILE.to_owned(),
            solver: HOSTILE.to_owned(),
            stop_reason: HOSTILE.to_owned(),
            warnings: vec![HOSTILE.to_owned()],
            options: serde_json::json!({ HOSTILE: HOSTILE }),
            ..record()
        };
        let html = text(&ReportPage::of_run(HOSTILE, &field, &run, ReportModel::lit(&field, &view), None));
        assert!(!html.contains("<img src=x") && !html.contains("<script>alert"));
        let page = described(&html);
        assert_eq!(page["model"]["surfaces"][0]["name"], HOSTILE);
        // One script for each array, one with the description, and the bundle.
        let arrays = html.matches("type=\"application/octet-stream\"").count();
        let outside = html.rsplit_once("<script>").unwrap().0;
        assert_eq!(outside.matches("<script").count(), arrays + 1);
        assert_eq!(html.matches("</script").count(), arrays + 2);
    }

    #[test]
    fn the_bundle_cannot_end_its_element_and_has_the_hash_that_is_allowed() {
        use base64::Engine;
        use sha2::Digest;
        let (html, _) = page(&sample(), &["r"], [&[1.0; 3], &[1.0; 3], &[1.0; 3]]);
        let (_, rest) = html.rsplit_once("<script>").unwrap();
        let script = rest.split("</script>").next().unwrap();
        assert!(script.len() > 500_000 && !script.contains("<!--"));
        assert!(rest[script.len()..].trim_start_matches("</script>").trim_start().starts_with("</body>"));
        let hash = base64::engine::general_purpose::STANDARD.encode(sha2::Sha256::digest(script));
        assert!(html.contains(&format!("script-src 'sha256-{hash}'")));
        assert!(html.contains("default-src 'none'") && html.contains("The MIT License"));
        assert_eq!(html.matches("</style").count(), 1);
    }

    #[test]
    fn the_same_result_is_the_same_file() {
        let make = || page(&sample(), &["r", "g"], [&[0.1; 6], &[0.2; 6], &[0.0; 6]]).0;
        assert_eq!(make(), make());
    }

    #[test]
    fn elements_read_back() {
        let mut builder = MeshBuilder::default();
        builder.surface("wall", 0);
        let lines: Vec<f64> = (0..=20).map(|i| f64::from(i).powf(1.3)).collect();
        grid(&mut builder, &lines, &lines[..15]);
        builder.surface("roof", 0);
        let corners = [Vec3::new(0., 0., 3.), Vec3::new(0., 5., 4.), Vec3::new(5., 0., 3.5)];
        builder.face(&[Patch::triangle(corners).unwrap()]).unwrap();
        let mesh = builder.build();
        let ones = vec![1.0; mesh.len()];
        let (html, page) = page(&mesh, &["r"], [&ones, &ones, &ones]);
        let model = &page["model"];
        let array = |name: &str| element(&html, model[name].as_str().unwrap());
        let vertices = model["vertices"].as_u64().unwrap() as usize;
        let codes = read_words(array("positions"), vertices);
        let bound = |name: &str, axis: usize| model[name][axis].as_f64().unwrap();
        let place = |vertex: usize| {
            Vec3::from_array([0, 1, 2].map(|axis| {
                let (low, high) = (bound("low", axis), bound("high", axis));
                low + (high - low) * f64::from(codes[axis * vertices + vertex]) / 65_535.0
            }))
        };
        let mut fresh = 0_u32;
        let mut corner = read_varints(array("corners")).into_iter().map(|distance| {
            let vertex = fresh.wrapping_sub(distance);
            fresh += u32::from(distance == 0);
            vertex as usize
        });
        let grain = page["grain"].as_f64().unwrap();
        for (patch, sides) in mesh.patches().zip(unpacked(array("sides"))) {
            assert_eq!(patch.corners().len(), usize::from(sides));
            for expected in patch.corners() {
                let found = place(corner.next().unwrap());
                assert!((found - *expected).abs().max_element() <= 0.5 * grain * (1.0 + 1e-9));
            }
        }
        assert!(corner.next().is_none());
        assert_eq!(unpacked(array("surface_of_face")).len(), 4 * mesh.faces().len());
    }

    /// The codes of the values of an array.
    fn packed_words(html: &str, values: &Value) -> Vec<u16> {
        read_words(element(html, values["blob"].as_str().unwrap()), usize::MAX)
    }

    #[test]
    fn radiosity_is_stored_where_the_surface_does_not_tell_it() {
        let e = [2.0, 4.0, 6.0];
        // Reflectance 0.5 and 0.25; the second surface emits.
        let (html, lawful) = page(&sample(), &["r"], [&e, &[1.0, 2.0, 4.5], &[0.0, 0.0, 3.0]]);
        let model = &lawful["model"];
        assert!(model["radiosity"][0].is_null());
        assert_eq!(model["surfaces"][1]["exitance"][0], 3.0);
        assert!((model["surfaces"][1]["reflectance"][0].as_f64().unwrap() - 0.25).abs() < 1e-12);
        let codes = packed_words(&html, &model["irradiance"][0]);
        let scale = pack::Scale::new(e.into_iter());
        for (code, expected) in codes.into_iter().zip(e) {
            assert!((scale.number(code) / expected - 1.0).abs() <= scale.error());
        }
        let (html, lawless) = page(&sample(), &["r"], [&e, &[1.0, 2.1, 4.5], &[0.0, 0.0, 3.0]]);
        assert_eq!(packed_words(&html, &lawless["model"]["radiosity"][0]).len(), 3);
    }

    #[test]
    fn a_picture_stands_where_nothing_can_be_turned() {
        let (mesh, bands) = (sample(), names(&["r"]));
        let field = Field::new(&mesh, &bands, &[1.0; 3], &[1.0; 3]).unwrap();
        let (view, run) = (View::framing(&field), record());
        let picture = Picture { width: 1, height: 1, pixels: vec![1, 2, 3] };
        let model = ReportModel::lit(&field, &view);
        let html = text(&ReportPage::of_run("t", &field, &run, model, Some(&picture)));
        assert!(html.contains("<img class=\"picture\"") && html.contains("data:image/png;base64,iVBOR"));
        // Tables stand in the page without any script.
        assert!(html.contains("<td class=\"text\">wall, &quot;north&quot;</td>"));
        let places = html.split("<script").next().unwrap();
        assert!(!places.contains("{{") && !places.contains("}}}"), "a place of the template is left");
    }

    #[test]
    fn histories_with_gaps_become_curves() {
        let mut run = record();
        run.history.residual[1][2] = f64::NAN;
        let plot = run::convergence(&run);
        assert!(plot.is_worth_drawing() && plot.across.len() == 2);
        let page = ReportPage { plots: vec![plot], ..ReportPage::default() };
        let page = described(&text(&page));
        let series = &page["plots"][0]["series"][0];
        assert_eq!(series.as_array().unwrap().len(), 3);
        assert!(series[1]["y"][2].is_null() && series[0]["y"][2] == 7.1e-11);
        assert_eq!(series[2]["name"], "asked for");
    }
}
