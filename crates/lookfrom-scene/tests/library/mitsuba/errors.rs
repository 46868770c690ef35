//! Faults in scenes of Mitsuba, and hostile files.

use std::path::PathBuf;

use lookfrom_scene::excerpt::Excerpts;
use lookfrom_scene::{ErrorKind, Memory};
use proptest::prelude::*;

use super::{error, files, read_of};

#[test]
fn mixes_of_mixes_under_a_map_are_as_many_as_they_are_written() {
    let mut elements = String::from("<bsdf type=\"diffuse\" id=\"b0\"/>\n");
    for k in 1..40 {
        let inner = k - 1;
        let mix = format!("<ref id=\"b{inner}\"/><ref name=\"other\" id=\"b{inner}\"/>");
        elements += &format!(
            "<bsdf type=\"blendbsdf\" id=\"b{k}\"><float name=\"weight\" value=\"0.5\"/>{mix}</bsdf>\n"
        );
    }
    let texture = "<texture type=\"checkerboard\"/>";
    elements +=
        &format!("<shape type=\"cube\"><bsdf type=\"bumpmap\">{texture}<ref id=\"b39\"/></bsdf></shape>");
    let text = format!("<scene version=\"3.0.0\">{elements}</scene>");
    let scene = read_of(&files(&[("s/a.xml", &text)]), &[]).0;
    assert!(scene.map_or(0, |scene| scene.materials.len()) <= 100);
}

#[test]
fn errors_have_their_place_and_a_remedy() {
    for (elements, at, message, hint) in [
        (
            "<shape type=\"sphere\"><float name=\"radius\" value=\"x\"/></shape>",
            50,
            "\"x\" is not a number, or too large",
            "",
        ),
        ("<shape type=\"spere\"/>", 14, "the shape \"spere\" is not supported", "did you mean \"sphere\"?"),
        (
            "<shape type=\"ellipsoids\"/>",
            14,
            "the shape \"ellipsoids\" is not supported",
            "there are: bsplinecurve",
        ),
        ("<shap type=\"sphere\" name=\"x\"/>", 1, "<shap> is not a known element", "did you mean <shape>?"),
        ("<shape type=\"cube\"><ref id=\"b\"/></shape>", 29, "\"b\" is not a known id", ""),
        ("<float name=\"x\" valeu=\"1\"/>", 17, "<float> has no attribute `valeu`", "it has: name, value"),
        ("<shape type=\"cube\"><ref/></shape>", 20, "this <ref> has no `id`", ""),
        ("<emitter type=\"area\"/>", 16, "an area light is a part of a shape", "write <emitter"),
        (
            "<shape type=\"ply\"><string name=\"filename\" value=\"no.ply\"/></shape>",
            50,
            "s/no.ply: no such file",
            "",
        ),
        ("words", 0, "unexpected text between elements", "comments are"),
        (
            "<shape type=\"cube\"><transform name=\"to_world\"><scale x=\"0\"/></transform></shape>",
            20,
            "`to_world` has to be a transform that can be inverted",
            "",
        ),
    ] {
        let found = error(elements);
        assert_eq!(found.message, message);
        if at > 0 {
            assert_eq!((found.at.line, found.at.column), (2, at), "{elements}");
        }
        let hinted = found.hint.map(|hint| hint.to_string()).unwrap_or_default();
        assert!(hinted.starts_with(hint), "{elements}: {hinted}");
    }
    let text = "<scene version=\"3.0.0\">\n  <shape type=\"sphree\"/>\n</scene>";
    let memory = files(&[("s/a.xml", text)]);
    let found = read_of(&memory, &[]).0.expect_err("a slip");
    let shown = Excerpts::new(&memory).of(&found.at).expect("a line").to_string();
    assert_eq!(shown, "  <shape type=\"sphree\"/>\n               ^^^^^^");
    let broken = read_of(&files(&[("s/a.xml", "<scene version=\"3.0.0\">\n<shape>\n</scene>")]), &[]);
    let broken = broken.0.expect_err("no end");
    assert_eq!((broken.kind, broken.at.line), (ErrorKind::Syntax, 3));
}

#[test]
fn hostile_files_end_in_errors() {
    let of = |text: &str| read_of(&files(&[("s/a.xml", text)]), &[]).0.expect_err("hostile");
    let bomb = "<!DOCTYPE scene [<!ENTITY a \"aaaa\"><!ENTITY b \"&a;&a;&a;\">]>\n<scene version=\"&b;\"/>";
    assert_eq!(of(bomb).kind, ErrorKind::Unsupported);
    let endless =
        of("<scene version=\"3.0.0\"><include filename=\"a.xml\"/><include filename=\"a.xml\"/></scene>");
    assert_eq!(endless.kind, ErrorKind::Limit);
    let deep = format!("<scene version=\"3.0.0\">{}", "<bsdf type=\"twosided\">".repeat(100_000));
    assert!(matches!(of(&deep).kind, ErrorKind::Syntax | ErrorKind::Limit));
    let closed = "<bsdf type=\"twosided\">".repeat(10_000) + &"</bsdf>".repeat(10_000);
    assert_eq!(error(&closed).kind, ErrorKind::Limit);
    assert_eq!(
        error("<shape type=\"sphere\"><float name=\"radius\" value=\"1e400\"/></shape>").kind,
        ErrorKind::Invalid
    );
    let huge = "<scale value=\"1e38\"/>".repeat(20);
    let huge =
        error(&format!("<shape type=\"cube\"><transform name=\"to_world\">{huge}</transform></shape>"));
    assert_eq!(huge.kind, ErrorKind::Invalid);
    // Each parameter is twice as long as the one before it.
    let doubled: String =
        (1..60).map(|k| format!("<default name=\"p{k}\" value=\"$p{}$p{}\"/>\n", k - 1, k - 1)).collect();
    assert_eq!(error(&format!("<default name=\"p0\" value=\"xx\"/>{doubled}")).kind, ErrorKind::Limit);
    // Many long values, each within its limit.
    let long = format!("<default name=\"p\" value=\"{}\"/>", "x".repeat(60_000));
    let uses: String = (0..500).map(|k| format!("<string name=\"s{k}\" value=\"$p\"/>")).collect();
    assert_eq!(error(&format!("{long}<shape type=\"cube\">{uses}</shape>")).kind, ErrorKind::Limit);
    // Columns of one long line are not counted from its beginning each time.
    let line = format!("{}<shape type=\"x\"/>", "<bsdf type=\"diffuse\"/>".repeat(100_000));
    assert_eq!(error(&line).at.column, 22 * 100_000 + 14);
    // Each attribute is compared with all before it.
    let attributes: String = (0..100_000).map(|k| format!(" a{k}=\"1\"")).collect();
    let crowded =
        error(&format!("<!-- {} --><![CDATA[\"]]><shape type=\"cube\"{attributes}/>", "=".repeat(2000)));
    assert_eq!((crowded.kind, &*crowded.message), (ErrorKind::Limit, "a tag with more than 1024 attributes"));
    let circle = "<bsdf type=\"twosided\" id=\"a\"><ref id=\"b\"/></bsdf><bsdf type=\"twosided\" id=\"b\"><ref id=\"a\"/></bsdf>\
                  <shape type=\"cube\"><ref id=\"a\"/></shape>";
    assert!(error(circle).message.ends_with("is a part of itself"));
    let twice = "<bsdf type=\"diffuse\" id=\"a\"/><bsdf type=\"diffuse\" id=\"a\"/>";
    assert!(error(twice).message.starts_with("the id \"a\" is taken already"));
}

/// A scene with most of the vocabulary, for mutations.
const SEED: &str = r##"<scene version="3.0.0"><default name="spp" value="4"/><integrator type="path"/>
<sensor type="perspective"><transform name="to_world"><lookat origin="0 0 4" target="0 0 0" up="0 1 0"/></transform>
<sampler type="independent"><integer name="sample_count" value="$spp"/></sampler></sensor>
<bsdf type="diffuse" id="d"><rgb name="reflectance" value="#808080"/></bsdf>
<shape type="sphere"><ref id="d"/><transform name="to_world"><scale x="2"/><rotate y="1" angle="30"/></transform></shape>
<emitter type="point"><spectrum name="intensity" value="400:1, 700:2"/></emitter></scene>"##;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn broken_scenes_are_errors_or_scenes(
        edits in proptest::collection::vec((0..SEED.len(), any::<u8>(), 0..4_usize), 1..6),
    ) {
        let mut bytes = SEED.as_bytes().to_vec();
        for (place, byte, kind) in edits {
            let place = place.min(bytes.len().saturating_sub(1));
            match kind {
                0 => bytes.truncate(place),
                1 => bytes.insert(place, byte),
                2 if !bytes.is_empty() => drop(bytes.remove(place)),
                _ if !bytes.is_empty() => bytes[place] = byte,
                _ => {}
            }
        }
        let memory = Memory([(PathBuf::from("s/a.xml"), bytes)].into());
        match read_of(&memory, &[]).0 {
            Err(error) => prop_assert!(!error.message.is_empty() && !error.at.file.is_empty()),
            Ok(scene) => prop_assert!(scene.shapes.iter().all(|shape| shape.material.index() < scene.materials.len())),
        }
    }
}
