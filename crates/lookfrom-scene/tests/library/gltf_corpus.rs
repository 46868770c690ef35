//! Do all glTF files of the corpora read, where they are valid, and give clear errors where they are not?
//!
//! Khronos' validator has a report beside each of its files. Files that it finds no error in must read; of the others,
//! each reads or gives an error. The corpora are test data outside the repository (`LOOKFROM_SHARED`).

use std::path::{Path, PathBuf};

use lookfrom_scene::{Disk, LoadContext, load};

fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let path = entry.path();
        if path.is_dir() {
            files(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "gltf" || extension == "glb") {
            found.push(path);
        }
    }
}

fn corpus(name: &str) -> Vec<PathBuf> {
    let root = lookfrom_test_data::shared(&format!("corpus/{name}"));
    let mut found = Vec::new();
    files(&root, &mut found);
    found.sort();
    assert!(!found.is_empty(), "{} has no glTF files", root.display());
    found
}

fn read(path: &Path) -> Result<(), String> {
    let mut context = LoadContext::new(&Disk);
    let scene = load::scene(path, &mut context);
    let scene = scene.map_err(|error| error.to_string())?;
    for mesh in &scene.meshes {
        let count = mesh.positions.len();
        assert!(mesh.positions.iter().all(|position| position.is_finite()), "{}", path.display());
        assert!(
            mesh.triangles.iter().flatten().all(|&vertex| (vertex as usize) < count),
            "{}",
            path.display()
        );
        for length in [mesh.normals.len(), mesh.uvs.len(), mesh.colors.len(), mesh.tangents.len()] {
            assert!(length == 0 || length == count, "{}", path.display());
        }
    }
    Ok(())
}

#[test]
#[ignore = "needs LOOKFROM_SHARED"]
fn models_read() {
    for path in corpus("gltf") {
        if let Err(error) = read(&path) {
            panic!("{error}");
        }
    }
}

#[test]
#[ignore = "needs LOOKFROM_SHARED"]
fn assimps_files_read_where_they_are_valid() {
    // What the names of these folders say is wrong with them.
    let broken =
        ["IndexOutOfRange", "MissingBin", "RecursiveNodes", "SchemaFailures", "TestNoRootNode", "wrongTypes"];
    let mut count = 0;
    for path in corpus("assimp/glTF2") {
        let is_broken = path.components().any(|folder| broken.iter().any(|name| folder.as_os_str() == *name));
        match read(&path) {
            Ok(()) => count += 1,
            Err(error) => assert!(is_broken, "{error}"),
        }
    }
    println!("{count} files of assimp read");
}

#[test]
#[ignore = "needs LOOKFROM_SHARED"]
fn files_of_the_validator_agree_with_their_reports() {
    let (mut read_well, mut refused, mut tolerated) = (0, 0, 0);
    let mut failed = Vec::new();
    for path in corpus("gltf-validator") {
        let report = std::fs::read_to_string(format!("{}.report.json", path.display()));
        let report: serde_json::Value = match report.map(|text| serde_json::from_str(&text)) {
            Ok(Ok(report)) => report,
            _ => continue,
        };
        let errors = report["issues"]["numErrors"].as_u64().unwrap_or(0);
        match (read(&path), errors) {
            (Ok(()), 0) => read_well += 1,
            (Ok(()), _) => tolerated += 1,
            (Err(error), 0) => failed.push(error),
            (Err(_), _) => refused += 1,
        }
    }
    println!(
        "{read_well} valid files read; of those with errors {refused} are refused, {tolerated} read all the same"
    );
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}
