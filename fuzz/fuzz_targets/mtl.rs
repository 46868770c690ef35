#![no_main]

const OBJ: &[u8] =
    b"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\nusemtl\nf 1 2 3\n";

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    lookfrom_fuzz::read_model(&[("a.obj", OBJ), ("a.mtl", bytes)], lookfrom_scene::obj::from_bytes);
});
