#![no_main]

use std::path::{Path, PathBuf};

use lookfrom_scene::{LoadContext, Memory, mitsuba};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let files = Memory([(PathBuf::from("a.xml"), bytes.to_vec())].into());
    let mut context = LoadContext::new(&files);
    context.limits = lookfrom_fuzz::limits();
    let _ = mitsuba::read(Path::new("a.xml"), &mut context);
});
