#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    lookfrom_fuzz::read_model(&[("a.obj", bytes)], lookfrom_scene::obj::from_bytes);
});
