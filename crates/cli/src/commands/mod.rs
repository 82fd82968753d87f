//! The verbs, one a file.

mod check;
mod compare;
mod completions;
mod converge;
mod crosscheck;
mod discretisations;
mod info;
mod reference;
mod resume;
mod schema;
mod shoot;
mod solve;
mod solvers;
mod spectrum;
mod trace;
mod view;
mod viewfactors;
mod waves;

use crate::args::Command;
use crate::failure::{Ending, Failure};

pub(crate) use compare::CompareArgs;
pub(crate) use crosscheck::{CrosscheckArgs, EXAMPLES as CROSSCHECK_EXAMPLES};
pub(crate) use reference::{EXAMPLES as REFERENCE_EXAMPLES, ReferenceArgs};
pub(crate) use resume::{EXAMPLES as RESUME_EXAMPLES, ResumeArgs};
pub(crate) use shoot::{EXAMPLES as SHOOT_EXAMPLES, ShootArgs};
pub(crate) use spectrum::SpectrumArgs;
pub(crate) use trace::{EXAMPLES as TRACE_EXAMPLES, TraceArgs};
pub(crate) use view::{EXAMPLES as VIEW_EXAMPLES, ViewArgs};
pub(crate) use viewfactors::{Plane, ViewFactorsArgs, plane, point};
pub(crate) use waves::{EXAMPLES as WAVES_EXAMPLES, WavesArgs};

/// Carries out what was asked for.
pub(crate) fn execute(command: &Command) -> Result<Ending, Failure> {
    match command {
        Command::Solve(args) => solve::solve(args),
        Command::Resume(args) => resume::resume(args),
        Command::Check(args) => check::check(args),
        Command::Converge(args) => converge::converge(args),
        Command::Compare(args) => compare::compare(args),
        Command::Shoot(args) => shoot::shoot(args),
        Command::Spectrum(args) => spectrum::spectrum(args),
        Command::ViewFactors(args) => viewfactors::view_factors(args),
        Command::Waves(args) => waves::waves(args),
        Command::Trace(args) => trace::trace(args),
        Command::Crosscheck(args) => crosscheck::crosscheck(args),
        Command::Reference(args) => reference::reference(args),
        Command::View(args) => view::view(args),
        Command::Info(args) => info::info(args),
        Command::Schema => schema::schema(),
        Command::Completions(args) => completions::completions(args),
        Command::Solvers => solvers::solvers(),
        Command::Discretisations => discretisations::discretisations(),
    }
}
