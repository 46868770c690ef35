//! Text as solids: closed, where its font says, and with errors that help.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use lookfrom_scene::shape::Mesh;
use lookfrom_scene::{LoadContext, Memory, load};

/// The font of the guide: a glyph for each letter of "lookfrom", of strokes that overlap.
const FONT: &[u8] = include_bytes!("../../../../docs/guide/scenes/parts/letters.ttf");

fn read(keys: &str) -> Result<(Mesh, Vec<String>), String> {
    let scene = format!("[camera]\nlookfrom = [0, 0, 9]\nlookat = [0, 0, 0]\n[[text]]\n{keys}\n");
    let files = Memory(
        [
            (PathBuf::from("a.toml"), scene.into_bytes()),
            (PathBuf::from("letters.ttf"), FONT.to_vec()),
            (PathBuf::from("bad.ttf"), b"no font".to_vec()),
            (PathBuf::from("short.ttf"), FONT[..FONT.len() / 2].to_vec()),
        ]
        .into(),
    );
    let mut context = LoadContext::new(&files);
    let scene = load::scene(Path::new("a.toml"), &mut context).map_err(|error| error.to_string())?;
    let warnings = context.warnings.iter().map(ToString::to_string).collect();
    Ok((scene.meshes.into_iter().next().unwrap(), warnings))
}

fn volume(mesh: &Mesh) -> f64 {
    let corners = mesh.triangles.iter().map(|t| t.map(|v| mesh.positions[v as usize].as_dvec3()));
    corners.map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
}

fn width(mesh: &Mesh) -> [f32; 2] {
    let x = || mesh.positions.iter().map(|position| position.x);
    [x().fold(f32::INFINITY, f32::min), x().fold(f32::NEG_INFINITY, f32::max)]
}

#[test]
fn solids_are_closed_and_as_large_as_their_letters() {
    let (mesh, warnings) =
        read("text = \"lookfrom\\nmol\"\nfont = \"letters.ttf\"\nsize = 2\ndepth = 0.5").unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    let mut edges = BTreeMap::new();
    for triangle in &mesh.triangles {
        let at = |k: usize| (mesh.positions[triangle[k % 3] as usize] + 0.0).to_array().map(f32::to_bits);
        for k in 0..3 {
            let (a, b) = (at(k), at(k + 1));
            *edges.entry(if a < b { [a, b] } else { [b, a] }).or_insert(0) += if a < b { 1 } else { -1 };
        }
    }
    assert!(edges.values().all(|&sum| sum == 0), "each edge once in each direction");
    assert!(mesh.normals.iter().all(|normal| (normal.length() - 1.0).abs() < 1e-5));
    // An l is a box of 0.1 by 0.72 em.
    let (l, _) = read("text = \"l\"\nfont = \"letters.ttf\"\nsize = 2\ndepth = 0.5").unwrap();
    assert!((volume(&l) - 0.2 * 1.44 * 0.5).abs() < 1e-6);
    assert_eq!((l.positions.len(), l.triangles.len()), (4 + 4 + 16, 12));
    // An o is nearly an elliptical ring, of parabolas with a bit more: (area of each arc's corner) 2/3 of a square.
    let (o, _) = read("text = \"o\"\nfont = \"letters.ttf\"\ndepth = 1").unwrap();
    let area = |rx: f64, ry: f64| 4.0 * rx * ry * (0.5 + 1.0 / 3.0);
    assert!((volume(&o) - (area(0.25, 0.26) - area(0.15, 0.16))).abs() < 2e-3, "{}", volume(&o));
    // Strokes that overlap are one: m has no walls inside of it.
    let (m, _) = read("text = \"m\"\nfont = \"letters.ttf\"\ndepth = 1").unwrap();
    let walls = m.normals.iter().zip(&m.positions).filter(|(normal, _)| normal.z == 0.0);
    assert!(walls.clone().count() > 20);
    assert!(walls.clone().all(|(_, p)| !(p.x > 0.075 && p.x < 0.145 && p.y > 0.01 && p.y < 0.4)));
}

#[test]
fn lines_are_set_by_advances_and_kerning() {
    let of = |keys: &str| width(&read(&format!("font = \"letters.ttf\"\n{keys}")).unwrap().0);
    // l from 0.06 to 0.16 of an advance of 0.22.
    assert_eq!(of("text = \"l\""), [0.06, 0.16]);
    assert_eq!(of("text = \"ll\""), [0.06, 0.38]);
    assert!((of("text = \"ll\"\nalign = \"right\"")[1] + 0.06).abs() < 1e-6);
    let [left, right] = of("text = \"ll\"\nalign = \"center\"");
    assert!((left + right).abs() < 1e-6);
    // The o comes nearer to a k by 0.06.
    assert!((of("text = \"ko\"")[1] - (0.48 - 0.06 + 0.54)).abs() < 1e-5);
    let (two, _) = read("text = \"l\\nl\"\nfont = \"letters.ttf\"\nline_spacing = 2").unwrap();
    let least = two.positions.iter().map(|position| position.y).fold(f32::INFINITY, f32::min);
    assert!((least + 2.2).abs() < 1e-5, "ascent 0.8, descent 0.2, gap 0.1: {least}");
}

#[test]
fn a_sheet_has_one_side() {
    let (sheet, _) = read("text = \"o\"\nfont = \"letters.ttf\"\ndepth = 0").unwrap();
    assert!(sheet.positions.iter().all(|p| p.z == 0.0) && sheet.normals.iter().all(|n| n.z == 1.0));
}

#[test]
fn mistakes_are_told() {
    let (_, warnings) = read("text = \"lux ux\"\nfont = \"letters.ttf\"").unwrap();
    assert!(warnings.iter().any(|warning| warning.contains("the font has no `u`, `x`")), "{warnings:?}");
    for (keys, expected) in [
        ("text = \"x\"\nfont = \"letters.ttf\"", "no character of the text has a shape"),
        ("text = \"l\"\nfont = \"bad.ttf\"", "not a TrueType or OpenType font"),
        ("text = \"l\"\nfont = \"none.ttf\"", "none.ttf"),
        ("text = \"l\"\nfont = \"letters.ttf\"\nalign = \"top\"", "align"),
        ("text = 3\nfont = \"letters.ttf\"", "a text"),
        ("font = \"letters.ttf\"", "`text` is missing"),
    ] {
        let error = read(keys).unwrap_err();
        assert!(error.contains(expected), "{keys}: {error}");
    }
    // A damaged font is an error or lacks letters; it never panics.
    for end in (0..FONT.len()).step_by(7) {
        let scene = "[camera]\nlookfrom = [0, 0, 9]\nlookat = [0, 0, 0]\n[[text]]\ntext = \"lookfrom\"\nfont = \"f.ttf\"\n";
        let files = Memory(
            [
                (PathBuf::from("a.toml"), scene.as_bytes().to_vec()),
                (PathBuf::from("f.ttf"), FONT[..end].to_vec()),
            ]
            .into(),
        );
        let _ = load::scene(Path::new("a.toml"), &mut LoadContext::new(&files));
    }
}
