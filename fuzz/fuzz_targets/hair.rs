#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    lookfrom_fuzz::read_model(&[("a.hair", bytes)], lookfrom_scene::hair::from_bytes);
});
