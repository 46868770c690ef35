//! Pinned pictures: hashes of small pictures that must be the same on any machine, at any SIMD level, with any number of
//! threads.
//!
//! `LOOKFROM_UPDATE_PINS=1 cargo test -p lookfrom-cli pinned` writes the hashes anew. A commit that changes them says why,
//! and raises `lookfrom::render::SAMPLING_VERSION`, so that films of different bits are never merged.

use std::path::{Path, PathBuf};

use lookfrom::render::SAMPLING_VERSION;

use super::stage::Stage;

const SCENES: [&str; 7] = [
    "whitted1980.toml",
    "glass-and-mirror.toml",
    "cornell.toml",
    "materials.toml",
    "many-lights.toml",
    "models/star.ply",
    "../docs/guide/scenes/gltf/clearcoat.gltf",
];

const SETTINGS: [(&str, &str); 5] = [
    ("whitted", "--integrator whitted"),
    ("path", "--integrator path"),
    ("spectral", "--integrator path --color spectral"),
    ("occlusion", "--integrator ambient_occlusion"),
    ("layers", "--integrator path --layers geometry --denoise on"),
];

/// Levels that a machine does not have are replaced by the next one that it has: then a row is tested twice.
const LEVELS: [&str; 3] = ["sse2", "avx2", "avx512"];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// FNV-1a (Fowler, Noll & Vo) of 64 bits.
fn hash(bytes: &[u8]) -> u64 {
    bytes
        .iter()
        .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x100_0000_01b3))
}

#[test]
fn pinned_pictures_are_the_same_at_every_level_and_on_any_number_of_threads() {
    let stage = Stage::new("pinned");
    let mut lines = format!("sampling version {SAMPLING_VERSION}\n");
    for scene in SCENES {
        for (name, settings) in SETTINGS {
            let path = root().join("scenes").join(scene);
            let mut hashes: Vec<(String, u64)> = Vec::new();
            for level in LEVELS {
                for threads in [1, 3] {
                    let arguments = format!(
                        "render -q -o p.exr --width 40 --height 30 --samples 2 --threads {threads} {settings}"
                    );
                    let mut command = stage.command(&arguments);
                    let output = command.arg(&path).env("LOOKFROM_SIMD", level).output().unwrap();
                    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
                    hashes.push((format!("{level}, {threads} threads"), hash(&pixels(&stage))));
                }
            }
            for (how, hash) in &hashes {
                assert_eq!(*hash, hashes[0].1, "{scene} {name}: {how} differs from {}", hashes[0].0);
            }
            lines += &format!("{scene} {name} {:016x}\n", hashes[0].1);
        }
    }
    let pins = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/command/pinned.txt");
    if std::env::var_os("LOOKFROM_UPDATE_PINS").is_some() {
        let before = std::fs::read_to_string(&pins).unwrap_or_default();
        let is_same_version = before.lines().next() == lines.lines().next();
        assert!(!is_same_version || before == lines, "other bits need another SAMPLING_VERSION");
        std::fs::write(&pins, &lines).unwrap();
    }
    let pinned = std::fs::read_to_string(&pins).unwrap_or_default();
    for (now, then) in lines.lines().zip(pinned.lines().chain(std::iter::repeat(""))) {
        assert_eq!(now, then, "a picture has other bits; if it should, update the pins and say why");
    }
    assert_eq!(lines.lines().count(), pinned.lines().count());
}

#[test]
fn guides_are_the_same_at_every_level() {
    let stage = Stage::new("guides");
    let room = root().join("docs/benchmarks/portals/window.toml");
    let picture = |level: &str, portals: &str| path_traced(&stage, &room, level, &["--portals", portals]);
    let guided = picture("sse2", "auto");
    assert_eq!(guided, picture("avx2", "auto"));
    assert_ne!(guided, picture("avx2", "named"));
}

/// Paths in the clear body are shaded together, those in the coloured one around it are not.
#[test]
fn bodies_in_bodies_are_the_same_at_every_level() {
    let stage = Stage::new("bodies");
    let scene = stage.path("bodies.toml");
    let picture = |level: &str, absorption: f64| {
        let written = format!(
            "[camera]\nlookfrom = [0, 1, 5]\nlookat = [0, 0, 0]\nfov = 30\n\
             [materials.drink]\ntype = \"principled\"\ntransmission = 1\nroughness = 0\nior = 1.33\n\
             solid = true\nabsorption = [0.2, {absorption}, 0.4]\n\
             [materials.glass]\ndiffuse = 0\ntransmission = 0.9\nior = 1.5\n\
             [[sphere]]\nradius = 1\nmaterial = \"drink\"\n\
             [[sphere]]\nradius = 0.5\nmaterial = \"glass\"\n\
             [[light]]\ntype = \"environment\"\ncolor = 1\n"
        );
        stage.write("bodies.toml", &written);
        path_traced(&stage, &scene, level, &[])
    };
    let mixed = picture("sse2", 1.5);
    assert_eq!(mixed, picture("avx2", 1.5));
    assert_ne!(mixed, picture("avx2", 0.5));
}

/// The hash of a small picture at a level.
fn path_traced(stage: &Stage, scene: &Path, level: &str, more: &[&str]) -> u64 {
    let settings = "--integrator path --width 16 --height 12 --samples 2 --denoise off";
    let mut command = stage.command(&format!("render -q -o p.exr {settings}"));
    let output = command.args(more).arg(scene).env("LOOKFROM_SIMD", level).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    hash(&pixels(stage))
}

/// The values of all channels of the picture, without the header, which names the version and the path.
fn pixels(stage: &Stage) -> Vec<u8> {
    use lookfrom_scene::{Disk, LoadContext, image};
    let channels = image::read_exr(&stage.path("p.exr"), &mut LoadContext::new(&Disk)).unwrap();
    let values = channels.channels.iter().flat_map(|(name, values)| {
        name.bytes().chain(values.iter().flat_map(|value| value.to_bits().to_le_bytes())).collect::<Vec<_>>()
    });
    values.collect()
}
