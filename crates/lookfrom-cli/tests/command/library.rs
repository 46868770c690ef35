//! The command and the library make the same pictures, byte for byte: doors decide nothing.

use std::path::{Path, PathBuf};

use lookfrom::render::StopCriteria;
use lookfrom::session::{Format, Options, Session};
use lookfrom_scene::settings::Layers;

use super::stage::Stage;

fn own(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes").join(name)
}

#[test]
fn the_library_makes_the_pictures_of_the_command() {
    let stage = Stage::new("library");
    let small = || Options { width: Some(40), height: Some(30), ..Options::default() };
    let cases = [
        ("whitted1980.toml", "--samples 2", Format::Png, Options { samples: Some(2), ..small() }),
        ("models/star.ply", "", Format::Png, small()),
        ("models/star.ply", "", Format::Jpeg(Format::JPEG_QUALITY), small()),
        ("star.pbrt", "", Format::WebP, small()),
        (
            "models/knot.obj",
            "--samples 3 --layers geometry",
            Format::Exr,
            Options { samples: Some(3), layers: Some(Layers::Geometry), ..small() },
        ),
        (
            "star.pbrt",
            "--noise 0.4 --denoise",
            Format::Exr,
            Options { denoise: Some(true), stop: StopCriteria { noise: Some(0.4), time: None }, ..small() },
        ),
        (
            "../docs/guide/scenes/gltf/sheen.gltf",
            "--turn 40 --floor",
            Format::Hdr,
            Options { turn: Some(40.0), floor: true, ..small() },
        ),
    ];
    for (name, arguments, format, options) in cases {
        let extension = Format::EXTENSIONS.iter().find(|(_, known)| *known == format).unwrap().0;
        let typed = format!("render -q --width 40 --height 30 {arguments} -o p.{extension}");
        let output = stage.command(&typed).arg(own(name)).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));

        let session = Session::open(own(name), &Options { format: Some(format), ..options }).unwrap();
        let bytes = session.render(&()).unwrap().encode(format).unwrap();
        assert!(bytes == stage.bytes(&format!("p.{extension}")), "{name} {arguments}");
    }
}
