#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    lookfrom_fuzz::read_model(&[("a.stl", bytes)], lookfrom_scene::stl::from_bytes);
});
