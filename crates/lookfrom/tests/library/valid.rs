//! Scenes that no reader has made: with any one id, number or length replaced, a scene is refused or renders.

use std::path::Path;

use glam::{DMat4, DVec3, Vec3};
use lookfrom::render::Renderer;
use lookfrom::world::World;
use lookfrom_scene::camera::{Camera, Projection};
use lookfrom_scene::light::{LightKind, Sky};
use lookfrom_scene::material::{
    BumpMapping, Coat, Color, Ior, MaterialKind, Metal, Pigment, Roughness, Scalar, SubsurfaceMedium, Tint,
};
use lookfrom_scene::medium::Extinction;
use lookfrom_scene::scene::{Instance, MaterialId, MeshId, ObjectId, Scene};
use lookfrom_scene::shape::{Geometry, Mesh, Profile, Shape, Sphere};
use lookfrom_scene::spectrum::Curve;
use lookfrom_scene::texture::{Mapping, MipFilter, TexelFilter, TextureKind};
use lookfrom_scene::{Error, ErrorKind, LoadContext, Location, Memory, Result};
use proptest::prelude::*;

use crate::support::own_scene;

/// The kinds of shapes, materials and media that the repository's scenes lack.
const OF_PBRT: &str = r#"
    LookAt 0 1 6  0 0 0  0 1 0
    Camera "perspective" "float fov" 40 "float lensradius" 0.1
    Integrator "volpath"
    WorldBegin
    LightSource "spot" "spectrum I" [400 1 700 2] "point3 from" [0 5 0]
    LightSource "distant" "blackbody L" 5000
    MakeNamedMedium "fog" "string type" "homogeneous" "rgb sigma_a" [0.1 0.2 0.3]
    Texture "noise" "spectrum" "marble"
    Texture "bumps" "float" "fbm"
    Texture "both" "spectrum" "mix" "texture tex1" "noise" "rgb tex2" [1 0 0]
    MakeNamedMaterial "a" "string type" "coateddiffuse" "texture reflectance" "both" "texture displacement" "bumps"
    MakeNamedMaterial "b" "string type" "coatedconductor"
    MakeNamedMaterial "mixed" "string type" "mix" "string materials" ["a" "b"] "float amount" 0.3
    NamedMaterial "mixed"
    Shape "cylinder" "float phimax" 200
    Shape "sphere" "float zmin" -0.5
    AttributeBegin
        AreaLightSource "diffuse" "rgb L" [1 2 3]
        Shape "disk" "float innerradius" 0.2 "float height" 2
        Shape "bilinearmesh" "point3 P" [0 0 0  1 0 0  0 1 0  1 1 1] "normal N" [0 0 1  0 0 1  0 0 1  0 0 1] "float alpha" 0.5
    AttributeEnd
    Material "diffusetransmission"
    Shape "curve" "string type" "ribbon" "point3 P" [0 0 0  1 0 0  1 1 0  2 1 1] "normal N" [0 0 1 0 1 1]
    Material "dielectric" "spectrum eta" "glass-BK7" "float uroughness" 0.1
    MediumInterface "fog" ""
    Shape "trianglemesh" "point3 P" [0 0 2  1 0 2  0 1 2] "point2 uv" [0 0 1 0 0 1] "integer indices" [0 1 2]
    ObjectBegin "thing"
        Material "conductor"
        Shape "sphere" "float radius" 0.2
    ObjectEnd
    ObjectInstance "thing"
"#;

/// The scenes that are corrupted, small and quick to render.
fn scenes() -> Vec<(String, Scene)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let files = std::fs::read_dir(folder).expect("the repository has scenes");
    let mut names: Vec<String> =
        files.map(|file| file.expect("readable").file_name().into_string().expect("UTF-8")).collect();
    names.retain(|name| name.ends_with(".toml"));
    names.sort();
    let memory = Memory([("all.pbrt".into(), OF_PBRT.as_bytes().to_vec())].into());
    let of_pbrt =
        lookfrom_scene::load::scene(Path::new("all.pbrt"), &mut LoadContext::new(&memory)).expect("valid");
    let own = names.into_iter().map(|name| (name.clone(), own_scene(&name)));
    let mut measured = of_pbrt.clone();
    let has_area = |shape: &&mut Shape| !matches!(shape.geometry, Geometry::Curves(_));
    measured.shapes.iter_mut().filter(has_area).for_each(|shape| shape.name = Some("measured".to_owned()));
    let projection = Projection::Irradiance { surface: "measured".to_owned() };
    measured.camera = Some(Camera { projection, ..Camera::default() });
    own.chain([("all.pbrt".to_owned(), of_pbrt), ("measured".to_owned(), measured)])
        .map(|(name, scene)| (name, small(scene)))
        .collect()
}

/// The scene with a picture of 4 × 4 pixels.
fn small(mut scene: Scene) -> Scene {
    (scene.image.width, scene.image.height, scene.image.crop) = (4, 4, None);
    scene.render.samples = 1;
    scene
}

fn render(scene: Scene) -> Result<()> {
    Renderer::of_scene(scene, &mut Vec::new())?.render(Some(1), &()).map(|_| ())
}

/// The ids, counts and numbers of a scene: of large arrays the first.
#[derive(Default)]
struct Places<'a> {
    whole: Vec<&'a mut u32>,
    single: Vec<&'a mut f32>,
    double: Vec<&'a mut f64>,
}

impl<'a> Places<'a> {
    fn of(scene: &'a mut Scene) -> Self {
        let mut places = Self::default();
        let p = &mut places;
        if let Some(camera) = &mut scene.camera {
            p.double.push(&mut camera.distance);
            p.whole.extend(camera.medium.as_mut().map(|id| &mut id.0));
            p.double.extend(camera.lens.as_mut().map(|lens| &mut lens.radius));
        }
        p.single.extend([&mut scene.image.exposure, &mut scene.image.sensor.max_component]);
        p.single.extend(&mut scene.image.filter.radius);
        for material in &mut scene.materials {
            p.bump_mapping(&mut material.bump_mapping);
            p.material(&mut material.kind);
        }
        for texture in &mut scene.textures {
            p.texture(&mut texture.kind);
        }
        for medium in &mut scene.media {
            let (Extinction::Parts { absorption: first, scattering: second }
            | Extinction::Sum { sum: first, albedo: second }) = &mut medium.extinction;
            p.color(first);
            p.color(second);
            p.single.push(&mut medium.scale);
        }
        for curve in &mut scene.curves {
            match curve {
                Curve::Constant(value) | Curve::Blackbody { kelvin: value } => p.single.push(value),
                Curve::Tabulated { wavelengths, values } => {
                    p.single.extend(wavelengths.iter_mut().chain(values).take(3));
                }
            }
        }
        for image in &mut scene.images {
            p.whole.extend([&mut image.width, &mut image.height]);
        }
        for mesh in &mut scene.meshes {
            p.whole.extend(mesh.triangles.as_flattened_mut().first_mut());
            p.single.extend(mesh.positions.first_mut().map(|v| &mut v.x));
            p.single.extend(mesh.normals.first_mut().map(|v| &mut v.x));
            p.single.extend(mesh.uvs.first_mut().map(|v| &mut v.x));
        }
        scene.shapes.iter_mut().for_each(|shape| p.shape(shape));
        scene.objects.iter_mut().flat_map(|object| &mut object.shapes).for_each(|shape| p.shape(shape));
        for instance in &mut scene.instances {
            p.whole.push(&mut instance.object.0);
            p.whole.extend(instance.material.as_mut().map(|id| &mut id.0));
            p.matrix(&mut instance.world_from_object);
        }
        for light in &mut scene.lights {
            p.single.push(&mut light.power.scale);
            p.single.extend(&mut light.power.total);
            p.light(&mut light.kind);
        }
        places
    }

    fn color(&mut self, color: &'a mut Color) {
        match color {
            Color::Value(rgb) => self.single.push(&mut rgb[1]),
            Color::Texture(id) => self.whole.push(&mut id.0),
            Color::Curve(id) => self.whole.push(&mut id.0),
        }
    }

    fn scalar(&mut self, scalar: &'a mut Scalar) {
        match scalar {
            Scalar::Value(value) => self.single.push(value),
            Scalar::Texture(id) => self.whole.push(&mut id.0),
        }
    }

    fn matrix(&mut self, matrix: &'a mut DMat4) {
        self.double.extend([&mut matrix.x_axis.x, &mut matrix.w_axis.y]);
    }

    fn vector(&mut self, vector: &'a mut DVec3) {
        self.double.extend([&mut vector.x, &mut vector.y, &mut vector.z]);
    }

    fn bump_mapping(&mut self, mapping: &'a mut BumpMapping) {
        match mapping {
            BumpMapping::None => {}
            BumpMapping::Bump(heights) => self.scalar(heights),
            BumpMapping::NormalMap(image) => self.whole.push(&mut image.0),
            BumpMapping::NormalTexture(normals) => {
                self.whole.push(&mut normals.texture.0);
                self.single.push(&mut normals.scale);
            }
        }
    }

    fn roughness(&mut self, Roughness { u, v, .. }: &'a mut Roughness) {
        self.scalar(u);
        self.scalar(v);
    }

    fn tint(&mut self, Tint { reflectance, transmittance }: &'a mut Tint) {
        self.color(reflectance);
        self.color(transmittance);
    }

    fn ior(&mut self, ior: &'a mut Ior) {
        match ior {
            Ior::Value(value) => self.single.push(value),
            Ior::Curve(id) => self.whole.push(&mut id.0),
        }
    }

    fn coat(&mut self, coat: &'a mut Coat) {
        self.ior(&mut coat.eta);
        self.roughness(&mut coat.roughness);
        self.scalar(&mut coat.thickness);
        self.color(&mut coat.albedo);
        self.scalar(&mut coat.g);
        self.whole.extend([&mut coat.max_depth, &mut coat.samples]);
    }

    fn metal(&mut self, metal: &'a mut Metal) {
        match metal {
            Metal::Indices { eta, k, .. } => [eta, k].into_iter().for_each(|color| self.color(color)),
            Metal::Reflectance(color) => self.color(color),
        }
    }

    fn material(&mut self, kind: &'a mut MaterialKind) {
        match kind {
            MaterialKind::Whitted(k) => {
                [&mut k.diffuse, &mut k.specular, &mut k.mirror].into_iter().for_each(|c| self.color(c));
                self.single.extend([&mut k.shininess, &mut k.ior, &mut k.absorption[0]]);
            }
            MaterialKind::Diffuse { reflectance: color } | MaterialKind::Unlit { color } => self.color(color),
            MaterialKind::DiffuseTransmission { reflectance, transmittance, scale } => {
                self.color(reflectance);
                self.color(transmittance);
                self.single.push(scale);
            }
            MaterialKind::Conductor { metal, roughness, specular_reflectance, .. } => {
                self.metal(metal);
                self.color(specular_reflectance);
                self.roughness(roughness);
            }
            MaterialKind::Dielectric { eta, roughness, tint, .. } => {
                self.ior(eta);
                self.roughness(roughness);
                self.tint(tint);
            }
            MaterialKind::ThinDielectric { eta, tint } => {
                self.ior(eta);
                self.tint(tint);
            }
            MaterialKind::CoatedDiffuse { reflectance, coat } => {
                self.color(reflectance);
                self.coat(coat);
            }
            MaterialKind::CoatedConductor { metal, roughness, coat } => {
                self.metal(metal);
                self.roughness(roughness);
                self.coat(coat);
            }
            MaterialKind::Plastic(plastic) => {
                self.color(&mut plastic.reflectance);
                self.color(&mut plastic.specular_reflectance);
                self.single.extend([&mut plastic.eta, &mut plastic.alpha]);
            }
            MaterialKind::Mix { materials, amount } => {
                self.whole.extend(materials.iter_mut().map(|id| &mut id.0));
                self.scalar(amount);
            }
            MaterialKind::Principled(look) => {
                self.color(&mut look.base_color);
                self.scalar(&mut look.roughness);
                self.single.extend([&mut look.ior, &mut look.dispersion, &mut look.absorption[2]]);
            }
            MaterialKind::OpenPbr(look) => {
                [&mut look.base_color, &mut look.coat_color].into_iter().for_each(|color| self.color(color));
                self.scalar(&mut look.specular_roughness);
                self.scalar(&mut look.coat_weight);
                self.single.extend([&mut look.specular_ior, &mut look.coat_ior, &mut look.dispersion]);
            }
            MaterialKind::Disney(look) => {
                self.color(&mut look.base_color);
                [&mut look.eta, &mut look.sheen, &mut look.diff_trans]
                    .into_iter()
                    .for_each(|n| self.scalar(n));
            }
            MaterialKind::Subsurface(below) => {
                let (SubsurfaceMedium::Coefficients { absorption: first, scattering: second }
                | SubsurfaceMedium::Reflectance { reflectance: first, mean_free_path: second }) =
                    &mut below.medium;
                self.color(first);
                self.color(second);
                self.single.extend([&mut below.scale, &mut below.g, &mut below.eta]);
                self.roughness(&mut below.roughness);
            }
            MaterialKind::Hair(hair) => {
                match &mut hair.pigment {
                    Pigment::Absorption(color) | Pigment::Reflectance(color) => self.color(color),
                    Pigment::Melanin { eumelanin, pheomelanin } => {
                        self.scalar(eumelanin);
                        self.scalar(pheomelanin);
                    }
                }
                let numbers = [&mut hair.eta, &mut hair.beta_m, &mut hair.beta_n, &mut hair.alpha];
                numbers.into_iter().for_each(|number| self.scalar(number));
            }
            MaterialKind::ShadowCatcher { normal } => self.single.push(&mut normal.y),
            MaterialKind::Measured(_) | MaterialKind::Interface => {}
        }
    }

    fn mapping(&mut self, mapping: &'a mut Mapping) {
        match mapping {
            Mapping::Uv { scale, offset } => self.single.extend([&mut scale[0], &mut offset[1]]),
            Mapping::Affine { set, matrix } => {
                self.whole.push(set);
                self.single.push(&mut matrix[1][2]);
            }
            Mapping::Spherical { texture_from_world }
            | Mapping::Cylindrical { texture_from_world }
            | Mapping::Planar { texture_from_world, .. }
            | Mapping::World { texture_from_world } => self.matrix(texture_from_world),
        }
    }

    fn texture(&mut self, kind: &'a mut TextureKind) {
        match kind {
            TextureKind::Image { image, mapping, scale, filter, .. } => {
                self.whole.push(&mut image.0);
                self.single.push(scale);
                if let TexelFilter::Mip { filter, footprint } = filter {
                    self.single.push(footprint);
                    if let MipFilter::Ewa { anisotropy } = filter {
                        self.single.push(anisotropy);
                    }
                }
                self.mapping(mapping);
            }
            TextureKind::Checker { even: a, odd: b, footprint, mapping } => {
                self.color(a);
                self.color(b);
                self.single.push(footprint);
                self.mapping(mapping);
            }
            TextureKind::Dots { inside: a, outside: b, mapping } => {
                self.color(a);
                self.color(b);
                self.mapping(mapping);
            }
            TextureKind::Noise { low: a, high: b, octaves, mapping }
            | TextureKind::Marble { vein: a, base: b, octaves, mapping, .. } => {
                self.color(a);
                self.color(b);
                self.whole.push(octaves);
                self.mapping(mapping);
            }
            TextureKind::Fbm { octaves, footprint, mapping, .. }
            | TextureKind::Wrinkled { octaves, footprint, mapping, .. }
            | TextureKind::PbrtMarble { octaves, footprint, mapping, .. } => {
                self.whole.push(octaves);
                self.single.push(footprint);
                self.mapping(mapping);
            }
            TextureKind::Scale { color, by: scalar } => {
                self.color(color);
                self.scalar(scalar);
            }
            TextureKind::Mix { low, high, amount } => {
                self.color(low);
                self.color(high);
                self.scalar(amount);
            }
            TextureKind::Bilinear { corners, .. } => corners.iter_mut().for_each(|color| self.color(color)),
            TextureKind::DirectionMix { low: a, high: b, .. }
            | TextureKind::Sides { outside: a, inside: b }
            | TextureKind::Product { a, b } => {
                self.color(a);
                self.color(b);
            }
            TextureKind::VertexColor { tint } => self.single.push(&mut tint[0]),
            TextureKind::Threshold { value, .. } => self.scalar(value),
            TextureKind::Quotient { a, b } => {
                self.scalar(a);
                self.scalar(b);
            }
            TextureKind::Windy { footprint, .. } => self.single.push(footprint),
            TextureKind::VertexAlpha => {}
        }
    }

    fn shape(&mut self, shape: &'a mut Shape) {
        self.whole.push(&mut shape.material.0);
        shape.alpha.iter_mut().for_each(|alpha| self.scalar(alpha));
        if let Some(sides) = &mut shape.sides {
            self.whole
                .extend([&mut sides.inside, &mut sides.outside].into_iter().flatten().map(|id| &mut id.0));
        }
        if let Some(emission) = &mut shape.emission {
            self.color(&mut emission.radiance);
            self.single.push(&mut emission.power.scale);
        }
        self.matrix(&mut shape.world_from_object);
        match &mut shape.geometry {
            Geometry::Sphere(Sphere { center, radius }) => {
                self.vector(center);
                self.double.push(radius);
            }
            Geometry::Quad { edge_u, edge_v, .. } => {
                [edge_u, edge_v].into_iter().for_each(|v| self.vector(v));
            }
            Geometry::Disk { normal, radius, .. } => {
                self.vector(normal);
                self.double.push(radius);
            }
            Geometry::Mesh(MeshId(id)) => self.whole.push(id),
            Geometry::PartialSphere { radius, z, phi_max } | Geometry::Cylinder { radius, z, phi_max } => {
                self.double.extend([radius, &mut z[0], phi_max]);
            }
            Geometry::PartialDisk { height, radius, inner_radius, phi_max } => {
                self.double.extend([height, radius, inner_radius, phi_max]);
            }
            Geometry::Torus { radius, tube } => self.double.extend([radius, tube]),
            Geometry::SolidSurface { body, .. } => self.whole.push(body),
            Geometry::Spheres(spheres) => {
                // Of millions of spheres that are shared: a copy of the first few.
                *spheres = spheres.iter().take(4).copied().collect();
                let first = std::sync::Arc::get_mut(spheres).and_then(|spheres| spheres.first_mut());
                self.double.extend(first.map(|sphere| &mut sphere.radius));
            }
            Geometry::Bilinear(patches) => {
                let patches = std::sync::Arc::make_mut(patches);
                self.whole.push(&mut patches.patches[0][3]);
                self.single.push(&mut patches.positions[0].z);
            }
            Geometry::Curves(strands) => {
                *strands = strands.iter().copied().collect();
                for strand in std::sync::Arc::get_mut(strands).into_iter().flatten().take(1) {
                    self.single.extend([&mut strand.points[1].x, &mut strand.width[0]]);
                    if let Profile::Ribbon([start, _]) = &mut strand.profile {
                        self.single.push(&mut start.x);
                    }
                }
            }
        }
    }

    fn light(&mut self, kind: &'a mut LightKind) {
        match kind {
            LightKind::Ambient { color } => self.single.push(&mut color[0]),
            LightKind::Point { position, intensity, .. } => {
                self.vector(position);
                self.color(intensity);
            }
            LightKind::Distant { direction, intensity } => {
                self.vector(direction);
                self.color(intensity);
            }
            LightKind::Spot { direction, intensity, cone_angle, inner_angle, .. } => {
                self.vector(direction);
                self.color(intensity);
                self.double.extend([cone_angle, inner_angle]);
            }
            LightKind::Projection { image, intensity, fov, world_from_light, cone, .. } => {
                self.double.extend(cone.iter_mut().flatten());
                self.whole.push(&mut image.0);
                self.single.extend([intensity, fov]);
                self.matrix(world_from_light);
            }
            LightKind::Goniometric { image, world_from_light, .. } => {
                self.whole.push(&mut image.0);
                self.matrix(world_from_light);
            }
            LightKind::Environment { sky, portal, .. } => {
                portal.iter_mut().for_each(|corners| self.vector(&mut corners[2]));
                match sky {
                    Sky::Constant(color) => self.color(color),
                    Sky::Gradient { zenith, .. } => self.single.push(&mut zenith[0]),
                    Sky::Image { image, scale, world_from_light, .. }
                    | Sky::Octahedral { image, scale, world_from_light } => {
                        self.whole.push(&mut image.0);
                        self.single.push(&mut scale[0]);
                        self.matrix(world_from_light);
                    }
                }
            }
        }
    }
}

/// Numbers that a scene may hold by mistake.
const ODD: [f64; 12] =
    [0.0, -1.0, 1.0, 90.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300, 1e-300, 1e30, 1e-30];

/// Replaces one value; which one, and by what, is for the arguments to say.
fn corrupt(scene: &mut Scene, category: usize, place: usize, value: usize) {
    let mut places = Places::of(scene);
    let odd = ODD[value % ODD.len()];
    let whole = [0, 1, 2, 3, 17, 1 << 20, u32::MAX][value % 7];
    match category {
        0 if !places.whole.is_empty() => *places.whole.swap_remove(place % places.whole.len()) = whole,
        1 if !places.single.is_empty() => {
            *places.single.swap_remove(place % places.single.len()) = odd as f32;
        }
        2 if !places.double.is_empty() => *places.double.swap_remove(place % places.double.len()) = odd,
        _ => {
            let count = scene.meshes.len().max(1);
            let Some(mesh) = scene.meshes.get_mut(place % count) else { return };
            match value % 5 {
                0 => mesh.positions.truncate(1),
                1 => mesh.normals.truncate(1),
                2 => mesh.uvs.truncate(1),
                3 => mesh.triangles.clear(),
                _ => mesh.opacities.push(0.5),
            }
        }
    }
}

#[test]
fn a_scene_of_the_repository_is_valid() {
    for (name, scene) in scenes() {
        scene.validate().unwrap_or_else(|error| panic!("{name}: {error}"));
    }
}

#[test]
fn a_scene_with_anything_replaced_is_refused_or_renders() {
    let scenes = scenes();
    let of = (0..scenes.len(), 0..4_usize, any::<usize>(), any::<usize>());
    proptest!(ProptestConfig::with_cases(256), |((scene, category, place, value) in of)| {
        let mut scene = scenes[scene].1.clone();
        corrupt(&mut scene, category, place, value);
        // Either way nothing panics.
        let _ = render(scene);
    });
}

#[test]
fn what_is_wrong_is_told_with_what_there_is() {
    let error = |change: &dyn Fn(&mut Scene)| -> Error {
        let mut scene = small(own_scene("whitted1980.toml"));
        change(&mut scene);
        render(scene).expect_err("it is not valid")
    };
    let wrong = error(&|scene| scene.shapes[0].material = MaterialId(70));
    assert_eq!(wrong.kind, ErrorKind::Invalid);
    assert!(wrong.message.contains("there is no material 70; the scene has"), "{wrong}");
    let wrong = error(&|scene| scene.image.height = 0);
    assert!(wrong.message.contains("pixels; both must be at least 1"), "{wrong}");
    let wrong = error(&|scene| scene.shapes[1].world_from_object.x_axis.x = f64::NAN);
    assert!(
        wrong.message.contains("shape 1") && wrong.message.contains("world_from_object has NaN"),
        "{wrong}"
    );
}

#[test]
fn ids_without_a_target_are_refused_where_a_scene_is_compiled_and_take_no_place() {
    let mut scene = Scene::new();
    let (none, sphere) = (MaterialId(77), Sphere { center: DVec3::ZERO, radius: 1.0 });
    let unpainted = scene.sphere(sphere.center, sphere.radius, none).clone();
    let wrong = World::compile(unpainted.clone(), &mut Vec::new()).expect_err("no such material");
    assert!(wrong.message.contains("there is no material 77"), "{wrong}");

    scene.shape(Geometry::Mesh(MeshId(77)), none);
    scene.instances.push(Instance::new(Location::default(), ObjectId(77), DMat4::IDENTITY));
    assert_eq!(scene.bounds(), unpainted.bounds());
    let triangle =
        Mesh { positions: vec![Vec3::ZERO, Vec3::X], triangles: vec![[0, 1, 2]], ..Mesh::default() };
    let mesh = scene.mesh(triangle);
    scene.shape(Geometry::Mesh(mesh), none);
    assert_eq!(scene.bounds(), unpainted.bounds());
    assert!(World::compile(scene, &mut Vec::new()).is_err());
}
