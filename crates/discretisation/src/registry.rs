//! The discretisations, by name.

use crate::method::{Collocation, DegenerateKernel, Galerkin, LeastSquares, Nystrom};
use crate::{Degree, Discretisation, DiscretisationError};

/// All discretisations.
///
/// ```
/// let names: Vec<_> = fredholm_discretisation::discretisations().iter().map(|d| d.name()).collect();
/// assert!(names.contains(&"galerkin-0") && names.contains(&"nystrom-3"));
/// ```
#[must_use]
pub fn discretisations() -> Vec<Box<dyn Discretisation>> {
    let mut all: Vec<Box<dyn Discretisation>> = Vec::new();
    for degree in Degree::ALL {
        all.push(Box::new(Galerkin { degree, conforming: false }));
        if degree != Degree::Constant {
            all.push(Box::new(Galerkin { degree, conforming: true }));
        }
    }
    all.extend(Degree::ALL.map(|degree| Box::new(Collocation(degree)) as _));
    all.extend(Degree::ALL.map(|degree| Box::new(Nystrom(degree)) as _));
    all.extend(Degree::ALL.map(|degree| Box::new(LeastSquares(degree)) as _));
    all.extend(Degree::ALL.map(|degree| Box::new(DegenerateKernel(degree)) as _));
    all
}

/// The discretisation of this name. A `p` or `q` before the degree is read over: `galerkin-q1` is
/// `galerkin-1`, since a degree means P on triangles and Q on quads.
///
/// # Errors
/// [`DiscretisationError::Unknown`], with all names, where there is none.
///
/// ```
/// use fredholm_discretisation::discretisation;
/// assert_eq!(discretisation("galerkin-q2-conforming")?.name(), "galerkin-2-conforming");
/// assert!(discretisation("galerkin-7").is_err());
/// # Ok::<(), fredholm_discretisation::DiscretisationError>(())
/// ```
pub fn discretisation(name: &str) -> Result<Box<dyn Discretisation>, DiscretisationError> {
    let mut plain = name.to_owned();
    for digit in ["0", "1", "2"] {
        plain = plain.replace(&format!("-p{digit}"), &format!("-{digit}"));
        plain = plain.replace(&format!("-q{digit}"), &format!("-{digit}"));
    }
    let found = discretisations().into_iter().find(|method| method.name() == plain);
    found.ok_or_else(|| {
        let known: Vec<&str> = discretisations().iter().map(|method| method.name()).collect();
        DiscretisationError::Unknown { name: name.to_owned(), known: known.join(", ") }
    })
}
