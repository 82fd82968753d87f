//! The method that suits a scene, where it does not name one.
//!
//! | scene | method | why |
//! |---|---|---|
//! | closed conductors, edges up to λ/4 | `dual-surface-mfie`, GMRES | an equation without approximation but the mesh |
//! | closed conductors that are thin or pointed, small | `cfie`, LU | facets that are not small beside the thickness do not follow the current around a rim |
//! | conductors, sheets among them, small | `efie`, LDLᵀ | an equation without approximation but the mesh; the matrix is stored |
//! | conductors, sheets among them, larger | `radiated`, GMRES, edge currents | currents make the shadow themselves: what hides a part of what stands behind is counted once |
//! | thin sheets with an impedance, conductors among them or not, small | `efie`, LDLᵀ | as above |
//! | conductors above a ground plane, small | `efie` with sheets, else `cfie`, by factors | nothing else knows the images |
//! | one flat sheet, small | `efie`, LDLᵀ | as above: it costs some seconds |
//! | one flat sheet, larger | one bounce, edge currents | its facets do not light each other |
//! | panes and other materials | one bounce; `radiated` where something is let through | bounces have to be asked for |
//! | many incident waves, where the scene names no solver | LU | one factorisation for all of them |
//! | edges above λ/2 | one bounce | nothing else is known on such facets |
//!
//! The figures are in `docs/notes/waves.md`, treatment by treatment and bounce by bounce. Where
//! bounces are asked for, what makes the sum converge to the truth is `radiated` on sheets: in
//! `geometric` the current on the front of a sheet radiates the shadow behind it, too, where what
//! is blocked has none already.

use fredholm_moments::{Basis, Surface};
use fredholm_waves::material::Material;
use fredholm_waves::{Complex64, Kind, Shadow};

use super::galerkin::Equations;
use super::geometry::Geometry;
use super::model::{BY_MATRIX, Band, Method};
use super::over_frequency::MOST_PICTURED;

/// Longest edge for the equation, in wavelengths.
const LONGEST_EDGE_OF_EQUATION: f64 = 0.26;
/// Most unknowns of boundary elements that are taken unasked: assembly and factorisation then take
/// some tens of seconds a core.
const MOST_UNKNOWNS: usize = 6_000;
/// The same of one flat sheet, which one bounce with edge currents describes well where it is
/// larger and the wave does not graze it.
const MOST_FLAT: usize = 3_000;
/// The same of thin closed bodies, for which there is nothing else that is exact.
const MOST_CLOSED: usize = 8_000;
/// A facet is of a thin part where the surface opposite is nearer than both of these: shares of the
/// extent and of the wavelength, below which the second surface of the dual equation has no room
/// for its full depth.
const THIN_DISTANCES: [f64; 2] = [0.3, 0.6];
/// Share of such facets from which a body is thin.
const THIN_SHARE: f64 = 0.1;
/// Incident waves from which on a factorisation is taken for all of them, and the largest matrix
/// for it, bytes.
const MANY_WAVES: usize = 16;
const MOST_FACTORISED: u128 = 4 << 30;
/// Extent over the wavelength below which physical optics says nothing.
const LEAST_OPTICAL_EXTENT: f64 = 0.5;
/// Matrices that the factorisation holds at once.
const MATRICES_AT_ONCE: u128 = 2;
/// Longest edge for several bounces, in wavelengths.
const LONGEST_EDGE_OF_BOUNCES: f64 = 0.5 * (1.0 + 1e-9);
/// Most facets for which all bounces are taken unasked: a product then takes some seconds a core.
const MOST_FACETS: usize = 60_000;
/// Longest sides of all faces together for which edge currents are added unasked, in wavelengths.
const LONGEST_SIDES: f64 = 20_000.0;
/// The residual of GMRES where it is taken unasked: below the error of any mesh.
const UNASKED_RESIDUAL: f64 = 1e-4;
/// What is asked for where the scene names no method.
const UNASKED_SOLVER: &str = "gmres:restart=60";
const UNASKED_ITERATIONS: usize = 500;

/// What a scene says of the method.
pub(super) struct Asked {
    pub(super) shadow: Option<Shadow>,
    /// Whether physical optics is asked for, with whatever shadows suit it.
    pub(super) optics: bool,
    /// Whether everything is above a ground plane, which boundary elements alone know.
    pub(super) ground: bool,
    pub(super) method: Option<Method>,
    pub(super) edge_currents: Option<bool>,
    /// Whether a solver is named.
    pub(super) solver: bool,
    /// Incident waves that are solved for.
    pub(super) waves: usize,
}

impl Asked {
    /// One bounce with geometric shadows but for what is asked: for what samples or compares that.
    pub(super) fn plain(self) -> Taken {
        Taken {
            shadow: self.shadow.unwrap_or_default(),
            galerkin: None,
            method: self.method.unwrap_or(Method::Bounces(1)),
            edge_currents: self.edge_currents.unwrap_or(false),
            reason: None,
            warnings: Vec::new(),
        }
    }
}

/// What is computed.
pub(super) struct Taken {
    pub(super) shadow: Shadow,
    /// The equations of boundary elements, where they are taken instead of currents on facets.
    pub(super) galerkin: Option<Equations>,
    pub(super) method: Method,
    pub(super) edge_currents: bool,
    /// Why, where the scene left it open.
    pub(super) reason: Option<String>,
    /// What should be known of what the scene asked for.
    pub(super) warnings: Vec<String>,
}

/// What decides.
#[allow(clippy::struct_excessive_bools, reason = "each is a fact of its own")]
struct Seen {
    conductors: bool,
    /// Whether there are thin sheets with an impedance, and conductors besides at most.
    films: bool,
    /// Whether a sheet lets something through.
    panes: bool,
    sheets: bool,
    /// Whether all is in one plane.
    flat: bool,
    facets: usize,
    /// Longest edge in the shortest wavelength.
    edge: f64,
    /// Length of the sides of all faces, in the shortest wavelength.
    sides: f64,
    /// Whether there are many frequencies.
    sweep: bool,
    /// Whether it is closed, and thin beside the longest wavelength and its own extent.
    thin: bool,
}

impl Seen {
    fn of(geometry: &Geometry, bands: &[Band]) -> Self {
        let materials = || bands.iter().flat_map(|band| &band.materials);
        let film = |material: &Material| matches!(material, Material::Sheet(_));
        let mesh = &geometry.mesh;
        let shortest = shortest(bands);
        let sides = |patch: &fredholm_mesh::Patch| -> f64 {
            (0..patch.sides()).map(|i| patch.corner(i).distance(patch.corner(i + 1))).sum()
        };
        let side = |patch: &fredholm_mesh::Patch| {
            let sides = (0..patch.sides()).map(|i| patch.corner(i).distance(patch.corner(i + 1)));
            sides.fold(0.0, f64::max)
        };
        let sheets = geometry.kinds().contains(&Kind::Sheet);
        Self {
            sides: mesh.occluders().iter().map(sides).sum::<f64>() / shortest,
            conductors: materials().all(|material| *material == Material::Conductor),
            films: materials().any(film) && materials().all(|m| film(m) || *m == Material::Conductor),
            panes: sheets && materials().any(|m| matches!(m, Material::Slab(_)) || film(m)),
            sheets,
            flat: is_flat(geometry),
            facets: mesh.len(),
            sweep: bands.len() > MOST_PICTURED,
            thin: !sheets && bands.iter().any(|band| is_thin(geometry, band)),
            edge: mesh.patches().map(side).fold(0.0, f64::max) / shortest,
        }
    }

    fn closed_conductors(&self) -> bool {
        self.conductors && !self.sheets
    }
}

/// Whether a good part of closed bodies is thin at a frequency.
fn is_thin(geometry: &Geometry, band: &Band) -> bool {
    let Ok(scatterer) = geometry.scatterer(&band.materials) else { return false };
    let most = (THIN_DISTANCES[0] * scatterer.extent()).min(THIN_DISTANCES[1] * band.wave.wavelength());
    let opposite = |facet: &&fredholm_waves::Facet| {
        scatterer.occluders().closest(facet.patch.centroid(), -facet.normal, most).is_some()
    };
    let thin = scatterer.facets().iter().filter(opposite).count();
    thin as f64 > THIN_SHARE * scatterer.facets().len() as f64
}

/// What is said of equations on facets of thin bodies.
const ON_THIN: &str = "the body is thin or pointed, where equations on facets may be tenths off; take method = \"cfie\" where its matrix fits";

/// The shortest wavelength, m.
fn shortest(bands: &[Band]) -> f64 {
    bands.iter().map(|band| band.wave.wavelength()).fold(f64::INFINITY, f64::min)
}

/// Whether boundary elements are possible on the mesh, their unknowns few, and their matrix fits.
fn is_small(geometry: &Geometry, (wavelength, most): (f64, usize), fits: &dyn Fn(u128) -> bool) -> bool {
    if geometry.mesh.len() > most {
        return false;
    }
    Surface::from_mesh(&geometry.mesh).and_then(Basis::new).is_ok_and(|basis| {
        let matrix = (basis.len() * basis.len() * size_of::<Complex64>()) as u128;
        let resolved = basis.topology().check_resolution(basis.surface(), wavelength, basis.order()).is_ok();
        resolved && basis.len() <= most && fits(MATRICES_AT_ONCE * matrix)
    })
}

/// Whether all sheets are in one plane.
fn is_flat(geometry: &Geometry) -> bool {
    let faces = geometry.mesh.occluders();
    let Some(bounds) = geometry.mesh.bounds() else { return false };
    let sheets = geometry.kinds().iter().all(|kind| *kind == Kind::Sheet);
    sheets && in_one_plane(faces, bounds.max.distance(bounds.min))
}

/// Whether all faces of something of this extent, m, are in one plane.
pub(super) fn in_one_plane(faces: &[fredholm_mesh::Patch], extent: f64) -> bool {
    let Some(first) = faces.first() else { return false };
    let height = |p: &fredholm_mesh::Vec3| first.normal().dot(*p - first.corner(0)).abs();
    faces.iter().flat_map(fredholm_mesh::Patch::corners).all(|p| height(p) <= 1e-9 * extent)
}

/// What is computed of a scene that asks for this, where `boundary_elements` may be taken unasked
/// and a matrix of some bytes `fits`.
pub(super) fn taken(
    asked: Asked,
    (geometry, bands): (&Geometry, &[Band]),
    boundary_elements: bool,
    fits: &dyn Fn(u128) -> bool,
) -> Taken {
    let seen = Seen::of(geometry, bands);
    let mut taken = match (asked.method, asked.shadow) {
        // Edge currents complete physical optics: who asks for them, or for none, means that.
        (None, None) if !asked.optics => {
            let most = match (seen.flat && seen.conductors && !asked.ground, seen.thin) {
                (true, _) => MOST_FLAT,
                (_, true) => MOST_CLOSED,
                _ => MOST_UNKNOWNS,
            };
            let size = (shortest(bands), most);
            let small =
                || boundary_elements && asked.edge_currents.is_none() && is_small(geometry, size, fits);
            chosen(&seen, asked.ground, &small)
        }
        (method, shadow) => completed(method.unwrap_or(Method::Bounces(1)), (asked.optics, shadow), &seen),
    };
    if let Some(edge_currents) = asked.edge_currents {
        taken.edge_currents = edge_currents;
    }
    if taken.edge_currents && (taken.shadow.is_equation() || taken.shadow == Shadow::Thesis) {
        // Asked for without a treatment: that which they complete is meant.
        let shadow = if seen.sheets { Shadow::Radiated } else { Shadow::Geometric };
        taken = Taken { shadow, reason: Some("edge currents complete physical optics".to_owned()), ..taken };
    }
    if !asked.solver && asked.waves >= MANY_WAVES {
        factorise(&mut taken, &seen, fits);
    }
    let longest = bands.iter().map(|band| band.wave.wavelength()).fold(0.0, f64::max);
    let extent = geometry.mesh.bounds().map_or(0.0, |bounds| bounds.diagonal()) / longest;
    if taken.galerkin.is_none()
        && !taken.shadow.is_equation()
        && seen.conductors
        && extent < LEAST_OPTICAL_EXTENT
    {
        taken.warnings.push(format!(
            "the surfaces are {extent:.2e} wavelengths from end to end, where physical optics says nothing; take method = \"efie\""
        ));
    }
    taken
}

/// Takes LU for many incident waves, where the matrix of the facets is not too large for that.
fn factorise(taken: &mut Taken, seen: &Seen, fits: &dyn Fn(u128) -> bool) {
    let matrix = (2 * seen.facets as u128).pow(2) * size_of::<Complex64>() as u128;
    if let Method::Solver { solver, .. } = &mut taken.method
        && taken.galerkin.is_none()
        && seen.conductors
        && matrix <= MOST_FACTORISED
        && fits(MATRICES_AT_ONCE * matrix)
        && let Ok(lu) = super::registry::build(BY_MATRIX)
    {
        *solver = lu;
    }
}

fn chosen(seen: &Seen, ground: bool, small: &dyn Fn() -> bool) -> Taken {
    let exact = (seen.sheets || seen.thin) && !seen.sweep;
    let boundary_elements = seen.films || seen.conductors && (exact || ground);
    let equations = if seen.sheets { Equations::Electric } else { Equations::Combined };
    if boundary_elements
        && small()
        && let Ok(solver) = super::registry::build(equations.direct_solver())
    {
        return Taken {
            shadow: Shadow::default(),
            galerkin: Some(equations),
            method: Method::Solver {
                solver,
                tolerance: UNASKED_RESIDUAL,
                max_iterations: UNASKED_ITERATIONS,
            },
            edge_currents: false,
            reason: Some(if ground {
                "a ground plane, which boundary elements alone know".to_owned()
            } else if seen.films {
                "thin sheets of few unknowns: an equation without approximation".to_owned()
            } else if seen.sheets {
                "conductors, sheets among them, of few unknowns: an equation without approximation".to_owned()
            } else {
                "thin or pointed closed conductors of few unknowns: an equation without approximation"
                    .to_owned()
            }),
            warnings: Vec::new(),
        };
    }
    let one = |shadow, edge_currents, why: &str| {
        (Method::Bounces(1), shadow, edge_currents, format!("one bounce: {why}"))
    };
    let all = |shadow, edge_currents, why: &str| match super::registry::build(UNASKED_SOLVER) {
        Ok(solver) => {
            let method =
                Method::Solver { solver, tolerance: UNASKED_RESIDUAL, max_iterations: UNASKED_ITERATIONS };
            (method, shadow, edge_currents, why.to_owned())
        }
        Err(_) => (Method::Bounces(1), shadow, edge_currents, why.to_owned()),
    };
    let mut warnings = Vec::new();
    let (method, shadow, edge_currents, why) = if !seen.conductors {
        if seen.films {
            warnings.push(
                "thin sheets with an impedance have an equation without approximation, which is not taken unasked for so many unknowns; write method = \"efie\""
                    .to_owned(),
            );
        } else if !seen.flat {
            warnings.push(
                "several bounces between materials are not taken unasked; write bounces = 3, say".to_owned(),
            );
        }
        let shadow = if seen.panes { Shadow::Radiated } else { Shadow::Geometric };
        one(shadow, false, "the scene has other materials than conductors")
    } else if seen.flat {
        one(Shadow::Geometric, true, "everything is in one plane, where nothing lights anything else")
    } else if seen.edge > LONGEST_EDGE_OF_BOUNCES {
        warnings.push("edges are above half a wavelength: one bounce is all that is known of such facets; mesh finer for more".to_owned());
        one(Shadow::Geometric, seen.sheets, "facets are above half a wavelength")
    } else if seen.facets > MOST_FACETS {
        warnings.push(format!("{} facets: one bounce is taken; write a solver for all of them", seen.facets));
        one(Shadow::Geometric, seen.sheets, "there are too many facets for more unasked")
    } else if seen.closed_conductors() && seen.edge <= LONGEST_EDGE_OF_EQUATION {
        all(Shadow::ExactDual, false, "closed conductors have an equation without approximation")
    } else if seen.closed_conductors() {
        all(
            Shadow::Geometric,
            false,
            "facets are above a quarter of a wavelength, too long for the equation of closed bodies",
        )
    } else {
        all(Shadow::Radiated, true, "sheets light and shadow each other through their currents")
    };
    if shadow == Shadow::ExactDual && seen.thin {
        warnings.push(ON_THIN.to_owned());
    }
    let long = seen.sides > LONGEST_SIDES;
    if edge_currents && long {
        warnings.push(
            "the edges are too long for edge currents unasked; write edge_currents = true for them"
                .to_owned(),
        );
    }
    if edge_currents && seen.sweep {
        warnings.push(
            "edge currents are left out of a sweep of many frequencies; write edge_currents = true for them"
                .to_owned(),
        );
    }
    let edge_currents = edge_currents && !long && !seen.sweep;
    Taken { shadow, galerkin: None, method, edge_currents, reason: Some(why), warnings }
}

/// The rest of what a scene that asks for a part gets.
fn completed(method: Method, (optics, shadow): (bool, Option<Shadow>), seen: &Seen) -> Taken {
    let several = !matches!(method, Method::Bounces(1));
    let rigorous = !optics && matches!(&method, Method::Solver { solver, .. } if solver.name() != "neumann");
    let mut warnings = Vec::new();
    if shadow == Some(Shadow::Geometric) && several && seen.sheets && !seen.flat {
        warnings.push(
            "geometric shadows with several bounces count the shadow behind a sheet twice; take shadows = \"radiated\" unless no sheet hides another"
                .to_owned(),
        );
    }
    if shadow == Some(Shadow::Geometric) && seen.panes && !seen.flat {
        warnings.push(
            "geometric shadows let what is behind a pane be dark; take shadows = \"radiated\" where something is let through"
                .to_owned(),
        );
    }
    if shadow.is_some_and(Shadow::is_equation) && seen.thin {
        warnings.push(ON_THIN.to_owned());
    }
    let suits = || {
        if !several {
            (Shadow::Geometric, "one bounce: what is hidden is dark")
        } else if seen.sheets || seen.panes {
            (Shadow::Radiated, "sheets light and shadow each other through their currents")
        } else if rigorous && seen.closed_conductors() && seen.edge <= LONGEST_EDGE_OF_EQUATION {
            (Shadow::ExactDual, "closed conductors have an equation without approximation")
        } else {
            (Shadow::Geometric, "bounces between closed bodies: what is hidden is dark")
        }
    };
    let reason = shadow.is_none().then(|| suits().1.to_owned());
    let shadow = shadow.unwrap_or_else(|| suits().0);
    Taken { shadow, galerkin: None, method, edge_currents: false, reason, warnings }
}
