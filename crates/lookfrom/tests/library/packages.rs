//! Packages: does each crate that is shipped have our licences, and a word about itself?

use std::fs;
use std::path::{Path, PathBuf};

fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

#[test]
fn shipped_crates_have_licences_and_readme() {
    let text = |path: PathBuf| fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path:?}: {error}"));
    let mut shipped = 0;
    for entry in fs::read_dir(workspace().join("crates")).expect("the folder of crates") {
        let folder = entry.expect("a crate").path();
        let is_shipped = folder.ends_with("lookfrom-py")
            || !text(folder.join("Cargo.toml")).lines().any(|line| line == "publish = false");
        if !is_shipped {
            continue;
        }
        shipped += 1;
        for licence in ["LICENSE-MIT", "LICENSE-APACHE"] {
            assert_eq!(text(folder.join(licence)), text(workspace().join(licence)), "{folder:?}");
        }
        assert!(!text(folder.join("README.md")).is_empty(), "{folder:?}");
    }
    assert!(shipped >= 7, "{shipped}");
}
