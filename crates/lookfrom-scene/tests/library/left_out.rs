//! Files in formats whose readers a build leaves out: what is said of them.

#[cfg(not(all(feature = "gltf", feature = "images", feature = "mitsuba", feature = "pbrt")))]
fn refusal(name: &str, content: &[u8]) -> String {
    use lookfrom_scene::{LoadContext, Memory, load};

    let files = Memory([(name.into(), content.to_vec())].into());
    let read = load::scene(name.as_ref(), &mut LoadContext::new(&files));
    read.expect_err("there is no reader").to_string()
}

#[cfg(not(feature = "gltf"))]
#[test]
fn a_build_without_gltf_says_so() {
    for name in ["a.gltf", "without-extension"] {
        let error = refusal(name, br#"{"asset": {"version": "2.0"}}"#);
        assert!(error.contains("this build has no reader for glTF"), "{error}");
        assert!(error.contains("build with the feature `gltf`"), "{error}");
    }
}

#[cfg(not(feature = "mitsuba"))]
#[test]
fn a_build_without_mitsuba_says_so() {
    let error = refusal("a.xml", b"<scene version=\"3.0.0\"/>");
    assert!(error.contains("build with the feature `mitsuba`"), "{error}");
}

#[cfg(not(feature = "pbrt"))]
#[test]
fn a_build_without_pbrt_says_so() {
    let error = refusal("a.pbrt", b"WorldBegin\n");
    assert!(error.contains("build with the feature `pbrt`"), "{error}");
}

#[cfg(not(feature = "images"))]
#[test]
fn a_build_without_all_pictures_says_so() {
    use std::path::Path;

    use lookfrom_scene::{LoadContext, Memory, image};

    for (name, content) in
        [("a.bmp", &b"BM"[..]), ("a.ktx2", b"\xabKTX 20\xbb\r\n\x1a\n"), ("a.ppm", b"P6 1 1 255 ")]
    {
        let files = Memory([(name.into(), content.to_vec())].into());
        let error =
            image::read(Path::new(name), &mut LoadContext::new(&files)).expect_err("there is no reader");
        let error = error.to_string();
        assert!(error.contains("build with the feature `images`"), "{error}");
    }
}
