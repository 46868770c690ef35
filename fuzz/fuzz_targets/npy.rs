#![no_main]

use lookfrom_scene::{Location, npy};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    if let Ok(rows) = npy::rows::<3>(bytes, &Location::default(), 1 << 16) {
        assert!(rows.len() <= bytes.len());
    }
});
