//! The command `lookfrom`, and its options as keywords.

use std::ffi::OsString;

use lookfrom_cli::keywords::{self, Asked, Keyword};
use pyo3::prelude::*;

use crate::error::Error;

/// Keyword arguments as the Python code words them: names, and values as one would type them; none for a switch.
pub(super) type Words = Vec<(String, Option<String>)>;

/// Runs the command with its arguments, of which the first is its own name, and returns the exit code.
#[pyfunction]
pub(crate) fn run_command(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| lookfrom_cli::run(arguments))
}

/// The keywords of a session: names, what they are, and whether they are switches.
#[pyfunction]
pub(crate) fn keyword_list() -> Vec<(String, String, bool)> {
    let described = keywords::all().into_iter();
    described.map(|described| (described.name, described.help, described.is_switch)).collect()
}

/// The options of a session that keywords ask for.
///
/// # Errors
/// `Error` for keywords that do not exist, and values that they cannot have.
pub(super) fn asked(words: Words) -> PyResult<Asked> {
    let keywords: Vec<Keyword> = words.into_iter().map(|(name, value)| Keyword { name, value }).collect();
    keywords::options(&keywords).map_err(|fault| Error::new_err(fault.message))
}
