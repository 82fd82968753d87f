//! Every file of every result, with its columns or arrays and their units: the source of
//! `docs/results.md`.
//!
//! A name that ends in `_BAND` stands for one column or array a band, `SURFACE_BAND` for one a
//! surface and band. The keys of records come from their types and the comments there.

use std::fmt::Write;

use schemars::{JsonSchema, schema_for};
use serde_json::Value;

use crate::outputs::{OutputFile, output_files};
use crate::{
    ComparisonRecord, CrosscheckRecord, JudgeRecord, MethodsRecord, ReferenceRecord, RefinementRecord,
    RunRecord, ShootingRecord, SpectrumRecord, ViewFactorsRecord, WaveComparison,
};

/// A file of results.
#[derive(Clone, Copy, Debug)]
pub struct CataloguedFile {
    /// Its name; `*` stands for a name that the scene or the caller gives.
    pub name: &'static str,
    /// The commands that write it.
    pub by: &'static str,
    /// What it holds.
    pub about: &'static str,
    /// Names of columns, arrays or keys, their units, and what they are.
    pub values: &'static [(&'static str, &'static str, &'static str)],
}

type Values = &'static [(&'static str, &'static str, &'static str)];

pub(crate) const fn file(
    name: &'static str,
    by: &'static str,
    about: &'static str,
    values: Values,
) -> CataloguedFile {
    CataloguedFile { name, by, about, values }
}

const SOLVERS: Values = &[
    ("reflectance", "1", "the largest of any material, in the case"),
    ("solver", "", "with its options"),
    ("outcome", "", "converged, not converged, diverged or refused"),
    ("iterations", "1", "done"),
    ("applications", "1", "of the matrix"),
    ("rows, columns", "1", "of the matrix that were visited"),
    ("entries", "1", "of the matrix that were read"),
    ("seconds", "s", "by the clock"),
    ("residual", "1", "‖b − A x‖₂/‖b‖₂, worst band"),
    ("error", "1", "‖x − x*‖₂/‖x*‖₂ against the reference, worst band"),
    ("reason", "", "why it was refused"),
];
const PHASOR_UNITS: &str = "E in V/m, H in A/m";

/// All files but records, by command.
const FILES: &[CataloguedFile] = &[
    file(
        "faces.csv",
        "trace",
        "a row an input face: estimates",
        &[
            ("face", "", "number, from 0"),
            ("surface", "", "name"),
            ("cx, cy, cz", "m", "centroid"),
            ("area", "m²", ""),
            ("irradiance_BAND", "W/m²", "mean"),
            ("standard_error_BAND", "W/m²", "one standard deviation of it"),
        ],
    ),
    file(
        "checkpoint.bin",
        "solve --accuracy",
        "the state between rounds, with a checksum, until the run is complete",
        &[],
    ),
    file("trace.json", "trace", "the state from which `trace --continue` goes on", &[]),
    file(
        "pixels.npz",
        "trace --spp, reference",
        "the pixels of a traced picture, rows from the top",
        &[
            ("radiosity", "W/m²", "f64, height × width × bands: mean over the pixel"),
            ("standard_error", "W/m²", "f64, the same shape"),
            ("covered", "1", "f64, height × width: share in which something is seen"),
        ],
    ),
    file(
        "shots.csv",
        "shoot",
        "a row a shot",
        &[
            ("shot", "", "number, from 1"),
            ("elements", "1", "that shot as one"),
            ("columns", "1", "computed by then"),
            ("seconds", "s", "since the first shot"),
            ("distributed", "1", "share of the power, slowest band"),
        ],
    ),
    file("shots.svg, shot_*.png", "shoot", "the share over the shots; pictures on the way", &[]),
    file("compare.csv", "compare", "a row a solver and case", SOLVERS),
    file(
        "compare_history.csv",
        "compare",
        "a row an iteration",
        &[
            ("reflectance, solver", "", "as in compare.csv"),
            ("iteration", "1", "from 0"),
            ("entries", "1", "read by then"),
            ("seconds", "s", "by then"),
            ("residual", "1", "worst band"),
        ],
    ),
    file("compare.svg, compare_sweep.svg", "compare", "residuals; iterations over the reflectance", &[]),
    file(
        "compare.csv",
        "waves --compare",
        "a row a solver and frequency",
        &[
            ("frequency", "Hz", ""),
            ("spectral_radius", "1", "estimate of ϱ(K)"),
            ("solver, outcome", "", "as of `compare`"),
            ("iterations, entries", "1", "done; of the matrix, read"),
            ("seconds", "s", "by the clock"),
            ("residual, error", "1", "as of `compare`"),
            ("reason", "", "why it was refused"),
        ],
    ),
    file(
        "compare_history.csv",
        "waves --compare",
        "a row an iteration",
        &[
            ("frequency", "Hz", ""),
            ("solver", "", ""),
            ("iteration", "1", "from 0"),
            ("entries", "1", "read by then"),
            ("seconds", "s", "by then"),
            ("residual", "1", ""),
        ],
    ),
    file(
        "methods.csv",
        "waves --methods",
        "a row a method, receiver and frequency; one a method that was refused",
        &[
            ("method, outcome", "", "as asked for; `done`, `not converged` or `refused`"),
            ("receiver", "", ""),
            ("frequency", "Hz", ""),
            ("stated_error", "1", "of the scattered field, L², as the method states it"),
            ("difference", "1", "of the scattered field from that of the reference, L²"),
            ("level_difference", "dB", "largest where the reference is within 20 dB of its largest"),
            ("facets", "1", ""),
            ("seconds", "s", "by the clock"),
            ("reason", "", "why it was refused"),
        ],
    ),
    file(
        "methods_over_angle.csv",
        "waves --methods",
        "the curves of all methods, a row an angle",
        &[
            ("receiver, method", "", ""),
            ("frequency", "Hz", ""),
            ("quantity, unit", "", "of the values"),
            ("angle_degrees", "°", ""),
            ("value", "", "in its unit"),
        ],
    ),
    file(
        "*.svg, *.png",
        "waves --methods",
        "curves of all methods over each other; maps of each and of its difference from the reference",
        &[],
    ),
    file(
        "spectrum.csv",
        "spectrum",
        "a row an eigenvalue",
        &[
            ("band, matrix", "", "of which it is one: reflection (R F), jacobi, gauss_seidel, psi, theta"),
            ("index", "", "from 0"),
            ("re, im", "1", "real and imaginary part"),
        ],
    ),
    file("spectrum.svg", "spectrum", "the eigenvalues of the worst band", &[]),
    file(
        "converge.csv",
        "converge",
        "a row a level",
        &[
            ("level", "", "number of refinements"),
            ("elements, unknowns", "1", ""),
            ("h", "m", "largest diameter of an element"),
            ("seconds", "s", "by the clock"),
            ("difference_BAND", "1", "to the finest level, relative L2 over the faces"),
            ("error_BAND", "1", "against the limit by Richardson"),
            ("order_BAND", "1", "from this level and the two before"),
            ("remaining_BAND", "1", "estimated error by that order"),
            ("irradiance_SURFACE_BAND", "W/m²", "mean"),
        ],
    ),
    file("converge.svg", "converge", "errors over the size of the elements", &[]),
    file(
        "crosscheck.csv",
        "crosscheck",
        "a row a face and band",
        &[
            ("face", "", "number, from 0"),
            ("surface", "", "name"),
            ("cx, cy, cz", "m", "centroid"),
            ("area", "m²", ""),
            ("band", "", ""),
            ("deterministic, deterministic_error", "W/m²", "irradiance, and its stated error"),
            ("stochastic, standard_error", "W/m²", "irradiance by paths, and its standard error"),
            ("z", "1", "normal score of the difference"),
            ("p", "1", "two-sided probability of it"),
            ("significant", "", "1 or 0"),
        ],
    ),
    file(
        "crosscheck.svg, crosscheck.png",
        "crosscheck",
        "histogram of z; the scene in the colours of z",
        &[],
    ),
    file(
        "reference.csv",
        "reference",
        "a row a face",
        &[
            ("face", "", "number, from 0"),
            ("surface", "", "name"),
            ("cx, cy, cz", "m", "centroid"),
            ("area", "m²", ""),
            ("E_BAND", "W/m²", "mean irradiance over the whole face"),
            ("E_error_BAND", "W/m²", "one standard deviation, all known errors together"),
            ("E_deterministic_BAND", "W/m²", "by the deterministic solution"),
            ("B_BAND", "W/m²", "radiosity, M + ρ E"),
            ("rho_BAND", "1", "reflectance"),
            ("M_BAND", "W/m²", "exitance"),
        ],
    ),
    file("patches.obj", "reference", "outlines of the faces, an object a surface, m", &[]),
    file(
        "judge.csv",
        "judge",
        "a row a place and band",
        &[
            ("kind", "", "pixel, tile, picture, or face, surface, whole"),
            ("place", "", "number, from 0; pixels and tiles row by row from the top"),
            ("band", "", ""),
            ("reference, reference_error", "W/(m² sr) or W/m²", "radiance of pixels, irradiance of faces"),
            ("found, standard_error", "the same", "of the tracer that is judged"),
            ("z, p", "1", "normal score, and its probability"),
            ("significant", "", "1 or 0"),
        ],
    ),
    file("judge.svg, judge.png", "judge", "histogram of z; the pixels in the colours of z", &[]),
    file(
        "*.csv",
        "viewfactors",
        "a row a surface, then a row a point",
        &[
            ("name", "", ""),
            ("area", "m²", "empty for a point"),
            ("emissivity", "1", "empty where it is not known"),
            ("row_sum, row_error, row_dropped", "1", "Σ F, its stated error, what was dropped"),
            ("SURFACE", "1", "the factor to it, in a column of its name"),
        ],
    ),
    file(
        "*.npz",
        "viewfactors",
        "the matrix as NumPy arrays",
        &[
            ("F", "1", "f64, n × n, where it is dense"),
            ("data, indices, indptr, shape, format", "1", "CSR in place of F, as SciPy has it"),
            ("threshold", "1", "f64: least factor kept of a sparse matrix"),
            ("F_error", "1", "f32, as F or data: stated error, rounded up"),
            ("names", "", "text, n"),
            ("areas", "m²", "f64, n"),
            ("emissivity", "1", "f64, n, where it is known"),
            ("row_sums, row_error, row_dropped", "1", "f64, n"),
            ("points, normals", "m, 1", "f64, m × 3, where there are points"),
            ("point_factors", "1", "f64, m × n"),
        ],
    ),
    file(
        "receivers.csv",
        "waves",
        "a row a point and frequency: incident (inc_), scattered (sca_) and total (tot_) peak phasors, e^{+jωt}",
        &[
            ("receiver", "", "name"),
            ("index", "", "of the point, from 0"),
            ("x, y, z", "m", ""),
            ("frequency", "Hz", ""),
            (
                "inc_ex_re, inc_ex_im, inc_ey_re, inc_ey_im, inc_ez_re, inc_ez_im, inc_hx_re, inc_hx_im, inc_hy_re, inc_hy_im, inc_hz_re, inc_hz_im",
                PHASOR_UNITS,
                "incident",
            ),
            (
                "sca_ex_re, sca_ex_im, sca_ey_re, sca_ey_im, sca_ez_re, sca_ez_im, sca_hx_re, sca_hx_im, sca_hy_re, sca_hy_im, sca_hz_re, sca_hz_im",
                PHASOR_UNITS,
                "scattered",
            ),
            (
                "tot_ex_re, tot_ex_im, tot_ey_re, tot_ey_im, tot_ez_re, tot_ez_im, tot_hx_re, tot_hx_im, tot_hy_re, tot_hy_im, tot_hz_re, tot_hz_im",
                PHASOR_UNITS,
                "both",
            ),
        ],
    ),
    file(
        "receivers.npz",
        "waves",
        "the same as arrays",
        &[
            ("receiver, index", "", "i64, n: numbers, from 0"),
            ("position", "m", "f64, n × 3"),
            ("frequency", "Hz", "f64, n"),
            (
                "incident, scattered, total",
                PHASOR_UNITS,
                "f64, n × 6 × 2: ex, ey, ez, hx, hy, hz; real, imaginary part",
            ),
        ],
    ),
    file(
        "receivers.csv",
        "trace of waves",
        "a row a point and frequency: the sampled scattered field",
        &[
            ("receiver", "", "name"),
            ("index", "", "of the point, from 0"),
            ("x, y, z", "m", ""),
            ("frequency", "Hz", ""),
            ("sca_ex_re, sca_ex_im, sca_ey_re, sca_ey_im, sca_ez_re, sca_ez_im", "V/m", "scattered E"),
            ("standard_error", "V/m", "root of the sum of squares over the components"),
        ],
    ),
    file(
        "far.csv",
        "waves",
        "a row a direction and frequency",
        &[
            ("receiver", "", "name"),
            ("index", "", "of the direction, from 0"),
            ("theta_degrees, phi_degrees", "°", ""),
            ("frequency", "Hz", ""),
            ("f_theta_re, f_theta_im, f_phi_re, f_phi_im", "V", "amplitude: E = f e^{−jkr}/r"),
            ("rcs_theta, rcs_phi", "m²", "cross-sections; empty without an incident plane wave"),
            (
                "t_theta_re, t_theta_im, t_phi_re, t_phi_im",
                "V",
                "amplitude with the sources in, where all are at places",
            ),
            ("gain", "1", "over the power that the sources supply"),
        ],
    ),
    file(
        "far.npz",
        "waves",
        "the same as arrays, in place of a table of more than 50,000 rows",
        &[
            ("receiver, index", "", "i64, n: numbers, from 0"),
            ("angles", "°", "f64, n × 2: θ and φ"),
            ("frequency", "Hz", "f64, n"),
            ("amplitude, total", "V", "f64, n × 2 × 2: along θ̂ and φ̂; real, imaginary part"),
            ("cross_section", "m²", "f64, n × 2"),
            ("gain", "1", "f64, n"),
        ],
    ),
    file(
        "monostatic.csv",
        "waves",
        "a row a direction and frequency: S with E → S E₀ e^{−jkr}/r, first received, then incident, t along θ̂, p along φ̂",
        &[
            ("receiver", "", "name"),
            ("index", "", "of the direction, from 0"),
            ("theta_degrees, phi_degrees", "°", ""),
            ("frequency", "Hz", ""),
            ("s_tt_re, s_tt_im, s_pt_re, s_pt_im, s_tp_re, s_tp_im, s_pp_re, s_pp_im", "m", "S"),
            ("rcs_tt, rcs_pt, rcs_tp, rcs_pp", "m²", "4π|S|²"),
        ],
    ),
    file(
        "monostatic.npz",
        "waves",
        "the same as arrays, in place of a table of more than 50,000 rows",
        &[
            ("receiver, index", "", "i64, n: numbers, from 0"),
            ("angles", "°", "f64, n × 2: θ and φ"),
            ("frequency", "Hz", "f64, n"),
            ("scattering", "m", "f64, n × 4 × 2: S_θθ, S_φθ, S_θφ, S_φφ; real, imaginary part"),
        ],
    ),
    file(
        "currents.vtu",
        "waves",
        "the surface currents for ParaView, a cell a facet: for each frequency magnitudes, real and imaginary vectors of J (A/m) and M (V/m), and the phase (degrees) of the largest component of J",
        &[],
    ),
    file(
        "residuals.csv",
        "waves with a solver",
        "a row an iteration",
        &[("frequency", "Hz", ""), ("iteration", "1", "from 0"), ("residual", "1", "‖b − A x‖₂/‖b‖₂")],
    ),
    file(
        "residuals.svg, *.svg, *.png",
        "waves",
        "residuals; cross-sections and fields of each receiver",
        &[],
    ),
    file("check.png", "check -o", "the mesh by its sides, with what is marked", &[]),
];

/// All files but records.
pub fn catalogue() -> impl Iterator<Item = CataloguedFile> {
    output_files().filter_map(OutputFile::about).chain(FILES.iter().copied())
}

/// The page `docs/results.md`.
#[must_use]
pub fn results_page() -> String {
    let mut page = PAGE_HEAD.to_owned();
    for CataloguedFile { name, by, about, values } in catalogue() {
        // Writing to a string cannot fail.
        let _ = writeln!(page, "\n### {name} ({by})\n\n{}.", wrapped(&capital(about)));
        if !values.is_empty() {
            page.push_str("\n| name | unit | |\n|---|---|---|\n");
        }
        for (names, unit, text) in values {
            let names: Vec<String> = names.split(", ").map(|name| format!("`{name}`")).collect();
            let _ = writeln!(page, "| {} | {unit} | {text} |", names.join(", "));
        }
    }
    page.push_str(RECORDS_TEXT);
    record::<RunRecord>("run.json (solve, resume, trace)", &mut page);
    page.push_str(WAVES_TEXT);
    record::<ViewFactorsRecord>("*.json (viewfactors)", &mut page);
    record::<ShootingRecord>("shots.json (shoot)", &mut page);
    record::<ComparisonRecord>("compare.json (compare)", &mut page);
    record::<WaveComparison>("compare.json (waves --compare)", &mut page);
    record::<MethodsRecord>("methods.json (waves --methods)", &mut page);
    record::<SpectrumRecord>("spectrum.json (spectrum)", &mut page);
    record::<RefinementRecord>("converge.json (converge)", &mut page);
    record::<CrosscheckRecord>("crosscheck.json (crosscheck)", &mut page);
    record::<ReferenceRecord>("reference.json (reference)", &mut page);
    record::<JudgeRecord>("judge.json (judge)", &mut page);
    page
}

const PAGE_HEAD: &str = "# Files of results

What every command writes, and what the columns, arrays and keys mean. This page is written by
`FREDHOLM_WRITE=1 cargo test --test command_line results_page` from the tables and types of
`crates/report`; a test compares it with them, and them with what the commands write.

- `_BAND` at the end of a name stands for one column or array a band, under the name of the band.
- A unit of 1 is a number without dimension; no unit is a name or a number of a thing.
- A result folder is complete where its record stands, which is written last; `fredholm info DIR`
  tells what it says. The hidden file `.fredholm` lists the files, so that the next run into the
  folder can remove them.

## Tables, arrays and pictures
";

const RECORDS_TEXT: &str = "
## Records

JSON. Numbers that are not finite are `null`. Times are by the clock.
";

const WAVES_TEXT: &str = "
### run.json (waves)

| key | type | |
|---|---|---|
| `format`, `program`, `scene`, `scene_sha256`, `title` | text | what made it |
| `method`, `order`, `shadows`, `solution`, `edge_currents`, `chosen_because` | text, number, yes or no | what was computed, and why |
| `receivers` | list of text | their names, in the order of the numbers in arrays |
| `frequencies` | list | of each `frequency_hz`, `wavelength_m`, `facets`, `solution`, `converged`, `residuals` |
| `stated_errors`, `estimated_mesh_errors`, `estimated_form_errors` | list | `receiver`, `frequency_hz`, and the error `relative` to the scattered field |
| `power` | list | `frequency_hz`, `supplied_w`, `radiated_w`, `absorbed_w`, and the `ratio` of the last two together to the first |
| `reciprocity` | list | `receiver`, `frequency_hz`, and the relative `defect` of a sweep |
| `left_out_as_text` | list of text | tables that are arrays only |
| `warnings`, `timings` | list | as of `solve` |
";

/// A record, with a table for every type in it.
fn record<R: JsonSchema>(title: &str, page: &mut String) {
    let schema = schema_for!(R).to_value();
    let _ = writeln!(page, "\n### {title}\n");
    table(&schema, page);
    for (name, part) in schema["$defs"].as_object().into_iter().flatten() {
        let _ = writeln!(page, "\n`{name}`: {}\n", wrapped(&described(part)));
        table(part, page);
    }
}

fn table(schema: &Value, page: &mut String) {
    page.push_str("| key | type | |\n|---|---|---|\n");
    for (key, value) in schema["properties"].as_object().into_iter().flatten() {
        let _ = writeln!(page, "| `{key}` | {} | {} |", kind(value), described(value));
    }
}

/// The comment on a type or a field, without the brackets of links and with what would end a cell
/// told apart.
fn described(value: &Value) -> String {
    let text = value["description"].as_str().unwrap_or_default();
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    text.replace("[`", "`").replace("`]", "`").replace('|', "\\|")
}

/// The type of a value in words.
fn kind(value: &Value) -> String {
    if let Some(name) = value["$ref"].as_str().and_then(|path| path.rsplit('/').next()) {
        return format!("`{name}`");
    }
    let of = |name: &str| match name {
        "string" => "text",
        "integer" | "number" => "number",
        "boolean" => "yes or no",
        "object" => "table",
        _ => "",
    };
    match &value["type"] {
        Value::String(name) if name == "array" => format!("list of {}", kind(&value["items"])),
        Value::String(name) => of(name).to_owned(),
        Value::Array(names) if names.iter().any(|name| name == "array") => {
            format!("list of {}, or null", kind(&value["items"]))
        }
        Value::Array(names) => {
            let known = names.iter().filter_map(Value::as_str).map(of).find(|name| !name.is_empty());
            format!("{} or null", known.unwrap_or_default())
        }
        _ => match value["anyOf"].as_array() {
            Some(options) => format!("{} or null", options.first().map(kind).unwrap_or_default()),
            None => "any".to_owned(),
        },
    }
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// Text in lines of at most 100 columns.
fn wrapped(text: &str) -> String {
    let mut lines: Vec<String> = vec![String::new()];
    for word in text.split(' ') {
        let line = lines.last_mut().filter(|line| line.chars().count() + word.chars().count() < 80);
        match line {
            Some(line) if line.is_empty() => line.push_str(word),
            Some(line) => {
                line.push(' ');
                line.push_str(word);
            }
            None => lines.push(word.to_owned()),
        }
    }
    lines.join("\n")
}
