//! Our own format says all that physically based scenes are made of: materials, curves, lights, textures, shapes.

use std::f32::consts::LN_2;
use std::path::Path;

use glam::{DVec3, Vec3};
use lookfrom_scene::camera::{Projection, Window};
use lookfrom_scene::light::{LightKind, Sky};
use lookfrom_scene::material::{
    BumpMapping, Color, Distribution, Energy, Illuminant, Ior, Masking, MaterialKind, Metal, Microfacets,
    OpenPbr, Plastic, Roughness, Scalar, SubsurfaceMedium, Tangent, Tint,
};
use lookfrom_scene::medium::{Density, Extinction};
use lookfrom_scene::scene::MediumId;
use lookfrom_scene::settings::{ColorMode, Integrator, Layers, LightSampler, SpectralFilm};
use lookfrom_scene::shape::{Geometry, Profile};
use lookfrom_scene::spectrum::{self, CameraSensor, Curve};
use lookfrom_scene::texture::{Mapping, MipFilter, TexelFilter, TextureKind};
use lookfrom_scene::{LoadContext, Memory, Scene, image, load};

fn read_files(texts: &[(&str, &str)]) -> Scene {
    let mut files = Memory::default();
    for (name, text) in texts {
        files.0.insert(name.into(), text.as_bytes().to_vec());
    }
    files.0.insert("half.png".into(), image::encode_png(1, 1, &[128; 3]).expect("a picture"));
    let scene = load::scene(Path::new(texts[0].0), &mut LoadContext::new(&files));
    scene.unwrap_or_else(|error| panic!("{error}\nin\n{}", texts[0].1))
}

fn read(text: &str) -> Scene {
    read_files(&[("a.toml", text)])
}

fn kind<'a>(scene: &'a Scene, name: &str) -> &'a MaterialKind {
    &scene.materials.iter().find(|material| material.name == name).expect("a material").kind
}

#[test]
fn microfacets_are_of_a_kind() {
    let scene = read(
        r#"
[materials.usual]
type = "dielectric"
roughness = 0.3
distribution = "trowbridge_reitz"
[materials.walter]
type = "conductor"
metal = "gold"
energy = "single_scattering"
distribution = "beckmann"
masking = "separable"
[materials.ball]
type = "plastic"
[materials.toy]
type = "plastic"
reflectance = [0.1, 0.2, 0.3]
specular_reflectance = 0.5
nonlinear = false
ior = 1.4
roughness = 0.5
distribution = "beckmann"
"#,
    );
    let MaterialKind::Dielectric { roughness, .. } = kind(&scene, "usual") else { panic!("a dielectric") };
    assert_eq!(roughness.microfacets, Microfacets::default());
    let MaterialKind::Conductor { roughness, .. } = kind(&scene, "walter") else { panic!("a conductor") };
    let walter = Microfacets { distribution: Distribution::Beckmann, masking: Masking::Separable };
    assert_eq!(roughness.microfacets, walter);
    let ball = Plastic {
        reflectance: Color::gray(0.8),
        specular_reflectance: Color::gray(1.0),
        eta: 1.5,
        alpha: 0.0,
        microfacets: Microfacets::default(),
        is_nonlinear: true,
    };
    assert_eq!(*kind(&scene, "ball"), MaterialKind::Plastic(Box::new(ball)));
    let toy = Plastic {
        reflectance: Color::Value([0.1, 0.2, 0.3]),
        specular_reflectance: Color::gray(0.5),
        eta: 1.4,
        alpha: 0.25,
        microfacets: Microfacets { distribution: Distribution::Beckmann, ..Microfacets::default() },
        is_nonlinear: false,
    };
    assert_eq!(*kind(&scene, "toy"), MaterialKind::Plastic(Box::new(toy)));
}

#[test]
fn materials_are_what_they_say() {
    let scene = read(
        r##"
[materials.gold]
type = "conductor"
metal = "gold"
illuminant = "E"
roughness = 0.5
[materials.tin]
type = "conductor"
reflectance = "#808080"
specular_reflectance = 0.5
roughness = [0.1, "spots"]
energy = "single_scattering"
[materials.salt]
type = "conductor"
eta = { curve = [[500, 1.5], [600, 2]] }
k = [3, 2, 1]
[materials.prism]
type = "dielectric"
ior = "SF11"
[materials.pane]
type = "thin_dielectric"
ior = 1.3
specular_reflectance = 0.5
specular_transmittance = [0.2, 0.4, 0.6]
[materials.plastic]
type = "coated_diffuse"
roughness = 0.3
coat_albedo = 0.4
g = 0.5
bump = "spots"
[materials.anodised]
type = "coated_conductor"
metal = "Al"
base_roughness = 0.5
[materials.a_mix]
type = "mix"
materials = ["gold", "plastic"]
amount = "spots"
[materials.paper]
type = "diffuse_transmission"
transmittance = 0.5
normal_map = "half.png"
[materials.nothing]
type = "interface"
[materials.red]
type = "diffuse"
reflectance = { type = "image", file = "half.png" }
[textures.spots]
type = "dots"
"##,
    );
    let curve = |color: Color| match color {
        Color::Curve(id) => &scene.curves[id.index()],
        other => panic!("{other:?} is no curve"),
    };
    let MaterialKind::Conductor { metal, roughness, energy, specular_reflectance } = *kind(&scene, "gold")
    else {
        panic!("a conductor")
    };
    let Metal::Indices { eta, k, illuminant } = metal else { panic!("{metal:?}") };
    assert_eq!((illuminant, specular_reflectance), (Illuminant::EqualEnergy, Color::gray(1.0)));
    assert_eq!(*curve(eta), spectrum::named("metal-Au-eta").expect("gold"));
    assert_eq!(*curve(k), spectrum::named("metal-Au-k").expect("gold"));
    assert_eq!(energy, Energy::Conserved);
    // Perceptual 0.5 is α = 0.25.
    let quarter = Scalar::Value(0.25);
    assert_eq!(roughness, Roughness::of_alphas(quarter, quarter));

    // A texture is squared as a number is.
    let MaterialKind::Conductor {
        metal: Metal::Reflectance(_),
        roughness,
        energy,
        specular_reflectance: Color::Value([0.5, 0.5, 0.5]),
    } = *kind(&scene, "tin")
    else {
        panic!("a conductor")
    };
    assert_eq!(energy, Energy::SingleScattering);
    assert_eq!((roughness.u, roughness.remap), (Scalar::Value(0.1_f32 * 0.1), false));
    let Scalar::Texture(squared) = roughness.v else { panic!("a texture") };
    let TextureKind::Scale { color: Color::Texture(spots), by: Scalar::Texture(also) } =
        scene.textures[squared.index()].kind
    else {
        panic!("a product")
    };
    assert_eq!((spots, scene.textures[spots.index()].name.as_str()), (also, "spots"));

    // Optical constants go on beyond their table.
    let MaterialKind::Conductor { metal: Metal::Indices { eta, .. }, .. } = *kind(&scene, "salt") else {
        panic!("a conductor")
    };
    for (nm, expected) in [(360.0, 1.5), (550.0, 1.75), (830.0, 2.0)] {
        assert!((curve(eta).at(nm) - expected).abs() < 1e-6);
    }

    let MaterialKind::Dielectric { eta: Ior::Curve(glass), roughness, energy, tint } = *kind(&scene, "prism")
    else {
        panic!("a dielectric")
    };
    assert_eq!((energy, tint), (Energy::Conserved, Tint::default()));
    assert_eq!(scene.curves[glass.index()], spectrum::named("glass-SF11").expect("a glass"));
    assert_eq!(roughness.u, Scalar::Value(0.0));
    let tint = Tint { reflectance: Color::gray(0.5), transmittance: Color::Value([0.2, 0.4, 0.6]) };
    assert_eq!(*kind(&scene, "pane"), MaterialKind::ThinDielectric { eta: Ior::Value(1.3), tint });
    let MaterialKind::CoatedDiffuse { coat, .. } = *kind(&scene, "plastic") else { panic!("coated") };
    assert_eq!((coat.roughness.u, coat.albedo), (Scalar::Value(0.3 * 0.3), Color::gray(0.4)));
    assert_eq!((coat.eta, coat.g), (Ior::Value(1.5), Scalar::Value(0.5)));
    let MaterialKind::CoatedConductor { roughness, coat, .. } = *kind(&scene, "anodised") else {
        panic!("coated")
    };
    assert_eq!((roughness.u, coat.roughness.u), (quarter, Scalar::Value(0.0)));
    let MaterialKind::Mix { materials, amount } = *kind(&scene, "a_mix") else { panic!("a mix") };
    assert_eq!(materials.map(|id| scene.materials[id.index()].name.as_str()), ["gold", "plastic"]);
    assert_eq!(amount, Scalar::Texture(spots));
    assert_eq!(*kind(&scene, "nothing"), MaterialKind::Interface);

    // The same file is numbers for a normal map and a colour elsewhere.
    let bump_mapping =
        |name: &str| scene.materials.iter().find(|m| m.name == name).expect("a material").bump_mapping;
    assert_eq!(bump_mapping("plastic"), BumpMapping::Bump(Scalar::Texture(spots)));
    let BumpMapping::NormalMap(normals) = bump_mapping("paper") else { panic!("a normal map") };
    assert_eq!(scene.images[normals.index()].texel(0)[0], 128.0 / 255.0);
    let linear = image::linear_from_srgb(128.0 / 255.0);
    assert!(scene.images.iter().any(|image| image.texel(0)[0] == linear));
}

#[test]
fn physical_materials_are_path_traced_unless_the_file_says_otherwise() {
    let integrator = |texts: &[(&str, &str)]| read_files(texts).render.integrator;
    let physical = "[materials.a]\ntype = \"diffuse\"\n";
    assert_eq!(integrator(&[("a.toml", "[materials.a]\ndiffuse = 1")]), Integrator::Whitted);
    assert_eq!(integrator(&[("a.toml", physical)]), Integrator::Path);
    let silent = format!("{physical}[render]\nsamples = 3");
    assert_eq!(integrator(&[("a.toml", &silent)]), Integrator::Path);
    let named = format!("{physical}[render]\nintegrator = \"whitted\"");
    assert_eq!(integrator(&[("a.toml", &named)]), Integrator::Whitted);
    let importing = "import = \"b.toml\"\n[render]\nsamples = 3";
    assert_eq!(integrator(&[("a.toml", importing), ("b.toml", &named)]), Integrator::Path);
    assert_eq!(integrator(&[("a.toml", "import = \"b.toml\""), ("b.toml", &named)]), Integrator::Whitted);
    let both = [
        ("a.toml", "import = [\"b.toml\", \"c.toml\"]"),
        ("b.toml", &silent),
        ("c.toml", "[render]\nintegrator = \"id\""),
    ];
    assert_eq!(integrator(&both), Integrator::Path);
}

#[test]
fn settings_and_cameras() {
    let scene = read(
        r#"
[render]
integrator = "ambient_occlusion"
color = "spectral"
light_sampler = "power"
regularize = true
occlusion_distance = 3
[image]
sensor = "sony_ilce_9"
imaging_ratio = 2
white_balance = 5000
max_component = 10
layers = true
spectral_buckets = 20
wavelengths = [400, 700.5]
bands = { red = { curve = [[600, 0], [700, 1]] }, all = { constant = 2 } }
[camera]
lookfrom = [0, 0, 5]
lookat = [0, 0, 0]
window = { x = [-1, 2], y = [0, 1] }
"#,
    );
    let render = &scene.render;
    assert_eq!(render.integrator, Integrator::AmbientOcclusion { cosine: true });
    assert_eq!((render.color, render.light_sampler), (ColorMode::Spectral, LightSampler::Power));
    assert_eq!((render.regularize, render.occlusion_distance), (true, 3.0));
    let sensor = scene.image.sensor;
    assert_eq!(sensor.camera.map(CameraSensor::name), Some("sony_ilce_9"));
    assert_eq!((sensor.imaging_ratio, sensor.white_balance, sensor.max_component), (2.0, Some(5000.0), 10.0));
    assert_eq!(scene.image.layers, Layers::Geometry);
    let film = scene.image.spectral_film.as_ref().expect("a spectral film");
    assert_eq!((film.buckets, film.range), (20, [400.0, 700.5]));
    let bands: Vec<(&str, f64)> =
        film.bands.iter().map(|band| (&*band.name, band.width([400.0, 700.0]))).collect();
    assert_eq!(bands, [("all", 600.0), ("red", 50.0)]);
    let film = |image: &str| read(&format!("[image]\n{image}")).image.spectral_film;
    assert_eq!(film("spectral_buckets = 3"), Some(SpectralFilm { buckets: 3, ..SpectralFilm::NONE }));
    assert_eq!(
        film("wavelengths = [500, 600]"),
        Some(SpectralFilm { range: [500.0, 600.0], ..SpectralFilm::NONE })
    );
    assert_eq!(film(""), None);
    let bands = film("bands = { a = { kelvin = 3000 } }").expect("a film of bands alone");
    assert_eq!((bands.buckets, bands.range, bands.bands.len()), (0, SpectralFilm::ALL, 1));
    let camera = scene.camera.expect("a camera");
    assert_eq!(camera.window, Some(Window { x: [-1.0, 2.0], y: [0.0, 1.0] }));
    for (word, projection) in
        [("equirectangular", Projection::Equirectangular), ("octahedral", Projection::Octahedral)]
    {
        let scene =
            read(&format!("[camera]\nlookfrom = [0, 0, 1]\nlookat = [0, 0, 0]\nprojection = \"{word}\""));
        assert_eq!(scene.camera.expect("a camera").projection, projection);
    }
}

#[test]
fn lights_have_curves_and_totals() {
    let scene = read(
        r#"
[[light]]
type = "point"
position = [0, 1, 0]
intensity = { kelvin = 3000, scale = 7 }
[[light]]
type = "distant"
direction = [0, -1, 0]
illuminance = 5
[[light]]
type = "environment"
color = { illuminant = "D65" }
portal = [[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]]
[[light]]
type = "ambient"
color = { illuminant = "D65", scale = 2 }
[[light]]
type = "sphere"
center = [0, 2, 0]
radius = 1
radiance = { kelvin = 3000 }
power = 100
[[sphere]]
emission = { kelvin = 3000, scale = 4 }
"#,
    );
    let LightKind::Point { intensity: Color::Curve(warm), .. } = scene.lights[0].kind else {
        panic!("a point")
    };
    assert_eq!(scene.curves[warm.index()], Curve::Blackbody { kelvin: 3000.0 });
    assert_eq!((scene.lights[0].power.scale, scene.lights[0].power.total), (7.0, None));
    assert!(!scene.lights[0].power.absolute);
    let LightKind::Distant { intensity, .. } = scene.lights[1].kind else { panic!("distant") };
    assert_eq!((intensity, scene.lights[1].power.total), (Color::gray(1.0), Some(5.0)));
    let LightKind::Environment { sky: Sky::Constant(Color::Curve(_)), portal: Some(corners), .. } =
        scene.lights[2].kind
    else {
        panic!("a window to the sky")
    };
    assert_eq!(corners[2], DVec3::new(2.0, 1.0, 0.0));
    // D65 is white, as bright as it says.
    let LightKind::Ambient { color } = scene.lights[3].kind else { panic!("ambient") };
    assert!(color.iter().all(|c| (c - 2.0).abs() < 1e-3), "{color:?}");
    // What it comes to as a whole outdoes the brightness; the curve is kept once.
    let emissions: Vec<_> = scene.shapes.iter().map(|shape| shape.emission.expect("it shines")).collect();
    assert!(emissions.iter().all(|emission| emission.radiance == Color::Curve(warm)));
    let powers: Vec<_> = emissions.iter().map(|e| (e.power.scale, e.power.total)).collect();
    assert!(powers.contains(&(1.0, Some(100.0))) && powers.contains(&(4.0, None)));
}

#[test]
fn lights_throw_pictures_the_right_way() {
    let scene = read(
        r#"
[[light]]
type = "projection"
image = "half.png"
position = [1, 2, 3]
direction = [0, 0, -2]
fov = 30
[[light]]
type = "goniometric"
image = "half.png"
position = [1, 2, 3]
intensity = 2
rotate = 90
[[light]]
type = "environment"
image = "half.png"
layout = "octahedral"
"#,
    );
    let LightKind::Projection { world_from_light, fov: 30.0, .. } = scene.lights[0].kind else {
        panic!("a projector")
    };
    let to = |v: DVec3| world_from_light.transform_vector3(v);
    assert_eq!((to(DVec3::X), to(DVec3::Y), to(DVec3::Z)), (DVec3::X, DVec3::Y, -DVec3::Z));
    assert_eq!(world_from_light.transform_point3(DVec3::ZERO), DVec3::new(1.0, 2.0, 3.0));
    let LightKind::Goniometric { world_from_light, .. } = scene.lights[1].kind else { panic!("a lamp") };
    assert_eq!(world_from_light.transform_vector3(DVec3::Z), DVec3::Y);
    assert_eq!(world_from_light.transform_vector3(DVec3::X), -DVec3::Z);
    let LightKind::Environment { sky: Sky::Octahedral { world_from_light, .. }, .. } = scene.lights[2].kind
    else {
        panic!("a sky")
    };
    assert_eq!(world_from_light.transform_vector3(DVec3::Z), DVec3::Y);
    assert_eq!(world_from_light.transform_vector3(DVec3::X), DVec3::X);
    assert!(world_from_light.determinant() > 0.0);
}

#[test]
fn textures_live_where_they_say() {
    let scene = read(
        r#"
[textures.a]
type = "image"
file = "half.png"
encoding = "linear"
multiply = 0.5
space = "planar"
axis_v = [0, 0, 3]
offset = [1, 2]
[textures.b]
type = "dots"
space = "spherical"
translate = [0, 5, 0]
[textures.c]
type = "bilinear"
corners = [0, "a", 1, { type = "windy" }]
[textures.d]
type = "direction_mix"
direction = [0, 0, -4]
[textures.e]
type = "mix"
amount = "f"
[textures.f]
type = "fbm"
roughness = 0.25
[textures.g]
type = "wrinkled"
"#,
    );
    let texture = |name: &str| &scene.textures.iter().find(|texture| texture.name == name).expect("it").kind;
    let TextureKind::Image { image, mapping: Mapping::Planar { axes, offset, .. }, scale, .. } =
        *texture("a")
    else {
        panic!("a picture on a plane")
    };
    assert_eq!(scene.images[image.index()].texel(0)[0], 128.0 / 255.0);
    assert_eq!((axes, offset, scale), ([Vec3::X, 3.0 * Vec3::Z], [1.0, 2.0], 0.5));
    // The pole is above the middle.
    let TextureKind::Dots { mapping: Mapping::Spherical { texture_from_world }, .. } = *texture("b") else {
        panic!("dots on a sphere")
    };
    assert_eq!(texture_from_world.transform_point3(DVec3::new(0.0, 6.0, 0.0)), DVec3::Z);
    assert_eq!(texture_from_world.transform_point3(DVec3::new(0.0, 5.0, -1.0)), DVec3::Y);
    let TextureKind::Bilinear { corners, .. } = *texture("c") else { panic!("bilinear") };
    assert_eq!((corners[0], corners[2]), (Color::BLACK, Color::gray(1.0)));
    assert!(matches!(*texture("d"), TextureKind::DirectionMix { direction: Vec3::NEG_Z, .. }));
    assert!(matches!(*texture("e"), TextureKind::Mix { amount: Scalar::Texture(_), .. }));
    assert!(matches!(*texture("f"), TextureKind::Fbm { octaves: 8, roughness: 0.25, .. }));
    assert!(matches!(*texture("g"), TextureKind::Wrinkled { roughness: 0.5, .. }));
}

#[test]
fn far_textures_are_filtered_as_they_say() {
    let scene = read(
        r#"
[textures.a]
type = "image"
file = "half.png"
[textures.b]
type = "image"
file = "half.png"
filter = "trilinear"
[textures.c]
type = "image"
file = "half.png"
filter = "ewa"
footprint = 0.5
anisotropy = 16
[textures.d]
type = "checker"
footprint = 1
[textures.e]
type = "fbm"
"#,
    );
    let kinds: Vec<_> = scene.textures.iter().map(|texture| texture.kind.clone()).collect();
    let filters: Vec<_> = kinds
        .iter()
        .filter_map(|kind| match kind {
            TextureKind::Image { filter, .. } => Some(*filter),
            _ => None,
        })
        .collect();
    let mip = |filter, footprint| TexelFilter::Mip { filter, footprint };
    let ewa = MipFilter::Ewa { anisotropy: 16.0 };
    assert_eq!(filters, [TexelFilter::Bilinear, mip(MipFilter::Trilinear, 0.25), mip(ewa, 0.5)]);
    assert!(matches!(kinds[3], TextureKind::Checker { footprint: 1.0, .. }));
    assert_eq!(TextureKind::need_footprints(&kinds), [false, true, true, true, false]);
}

#[test]
fn shapes_stand_where_they_say() {
    let scene = read(
        r#"
[[sphere]]
center = [1, 0, 0]
radius = 2
z_max = 1
translate = [0, 3, 0]
[[disk]]
center = [0, 4, 0]
normal = [0, 2, 0]
radius = 2
inner_radius = 1
alpha = 0.5
reverse_orientation = true
[[cylinder]]
from = [1, 1, 1]
to = [1, 1, -3]
radius = 0.5
phi_max = 90
[[patch]]
corners = [[0, 0, 0], [1, 0, 0], [0, 0, 1], [1, 1, 1]]
uvs = [[0, 0], [2, 0], [0, 2], [2, 2]]
[[curve]]
points = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0], [4, 0, 0], [5, 0, 0], [6, 0, 0]]
width = [3, 2, 1]
profile = "ribbon"
normals = [[0, 2, 0], [0, 1, 0], [0, 0, 1]]
"#,
    );
    let place = |index: usize, x: f64, y: f64, z: f64| {
        scene.shapes[index].world_from_object.transform_point3(DVec3::new(x, y, z))
    };
    // Kinds are read in the order of the guide.
    assert!(matches!(
        scene.shapes[0].geometry,
        Geometry::PartialSphere { radius: 2.0, z: [-2.0, 1.0], phi_max: 360.0 }
    ));
    assert_eq!(place(0, 0.0, 0.0, 0.0), DVec3::new(1.0, 3.0, 0.0));
    assert!(matches!(
        scene.shapes[1].geometry,
        Geometry::PartialDisk { height: 0.0, radius: 2.0, inner_radius: 1.0, phi_max: 360.0 }
    ));
    assert_eq!(place(1, 0.0, 0.0, 1.0), DVec3::new(0.0, 5.0, 0.0));
    assert_eq!(
        (scene.shapes[1].alpha, scene.shapes[1].reverse_orientation),
        (Some(Scalar::Value(0.5)), true)
    );
    assert!(scene.shapes[1].world_from_object.determinant() > 0.0);
    assert!(matches!(scene.shapes[2].geometry, Geometry::Cylinder { z: [0.0, 4.0], phi_max: 90.0, .. }));
    assert_eq!(place(2, 0.0, 0.0, 4.0), DVec3::new(1.0, 1.0, -3.0));
    let Geometry::Bilinear(patches) = &scene.shapes[3].geometry else { panic!("a patch") };
    assert_eq!((patches.positions[3], patches.patches.len(), patches.uvs.len()), (Vec3::ONE, 1, 4));
    let Geometry::Curves(strands) = &scene.shapes[4].geometry else { panic!("curves") };
    assert_eq!(
        (strands.len(), strands[0].points[3], strands[1].width),
        (2, strands[1].points[0], [2.0, 1.0])
    );
    assert_eq!(strands[0].profile, Profile::Ribbon([Vec3::Y, Vec3::Y]));
}

#[test]
fn mixes_of_mixes_come_to_an_end() {
    let chain: String = (0..100_000)
        .map(|i| format!("[materials.m{i}]\ntype = \"mix\"\nmaterials = [\"m{}\", \"last\"]\n", i + 1))
        .collect();
    let text = format!("{chain}[materials.m100000]\n[materials.last]\n");
    let mut files = Memory::default();
    files.0.insert("a.toml".into(), text.into_bytes());
    let error = load::scene(Path::new("a.toml"), &mut LoadContext::new(&files)).unwrap_err();
    assert_eq!(error.kind, lookfrom_scene::ErrorKind::Limit, "{error}");
}

#[test]
fn colours_have_names_unless_textures_have_them() {
    let reflectance = |text: &str| {
        let scene = read(&format!(
            "[materials.a]\ntype = \"diffuse\"\nreflectance = {text}\n[textures.plum]\ntype = \"checker\"\n"
        ));
        let MaterialKind::Diffuse { reflectance } = *kind(&scene, "a") else { panic!("{text}") };
        reflectance
    };
    assert_eq!(reflectance("\"tomato\""), reflectance("\"#ff6347\""));
    assert_eq!(reflectance("\"DarkSlateGray\""), reflectance("\"#2f4f4f\""));
    assert!(matches!(reflectance("\"plum\""), Color::Texture(_)));
    let scene = read("[[light]]\ntype = \"point\"\nposition = [0, 1, 0]\nintensity = \"white\"\n");
    assert_eq!(scene.lights.len(), 1);
}

#[test]
fn photometric_files_are_read_once() {
    let lamp = "[[light]]\ntype = \"goniometric\"\nimage = \"a.IES\"\nposition = [0, 2, 0]\nintensity = 3\n";
    let ies = "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 2 1 1 2 0 0 0 1 1 1\n0 90\n0\n2 1\n";
    let scene = read_files(&[("a.toml", &lamp.repeat(2)), ("a.IES", ies)]);
    assert_eq!((scene.lights.len(), scene.images.len()), (2, 1));
    let Color::Value(intensity) = (match scene.lights[1].kind {
        LightKind::Goniometric { intensity, .. } => intensity,
        ref other => panic!("{other:?}"),
    }) else {
        panic!("no colour")
    };
    assert_eq!(intensity, [3.0; 3]);
    // The brightest direction, straight down, is at the corners of the map.
    assert!(scene.images[0].texel(0)[0] > 0.99);
}

#[test]
fn d50_is_the_cies() {
    let xy = |color: &str| {
        let scene =
            read(&format!("[[light]]\ntype = \"point\"\nposition = [0, 0, 0]\nintensity = {color}\n"));
        let [x, y, z] = spectrum::observer::xyz(&scene.curves[0]);
        [x / (x + y + z), y / (x + y + z)]
    };
    let [x, y] = xy("{ illuminant = \"D50\" }");
    assert!((x - 0.3457).abs() < 2e-4 && (y - 0.3585).abs() < 2e-4, "{x} {y}");
    let [x, _] = xy("{ illuminant = \"D65\" }");
    assert!((x - 0.3127).abs() < 2e-4, "{x}");
}

#[test]
fn media_are_what_they_say() {
    let scene = read(
        r##"
[camera]
lookfrom = [0, 0, 5]
lookat = [0, 0, 0]
medium = "haze"
[media.haze]
scattering = 0.1
g = -0.4
density = 3
[media.smoke]
absorption = [1, 2, 3]
emission = [4, 5, 6]
density = { formula = "x + 10 * y + 100 * z", min = [0, 0, 0], max = [4, 2, 1], cells = 4 }
translate = [7, 8, 9]
[media.spots]
scattering = 1
density = { type = "noise" }
max_density = 2
[media.flame]
absorption = 1
emission = 2
temperature = { formula = "1000 - 3000 * x", cells = 2 }
[materials.liquid]
type = "dielectric"
medium = "spots"
[[sphere]]
medium = "smoke"
[[sphere]]
medium = "smoke"
[[sphere]]
material = "liquid"
medium = "flame"
[[sphere]]
material = "liquid"
"##,
    );
    assert_eq!(scene.render.integrator, Integrator::Path);
    let medium = |name: &str| scene.media.iter().find(|medium| medium.name == name).expect("a medium");
    let id = |name: &str| scene.media.iter().position(|medium| medium.name == name);
    let (haze, smoke, spots, flame) = (medium("haze"), medium("smoke"), medium("spots"), medium("flame"));
    assert_eq!(scene.camera.as_ref().and_then(|camera| camera.medium).map(MediumId::index), id("haze"));
    let parts = |absorption, scattering| Extinction::Parts { absorption, scattering };
    assert_eq!((haze.extinction, haze.g, haze.scale), (parts(Color::BLACK, Color::gray(0.1)), -0.4, 3.0));
    assert!(haze.scatters() && !haze.emits() && haze.variation.is_none());
    assert!(!smoke.scatters() && smoke.emits());
    assert_eq!(
        (smoke.extinction, smoke.emission),
        (parts(Color::Value([1.0, 2.0, 3.0]), Color::BLACK), Color::Value([4.0, 5.0, 6.0]))
    );

    // A formula is evaluated at the centres of cells.
    let variation = smoke.variation.as_ref().expect("a variation");
    assert_eq!(variation.world_from_medium.w_axis.truncate(), DVec3::new(7.0, 8.0, 9.0));
    let Density::Grid(placed) = &variation.density else { panic!("no grid") };
    assert_eq!((placed.grid.size(), placed.bounds), ([4, 2, 1], [Vec3::ZERO, Vec3::new(4.0, 2.0, 1.0)]));
    assert_eq!(variation.bounds, Some(placed.bounds));
    for [x, y] in [[0, 0], [3, 0], [1, 1]] {
        let expected = (x as f32 + 0.5) + 10.0 * (y as f32 + 0.5) + 50.0;
        assert_eq!(placed.grid.value([x, y, 0]), expected);
    }
    let spots = spots.variation.as_ref().expect("a variation");
    assert!(matches!(spots.density, Density::Texture { of: Scalar::Texture(_), most: 2.0 }));
    assert_eq!(spots.bounds, None);
    let hot =
        flame.variation.as_ref().and_then(|variation| variation.temperature.as_ref()).expect("temperatures");
    // What is negative is nothing.
    assert_eq!([0, 1].map(|x| hot.grid.grid.value([x, 0, 0])), [2500.0, 0.0]);
    assert!(flame.emits());

    // What is filled has materials of its own, each once.
    let inside =
        |shape: usize| scene.materials[scene.shapes[shape].material.index()].medium.map(MediumId::index);
    assert_eq!([0, 1, 2, 3].map(inside), [id("smoke"), id("smoke"), id("flame"), id("spots")]);
    assert_eq!(scene.shapes[0].material, scene.shapes[1].material);
    let of = |shape: usize| &scene.materials[scene.shapes[shape].material.index()].kind;
    assert!(matches!(of(0), MaterialKind::Interface) && matches!(of(2), MaterialKind::Dielectric { .. }));
}

#[test]
fn media_below_surfaces() {
    let scene = read(
        r#"
        [materials.milk]
        type = "subsurface"

        [materials.skin]
        type = "subsurface"
        preset = "Skin1"
        scale = 10
        roughness = 0.5

        [materials.wax]
        type = "subsurface"
        absorption = [1, 2, 3]
        scattering = 9
        g = -0.3
        ior = 1.4

        [materials.jade]
        type = "subsurface"
        reflectance = [0.3, 0.7, 0.4]
        mean_free_path = 0.1
        "#,
    );
    let of = |name: &str| match kind(&scene, name) {
        MaterialKind::Subsurface(below) => &**below,
        other => panic!("{other:?}"),
    };
    let milk = of("milk");
    assert_eq!((&milk.medium, milk.scale, milk.g, milk.eta), (&SubsurfaceMedium::MILK, 1.0, 0.0, 1.33));
    let skin = of("skin");
    let absorption = Color::Value([0.032, 0.17, 0.48]);
    assert_eq!(
        skin.medium,
        SubsurfaceMedium::Coefficients { absorption, scattering: Color::Value([0.74, 0.88, 1.01]) }
    );
    assert_eq!((skin.scale, skin.roughness.u, skin.roughness.remap), (10.0, Scalar::Value(0.25), false));
    let wax = of("wax");
    let absorption = Color::Value([1.0, 2.0, 3.0]);
    assert_eq!(wax.medium, SubsurfaceMedium::Coefficients { absorption, scattering: Color::gray(9.0) });
    assert_eq!((wax.g, wax.eta), (-0.3, 1.4));
    let reflectance = Color::Value([0.3, 0.7, 0.4]);
    assert_eq!(
        of("jade").medium,
        SubsurfaceMedium::Reflectance { reflectance, mean_free_path: Color::gray(0.1) }
    );
}

#[test]
fn openpbr_is_a_surface_a_medium_and_what_shapes_have() {
    let scene = read(
        r##"
[materials.usual]
type = "openpbr"
[materials.honey]
type = "openpbr"
transmission_weight = 1
transmission_color = [0.5, 1, 0.25]
transmission_depth = 2
transmission_scatter = [0.2, 0.4, 0.6]
transmission_scatter_anisotropy = -1
transmission_dispersion_scale = 0.5
[materials.wax]
type = "openpbr"
subsurface_weight = 1
subsurface_color = [0.9, 0.8, 0.7]
subsurface_radius = 0.5
specular_roughness = 0.5
specular_roughness_anisotropy = 0.5
[materials.skin]
type = "openpbr"
subsurface_weight = 0.25
[materials.lamp]
type = "openpbr"
emission_luminance = 3
emission_color = [1, 0.5, 0]
geometry_opacity = 0.5
geometry_tangent = [0, 1]
[[sphere]]
material = "lamp"
[[sphere]]
material = "lamp"
alpha = 0.75
"##,
    );
    let look = |name| match kind(&scene, name) {
        MaterialKind::OpenPbr(look) => look,
        other => panic!("{other:?}"),
    };
    // The specification's defaults.
    assert_eq!(**look("usual"), OpenPbr::default());
    assert!(!look("usual").is_body() && look("honey").is_body());
    // Extinction −ln T / depth, less scattering S / depth, raised by what green has less than none.
    assert_eq!(look("honey").transmission_color, Color::gray(1.0));
    assert_eq!(look("honey").dispersion, 0.5);
    let honey = scene.materials.iter().find(|material| material.name == "honey").expect("honey");
    let medium = &scene.media[honey.medium.expect("a medium").index()];
    let Extinction::Parts { absorption: Color::Value(absorption), scattering: Color::Value(scattering) } =
        medium.extinction
    else {
        panic!("{medium:?}")
    };
    let expected = [0.5 * LN_2 - 0.1 + 0.2, 0.0, LN_2 - 0.3 + 0.2];
    for k in 0..3 {
        assert!((absorption[k] - expected[k]).abs() < 1e-5, "{absorption:?} {expected:?}");
    }
    assert_eq!(scattering, [0.1, 0.2, 0.3]);
    assert_eq!(medium.g, -0.99);
    // In depth it is the material of that name, or a mix with it.
    let MaterialKind::Subsurface(wax) = kind(&scene, "wax") else { panic!("{:?}", kind(&scene, "wax")) };
    let reflectance = Color::Value([0.9, 0.8, 0.7]);
    let mean_free_path = Color::Value([0.5, 0.25, 0.125]);
    assert_eq!(wax.medium, SubsurfaceMedium::Reflectance { reflectance, mean_free_path });
    let [u, v] = OpenPbr::alphas(0.5, 0.5).map(Scalar::Value);
    assert_eq!((wax.eta, wax.roughness), (1.5, Roughness::of_alphas(u, v)));
    let MaterialKind::Mix { materials: [above, below], amount } = kind(&scene, "skin") else {
        panic!("{:?}", kind(&scene, "skin"))
    };
    assert_eq!(*amount, Scalar::Value(0.25));
    let part = |id: &lookfrom_scene::scene::MaterialId| &scene.materials[id.index()].kind;
    assert!(matches!(part(above), MaterialKind::OpenPbr(_)));
    assert!(matches!(part(below), MaterialKind::Subsurface(_)));
    // Shapes have emission and opacity.
    let glow = scene.shapes[0].emission.expect("a lamp");
    assert_eq!((glow.radiance, glow.power.scale), (Color::Value([1.0, 0.5, 0.0]), 3.0));
    assert_eq!(
        scene.shapes.iter().map(|shape| shape.alpha).collect::<Vec<_>>(),
        [0.5, 0.75].map(|a| Some(Scalar::Value(a)))
    );
    assert_eq!(look("lamp").geometry_tangent, Tangent::Value([0.0, 1.0]));
}

#[test]
fn openpbr_tells_what_it_approximates() {
    let warnings = |text: &str| {
        let mut files = Memory::default();
        files.0.insert("a.toml".into(), format!("[materials.a]\ntype = \"openpbr\"\n{text}").into_bytes());
        let mut context = LoadContext::new(&files);
        load::scene(Path::new("a.toml"), &mut context).unwrap_or_else(|error| panic!("{error}"));
        context.warnings.iter().map(|warning| warning.message.clone()).collect::<Vec<_>>()
    };
    let said = |text: &str, word: &str| {
        let said = warnings(text);
        assert!(said.iter().any(|message| message.contains(word)), "{text}: {said:?}");
    };
    said("subsurface_weight = 1\ncoat_weight = 0.5", "taken for diffuse");
    said("subsurface_weight = 1\nbase_metalness = 0.5", "taken for diffuse");
    said("emission_luminance = 1\ncoat_weight = 1\ncoat_color = [1, 0, 0]", "does not colour");
    said("transmission_weight = 1\ntransmission_scatter = 0.5", "`transmission_depth`");
    said("transmission_depth = 1", "`transmission_weight`");
    said("emission_color = 0.5", "`emission_luminance`");
    for fine in
        ["", "subsurface_weight = 1", "geometry_thin_walled = true\nsubsurface_weight = 1\ncoat_weight = 1"]
    {
        assert_eq!(warnings(fine), Vec::<String>::new(), "{fine}");
    }
}
