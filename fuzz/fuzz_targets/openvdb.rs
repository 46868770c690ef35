#![no_main]

use std::path::{Path, PathBuf};

use lookfrom_scene::files::Memory;
use lookfrom_scene::{Budget, LoadContext, vdb};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    // The header is there already: magic number, version, and that there are positions.
    let header = [&b" BDV\0\0\0\0\xe0\0\0\0"[..], &[0; 8], &[1], &[b'0'; 36]].concat();
    let files = Memory([(PathBuf::from("a.vdb"), [&header, bytes].concat())].into());
    let mut context = LoadContext::within(&Budget::new(1 << 26), &files);
    context.limits = lookfrom_fuzz::limits();
    if let Ok(volume) = vdb::read(Path::new("a.vdb"), "density", &mut context) {
        assert!(volume.grid.stored().iter().all(|value| value.is_finite()));
        assert!(volume.world_from_index.inverse().is_finite());
    }
});
