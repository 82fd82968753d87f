//! The verbs, one a file.

mod check;
mod compare;
mod completions;
mod converge;
mod crosscheck;
mod discretisations;
mod exchange;
mod info;
mod judge;
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

use fredholm_study::Error;

use crate::args::Command;
use crate::ending::Ending;
pub(crate) use view::{EXAMPLES as VIEW_EXAMPLES, ViewArgs};

/// Carries out what was asked for.
pub(crate) fn execute(command: &Command) -> Result<Ending, Error> {
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
        Command::Judge(args) => judge::judge(args),
        Command::Export(args) => exchange::export(args),
        Command::Convert(args) => exchange::convert(args),
        Command::View(args) => view::view(args),
        Command::Info(args) => info::info(args),
        Command::Schema(args) => schema::schema(*args),
        Command::Completions(args) => completions::completions(args),
        Command::Solvers => solvers::solvers(),
        Command::Discretisations => discretisations::discretisations(),
    }
}
