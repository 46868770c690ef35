#![no_main]

use std::path::{Path, PathBuf};

use lookfrom_scene::files::Memory;
use lookfrom_scene::{Budget, LoadContext, vdb};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let files = Memory([(PathBuf::from("a.nvdb"), bytes.to_vec())].into());
    let mut context = LoadContext::within(&Budget::new(1 << 26), &files);
    context.limits = lookfrom_fuzz::limits();
    if let Ok(volume) = vdb::read(Path::new("a.nvdb"), "density", &mut context) {
        assert!(volume.grid.stored().iter().all(|value| value.is_finite()));
        assert!(volume.world_from_index.inverse().is_finite());
    }
});
