#![no_main]

use lookfrom_scene::{Location, lens};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    if let Ok(surfaces) = lens::parse(bytes, &Location::default()) {
        assert!(surfaces.iter().any(|surface| !surface.is_stop()));
    }
});
