//! Solvers by name and with options, as `gmres:restart=20` writes them.

use thiserror::Error;

/// What of the matrix a solver asks for. The order is that of what an operator has to offer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Access {
    /// Products with vectors alone.
    Products,
    /// Products, and the diagonal.
    Diagonal,
    /// Rows, columns or single entries too. An operator that computes or compresses its matrix may
    /// have to make a product for each of them.
    Entries,
}

/// A solver that can be asked for by name: a [`Solver`](crate::Solver) or a
/// [`Scheme`](crate::Scheme).
pub struct Entry<S: ?Sized> {
    /// Lower case, words joined by hyphens.
    pub name: &'static str,
    /// What it asks of the matrix.
    pub access: Access,
    /// Whether it is made for symmetric couplings.
    pub symmetric: bool,
    /// What it asks of the system, in one line; what does not have it is refused.
    pub requirements: &'static str,
    /// Options: name, and meaning with the default.
    pub options: &'static [(&'static str, &'static str)],
    /// Makes it. Options that are not read are refused by [`Entry::build`].
    pub make: fn(&mut Options) -> Result<Box<S>, OptionError>,
}

impl<S: ?Sized> Entry<S> {
    /// Makes it with options.
    ///
    /// # Errors
    /// An option is unknown, or its value does not fit.
    pub fn build(&self, mut options: Options) -> Result<Box<S>, OptionError> {
        let made = (self.make)(&mut options)?;
        match options.0.into_iter().next() {
            None => Ok(made),
            Some((option, _)) => {
                let known: Vec<&str> = self.options.iter().map(|(name, _)| *name).collect();
                let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
                Err(OptionError::Unknown { solver: self.name.to_owned(), option, known })
            }
        }
    }
}

/// Makes the solver that a text such as `sor:omega=1.3` asks for.
///
/// # Errors
/// There is none of this name, or its options are wrong.
pub fn build<S: ?Sized>(entries: &[Entry<S>], text: &str) -> Result<Box<S>, OptionError> {
    let (name, options) = Options::parse(text)?;
    match entries.iter().find(|entry| entry.name == name) {
        Some(entry) => entry.build(options),
        None => Err(OptionError::Solver {
            name,
            known: entries.iter().map(|entry| entry.name).collect::<Vec<_>>().join(", "),
        }),
    }
}

/// Options of a solver, each to be taken once.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Options(Vec<(String, String)>);

impl Options {
    /// Takes `name:option=value:option=value` apart.
    ///
    /// # Errors
    /// [`OptionError::Form`] where a part is not `option=value`, or an option comes twice.
    pub fn parse(text: &str) -> Result<(String, Self), OptionError> {
        let mut parts = text.split(':');
        let name = parts.next().unwrap_or_default().to_owned();
        let mut options: Vec<(String, String)> = Vec::new();
        for part in parts {
            match part.split_once('=') {
                Some((option, value)) if options.iter().all(|(known, _)| known != option) => {
                    options.push((option.to_owned(), value.to_owned()));
                }
                _ => return Err(OptionError::Form { part: part.to_owned() }),
            }
        }
        Ok((name, Self(options)))
    }

    /// Takes the value of an option, as it was written.
    pub fn text(&mut self, option: &str) -> Option<String> {
        let at = self.0.iter().position(|(name, _)| name == option)?;
        Some(self.0.remove(at).1)
    }

    /// Takes a number that `fits`.
    ///
    /// # Errors
    /// [`OptionError::Value`], saying what was `expected`.
    pub fn number(
        &mut self,
        option: &str,
        expected: &'static str,
        fits: impl Fn(f64) -> bool,
    ) -> Result<Option<f64>, OptionError> {
        let Some(text) = self.text(option) else { return Ok(None) };
        match text.parse() {
            Ok(value) if fits(value) => Ok(Some(value)),
            _ => Err(OptionError::Value { option: option.to_owned(), value: text, expected }),
        }
    }

    /// Takes a count of at least 1.
    ///
    /// # Errors
    /// [`OptionError::Value`] for anything else.
    pub fn count(&mut self, option: &str) -> Result<Option<usize>, OptionError> {
        let expected = "a whole number from 1 to 1000000";
        let found = self.number(option, expected, |x| x.fract() == 0.0 && (1.0..=1e6).contains(&x))?;
        Ok(found.map(|count| count as usize))
    }
}

/// A solver that cannot be made as asked for.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum OptionError {
    /// No solver of this name.
    #[error("there is no solver {name:?}; known are {known}")]
    Solver {
        /// What was asked for.
        name: String,
        /// The names there are.
        known: String,
    },
    /// Not an option and its value.
    #[error("{part:?} is not of the form option=value, each option once, as in sor:omega=1.2")]
    Form {
        /// The part that is wrong.
        part: String,
    },
    /// No option of this name.
    #[error("{solver} has no option {option:?}; its options: {known}")]
    Unknown {
        /// Name of the solver.
        solver: String,
        /// What was asked for.
        option: String,
        /// The options there are.
        known: String,
    },
    /// The value does not fit.
    #[error("{option} is {value:?}, but must be {expected}")]
    Value {
        /// Name of the option.
        option: String,
        /// What was given.
        value: String,
        /// What would fit.
        expected: &'static str,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    const ENTRIES: &[Entry<str>] = &[Entry {
        name: "echo",
        access: Access::Products,
        symmetric: false,
        requirements: "",
        options: &[("factor", "default 2")],
        make: |options| {
            let factor = options.number("factor", "a number above 0", |x| x > 0.0)?.unwrap_or(2.0);
            Ok(format!("echo {factor}").into_boxed_str())
        },
    }];

    #[test]
    fn options_are_taken_by_name_or_refused() {
        let built = |text| build(ENTRIES, text).map(String::from).map_err(|error| error.to_string());
        assert_eq!(built("echo"), Ok("echo 2".to_owned()));
        assert_eq!(built("echo:factor=1.5"), Ok("echo 1.5".to_owned()));
        assert!(built("sor").unwrap_err().contains("known are echo"));
        assert!(built("echo:factor").unwrap_err().contains("option=value"));
        assert!(built("echo:factor=1:factor=2").unwrap_err().contains("each option once"));
        assert!(built("echo:volume=3").unwrap_err().contains("its options: factor"));
        assert!(built("echo:factor=-1").unwrap_err().contains("a number above 0"));
        assert!(built("echo:factor=x").is_err());
    }

    #[test]
    fn counts_are_whole_and_positive() {
        let count = |text: &str| Options::parse(text).unwrap().1.count("n");
        assert_eq!((count("a:n=12"), count("a")), (Ok(Some(12)), Ok(None)));
        for wrong in ["a:n=0", "a:n=1.5", "a:n=-3", "a:n=nan", "a:n=1e9"] {
            assert!(count(wrong).is_err(), "{wrong}");
        }
    }
}
