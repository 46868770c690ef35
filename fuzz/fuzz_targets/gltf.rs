#![no_main]

use std::path::{Path, PathBuf};

use lookfrom_scene::{LoadContext, Memory, gltf};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let files = Memory([(PathBuf::from("a.glb"), bytes.to_vec())].into());
    let mut context = LoadContext::new(&files);
    context.limits = lookfrom_fuzz::limits();
    context.import.at = Some(0.5);
    if let Ok(scene) = gltf::read(Path::new("a.glb"), &mut context) {
        scene.meshes.iter().for_each(lookfrom_fuzz::check_mesh);
    }
});
