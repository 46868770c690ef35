//! The same surface in glTF's words and in pbrt's makes the same picture.
//!
//! One mesh among shining panels, once in a glTF file and once in a scene of pbrt, with what both formats can say
//! exactly alike: smooth glass that absorbs, the white mirror, what is matte, leaves, and what shines. Two pictures may
//! differ by their noise, which is that of two pictures of one of them with different random numbers.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use lookfrom::render::Renderer;
use lookfrom_scene::settings::{ColorMode, FilterShape, Sampler};
use lookfrom_scene::{LoadContext, Memory, Scene, load};

/// Columns and rows of a picture.
const SIZE: u32 = 40;
/// In degrees.
const FOV: f32 = 30.0;
/// From the middle of the ball to the camera, which looks along −z.
const DISTANCE: f32 = 6.0;

/// Points and triangles.
type Form = (Vec<[f32; 3]>, Vec<[u16; 3]>);

/// The unit sphere around the origin, so fine that its corners do not matter; its points are its normals, too.
fn ball() -> Form {
    let (columns, rows) = (64_u16, 32_u16);
    let point = |row: u16, column: u16| {
        let theta = std::f32::consts::PI * f32::from(row) / f32::from(rows);
        let phi = std::f32::consts::TAU * f32::from(column % columns) / f32::from(columns);
        [theta.sin() * phi.cos(), theta.cos(), -theta.sin() * phi.sin()]
    };
    let points = (0..=rows).flat_map(|row| (0..columns).map(move |column| point(row, column))).collect();
    let cell = |row: u16, column: u16| {
        let (right, below) = ((column + 1) % columns, (row + 1) * columns);
        let above = row * columns;
        [[above + column, below + column, below + right], [above + column, below + right, above + right]]
    };
    let cells = (0..rows).flat_map(|row| (0..columns).flat_map(move |column| cell(row, column)));
    // At the poles cells are triangles.
    let is_whole = |triangle: &[u16; 3]| {
        let pole =
            |corner: u16| if corner < columns { 0 } else { u16::from(corner >= rows * columns) * 2 + 1 };
        let [a, b, c] = triangle.map(pole);
        !((a == b || a == c) && a != 1 || b == c && b != 1)
    };
    (points, cells.filter(is_whole).collect())
}

/// A panel that shines to both sides: a corner, two edges, and its radiance.
type Panel = ([f32; 3], [f32; 3], [f32; 3], [f32; 3]);

const PANELS: [Panel; 4] = [
    ([-3.0, -3.0, -4.0], [6.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.2, 0.5, 1.0]),
    ([-3.0, 0.5, -4.0], [2.5, 0.0, 0.0], [0.0, 2.5, 0.0], [1.0, 0.3, 0.1]),
    ([-2.0, 4.0, -2.0], [4.0, 0.0, 0.0], [0.0, 0.0, 4.0], [2.0, 1.8, 1.5]),
    ([4.0, -2.0, -2.0], [0.0, 4.0, 0.0], [0.0, 0.0, 4.0], [0.3, 1.2, 0.4]),
];

fn corners((corner, u, v, _): Panel) -> Form {
    let at = |s: f32, t: f32| std::array::from_fn(|axis| corner[axis] + s * u[axis] + t * v[axis]);
    (vec![at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)], vec![[0, 1, 2], [0, 2, 3]])
}

/// A glTF file whose ball has a material and which uses these extensions of materials.
pub(super) fn gltf(material: &str, extensions: &str) -> Scene {
    let (mut bytes, mut views, mut accessors) = (Vec::new(), String::new(), String::new());
    let (mut meshes, mut nodes, mut materials) = (String::new(), String::new(), material.to_owned());
    let forms = std::iter::once(ball()).chain(PANELS.map(corners));
    for (index, (points, triangles)) in forms.enumerate() {
        let start = bytes.len();
        bytes.extend(points.iter().flatten().flat_map(|number| number.to_le_bytes()));
        let middle = bytes.len();
        bytes.extend(triangles.iter().flatten().flat_map(|corner| corner.to_le_bytes()));
        let end = bytes.len();
        bytes.resize(end.next_multiple_of(4), 0);
        let comma = if index == 0 { "" } else { "," };
        let (lengths, counts) = ([middle - start, end - middle], [points.len(), 3 * triangles.len()]);
        let _ = write!(
            views,
            r#"{comma}{{"buffer":0,"byteOffset":{start},"byteLength":{}}},{{"buffer":0,"byteOffset":{middle},"byteLength":{}}}"#,
            lengths[0], lengths[1]
        );
        let _ = write!(
            accessors,
            r#"{comma}{{"bufferView":{},"componentType":5126,"count":{},"type":"VEC3"}},{{"bufferView":{},"componentType":5123,"count":{},"type":"SCALAR"}}"#,
            2 * index,
            counts[0],
            2 * index + 1,
            counts[1]
        );
        let normals = if index == 0 { r#","NORMAL":0"# } else { "" };
        let _ = write!(
            meshes,
            r#"{comma}{{"primitives":[{{"attributes":{{"POSITION":{}{normals}}},"indices":{},"material":{index}}}]}}"#,
            2 * index,
            2 * index + 1
        );
        let _ = write!(nodes, r#"{{"mesh":{index}}},"#);
    }
    for (.., radiance) in PANELS {
        let strength = radiance.into_iter().fold(0.0, f32::max);
        let [r, g, b] = radiance.map(|radiance| radiance / strength);
        let _ = write!(
            materials,
            r#",{{"pbrMetallicRoughness":{{"baseColorFactor":[0,0,0,1],"metallicFactor":0}},"emissiveFactor":[{r},{g},{b}],"doubleSided":true,"extensions":{{"KHR_materials_emissive_strength":{{"emissiveStrength":{strength}}},"KHR_materials_specular":{{"specularFactor":0}}}}}}"#
        );
    }
    let fov = FOV.to_radians();
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0,1,2,3,4,5]}}],"materials":[{materials}],"meshes":[{meshes}],
        "extensionsUsed":["KHR_materials_emissive_strength","KHR_materials_specular"{extensions}],
        "nodes":[{nodes}{{"camera":0,"translation":[0,0,{DISTANCE}]}}],
        "cameras":[{{"type":"perspective","perspective":{{"yfov":{fov},"aspectRatio":1,"znear":0.1}}}}],
        "buffers":[{{"uri":"a.bin","byteLength":{}}}],"bufferViews":[{views}],"accessors":[{accessors}]}}"#,
        bytes.len()
    );
    read("a.gltf", [("a.gltf", json.into_bytes()), ("a.bin", bytes)])
}

/// A scene of pbrt whose ball has what these lines say.
pub(super) fn pbrt(ball_is: &str) -> Scene {
    let mesh = |(points, triangles): Form, normals: bool| {
        let numbers = points.iter().flatten().fold(String::new(), |text, number| format!("{text} {number}"));
        let corners =
            triangles.iter().flatten().fold(String::new(), |text, corner| format!("{text} {corner}"));
        let normals = if normals { format!("\"normal N\" [{numbers}]") } else { String::new() };
        format!("Shape \"trianglemesh\" \"point3 P\" [{numbers}] \"integer indices\" [{corners}] {normals}\n")
    };
    let mut text = format!(
        "Scale -1 1 1\nLookAt 0 0 {DISTANCE}  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" {FOV}\n\
         Film \"rgb\" \"integer xresolution\" {SIZE} \"integer yresolution\" {SIZE}\nWorldBegin\n\
         AttributeBegin\n{ball_is}\n{}AttributeEnd\nMaterial \"diffuse\" \"rgb reflectance\" [0 0 0]\n",
        mesh(ball(), true)
    );
    for panel in PANELS {
        let [r, g, b] = panel.3;
        let light = format!("AreaLightSource \"diffuse\" \"rgb L\" [{r} {g} {b}] \"bool twosided\" true");
        let _ = write!(text, "AttributeBegin\n{light}\n{}AttributeEnd\n", mesh(corners(panel), false));
    }
    read("a.pbrt", [("a.pbrt", text.into_bytes())])
}

fn read<const N: usize>(name: &str, files: [(&str, Vec<u8>); N]) -> Scene {
    let memory = Memory(files.into_iter().map(|(name, bytes)| (PathBuf::from(name), bytes)).collect());
    let mut context = LoadContext::new(&memory);
    let scene = load::scene(Path::new(name), &mut context).unwrap_or_else(|error| panic!("{error}"));
    assert!(context.warnings.is_empty(), "{:?}", context.warnings);
    scene
}

fn render(scene: &Scene, samples: u32, seed: u64) -> Vec<[f32; 3]> {
    let mut scene = scene.clone();
    (scene.image.width, scene.image.height) = (SIZE, SIZE);
    scene.image.filter = FilterShape::Box.of_radius(0.5);
    let render = &mut scene.render;
    (render.samples, render.depth, render.seed) = (samples, 24, seed);
    (render.color, render.sampler) = (ColorMode::Rgb, Sampler::Independent);
    let renderer = Renderer::of_scene(scene, &mut Vec::new()).expect("a good scene");
    let rendered = renderer.render(None, &()).expect("a picture");
    assert_eq!(rendered.film.dropped(), 0);
    rendered.film.picture().pixels
}

fn mean(picture: &[[f32; 3]]) -> f64 {
    picture.iter().flatten().map(|&c| f64::from(c)).sum::<f64>() / (3 * picture.len()) as f64
}

/// The root of the mean square of the differences.
fn difference(a: &[[f32; 3]], b: &[[f32; 3]]) -> f64 {
    let squares = a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| f64::from(a - b).powi(2));
    (squares.sum::<f64>() / (3 * a.len()) as f64).sqrt()
}

/// The scenes' pictures differ as two of the same scene do, and no more.
pub(super) fn assert_same(gltf: &Scene, pbrt: &Scene, samples: u32) {
    let one = render(gltf, samples, 1);
    let [two, three] = [2, 3].map(|seed| render(pbrt, samples, seed));
    let noise = difference(&two, &three);
    let found = difference(&one, &two);
    let (mean_one, mean_two) = (mean(&one), 0.5 * (mean(&two) + mean(&three)));
    eprintln!("means {mean_one:.5} {mean_two:.5}, noise {noise:.5}, difference {found:.5}");
    assert!(mean_two > 0.05, "it is too dark to tell");
    // The noise of the mean is that of a pixel over the root of their number.
    let noise_of_mean = noise / f64::from(SIZE);
    assert!((mean_one - mean_two).abs() < 5.0 * noise_of_mean + 1e-6, "means {mean_one} and {mean_two}");
    assert!(found < 1.08 * noise + 1e-6, "the difference is {found}, the noise {noise}");
}

const SOLID: &str = r#","KHR_materials_transmission","KHR_materials_volume","KHR_materials_ior""#;

#[test]
fn a_glass_ball_is_pbrts_dielectric() {
    let glass = r#"{"pbrMetallicRoughness":{"metallicFactor":0,"roughnessFactor":0},"extensions":{
        "KHR_materials_transmission":{"transmissionFactor":1},"KHR_materials_volume":{"thicknessFactor":1},"KHR_materials_ior":{"ior":1.6}}}"#;
    assert_same(&gltf(glass, SOLID), &pbrt("Material \"dielectric\" \"float eta\" 1.6"), 128);
}

#[test]
fn a_ball_that_absorbs_is_pbrts_medium() {
    // Of light that goes a distance of 2, (0.25, 0.5, 1) is left: −ln(color) / 2.
    let glass = r#"{"pbrMetallicRoughness":{"metallicFactor":0,"roughnessFactor":0},"extensions":{
        "KHR_materials_transmission":{"transmissionFactor":1},"KHR_materials_ior":{"ior":1.33},
        "KHR_materials_volume":{"thicknessFactor":1,"attenuationColor":[0.25,0.5,1],"attenuationDistance":2}}}"#;
    let medium = "MakeNamedMedium \"inside\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [0.6931472 0.3465736 0] \
                  \"rgb sigma_s\" [0 0 0]\nMediumInterface \"inside\" \"\"\nMaterial \"dielectric\" \"float eta\" 1.33";
    assert_same(&gltf(glass, SOLID), &pbrt(medium), 128);
}

/// Solid glass of index 1.5 with this roughness factor, in glTF's words and in pbrt's.
fn frosted(roughness: f32) -> [Scene; 2] {
    let glass = format!(
        r#"{{"pbrMetallicRoughness":{{"metallicFactor":0,"roughnessFactor":{roughness}}},"extensions":{{
        "KHR_materials_transmission":{{"transmissionFactor":1}},"KHR_materials_volume":{{"thicknessFactor":1}},"KHR_materials_ior":{{"ior":1.5}}}}}}"#
    );
    let dielectric = format!(
        "Material \"dielectric\" \"float eta\" 1.5 \"float roughness\" {} \"bool remaproughness\" false",
        roughness * roughness
    );
    [gltf(&glass, SOLID), pbrt(&dielectric)]
}

#[test]
fn slightly_frosted_glass_is_pbrts_of_the_same_microfacets() {
    let [gltf, pbrt] = frosted(0.2);
    assert_same(&gltf, &pbrt, 128);
}

/// pbrt's loses what facets send to other facets; ours does not (docs/decisions/0017).
#[test]
fn frosted_glass_keeps_the_light_that_pbrts_loses() {
    let [ours, pbrts] = frosted(0.6).map(|scene| mean(&render(&scene, 128, 1)));
    assert!((1.03..1.1).contains(&(ours / pbrts)), "{ours} and {pbrts}");
}

#[test]
fn the_white_mirror_is_pbrts_conductor_that_reflects_everything() {
    let mirror = r#"{"pbrMetallicRoughness":{"metallicFactor":1,"roughnessFactor":0}}"#;
    assert_same(&gltf(mirror, ""), &pbrt("Material \"conductor\" \"rgb reflectance\" [1 1 1]"), 128);
}

#[test]
fn what_mirrors_nothing_is_diffuse() {
    let matte = r#"{"pbrMetallicRoughness":{"baseColorFactor":[0.8,0.5,0.2,1],"metallicFactor":0,"roughnessFactor":1},
        "extensions":{"KHR_materials_specular":{"specularFactor":0}}}"#;
    assert_same(&gltf(matte, ""), &pbrt("Material \"diffuse\" \"rgb reflectance\" [0.8 0.5 0.2]"), 64);
}

#[test]
fn a_leaf_is_pbrts_diffuse_transmission() {
    // Of what the leaf scatters, 0.4 comes out behind in its own colour, the rest in the base colour.
    let leaf = r#"{"pbrMetallicRoughness":{"baseColorFactor":[0.8,0.5,0.2,1],"metallicFactor":0,"roughnessFactor":1},"doubleSided":true,
        "extensions":{"KHR_materials_specular":{"specularFactor":0},"KHR_materials_diffuse_transmission":{
        "diffuseTransmissionFactor":0.4,"diffuseTransmissionColorFactor":[0.3,0.9,0.6]}}}"#;
    let material = "Material \"diffusetransmission\" \"rgb reflectance\" [0.48 0.3 0.12] \"rgb transmittance\" [0.12 0.36 0.24] \
                    \"float scale\" 1";
    assert_same(&gltf(leaf, r#","KHR_materials_diffuse_transmission""#), &pbrt(material), 64);
}

#[test]
fn what_is_not_lit_looks_like_what_shines() {
    let unlit = r#"{"pbrMetallicRoughness":{"baseColorFactor":[0.8,0.5,0.2,1]},"extensions":{"KHR_materials_unlit":{}}}"#;
    let lamp = "Material \"diffuse\" \"rgb reflectance\" [0 0 0]\n\
                AreaLightSource \"diffuse\" \"rgb L\" [0.8 0.5 0.2] \"bool twosided\" true";
    assert_same(&gltf(unlit, r#","KHR_materials_unlit""#), &pbrt(lamp), 64);
}
