//! The methods that form factors can be computed with. This is the one place that knows them.
//!
//! `row-budget` is the fast assembly to a tolerance of rows, and `auto` the same to one of pairs.
//! Every other method of [`fredholm_coupling::method`] computes A_i F_ij (m²) of one pair after the
//! other, for study. Each pair is computed once, from the smaller patch (of equal ones the first),
//! so that the matrix is symmetric whether the method is or not.

use fredholm_coupling::method::{Evaluated, FormFactorMethod, MethodError, Setting, method, methods};
use fredholm_coupling::{Assembled, MethodCounts};
use fredholm_linop::{PackedSymmetric, Steps};
use fredholm_mesh::{Patch, Vec3};
use fredholm_visibility::Occluders;
use rayon::prelude::*;

use crate::error::{Error, ErrorKind};

/// The cheapest method whose error estimate meets the tolerance, for each pair.
pub(super) const AUTO: &str = "auto";
/// The same where the tolerance is that of a row, which is the usual one: few segments for pairs
/// that matter little to it.
pub(super) const BUDGET: &str = "row-budget";

/// Rows that are computed before they are stored: enough to keep many threads busy.
const ROWS_OF_A_BATCH: usize = 128;

/// The names of all methods.
pub(super) fn names() -> Vec<&'static str> {
    let all = methods();
    let names = all.iter().map(|method| method.name());
    names.flat_map(|name| if name == AUTO { vec![BUDGET, AUTO] } else { vec![name] }).collect()
}

/// A method with its setting.
pub(super) struct Chosen {
    method: Box<dyn FormFactorMethod>,
    pub(super) setting: Setting,
}

impl Chosen {
    /// The method of a name with the setting given, else the tolerance given, else its usual
    /// setting. `None` for [`AUTO`] and [`BUDGET`].
    pub(super) fn new(
        name: &str,
        setting: Option<&str>,
        tolerance: Option<f64>,
    ) -> Result<Option<Self>, Error> {
        if name == AUTO || name == BUDGET {
            let text = format!("--setting: the method {name} takes --tolerance");
            let refused = || Error::new(ErrorKind::Input, text);
            return setting.map_or(Ok(None), |_| Err(refused()));
        }
        let method = method(name).map_err(|error| Error::new(ErrorKind::Input, error))?;
        let usual = method.default_setting();
        let setting = match (setting, usual, tolerance) {
            (Some(text), _, _) => parsed(text, usual).ok_or_else(|| unread(&*method, text))?,
            (None, Setting::Tolerance(_), Some(tolerance)) => Setting::Tolerance(tolerance),
            _ => usual,
        };
        let chosen = Self { method, setting };
        chosen.try_out()?;
        Ok(Some(chosen))
    }

    /// The tolerance, where that is the setting.
    pub(super) fn tolerance(&self) -> Option<f64> {
        if let Setting::Tolerance(tolerance) = self.setting { Some(tolerance) } else { None }
    }

    /// Refuses a setting out of range before anything is read.
    fn try_out(&self) -> Result<(), Error> {
        let input =
            |error: &dyn std::error::Error| Error::new(ErrorKind::Input, format!("--setting: {error}"));
        let floor = Patch::triangle([Vec3::ZERO, Vec3::X, Vec3::Y]).map_err(|error| input(&error))?;
        let lid = Patch::triangle([Vec3::Z, Vec3::Y + Vec3::Z, Vec3::X + Vec3::Z])
            .map_err(|error| input(&error))?;
        let nothing = Occluders::new(&[]).map_err(|error| input(&error))?;
        let outcome = self.method.exchange(&floor, &lid, &nothing, self.setting);
        outcome.map(drop).map_err(|error| input(&error))
    }

    /// Computes all pairs and the errors stated for them, m²; `steps` counts the rows.
    pub(super) fn assemble(
        &self,
        patches: &[&Patch],
        occluders: &Occluders,
        name: &dyn Fn(usize) -> String,
        steps: &Steps<'_>,
    ) -> Result<(Assembled<f64>, PackedSymmetric<f64>), Error> {
        let row = |i: usize| {
            // A run that is no longer wanted ends by itself: there is nothing to save.
            let _ = steps.begin();
            self.row(patches, occluders, i)
        };
        let mut matrix = Matrix::new(patches)?;
        for start in (0..patches.len()).step_by(ROWS_OF_A_BATCH) {
            let batch = start..(start + ROWS_OF_A_BATCH).min(patches.len());
            let rows: Vec<_> = batch.clone().into_par_iter().map(row).collect();
            for (i, row) in batch.zip(rows) {
                let row = row.map_err(|(j, error)| refused([name(j), name(i)], &error))?;
                matrix.push(i, &row);
            }
        }
        matrix.finish()
    }

    /// Exchanges of patch i with those before it; the first pair that is refused.
    fn row(
        &self,
        patches: &[&Patch],
        occluders: &Occluders,
        i: usize,
    ) -> Result<Vec<Evaluated>, (usize, MethodError)> {
        let exchange = |j: usize| {
            let [a, b] = if patches[i].area() < patches[j].area() { [i, j] } else { [j, i] };
            let found = self.method.exchange(patches[a], patches[b], occluders, self.setting);
            found.map_err(|error| (j, error))
        };
        (0..i).map(exchange).collect()
    }
}

/// A setting of the kind of `usual`.
fn parsed(text: &str, usual: Setting) -> Option<Setting> {
    match usual {
        Setting::Fixed => None,
        Setting::Order(_) => text.parse().ok().map(Setting::Order),
        Setting::Tolerance(_) => text.parse().ok().map(Setting::Tolerance),
        Setting::Resolution(_) => text.parse().ok().map(Setting::Resolution),
        Setting::Samples { seed, .. } => {
            let (count, given) =
                text.split_once(',').map_or((text, None), |(count, seed)| (count, Some(seed)));
            let seed = given.map_or(Some(seed), |given| given.trim().parse().ok())?;
            Some(Setting::Samples { count: count.trim().parse().ok()?, seed })
        }
    }
}

fn unread(method: &dyn FormFactorMethod, text: &str) -> Error {
    let usual = method.default_setting();
    let text = format!("--setting: `{text}` is no setting of {}, whose usual one is {usual}", method.name());
    Error::new(ErrorKind::Input, text)
}

fn refused([a, b]: [String; 2], error: &MethodError) -> Error {
    Error::new(ErrorKind::Input, format!("{a} and {b}: {error}"))
}

/// The packed triangles of exchanges and stated errors under construction.
struct Matrix<'a> {
    patches: &'a [&'a Patch],
    packed: Vec<f64>,
    errors: Vec<f64>,
    error: Vec<f64>,
    largest: f64,
}

impl<'a> Matrix<'a> {
    fn new(patches: &'a [&'a Patch]) -> Result<Self, Error> {
        let n = patches.len();
        let (packed, errors) = (triangle(n)?, triangle(n)?);
        Ok(Self { patches, packed, errors, error: vec![0.0; n], largest: 0.0 })
    }

    /// Adds row i, up to the diagonal: flat patches see nothing of themselves.
    fn push(&mut self, i: usize, row: &[Evaluated]) {
        for (j, found) in row.iter().enumerate() {
            self.packed.push(found.value);
            self.errors.push(found.error);
            self.error[i] += found.error;
            self.error[j] += found.error;
            let area = self.patches[i].area().min(self.patches[j].area());
            self.largest = self.largest.max(found.error / area);
        }
        self.packed.push(0.0);
        self.errors.push(0.0);
    }

    fn finish(self) -> Result<(Assembled<f64>, PackedSymmetric<f64>), Error> {
        let input = |error| Error::new(ErrorKind::Input, error);
        let n = self.patches.len();
        let errors = PackedSymmetric::new(n, self.errors).map_err(input)?;
        let matrix = PackedSymmetric::new(n, self.packed).map_err(input)?;
        let methods = MethodCounts::default();
        Ok((Assembled { matrix, error: self.error, largest: self.largest, methods }, errors))
    }
}

/// Room for the lower triangle of n × n entries.
fn triangle(n: usize) -> Result<Vec<f64>, Error> {
    let mut packed = Vec::new();
    let needed = PackedSymmetric::<f64>::bytes(n);
    let no_memory =
        format!("the system has no {needed} bytes for the form-factor matrix; use fewer elements");
    packed.try_reserve_exact(n * (n + 1) / 2).map_err(|_| Error::new(ErrorKind::Resources, no_memory))?;
    Ok(packed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_are_those_of_the_method() {
        let setting =
            |name, text| Chosen::new(name, text, Some(1e-5)).map(|chosen| chosen.map(|c| c.setting));
        assert_eq!(setting("area-gauss", Some("12")).unwrap(), Some(Setting::Order(12)));
        assert_eq!(setting("contour", None).unwrap(), Some(Setting::Tolerance(1e-5)));
        assert_eq!(setting("contour", Some("1e-9")).unwrap(), Some(Setting::Tolerance(1e-9)));
        let samples = Setting::Samples { count: 64, seed: 7 };
        assert_eq!(setting("monte-carlo", Some("64, 7")).unwrap(), Some(samples));
        assert_eq!(setting("auto", None).unwrap(), None);
        let refused =
            [("auto", "3"), ("hemicube", "7"), ("centre", "1"), ("contour", "x"), ("area-gauss", "65")];
        for (name, text) in refused {
            assert_eq!(setting(name, Some(text)).unwrap_err().kind(), ErrorKind::Input, "{name} {text}");
        }
    }
}
