//! How the currents are found: method, shadows, bounces or solver.

use schemars::JsonSchema;
use serde::Deserialize;

use super::format::WaveEntry;
use crate::error::SceneError;
use crate::source::Source;

/// How surface currents are found.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
#[schemars(rename = "Method")]
pub enum Method {
    /// J = 2 n × H of what arrives, bounce by bounce; any material, open and closed.
    PhysicalOptics,
    /// The magnetic field integral equation of closed conductors, away from resonances of the
    /// inside.
    Mfie,
    /// The same with j times that on a second surface inside, which has no resonances.
    DualSurfaceMfie,
    /// The electric field integral equation of open and closed conductors, thin sheets with an
    /// impedance and closed bodies with a surface impedance, by boundary elements.
    Efie,
    /// The combined field integral equation of closed conductors, by boundary elements; it has no
    /// resonances.
    Cfie,
    /// The equations of Poggio, Miller, Chang, Harrington, Wu and Tsai for both currents of
    /// dielectric bodies, and of conductors next to and inside of them, by boundary elements.
    Pmchwt,
    /// M = 2 n × E with n turned to the observer (G. Viennot, Limoges 2012).
    Thesis,
}

impl Method {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::PhysicalOptics,
        Self::Mfie,
        Self::DualSurfaceMfie,
        Self::Efie,
        Self::Cfie,
        Self::Pmchwt,
        Self::Thesis,
    ];

    /// The name in scene files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::PhysicalOptics => "physical-optics",
            Self::Mfie => "mfie",
            Self::DualSurfaceMfie => "dual-surface-mfie",
            Self::Efie => "efie",
            Self::Cfie => "cfie",
            Self::Pmchwt => "pmchwt",
            Self::Thesis => "thesis",
        }
    }

    /// Whether it is an equation, whose first bounces mean nothing by themselves.
    #[must_use]
    pub fn is_equation(self) -> bool {
        !matches!(self, Self::PhysicalOptics | Self::Thesis)
    }

    /// Whether it is one of boundary elements.
    #[must_use]
    pub fn is_boundary_elements(self) -> bool {
        matches!(self, Self::Efie | Self::Cfie | Self::Pmchwt)
    }

    /// Whether it finds the fields inside of bodies.
    pub(super) fn knows_insides(self) -> bool {
        self == Self::Pmchwt
    }
}

/// What blocks the waves of physical optics.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
#[schemars(rename = "Shadows")]
pub enum Shadows {
    /// Facets hide what is behind them from sources and from each other.
    Geometric,
    /// Nothing blocks; the currents radiate the shadow.
    Radiated,
}

impl Shadows {
    /// The name in scene files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Geometric => "geometric",
            Self::Radiated => "radiated",
        }
    }
}

/// What a scene says of the method; `None` where it says nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Settings {
    /// How the currents are found.
    pub method: Option<Method>,
    /// Order of the functions of boundary elements, 0 or 1.
    pub order: Option<u32>,
    /// What blocks waves.
    pub shadows: Option<Shadows>,
    /// Bounces to sum, at least 1.
    pub bounces: Option<u32>,
    /// Name of a solver with its options.
    pub solver: Option<String>,
    /// Relative residual to reach, above 0 and below 1.
    pub tolerance: Option<f64>,
    /// Most iterations, at least 1.
    pub max_iterations: Option<u32>,
    /// Whether the edge currents are added that physical optics lacks.
    pub edge_currents: Option<bool>,
    /// Whether errors are estimated by further runs.
    pub estimate_errors: bool,
    /// Relative error up to which frequencies may be interpolated, above 0 and below 1.
    pub sweep_accuracy: Option<f64>,
}

pub(super) fn settings(source: &Source, entry: &WaveEntry) -> Result<Settings, SceneError> {
    agreement(source, entry)?;
    let at_least_1 = |number: &Option<crate::format::At<u32>>, what: &str| match number {
        Some(number) if **number == 0 => {
            Err(source.value_error(number, format!("{what} is 0"), "write a whole number, at least 1"))
        }
        number => Ok(number.as_ref().map(|number| **number)),
    };
    Ok(Settings {
        method: entry.method.as_ref().map(|method| **method),
        order: entry.order.as_ref().map(|order| **order),
        shadows: entry.shadows.as_ref().map(|shadows| **shadows),
        bounces: at_least_1(&entry.bounces, "the number of bounces")?,
        solver: entry.solver.as_deref().cloned(),
        tolerance: entry.tolerance.as_ref().map(|t| source.below(t, 1.0, "tolerance")).transpose()?,
        max_iterations: at_least_1(&entry.max_iterations, "max_iterations")?,
        edge_currents: entry.edge_currents.as_ref().map(|wanted| **wanted),
        estimate_errors: entry.estimate_errors,
        sweep_accuracy: entry
            .sweep_accuracy
            .as_ref()
            .map(|accuracy| source.below(accuracy, 1.0, "sweep_accuracy"))
            .transpose()?,
    })
}

/// Refuses settings that do not go together.
fn agreement(source: &Source, entry: &WaveEntry) -> Result<(), SceneError> {
    let method = entry.method.as_ref().map_or(Method::PhysicalOptics, |method| **method);
    let optics = method == Method::PhysicalOptics;
    if let (Some(bounces), Some(_)) = (&entry.bounces, &entry.solver) {
        return Err(source.value_error(
            bounces,
            "bounces and solver are both given".to_owned(),
            "keep one of them",
        ));
    }
    if let (Some(bounces), true) = (&entry.bounces, method.is_equation()) {
        let what =
            format!("{} is an equation, whose first bounces mean nothing by themselves", method.name());
        return Err(source.value_error(bounces, what, "leave bounces out, or write solver = \"gmres\""));
    }
    if let (Some(shadows), false) = (&entry.shadows, optics) {
        let what = format!("{} has no choice of shadows", method.name());
        let help = "leave shadows out, or take method = \"physical-optics\"";
        return Err(source.value_error(shadows, what, help));
    }
    if let Some(order) = &entry.order {
        if **order > 1 {
            let what = format!("there are no functions of order {}", **order);
            return Err(source.value_error(order, what, "write 0 or 1"));
        }
        if !method.is_boundary_elements() {
            let what = format!("{} has no functions of a choice of orders", method.name());
            let help = "leave order out, or take method = \"efie\", \"cfie\" or \"pmchwt\"";
            return Err(source.value_error(order, what, help));
        }
    }
    if let (Some(accuracy), true) = (&entry.sweep_accuracy, entry.estimate_errors) {
        return Err(source.value_error(
            accuracy,
            "errors are not estimated by further runs of interpolated frequencies".to_owned(),
            "leave sweep_accuracy or estimate_errors out",
        ));
    }
    match &entry.edge_currents {
        Some(wanted) if **wanted && !optics => {
            let what = format!("edge currents complete physical optics, not {}", method.name());
            let help = "leave edge_currents out, or take method = \"physical-optics\"";
            Err(source.value_error(wanted, what, help))
        }
        _ => Ok(()),
    }
}
