//! Test data outside the repository: third-party models, scenes and reference pictures.
//!
//! The environment variable `LOOKFROM_SHARED` names the folder. CONTRIBUTING.md says what it holds. Tests that need it are
//! `#[ignore = "needs LOOKFROM_SHARED"]`, so that whoever runs them without it is told their number.

use std::path::{Path, PathBuf};

/// The environment variable that names the folder.
const VARIABLE: &str = "LOOKFROM_SHARED";

/// A file or folder of the test data by its path in that folder, with `/` between the parts.
///
/// # Panics
/// If `LOOKFROM_SHARED` is not set, or there is no such file or folder.
pub fn shared(name: &str) -> PathBuf {
    let Some(root) = std::env::var_os(VARIABLE) else {
        panic!("{VARIABLE} has to name the folder that has {name}: CONTRIBUTING.md")
    };
    let path = Path::new(&root).join(name);
    assert!(path.exists(), "{VARIABLE} is set, and there is no {}", path.display());
    path
}
