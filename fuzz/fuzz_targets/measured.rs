#![no_main]

use std::path::Path;

use lookfrom_scene::error::Location;
use lookfrom_scene::measured::Measured;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    if let Ok(measured) = Measured::from_bytes(bytes, &Location::file(Path::new("a.bsdf"))) {
        assert!(measured.is_consistent());
    }
});
