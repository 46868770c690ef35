//! Test data outside the repository: third-party models, scenes and reference pictures.
//!
//! The environment variable `LOOKFROM_SHARED` names the folder. CONTRIBUTING.md says what it holds.

use std::io::Write;
use std::path::{Path, PathBuf};

/// The environment variable that names the folder.
pub const VARIABLE: &str = "LOOKFROM_SHARED";

/// A file or folder of the test data by its path in that folder, with `/` between the parts; `None` where `LOOKFROM_SHARED` is
/// not set. Then the test returns, and a line on stderr says that it was skipped.
///
/// # Panics
/// If the variable is set and there is no such file or folder: then the test must not be skipped.
pub fn shared(name: &str) -> Option<PathBuf> {
    let Some(root) = std::env::var_os(VARIABLE) else {
        let thread = std::thread::current();
        let test = thread.name().unwrap_or("a test");
        // Written to stderr directly: the test harness hides the output of `eprintln!` of tests that pass. An error in
        // writing the line does no harm.
        let _ = writeln!(std::io::stderr(), "skipped: {test} needs {name} in the folder {VARIABLE}");
        return None;
    };
    let path = Path::new(&root).join(name);
    assert!(path.exists(), "{VARIABLE} is set, and there is no {}", path.display());
    Some(path)
}
