//! What the readers make of good files: meshes, materials, colours, pictures.

mod exporters;

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use glam::{Vec2, Vec3};
use lookfrom_scene::image::{Pixels, encode_png_of};
use lookfrom_scene::material::{BumpMapping, Color, Material, MaterialKind, Principled, Scalar, Whitted};
use lookfrom_scene::shape::{Geometry, Mesh, Part};
use lookfrom_scene::texture::{Channel, Mapping, TextureKind, Wrap};
use lookfrom_scene::{LoadContext, Memory, Scene, model, ply};
use proptest::prelude::*;

struct Model {
    scene: Scene,
    parts: Vec<Part>,
    warnings: Vec<String>,
}

impl Model {
    fn of(files: &[(&str, &[u8])]) -> Self {
        let contents = files.iter().map(|(name, content)| (PathBuf::from(name), content.to_vec())).collect();
        let files_in_memory = Memory(contents);
        let mut context = LoadContext::new(&files_in_memory);
        let mut scene = Scene::default();
        let parts = model::read(Path::new(files[0].0), &mut context, &mut scene).unwrap();
        Self { scene, parts, warnings: context.warnings.iter().map(ToString::to_string).collect() }
    }

    fn mesh(&self, part: usize) -> &Mesh {
        match &self.parts[part].geometry {
            Geometry::Mesh(mesh) => &self.scene.meshes[mesh.index()],
            other => panic!("not a mesh: {other:?}"),
        }
    }

    fn look(&self, part: usize) -> &Whitted {
        let MaterialKind::Whitted(whitted) =
            &self.scene.materials[self.parts[part].material.unwrap().index()].kind
        else {
            panic!("not Whitted's")
        };
        whitted
    }

    fn material(&self) -> &Material {
        &self.scene.materials[self.parts[0].material.unwrap().index()]
    }

    fn principled(&self) -> &Principled {
        let MaterialKind::Principled(principled) = &self.material().kind else { panic!("not glTF's") };
        principled
    }

    /// The texels, the channel and the factor of a number.
    fn number(&self, number: Scalar) -> (Vec<[f32; 3]>, Channel, f32) {
        let Scalar::Texture(texture) = number else { panic!("no texture: {number:?}") };
        match &self.scene.textures[texture.index()].kind {
            &TextureKind::Image { image, channel, scale, .. } => {
                (self.scene.images[image.index()].texels().collect(), channel, scale)
            }
            other => panic!("no picture: {other:?}"),
        }
    }

    /// The picture behind a colour, and how it is laid on.
    fn picture(&self, color: Color) -> (Vec<[f32; 3]>, [f32; 2], [f32; 2], Wrap) {
        let Color::Texture(texture) = color else { panic!("no texture: {color:?}") };
        match &self.scene.textures[texture.index()].kind {
            TextureKind::Image { image, mapping: Mapping::Uv { scale, offset }, wrap, .. } => {
                (self.scene.images[image.index()].texels().collect(), *scale, *offset, wrap[0])
            }
            other => panic!("no picture: {other:?}"),
        }
    }
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

/// An OBJ with one triangle of material `m`, whose library is `mtl`.
fn with_material(mtl: &str, more: &[(&str, &[u8])]) -> Model {
    let obj = format!("mtllib m.mtl\n{TRIANGLE}vt 0 0\nusemtl m\nf 1/1 2/1 3/1\n");
    let mtl = format!("newmtl m\n{mtl}");
    Model::of(&[&[("d/a.obj", obj.as_bytes()), ("d/m.mtl", mtl.as_bytes())], more].concat())
}

/// A picture of one white texel, as PPM.
const WHITE: &[u8] = b"P6\n1 1\n255\n\xff\xff\xff";

#[test]
fn obj_faces_share_vertices_and_have_corners_of_all_forms() {
    let obj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0 0\nvt 1\nvn 0 0 2\n\
               f 1/1/1 2/2/1 3//1 4\nf -4/-2/-1 \\\n-3/-1/-1 -2//-1\nf 3/1/1 4 1/1/1 # comment 9\n";
    let model = Model::of(&[("a.obj", obj.as_bytes())]);
    let mesh = model.mesh(0);
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 2], [4, 3, 0]]);
    assert_eq!(mesh.uvs, [Vec2::ZERO, Vec2::X, Vec2::ZERO, Vec2::ZERO, Vec2::ZERO]);
    let n = Vec3::new(0.0, 0.0, 2.0);
    assert_eq!(mesh.normals, [n, n, n, Vec3::ZERO, n]);
    assert_eq!(model.warnings, [""; 0]);
}

#[test]
fn obj_faces_may_come_before_their_vertices() {
    let model = Model::of(&[("a.obj", format!("f 1 2 3\n{TRIANGLE}").as_bytes())]);
    assert_eq!(model.mesh(0).positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
}

#[test]
fn obj_parts_are_materials_in_the_order_of_their_use() {
    let obj = format!(
        "{TRIANGLE}o first\nusemtl b c\nf 1 2 3\nusemtl a\nf 1 2 3\no second\nusemtl b c  \nf 3 2 1\nusemtl\nf 1 2 3\n"
    );
    let model = Model::of(&[("a.obj", obj.replace('\n', "\r").as_bytes())]);
    // The faces without a material are in front: that is where every file begins.
    let names: Vec<_> = model.parts.iter().map(|part| part.name.as_deref()).collect();
    assert_eq!(names, [None, Some("b c"), Some("a")]);
    assert_eq!(model.mesh(1).triangles, [[0, 1, 2], [2, 1, 0]]);
}

#[test]
fn obj_smoothing_groups_make_normals() {
    // A roof: two faces that share the edge from 1 to 2.
    let roof = "v 0 0 0\nv 1 0 0\nv 0 1 -1\nv 0 -1 -1\n";
    let flat = Model::of(&[("a.obj", format!("{roof}s off\nf 1 2 3\nf 2 1 4\n").as_bytes())]);
    assert_eq!(flat.mesh(0).normals, []);
    let parted = Model::of(&[("a.obj", format!("{roof}s 1\nf 1 2 3\ns 2\nf 2 1 4\n").as_bytes())]);
    assert_eq!(parted.mesh(0).positions.len(), 6);
    let smooth =
        Model::of(&[("a.obj", format!("{roof}s 1\nusemtl a\nf 1 2 3\nusemtl b\nf 2 1 4\n").as_bytes())]);
    for mesh in [smooth.mesh(0), smooth.mesh(1)] {
        for (position, normal) in mesh.positions.iter().zip(&mesh.normals) {
            assert!((normal.length() - 1.0).abs() < 1e-6);
            // On the shared edge the normal points straight up, elsewhere it is the face's.
            let expected = Vec3::new(0.0, position.y, 1.0).normalize();
            assert!(normal.distance(expected) < 1e-6, "{position} {normal}");
        }
    }
}

#[test]
fn obj_colours_of_vertices_are_srgb_and_white_where_there_are_none() {
    let obj = "v 0 0 0 1 0.5 0\nv 1 0 0\nv 0 1 0 0 0 1\nf 1 2 3\n";
    let model = Model::of(&[("a.obj", obj.as_bytes())]);
    let colors = &model.mesh(0).colors;
    assert!((colors[0][1] - 0.214_041).abs() < 1e-6);
    assert_eq!((colors[0][0], colors[1], colors[2]), (1.0, [1.0; 3], [0.0, 0.0, 1.0]));
    let Color::Texture(texture) = model.look(0).diffuse else { panic!("no texture") };
    assert_eq!(model.scene.textures[texture.index()].kind, TextureKind::VertexColor { tint: [1.0; 3] });
}

#[test]
fn mtl_plain_and_shiny() {
    let model = with_material("Kd 1 .5 0\nKs .25\nNs 20\nKa 1 1 1\n", &[]);
    let look = model.look(0);
    assert_eq!(look.diffuse, Color::Value([1.0, 0.5, 0.0]));
    assert_eq!((look.specular, look.shininess), (Color::gray(0.25), 20.0));
    assert_eq!((look.mirror, look.transmission, look.ambient), (Color::BLACK, Color::BLACK, None));
    let dull = with_material("Ks 1 1 1\nNs 20\nillum 1\n", &[]);
    assert_eq!(dull.look(0).specular, Color::BLACK);
    let even = with_material("Ks 1 1 1\nNs 0\nillum 2\n", &[]);
    assert_eq!(even.look(0).specular, Color::BLACK);
    let mirror = with_material("Ks .9 .9 .9\nNs 9\nillum 3\n", &[]);
    assert_eq!((mirror.look(0).mirror, mirror.look(0).fresnel), (Color::gray(0.9), false));
}

#[test]
fn mtl_lets_light_through() {
    let veil = with_material("Kd 1 1 1\nTr 0.75\nNi 1.5\n", &[]);
    assert_eq!(veil.look(0).diffuse, Color::gray(0.25));
    assert_eq!((veil.look(0).transmission, veil.look(0).ior), (Color::gray(0.75), 1.0));
    let glass = with_material("Kd 1 1 1\nd 1\nTf 1 .5 1\nNi 1.6\nillum 7\n", &[]);
    let look = glass.look(0);
    assert_eq!((look.diffuse, look.mirror), (Color::BLACK, Color::gray(1.0)));
    assert_eq!(look.transmission, Color::Value([1.0, 0.5, 1.0]));
    assert_eq!((look.ior, look.fresnel), (1.6, true));
    // `illum 4` without any transparency is an opaque thing in many files.
    assert_eq!(with_material("Kd 1 1 1\nd 1\nillum 4\n", &[]).look(0).diffuse, Color::gray(1.0));
}

#[test]
fn mtl_shines() {
    let lamp = with_material("Ke 3 2 1\n", &[]).parts[0].emission.unwrap();
    assert_eq!(lamp.radiance, Color::Value([3.0, 2.0, 1.0]));
    assert!(!lamp.two_sided, "as in glTF, pbrt and our own format");
    assert_eq!(with_material("Ke 0 0 0\n", &[]).parts[0].emission, None);
}

#[test]
fn mtl_pictures_are_multiplied_found_and_shared() {
    let mtl = "Kd .5 1 1\nmap_Kd -o 0.25 0.5 0 -s 2 3 -clamp on \"x\\my white.ppm\"\nmap_Ke white.ppm\n";
    let model = with_material(mtl, &[("d/my white.ppm", WHITE), ("d/white.ppm", WHITE)]);
    let (texels, scale, offset, wrap) = model.picture(model.look(0).diffuse);
    assert_eq!(texels, [[0.5, 1.0, 1.0]]);
    assert_eq!((scale, offset, wrap), ([2.0, 3.0], [0.25, 0.5], Wrap::Black));
    let (texels, scale, ..) = model.picture(model.parts[0].emission.unwrap().radiance);
    assert_eq!((texels, scale), (vec![[1.0; 3]], [1.0; 2]));
    // A black Kd is a sloppy exporter's.
    let model = with_material("Kd 0 0 0\nmap_Kd white.ppm\n", &[("d/white.ppm", WHITE)]);
    assert_eq!(model.picture(model.look(0).diffuse).0, [[1.0; 3]]);
    // The same picture with the same tint is read once.
    let obj = format!("mtllib m.mtl\n{TRIANGLE}usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\n");
    let mtl = b"newmtl a\nmap_Kd w.ppm\nnewmtl b\nmap_Kd ./w.ppm\nnewmtl unused\nmap_Kd no.ppm\n";
    let model = Model::of(&[("a.obj", obj.as_bytes()), ("m.mtl", mtl), ("w.ppm", WHITE)]);
    assert_eq!((model.scene.images.len(), model.scene.materials.len()), (1, 2));
    assert_eq!(model.warnings, [""; 0]);
}

/// A triangle of 3 × 4 over half of the picture, of material `m`.
fn pictured(mtl: &str, more: &[(&str, &[u8])]) -> Model {
    let obj = "mtllib m.mtl\nv 0 0 0\nv 3 0 0\nv 0 4 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3\n";
    let mtl = format!("newmtl m\n{mtl}");
    let mut files = vec![("a.obj", obj.as_bytes()), ("m.mtl", mtl.as_bytes())];
    files.extend(more);
    Model::of(&files)
}

/// A picture of one texel.
fn ppm(texel: [u8; 3]) -> Vec<u8> {
    [b"P6\n1 1\n255\n".as_slice(), &texel].concat()
}

#[test]
fn mtl_opacity_maps_cut_surfaces_out() {
    let (mask, clear) = (ppm([0, 51, 255]), encode_png_of([1, 1], Pixels::Rgba8(&[255, 255, 255, 51]), None));
    let clear = clear.unwrap();
    let files: [(&str, &[u8]); 2] = [("mask.ppm", &mask), ("clear.png", &clear)];
    for (map, channel) in [
        ("map_d mask.ppm", Channel::Rgb),
        ("map_d -imfchan g mask.ppm", Channel::Green),
        ("map_d clear.png", Channel::Alpha),
        ("map_d -imfchan l clear.png", Channel::Rgb),
        ("d 0\nmap_d mask.ppm", Channel::Rgb),
    ] {
        let model = pictured(&format!("Kd 1 0 0\n{map}\n"), &files);
        let (texels, found, scale) = model.number(model.parts[0].alpha.unwrap());
        assert_eq!((found, scale), (channel, 1.0), "{map}");
        // Opacities are numbers, not encoded colours.
        assert!(texels == [[0.0, 0.2, 1.0]] || texels == [[1.0; 3]], "{map}: {texels:?}");
        assert_eq!(model.look(0).diffuse, Color::Value([1.0, 0.0, 0.0]), "{map}");
        assert_eq!(model.warnings, [""; 0], "{map}");
    }
    // `d` lets light through besides.
    assert_eq!(pictured("Kd 1 1 1\nd 0.25\nmap_d mask.ppm\n", &files).look(0).diffuse, Color::gray(0.25));
    // A picture of colours is no opacity.
    let model = pictured("map_Kd mask.ppm\nmap_d mask.ppm\n", &files);
    assert_eq!(model.parts[0].alpha, None);
    assert!(model.warnings[0].contains("no alpha channel"), "{:?}", model.warnings);
}

#[test]
fn mtl_bump_and_normal_maps() {
    let (gray, blue) = (ppm([128; 3]), ppm([128, 128, 255]));
    let files: [(&str, &[u8]); 2] = [("gray.ppm", &gray), ("blue.ppm", &blue)];
    let heights = |mtl: &str| {
        let model = pictured(mtl, &files);
        let BumpMapping::Bump(heights) = model.material().bump_mapping else { panic!("{mtl}") };
        let (_, channel, scale) = model.number(heights);
        (channel, f64::from(scale))
    };
    // Slopes do not depend on the unit of the model: a unit of uv is as long as √12 here.
    let (channel, height) = heights("map_Bump -bm 2 gray.ppm\n");
    assert_eq!(channel, Channel::Rgb);
    assert!((height - 0.02 * 12_f64.sqrt()).abs() < 1e-6, "{height}");
    let (channel, repeated) = heights("bump -s 4 4 -bm 2 -imfchan r gray.ppm\n");
    assert_eq!(channel, Channel::Red);
    assert!((repeated - height / 4.0).abs() < 1e-6, "{repeated}");
    for (mtl, scale, warnings) in
        [("norm blue.ppm\n", 1.0, 0), ("map_Kn -bm 0.5 blue.ppm\n", 0.5, 0), ("map_Bump blue.ppm\n", 1.0, 1)]
    {
        let model = pictured(mtl, &files);
        let BumpMapping::NormalTexture(normals) = model.material().bump_mapping else { panic!("{mtl}") };
        assert_eq!((normals.scale, model.warnings.len()), (scale, warnings), "{mtl}");
    }
    // Without texture coordinates that span an area there is nothing to lay them on.
    let model = with_material("bump gray.ppm\n", &[("d/gray.ppm", &gray)]);
    assert_eq!(model.scene.materials[0].bump_mapping, BumpMapping::None);
}

#[test]
fn mtl_highlights_by_maps() {
    let half = ppm([51, 102, 153]);
    let model = pictured("Ks 1 1 1\nNs 50\nmap_Ns half.ppm\n", &[("half.ppm", &half)]);
    assert!((model.look(0).shininess - 20.0).abs() < 1e-4, "{}", model.look(0).shininess);
    let model = pictured("Ks 1 1 1\nNs 50\nmap_Ns -mm 0.5 0.5 -imfchan b half.ppm\n", &[("half.ppm", &half)]);
    assert!((model.look(0).shininess - 40.0).abs() < 1e-4, "{}", model.look(0).shininess);
}

#[test]
fn mtl_physically_based() {
    let parts = ppm([26, 128, 255]);
    let files: [(&str, &[u8]); 1] = [("p.ppm", &parts)];
    let model = pictured(
        "Kd .5 .5 .5\nPr 0.3\nPm 1\nPs 0.25\nPc 0.5\nPcr 0.1\naniso 0.8\nanisor 0.25\nNi 1.4\n",
        &[],
    );
    let look = model.principled();
    assert_eq!(look.base_color, Color::gray(0.5));
    assert_eq!((look.metallic, look.roughness), (Scalar::Value(1.0), Scalar::Value(0.3)));
    assert_eq!((look.clearcoat, look.clearcoat_roughness), (Scalar::Value(0.5), Scalar::Value(0.1)));
    assert_eq!((look.sheen_color, look.ior), (Color::gray(0.25), 1.4));
    let anisotropy = look.anisotropy.unwrap();
    assert_eq!(anisotropy.strength, 0.8);
    assert!((anisotropy.rotation - std::f32::consts::FRAC_PI_2).abs() < 1e-6);
    for (map, roughness, metallic) in
        [("map_ORM", Channel::Green, Channel::Blue), ("map_RMA", Channel::Red, Channel::Green)]
    {
        let model = pictured(&format!("Pr 1\nPm 0\n{map} p.ppm\n"), &files);
        let look = model.principled();
        assert_eq!(model.number(look.roughness).1, roughness, "{map}");
        assert_eq!(model.number(look.metallic).1, metallic, "{map}");
        assert_eq!(model.scene.images.len(), 1, "{map}");
    }
    let model = pictured("map_Pr p.ppm\nd 0.5\n", &files);
    let look = model.principled();
    assert_eq!((look.metallic, model.parts[0].alpha), (Scalar::Value(0.0), Some(Scalar::Value(0.5))));
    // Without a roughness, the highlight is as wide as that of `Ns`.
    let Scalar::Value(rough) = pictured("Pc 1\nNs 30\n", &[]).principled().roughness else { panic!() };
    assert!((rough - 0.5).abs() < 1e-6, "{rough}");
    // `Pm` and `Pr` alone stay a highlight of Whitted's model.
    assert!(matches!(pictured("Pm 1\nPr 0.2\n", &[]).material().kind, MaterialKind::Whitted(_)));
}

#[test]
fn mtl_misses_are_warned_of() {
    let model = with_material("Kd 1 0 0\nmap_Kd no.png\ndisp b.png\nNs many\nfoo\n", &[]);
    assert_eq!(model.look(0).diffuse, Color::Value([1.0, 0.0, 0.0]));
    assert_eq!(
        model.warnings,
        [
            "d/m.mtl:5: 1 line ignored: the values are not what the keyword expects",
            "d/m.mtl:6: 1 `(unknown)` statement ignored: not supported",
            "d/m.mtl:4: 1 `disp, decal` statement ignored: not supported",
            "d/m.mtl:3:8: texture `no.png`: no such file; the constant colour is used",
        ]
    );
}

#[test]
fn ply_of_all_types_in_all_formats_is_the_same() {
    let header = |format: &str| {
        format!(
            "ply\nformat {format} 1.0\nobj_info x\nelement extra 1\nproperty list uchar short l\nproperty double d\n\
             element vertex 4\nproperty double x\nproperty float32 y\nproperty int16 z\nproperty uint8 red\n\
             property uchar green\nproperty uchar blue\nproperty char alpha\n\
             element face 1\nproperty int flags\nproperty list uint16 uint32 vertex_index\n\
             element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
        )
        .into_bytes()
    };
    let points = [(0.5_f64, 0.25, -3_i16), (1.0, 0.0, 7), (1.0, 1.0, 0), (0.0, 1.0, -1)];
    let strip = [0_i32, 1, 2, 3, -1, 0, 1, 3];
    let mut ascii = header("ascii");
    ascii.extend(b"2 5 6 0.5\n");
    for (x, y, z) in points {
        ascii.extend(format!("{x} {y} {z} 255 0 128 0\n").bytes());
    }
    ascii.extend(b"0 4 0 1 2 3\n8 0 1 2 3 -1 0 1 3\n");
    let (mut little, mut big) = (header("binary_little_endian"), header("binary_big_endian"));
    macro_rules! put {
        ($($value:expr),*) => {$( little.extend($value.to_le_bytes()); big.extend($value.to_be_bytes()); )*};
    }
    put!(2_u8, 5_i16, 6_i16, 0.5_f64);
    for (x, y, z) in points {
        put!(x, y as f32, z, 255_u8, 0_u8, 128_u8, 0_i8);
    }
    put!(0_i32, 4_u16, 0_u32, 1_u32, 2_u32, 3_u32, 8_i32);
    for index in strip {
        put!(index);
    }
    let expected = Model::of(&[("a.ply", &ascii)]);
    let mesh = expected.mesh(0);
    assert_eq!(mesh.positions[0], Vec3::new(0.5, 0.25, -3.0));
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 2], [2, 1, 3], [0, 1, 3]]);
    assert_eq!(mesh.colors[0][..2], [1.0, 0.0]);
    assert!((mesh.colors[0][2] - 0.215_861).abs() < 1e-6);
    for bytes in [little, big] {
        let model = Model::of(&[("a.ply", &bytes)]);
        let other = model.mesh(0);
        assert_eq!(
            (&other.positions, &other.triangles, &other.colors),
            (&mesh.positions, &mesh.triangles, &mesh.colors)
        );
    }
}

#[test]
fn ply_pictures_with_coordinates_at_corners() {
    let ply = b"ply\nformat ascii 1.0\ncomment TextureFile white.ppm\nelement vertex 4\nproperty float x\nproperty float y\n\
        property float z\nelement face 2\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\n\
        end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 6 0 0 1 0 1 1\n3 0 2 3 6 0 0 0.5 0.5 0 1\n";
    let model = Model::of(&[("a.ply", ply), ("white.ppm", WHITE)]);
    let mesh = model.mesh(0);
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 3, 4]]);
    assert_eq!(mesh.uvs[3], Vec2::splat(0.5));
    assert_eq!(model.picture(model.look(0).diffuse).0, [[1.0; 3]]);
}

/// As MeshLab writes what was photographed: a picture for each face.
#[test]
fn ply_faces_of_several_pictures_are_several_parts() {
    let ply = "ply\nformat ascii 1.0\ncomment TextureFile white.ppm\ncomment TextureFile red.ppm\nelement vertex 4\nproperty float x\n\
        property float y\nproperty float z\nelement face 3\nproperty list uchar int vertex_indices\n\
        property list uchar float texcoord\nproperty int texnumber\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n\
        3 0 1 2 6 0 0 1 0 1 1 1\n3 0 2 3 6 0 0 1 1 0 1 0\n3 0 1 3 6 0 0 1 0 0 1 -1\n";
    let red = ppm([255, 0, 0]);
    let model = Model::of(&[("a.ply", ply.as_bytes()), ("white.ppm", WHITE), ("red.ppm", &red)]);
    assert_eq!(model.warnings, [""; 0]);
    let texels = |part: usize| model.picture(model.look(part).diffuse).0;
    assert_eq!((texels(0), texels(1)), (vec![[1.0; 3]], vec![[1.0, 0.0, 0.0]]));
    assert_eq!((model.parts.len(), model.parts[2].material), (3, None));
    for part in 0..3 {
        assert_eq!((model.mesh(part).positions.len(), model.mesh(part).triangles.len()), (3, 1));
    }
    assert_eq!(model.mesh(1).positions[2], Vec3::new(1.0, 1.0, 0.0));
}

#[test]
fn stl_text_and_binary_weld_the_same() {
    let facets = [
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        [[1.0, 0.0, -0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
    ];
    let mut text = String::from("SOLID two words\n");
    // The header of a binary file may begin as a text.
    let mut binary = b"solid facet".to_vec();
    binary.resize(80, b' ');
    binary.extend(2_u32.to_le_bytes());
    for facet in facets {
        text += "Facet Normal 0 0 1\nouter loop\n";
        binary.extend([0; 12]);
        for [x, y, z] in facet {
            text += &format!("vertex {x:e} {y} {z:.3}\n");
            binary.extend([x, y, z].into_iter().flat_map(|value: f32| value.to_le_bytes()));
        }
        text += "endloop\nendfacet\n";
        binary.extend([0, 0]);
    }
    text += "endsolid";
    for (name, bytes) in [("a.stl", text.as_bytes()), ("a.stl", &binary), ("a", &binary), ("a.obj", &binary)]
    {
        let model = Model::of(&[(name, bytes)]);
        assert_eq!(model.mesh(0).triangles, [[0, 1, 2], [1, 3, 2]]);
        assert_eq!(model.mesh(0).normals, []);
        assert_eq!(model.parts[0].name.is_some(), bytes[0] == b'S');
        assert_eq!(model.warnings, [""; 0]);
    }
}

#[test]
fn stl_colours_in_both_dialects() {
    let file = |header: &[u8], attribute: u16| {
        let mut bytes = header.to_vec();
        bytes.resize(80, b' ');
        bytes.extend(1_u32.to_le_bytes());
        let values = [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0_f32];
        bytes.extend(values.into_iter().flat_map(f32::to_le_bytes));
        bytes.extend(attribute.to_le_bytes());
        Model::of(&[("a.stl", &bytes)]).mesh(0).colors.first().copied()
    };
    let (red, blue) = (Some([1.0, 0.0, 0.0]), Some([0.0, 0.0, 1.0]));
    assert_eq!(file(b"VisCAM", 1 << 15 | 31 << 10), red);
    assert_eq!(file(b"VisCAM", 1 << 15 | 31), blue);
    assert_eq!(file(b"VisCAM", 31 << 10), None);
    assert_eq!(file(b"COLOR=\xff\0\0\xff", 31 << 10), blue);
    assert_eq!(file(b"COLOR=\xff\0\0\xff", 1 << 15), red);
    // Attributes without a colour in them are none, whatever their bit of validity says.
    assert_eq!(file(b"COLOR=\0\0\0\xff", 0), None);
    assert_eq!(file(b"COLOR=\xff\0\0\xff", 0), red);
    assert_eq!(file(b"VisCAM", 1 << 15), None);
    assert_eq!(file(b"VisCAM", 0), None);
}

#[test]
fn ply_colours_of_faces_and_rows_that_are_too_long() {
    let ply = b"ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
        element face 2\nproperty list uchar int vertex_indices\nproperty uchar red\nproperty uchar green\n\
        property uchar blue\nend_header\n0 0 0 9 9\n1 0 0\n1 1 0\n0 1 0 7\n3 0 1 2 255 0 0\n3 0 2 3 0 0 255 255\n";
    let model = Model::of(&[("a.ply", ply)]);
    let mesh = model.mesh(0);
    assert_eq!(mesh.triangles, [[0, 1, 2], [3, 4, 5]]);
    assert_eq!((mesh.colors[0], mesh.colors[4]), ([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]));
    assert!(
        model.warnings[0].contains("3 rows with more values than the header declares"),
        "{:?}",
        model.warnings
    );
}

#[test]
fn mtl_tr_means_what_its_writer_means() {
    let covers = |mtl: &str| {
        let model = with_material(mtl, &[]);
        let Color::Value([r, ..]) = model.look(0).diffuse else { panic!("not a constant") };
        (r, model.warnings.join("\n"))
    };
    assert_eq!(covers("Kd 1 1 1\nTr 0.75\n").0, 0.25);
    assert_eq!(
        covers("# Wavefront material file\n# Converted by Meshlab Group\nKd 1 1 1\nTr 0.75\n").0,
        0.75
    );
    assert_eq!(covers("Kd 1 1 1\nTr 1\n").0, 1.0);
    assert_eq!(covers("Kd 1 1 1\nd 0.5\nTr 1\n").0, 0.5);
    let (invisible, warnings) = covers("Kd 1 1 1\nd 0\n");
    assert!(invisible == 0.0 && warnings.contains("every material is fully transparent"), "{warnings}");
}

#[test]
fn obj_corners_without_their_attributes() {
    for corners in ["1//1 2//2 3//3", "1/4 2/5 3/6", "1/1/1 2/2/2 3/3/3", "1//-1 2//-2 3//-3"] {
        let obj = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nf {corners}\n");
        let model = Model::of(&[("a.obj", obj.as_bytes())]);
        assert_eq!(model.mesh(0).triangles, [[0, 1, 2]]);
        assert!(model.mesh(0).uvs.is_empty());
        assert!(model.warnings[0].contains("but the file has none"), "{:?}", model.warnings);
    }
}

proptest! {
    /// What is written as PLY comes back bit by bit, at any scale.
    #[test]
    fn ply_round_trip(
        vertices in prop::collection::vec((any::<[u32; 3]>(), any::<[f32; 2]>()), 3..20),
        corners in prop::collection::vec(any::<[prop::sample::Index; 3]>(), 1..20),
        (normals, uvs, colors) in any::<(bool, bool, bool)>(),
    ) {
        let n = vertices.len();
        let finite = |bits: u32| Some(f32::from_bits(bits)).filter(|value| value.is_finite()).unwrap_or(1.5);
        let positions: Vec<Vec3> = vertices.iter().map(|(bits, _)| Vec3::from_array(bits.map(finite))).collect();
        let triangles: Vec<[u32; 3]> = corners.iter().map(|c| c.map(|index| index.index(n) as u32)).collect();
        let has_area = |triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|vertex| positions[vertex as usize].as_dvec3());
            (b - a).cross(c - a) != glam::DVec3::ZERO
        };
        let triangles: Vec<_> = triangles.into_iter().filter(has_area).collect();
        prop_assume!(!triangles.is_empty());
        let mesh = Mesh {
            triangles,
            normals: if normals { positions.clone() } else { Vec::new() },
            uvs: if uvs { vertices.iter().map(|(_, uv)| Vec2::from_array(*uv)).collect() } else { Vec::new() },
            colors: if colors { positions.iter().map(|p| p.abs().to_array()).collect() } else { Vec::new() },
            positions,
            ..Mesh::default()
        };
        let model = Model::of(&[("a.ply", &ply::write(&mesh))]);
        let back = model.mesh(0);
        prop_assert_eq!(format!("{:?}", (&back.positions, &back.triangles, &back.normals, &back.uvs, &back.colors)),
            format!("{:?}", (&mesh.positions, &mesh.triangles, &mesh.normals, &mesh.uvs, &mesh.colors)));
    }
}

#[test]
fn obj_lines_are_wires() {
    let wires = |part: &Part| match &part.geometry {
        Geometry::Curves(strands) => strands.iter().map(|s| [s.points[0], s.points[3]]).collect::<Vec<_>>(),
        other => panic!("no wires: {other:?}"),
    };
    let [o, x, y] = [Vec3::ZERO, Vec3::X, Vec3::Y];
    // A closed loop, without faces; indices of texture coordinates that are not there do not matter.
    let bare = Model::of(&[("a.obj", format!("{TRIANGLE}l 1/1 2/2 3 -3\nl 2\nl 2 2\n").as_bytes())]);
    assert_eq!(wires(&bare.parts[0]), [[o, x], [x, y], [y, o]]);
    assert_eq!(bare.parts.len(), 1);

    // Beside faces, with the material in use.
    let obj = format!("mtllib m.mtl\n{TRIANGLE}usemtl m\nf 1 2 3\nusemtl n\nl 1 3\n");
    let both = Model::of(&[("a.obj", obj.as_bytes()), ("m.mtl", b"newmtl m\nnewmtl n\nKd 1 0 0\n")]);
    assert_eq!(wires(&both.parts[1]), [[o, y]]);
    assert_eq!(both.look(1).diffuse, Color::Value([1.0, 0.0, 0.0]));

    // With colours at the vertices: a wire has the mean of its ends.
    let colored = "v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 0 0 1\nv 1 1 0 0 0 1\nl 1 2\nl 3 4\n";
    let colored = Model::of(&[("a.obj", colored.as_bytes())]);
    let mut colors: Vec<Color> = (0..2).map(|part| colored.look(part).diffuse).collect();
    colors.sort_by_key(|color| *color == Color::Value([0.0, 0.0, 1.0]));
    assert_eq!(colors, [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]].map(Color::Value));
}

#[test]
fn ply_splats_are_coloured_points() {
    let names = ["x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity"];
    let properties: String = names.iter().map(|name| format!("property float {name}\n")).collect();
    let ply = format!(
        "ply\nformat ascii 1.0\nelement vertex 2\n{properties}end_header\n0 0 0 9 0 -9 1\n1 0 0 9 0 -9 1\n"
    );
    let cloud = Model::of(&[("a.ply", ply.as_bytes())]);
    assert!(matches!(&cloud.parts[0].geometry, Geometry::Spheres(spheres) if spheres.len() == 2));
    let Color::Value([red, green, blue]) = cloud.look(0).diffuse else { panic!("no colour") };
    assert!(red == 1.0 && blue == 0.0 && (green - 0.214).abs() < 1e-3, "{green}: half of 1, encoded");
    assert!(cloud.warnings[0].contains("Gaussian splats"), "{:?}", cloud.warnings);
}

#[test]
fn ply_edges_without_faces_are_wires() {
    let header =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
    let vertices = "0 0 0\n1 0 0\n0 1 0\n";
    let edge = "property int vertex1\nproperty int vertex2\n";
    let of = |file: &str| Model::of(&[("a.ply", file.as_bytes())]);
    let wires = |model: &Model, part: usize| match &model.parts[part].geometry {
        Geometry::Curves(strands) => {
            strands.iter().map(|strand| [strand.points[0], strand.points[3]]).collect::<Vec<_>>()
        }
        other => panic!("no wires: {other:?}"),
    };

    let plain = of(&format!("{header}element edge 3\n{edge}end_header\n{vertices}0 1\n1 2\n2 2\n"));
    assert_eq!((plain.parts.len(), plain.parts[0].material), (1, None));
    assert_eq!(wires(&plain, 0), [[Vec3::ZERO, Vec3::X], [Vec3::X, Vec3::Y]]);
    assert_eq!(plain.warnings, [""; 0]);

    let rgb = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    let rows = "0 1 255 0 0\n1 2 0 0 255\n";
    let colored = of(&format!("{header}element edge 2\n{edge}{rgb}end_header\n{vertices}{rows}"));
    assert_eq!(colored.parts.len(), 2);
    let mut colors = [colored.look(0).diffuse, colored.look(1).diffuse];
    colors.sort_by_key(|color| *color != Color::Value([1.0, 0.0, 0.0]));
    assert_eq!(colors, [Color::Value([1.0, 0.0, 0.0]), Color::Value([0.0, 0.0, 1.0])]);

    // Colours of vertices are those of their edges, too.
    let vertices_rgb = "0 0 0 255 0 0\n1 0 0 255 0 0\n0 1 0 0 0 255\n";
    let colored = of(&format!("{header}{rgb}element edge 1\n{edge}end_header\n{vertices_rgb}0 2\n"));
    assert_eq!(colored.look(0).diffuse, Color::Value([0.5, 0.0, 0.5]));

    let strays = of(&format!("{header}element edge 4\n{edge}end_header\n{vertices}0 1\n0 3\n-1 0\n2 1\n"));
    assert_eq!(wires(&strays, 0), [[Vec3::ZERO, Vec3::X], [Vec3::Y, Vec3::X]]);
    assert_eq!(strays.warnings, ["a.ply: 2 edges left out: there is no vertex of this index"]);

    // Beside faces, edges are only the outlines of these.
    let face = "element face 1\nproperty list uchar int vertex_indices\n";
    let both = of(&format!("{header}{face}element edge 1\n{edge}end_header\n{vertices}3 0 1 2\n0 1\n"));
    assert_eq!((both.parts.len(), both.mesh(0).triangles.len()), (1, 1));
    // Without ends there are no edges: the vertices are points.
    let other = of(&format!("{header}element edge 1\nproperty int length\nend_header\n{vertices}7\n"));
    assert!(matches!(&other.parts[0].geometry, Geometry::Spheres(spheres) if spheres.len() == 3));
}

/// The first triangles of the pieces of a part, and their names.
fn pieces(part: &Part) -> Vec<(u32, Option<&str>)> {
    part.pieces.iter().map(|piece| (piece.first, piece.name.as_deref())).collect()
}

#[test]
fn objects_of_obj_files_are_pieces_of_the_meshes_of_their_materials() {
    let positions = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    let of = |statements: &str| Model::of(&[("a.obj", &[positions, statements.as_bytes()].concat())]);
    // Quadrilaterals are two triangles each; a face without area is none.
    let model = of("usemtl red\nf 1 2 3\no Table top\nf 1 2 3 4\nusemtl blue\nf 1 2 3\nf 1 1 2\n\
                    o Lämpe\nf 2 3 4\nusemtl red\nf 1 2 4\no Table top\nf 2 3 4\no Gone\nf 1 1 2\n");
    let expected = [(1, Some("Table top")), (3, Some("Lämpe")), (4, Some("Table top"))];
    assert_eq!(pieces(&model.parts[0]), expected);
    assert_eq!(pieces(&model.parts[1]), [(0, Some("Table top")), (1, Some("Lämpe"))]);
    assert_eq!(model.parts[0].name.as_deref(), Some("red"));
    // Groups are objects only where nothing says what is one.
    let model = of("g leg\nf 1 2 3\ng\nf 1 2 4\no Chair\ng seat\nf 1 3 4\ng back\nf 2 3 4\n");
    assert_eq!(pieces(&model.parts[0]), [(0, Some("leg")), (1, None), (2, Some("Chair"))]);
    assert_eq!(pieces(&of("f 1 2 3\n").parts[0]), []);
}

#[test]
fn subdivided_objects_keep_their_names() {
    let files = Memory(HashMap::from([(
        PathBuf::from("a.obj"),
        b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\no a\nf 1 2 3 4\no b\nf 2 5 6 3\n".to_vec(),
    )]));
    let mut context = LoadContext::new(&files);
    context.import.subdivision = 2;
    let parts = model::read(Path::new("a.obj"), &mut context, &mut Scene::default()).unwrap();
    assert_eq!(pieces(&parts[0]), [(0, Some("a")), (32, Some("b"))]);
}
