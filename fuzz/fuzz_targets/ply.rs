#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    lookfrom_fuzz::read_model(&[("a.ply", bytes)], lookfrom_scene::ply::from_bytes);
});
