//! A scene for every variant of the vocabulary, and the comparison of scenes up to their numbers, names and locations.

use std::sync::Arc;

use glam::{DMat4, DVec3, DVec4, Vec2, Vec3, Vec4};
use lookfrom_scene::camera::{Camera, Lens, Projection, Target, View, Window};
use lookfrom_scene::grid::{Grid, Placed};
use lookfrom_scene::image::{Encoding, Image};
use lookfrom_scene::lens::{ApertureShape, LensConvention, LensSurface, LensSystem};
use lookfrom_scene::light::{Edge, Falloff, Light, LightKind, MapRows, Power, Projected, Sky};
use lookfrom_scene::material::{
    Anisotropy, BackFace, BumpGuard, BumpMapping, Coat, CoatEstimate, Color, Disney, Distribution, Energy,
    Hair, Illuminant, Ior, Masking, Material, MaterialKind, Metal, Microfacets, NormalTexture, OpenPbr,
    Pigment, Plastic, Principled, Roughness, Scalar, Subsurface, SubsurfaceMedium, Tangent, Tint, Whitted,
};
use lookfrom_scene::medium::{Density, DraineLobe, Extinction, Medium, Sides, Temperature, Variation};
use lookfrom_scene::motion::Motion;
use lookfrom_scene::scene::{
    CurveId, ImageId, Instance, MaterialId, MediumId, MeshId, Object, ObjectId, TextureId, VertexNormals,
};
use lookfrom_scene::settings::{
    Allocation, Background, Band, ColorMode, FilterShape, ImageSettings, Integrator, Layers, LightPathLayer,
    LightSampler, PixelBounds, Portals, RenderSettings, Sampler, Sensor, SpectralFilm, Tonemap,
};
use lookfrom_scene::shape::{Emission, Geometry, Mesh, MeshPose, Patches, Profile, Shape, Sphere, Strand};
use lookfrom_scene::spectrum::{self, CameraSensor, Curve};
use lookfrom_scene::texture::{Channel, Mapping, MipFilter, TexelFilter, Texture, TextureKind, Wrap};
use lookfrom_scene::{Location, Scene};

const NOISE: TextureId = TextureId(0);
const TEXTURE: Scalar = Scalar::Texture(NOISE);
const COLOR: Color = Color::Texture(NOISE);
const TABLE: CurveId = CurveId(0);

fn here() -> Location {
    Location::default()
}

/// A shear, which only a matrix can say.
fn shear() -> DMat4 {
    DMat4::from_cols(
        DVec4::new(1.1, 0.2, -0.0, 0.0),
        DVec4::new(0.3, 0.9, 0.1, 0.0),
        DVec4::new(-0.4, 0.0, 1.3, 0.0),
        DVec4::new(0.1, 1.0 / 3.0, -7.0, 1.0),
    )
}

fn unit() -> Vec3 {
    Vec3::new(0.3, -0.7, 0.2).normalize()
}

/// A sphere in a scene with a texture, pictures, spectra and media for others to use.
fn base() -> Scene {
    let value = |gray| Color::gray(gray);
    let noise = TextureKind::Noise { low: value(0.25), high: value(0.75), octaves: 3, mapping: Mapping::UV };
    let bytes: Vec<[u8; 4]> = (0..16_u8).map(|k| [k, 200 - k, 3 * k, 255 - 5 * k]).collect();
    let opaque: Vec<[u8; 4]> = bytes.iter().map(|[r, g, b, _]| [*r, *g, *b, 255]).collect();
    let floats: Vec<[f32; 3]> = (0..16).map(|k| [k as f32 * 0.37, 1e-8, 5000.0]).collect();
    let gamma = |x: f32| libm::powf(x, 1.8);
    let curve = |first: f32| Curve::Tabulated {
        wavelengths: vec![first, 500.0, 650.5],
        values: vec![1.5, 1.25, 1.75],
    };
    let long = Curve::Tabulated {
        wavelengths: (0..40).map(|k| 355.0 + 12.5 * k as f32).collect(),
        values: (0..40).map(|k| 1.0 + 1.0 / (k as f32 + 3.0)).collect(),
    };
    let named = |name: &str| spectrum::named(name).expect("a spectrum");
    let mut media = Vec::new();
    for name in ["fog", "air"] {
        let extinction = Extinction::Parts { absorption: Color::BLACK, scattering: value(0.5) };
        media.push(Medium { extinction, g: 0.25, ..Medium::clear(name, here()) });
    }
    let kind = MaterialKind::Diffuse { reflectance: value(0.5) };
    let shape =
        Shape::new(here(), Geometry::Sphere(Sphere { center: DVec3::ZERO, radius: 1.0 }), MaterialId(0));
    Scene {
        camera: Some(Camera::default()),
        materials: vec![Material::new("grey", here(), kind)],
        textures: vec![Texture { name: "noise".to_owned(), at: here(), kind: noise }],
        images: vec![
            Image::from_bytes("srgb", 4, 4, opaque.clone(), Encoding::Srgb),
            Image::from_bytes("linear", 4, 4, bytes.clone(), Encoding::Linear),
            Image::from_bytes("gamma", 4, 4, bytes, Encoding::Curve(&gamma)),
            Image::from_linear("floats", 4, 4, floats),
            Image::from_bytes("normals", 4, 4, opaque, Encoding::Linear),
        ],
        curves: vec![
            curve(400.0),
            Curve::Constant(1.25),
            Curve::Blackbody { kelvin: 3000.0 },
            long,
            named("glass-BK7"),
            named("metal-Au-eta"),
            named("metal-Au-k"),
            named("stdillum-F7"),
            named("stdillum-D50"),
        ],
        media,
        shapes: vec![shape],
        ..Scene::default()
    }
}

/// Scenes of a list of variants, each of which is put into a scene; every variant has to be among them.
fn each<T: Clone>(
    kind: &str,
    variants: Vec<T>,
    index: impl Fn(&T) -> usize,
    put: impl Fn(&mut Scene, T),
) -> Vec<(String, Scene)> {
    let mut found: Vec<usize> = variants.iter().map(&index).collect();
    found.sort_unstable();
    found.dedup();
    assert!(found.iter().copied().eq(0..found.len()), "of the variants of {kind} there are only {found:?}");
    let scene = |(number, variant): (usize, T)| {
        let mut scene = base();
        put(&mut scene, variant);
        (format!("{kind} {number}"), scene)
    };
    variants.into_iter().enumerate().map(scene).collect()
}

pub(super) fn scenes() -> Vec<(String, Scene)> {
    [
        materials(),
        bumps(),
        textures(),
        mappings(),
        lights(),
        powers(),
        geometries(),
        meshes(),
        media(),
        cameras(),
        settings(),
        looks(),
    ]
    .concat()
}

fn roughness(u: Scalar, v: Scalar, remap: bool) -> Roughness {
    Roughness { remap, ..Roughness::of_alphas(u, v) }
}

fn materials() -> Vec<(String, Scene)> {
    let rough = roughness(Scalar::Value(0.3), TEXTURE, true);
    let alpha = roughness(Scalar::Value(0.04), Scalar::Value(0.5), false);
    let coat = Coat {
        eta: Ior::Curve(CurveId(4)),
        roughness: roughness(Scalar::Value(0.25), Scalar::Value(0.25), false),
        thickness: TEXTURE,
        albedo: Color::Value([0.1, 0.2, 0.3]),
        g: Scalar::Value(-0.5),
        max_depth: 10,
        samples: 3,
        estimate: CoatEstimate::Pbrt,
    };
    let gold = Metal::Indices {
        eta: Color::Curve(CurveId(5)),
        k: Color::Curve(CurveId(6)),
        illuminant: Illuminant::EqualEnergy,
    };
    let odd =
        Metal::Indices { eta: Color::Curve(TABLE), k: Color::Curve(CurveId(1)), illuminant: Illuminant::D65 };
    let conductor = |metal, roughness, energy, specular_reflectance| MaterialKind::Conductor {
        metal,
        roughness,
        energy,
        specular_reflectance,
    };
    let below = |medium| {
        MaterialKind::Subsurface(Box::new(Subsurface {
            medium,
            scale: 2.0,
            g: 0.5,
            eta: 1.4,
            roughness: alpha,
        }))
    };
    let hair = |pigment| {
        MaterialKind::Hair(Box::new(Hair {
            pigment,
            eta: Scalar::Value(1.5),
            beta_m: TEXTURE,
            beta_n: Scalar::Value(0.5),
            alpha: Scalar::Value(-3.0),
        }))
    };
    let map = NormalTexture { texture: NOISE, scale: 0.5 };
    let principled = Principled {
        base_color: COLOR,
        metallic: TEXTURE,
        roughness: Scalar::Value(0.25),
        anisotropy: Some(Anisotropy { strength: 0.5, rotation: 0.777_777_7, texture: Some(NOISE) }),
        ior: 0.0,
        dispersion: 0.4,
        specular: Scalar::Value(0.75),
        specular_color: Color::Value([1.0, 0.5, 0.25]),
        transmission: TEXTURE,
        is_solid: true,
        absorption: [0.1, 0.2, 0.3],
        diffuse_transmission: Scalar::Value(0.125),
        diffuse_transmission_color: COLOR,
        clearcoat: Scalar::Value(0.5),
        clearcoat_roughness: Scalar::Value(0.125),
        clearcoat_normal: Some(map),
        sheen_color: Color::Value([0.3, 0.2, 0.1]),
        sheen_roughness: Scalar::Value(0.25),
        iridescence: TEXTURE,
        iridescence_ior: 1.5,
        iridescence_thickness: TEXTURE,
    };
    let open = OpenPbr {
        base_weight: TEXTURE,
        base_color: COLOR,
        base_diffuse_roughness: Scalar::Value(0.5),
        base_metalness: Scalar::Value(0.5),
        specular_weight: Scalar::Value(2.0),
        specular_color: Color::Value([0.5, 0.25, 1.0]),
        specular_roughness: TEXTURE,
        specular_roughness_anisotropy: Scalar::Value(0.5),
        specular_ior: 1.7,
        transmission_weight: Scalar::Value(0.5),
        transmission_color: Color::Value([0.5, 0.75, 1.0]),
        dispersion: 0.333_333_3,
        subsurface_weight: Scalar::Value(0.25),
        subsurface_color: COLOR,
        subsurface_scatter_anisotropy: 0.5,
        coat_weight: Scalar::Value(0.5),
        coat_color: Color::Value([0.5, 0.25, 0.125]),
        coat_roughness: TEXTURE,
        coat_roughness_anisotropy: Scalar::Value(0.5),
        coat_ior: 1.5,
        coat_darkening: Scalar::Value(0.5),
        fuzz_weight: Scalar::Value(0.5),
        fuzz_color: Color::Value([0.0, 0.5, 1.0]),
        fuzz_roughness: TEXTURE,
        thin_film_weight: Scalar::Value(0.5),
        thin_film_thickness: Scalar::Value(0.25),
        thin_film_ior: 1.5,
        geometry_thin_walled: false,
        geometry_coat_normal: Some(map),
        geometry_tangent: Tangent::Value([0.5, -2.0]),
        geometry_coat_tangent: Tangent::Texture(NOISE),
    };
    let thin = OpenPbr { geometry_thin_walled: true, ..open.clone() };
    let value = Color::Value([0.123, 0.456, 0.789]);
    let whitted = Whitted {
        ambient: Some(Color::gray(0.3)),
        diffuse: COLOR,
        specular: Color::gray(0.5),
        shininess: 12.5,
        mirror: Color::gray(0.1),
        transmission: Color::gray(0.9),
        ior: 1.3,
        fresnel: true,
        absorption: [0.5, 0.25, 0.125],
    };
    let disney = Disney {
        base_color: COLOR,
        roughness: Scalar::Value(0.3),
        anisotropic: TEXTURE,
        metallic: Scalar::Value(0.123),
        spec_trans: Scalar::Value(0.5),
        eta: Scalar::Value(1.333),
        spec_tint: TEXTURE,
        sheen: Scalar::Value(2.0),
        sheen_tint: Scalar::Value(0.1),
        flatness: Scalar::Value(0.7),
        clearcoat: TEXTURE,
        clearcoat_gloss: Scalar::Value(0.9),
        diff_trans: Scalar::Value(0.0),
        is_thin: false,
    };
    let microfacets = Microfacets { distribution: Distribution::Beckmann, masking: Masking::Separable };
    let plastic = Plastic {
        reflectance: COLOR,
        specular_reflectance: value,
        eta: 1.7,
        alpha: 0.123,
        microfacets,
        is_nonlinear: false,
    };
    let beckmann = Roughness { microfacets, ..alpha };
    let (conserved, single) = (Energy::Conserved, Energy::SingleScattering);
    let (clear, stained) = (Tint::default(), Tint { reflectance: value, transmittance: COLOR });
    let glass = |eta, roughness, energy, tint| MaterialKind::Dielectric { eta, roughness, energy, tint };
    let variants = vec![
        MaterialKind::Whitted(whitted),
        MaterialKind::Diffuse { reflectance: Color::Curve(CurveId(3)) },
        MaterialKind::DiffuseTransmission { reflectance: value, transmittance: COLOR, scale: 0.5 },
        conductor(gold, rough, single, Color::gray(1.0)),
        conductor(odd, alpha, conserved, value),
        conductor(Metal::Reflectance(value), alpha, single, COLOR),
        glass(Ior::Curve(TABLE), alpha, single, clear),
        glass(Ior::Curve(CurveId(3)), rough, conserved, stained),
        MaterialKind::ThinDielectric { eta: Ior::Value(1.25), tint: clear },
        MaterialKind::ThinDielectric { eta: Ior::Value(1.25), tint: stained },
        MaterialKind::CoatedDiffuse { reflectance: value, coat },
        MaterialKind::CoatedConductor { metal: gold, roughness: rough, coat },
        below(SubsurfaceMedium::Coefficients { absorption: value, scattering: Color::Curve(TABLE) }),
        below(SubsurfaceMedium::Reflectance { reflectance: COLOR, mean_free_path: value }),
        hair(Pigment::Absorption(value)),
        hair(Pigment::Reflectance(COLOR)),
        hair(Pigment::Melanin { eumelanin: TEXTURE, pheomelanin: Scalar::Value(0.5) }),
        MaterialKind::Mix { materials: [MaterialId(0), MaterialId(0)], amount: TEXTURE },
        MaterialKind::Principled(Box::new(principled)),
        MaterialKind::Principled(Box::default()),
        MaterialKind::OpenPbr(Box::new(open)),
        MaterialKind::OpenPbr(Box::new(thin)),
        MaterialKind::OpenPbr(Box::default()),
        MaterialKind::Disney(Box::new(disney)),
        MaterialKind::Disney(Box::default()),
        MaterialKind::Disney(Box::new(Disney { is_thin: true, diff_trans: TEXTURE, ..Disney::default() })),
        MaterialKind::Plastic(Box::new(plastic)),
        MaterialKind::Plastic(Box::new(Plastic { alpha: 0.25, is_nonlinear: true, ..plastic })),
        conductor(gold, beckmann, single, Color::gray(1.0)),
        glass(Ior::Value(1.3), beckmann, single, clear),
        MaterialKind::Unlit { color: value },
        MaterialKind::ShadowCatcher { normal: unit() },
        MaterialKind::Interface,
        MaterialKind::Whitted(Whitted::default()),
    ];
    // Measured materials are copies of files: one is among the scenes of the guide.
    let index = |kind: &MaterialKind| match kind {
        MaterialKind::Whitted(_) => 0,
        MaterialKind::Diffuse { .. } => 1,
        MaterialKind::DiffuseTransmission { .. } => 2,
        MaterialKind::Conductor { .. } => 3,
        MaterialKind::Dielectric { .. } => 4,
        MaterialKind::ThinDielectric { .. } => 5,
        MaterialKind::CoatedDiffuse { .. } => 6,
        MaterialKind::CoatedConductor { .. } => 7,
        MaterialKind::Subsurface(_) => 8,
        MaterialKind::Hair(_) => 9,
        MaterialKind::Mix { .. } => 10,
        MaterialKind::Principled(_) => 11,
        MaterialKind::OpenPbr(_) => 12,
        MaterialKind::Unlit { .. } => 13,
        MaterialKind::ShadowCatcher { .. } => 14,
        MaterialKind::Interface => 15,
        MaterialKind::Disney(_) => 16,
        MaterialKind::Plastic(_) => 17,
        MaterialKind::Measured(_) => 18,
    };
    each("material", variants, index, |scene, kind| {
        scene.materials.push(Material { medium: Some(MediumId(0)), ..Material::new("made", here(), kind) });
        scene.shapes[0].material = MaterialId(1);
    })
}

fn bumps() -> Vec<(String, Scene)> {
    let map = NormalTexture { texture: NOISE, scale: 1.0 };
    let variants = vec![
        BumpMapping::None,
        BumpMapping::Bump(TEXTURE),
        BumpMapping::NormalMap(ImageId(4)),
        BumpMapping::NormalTexture(map),
        BumpMapping::NormalTexture(NormalTexture { scale: -0.5, ..map }),
    ];
    let index = |bump: &BumpMapping| match bump {
        BumpMapping::None => 0,
        BumpMapping::Bump(_) => 1,
        BumpMapping::NormalMap(_) => 2,
        BumpMapping::NormalTexture(_) => 3,
    };
    each("bump", variants, index, |scene, bump_mapping| {
        let material = &mut scene.materials[0];
        material.bump_guard = match bump_mapping {
            BumpMapping::Bump(_) => Some(BumpGuard { turns: true, shadows: false }),
            BumpMapping::NormalMap(_) => Some(BumpGuard { turns: false, shadows: true }),
            _ => None,
        };
        material.back_face = match bump_mapping {
            BumpMapping::None => BackFace::Black,
            _ => BackFace::Own,
        };
        material.bump_mapping = bump_mapping;
    })
}

/// Puts a texture as the reflectance of the sphere.
fn put_texture(scene: &mut Scene, kind: TextureKind) {
    scene.textures.push(Texture { name: "made".to_owned(), at: here(), kind });
    scene.materials[0].kind = MaterialKind::Diffuse { reflectance: Color::Texture(TextureId(1)) };
}

fn image(image: u32, filter: TexelFilter, channel: Channel) -> TextureKind {
    TextureKind::Image {
        image: ImageId(image),
        mapping: Mapping::Uv { scale: [2.0, 3.0], offset: [0.5, -0.25] },
        wrap: [Wrap::Clamp, Wrap::Mirror],
        filter,
        channel,
        scale: 0.5,
        invert: true,
    }
}

fn textures() -> Vec<(String, Scene)> {
    let (low, high) = (Color::Value([0.1, 0.9, 0.3]), COLOR);
    let mapping = Mapping::World { texture_from_world: DMat4::from_scale(DVec3::splat(4.0)) };
    let mip = |filter| TexelFilter::Mip { filter, footprint: 0.5 };
    let variants = vec![
        image(0, TexelFilter::Bilinear, Channel::Rgb),
        image(1, TexelFilter::Nearest, Channel::Red),
        image(2, mip(MipFilter::Nearest), Channel::Green),
        image(3, mip(MipFilter::Bilinear), Channel::Blue),
        image(1, mip(MipFilter::Trilinear), Channel::Alpha),
        image(0, mip(MipFilter::Ewa { anisotropy: 16.0 }), Channel::Rgb),
        TextureKind::Image {
            image: ImageId(0),
            mapping: Mapping::UV,
            wrap: [Wrap::Black; 2],
            filter: TexelFilter::Bilinear,
            channel: Channel::Rgb,
            scale: 1.0,
            invert: false,
        },
        TextureKind::Checker { even: low, odd: high, footprint: 0.5, mapping: Mapping::UV },
        TextureKind::Noise { low, high, octaves: 7, mapping },
        TextureKind::Marble { vein: low, base: high, octaves: 5, turbulence: 0.5, mapping },
        TextureKind::Scale { color: high, by: TEXTURE },
        TextureKind::Mix { low, high, amount: Scalar::Value(0.25) },
        TextureKind::DirectionMix { low, high, direction: unit() },
        TextureKind::Bilinear { corners: [low, high, Color::BLACK, Color::gray(0.5)], mapping: Mapping::UV },
        TextureKind::Dots { inside: low, outside: high, mapping: Mapping::UV },
        TextureKind::Fbm { octaves: 3, roughness: 0.25, footprint: 0.5, mapping },
        TextureKind::Wrinkled { octaves: 3, roughness: 0.25, footprint: 0.5, mapping },
        TextureKind::Windy { footprint: 0.5, mapping },
        TextureKind::PbrtMarble {
            octaves: 3,
            roughness: 0.25,
            scale: 2.0,
            variation: 0.5,
            footprint: 0.5,
            mapping,
        },
        TextureKind::VertexColor { tint: [0.5, 0.25, 1.0] },
        TextureKind::VertexAlpha,
        TextureKind::Product { a: low, b: high },
        TextureKind::Threshold { value: TEXTURE, edge: 0.25 },
        TextureKind::Sides { outside: low, inside: high },
        TextureKind::Quotient { a: TEXTURE, b: Scalar::Value(0.5) },
    ];
    let index = |kind: &TextureKind| match kind {
        TextureKind::Image { .. } => 0,
        TextureKind::Checker { .. } => 1,
        TextureKind::Noise { .. } => 2,
        TextureKind::Marble { .. } => 3,
        TextureKind::Scale { .. } => 4,
        TextureKind::Mix { .. } => 5,
        TextureKind::DirectionMix { .. } => 6,
        TextureKind::Bilinear { .. } => 7,
        TextureKind::Dots { .. } => 8,
        TextureKind::Fbm { .. } => 9,
        TextureKind::Wrinkled { .. } => 10,
        TextureKind::Windy { .. } => 11,
        TextureKind::PbrtMarble { .. } => 12,
        TextureKind::VertexColor { .. } => 13,
        TextureKind::VertexAlpha => 14,
        TextureKind::Product { .. } => 15,
        TextureKind::Threshold { .. } => 16,
        TextureKind::Sides { .. } => 17,
        TextureKind::Quotient { .. } => 18,
    };
    each("texture", variants, index, put_texture)
}

fn mappings() -> Vec<(String, Scene)> {
    let texture_from_world = shear();
    let turned = DMat4::from_cols(DVec4::X, DVec4::Z, -DVec4::Y, DVec4::W);
    let variants = vec![
        Mapping::UV,
        Mapping::Affine { set: 2, matrix: [[1.0, 0.5, 0.25], [-0.5, 1.0, 0.1]] },
        Mapping::Spherical { texture_from_world },
        Mapping::Spherical { texture_from_world: turned * DMat4::IDENTITY },
        Mapping::Cylindrical { texture_from_world },
        Mapping::Planar { texture_from_world, axes: [unit(), Vec3::Z], offset: [0.25, 0.5] },
        Mapping::World { texture_from_world },
        Mapping::World { texture_from_world: DMat4::IDENTITY },
    ];
    let index = |mapping: &Mapping| match mapping {
        Mapping::Uv { .. } => 0,
        Mapping::Affine { .. } => 1,
        Mapping::Spherical { .. } => 2,
        Mapping::Cylindrical { .. } => 3,
        Mapping::Planar { .. } => 4,
        Mapping::World { .. } => 5,
    };
    each("mapping", variants, index, |scene, mapping| {
        let (even, odd) = (Color::gray(0.25), Color::gray(0.5));
        put_texture(scene, TextureKind::Checker { even, odd, footprint: 0.0, mapping });
    })
}

fn lights() -> Vec<(String, Scene)> {
    let intensity = Color::Value([1.0, 2.0, 3.0]);
    let environment = |sky| LightKind::Environment { sky, portal: None, illuminates: true };
    let (scale, world_from_light) = ([0.5, 0.25, 1.0], shear());
    let image = ImageId(0);
    let portal = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]].map(DVec3::from_array);
    let variants = vec![
        LightKind::Ambient { color: [0.1, 0.2, 0.3] },
        LightKind::Point { position: DVec3::Y, intensity, falloff: Falloff::None },
        LightKind::Distant { direction: DVec3::new(0.1, -0.2, 0.3), intensity: Color::Curve(CurveId(7)) },
        LightKind::Spot {
            position: DVec3::Y,
            direction: -DVec3::Y,
            intensity: Color::Curve(CurveId(8)),
            cone_angle: 33.3,
            inner_angle: 11.1,
            edge: Edge::Linear,
            falloff: Falloff::Linear,
        },
        LightKind::Projection {
            image,
            filter: TexelFilter::Bilinear,
            quantity: Projected::Irradiance,
            intensity: 2.0,
            cone: Some([40.0, 15.0]),
            fov: 33.0,
            world_from_light,
        },
        LightKind::Goniometric { intensity, image, world_from_light },
        LightKind::Environment { sky: Sky::Constant(intensity), portal: Some(portal), illuminates: false },
        environment(Sky::Gradient { zenith: [0.1; 3], horizon: [0.2; 3], nadir: [0.5, 0.25, 0.125] }),
        environment(Sky::Image { image: ImageId(3), scale, world_from_light, rows: MapRows::ToPoles }),
        environment(Sky::Image {
            image,
            scale: [1.0; 3],
            world_from_light: DMat4::IDENTITY,
            rows: MapRows::Bands,
        }),
        environment(Sky::Octahedral { image: ImageId(3), scale, world_from_light }),
    ];
    let index = |kind: &LightKind| match kind {
        LightKind::Ambient { .. } => 0,
        LightKind::Point { .. } => 1,
        LightKind::Distant { .. } => 2,
        LightKind::Spot { .. } => 3,
        LightKind::Projection { .. } => 4,
        LightKind::Goniometric { .. } => 5,
        LightKind::Environment { sky: Sky::Constant(_), .. } => 6,
        LightKind::Environment { sky: Sky::Gradient { .. }, .. } => 7,
        LightKind::Environment { sky: Sky::Image { .. }, .. } => 8,
        LightKind::Environment { sky: Sky::Octahedral { .. }, .. } => 9,
    };
    each("light", variants, index, |scene, kind| {
        scene.lights.push(Light {
            name: Some("a lamp".to_owned()),
            at: here(),
            kind,
            power: Power::AS_WRITTEN,
        });
    })
}

/// Powers of a light, and of a shape.
fn powers() -> Vec<(String, Scene)> {
    let kinds = [Color::Value([1.0, 2.0, 3.0]), Color::Curve(CurveId(2))];
    let powers = [
        Power { scale: 0.3, total: None, absolute: false },
        Power { scale: 1.0, total: Some(7.0), absolute: false },
        Power { scale: 0.3, total: Some(7.0), absolute: false },
        Power { scale: 0.3, total: None, absolute: true },
    ];
    let scene = |color: Color, power: Power| {
        let mut scene = base();
        let kind = LightKind::Point { position: DVec3::Y, intensity: color, falloff: Falloff::Quadratic };
        scene.lights.push(Light { name: None, at: here(), kind, power });
        scene.shapes[0].emission = Some(Emission { radiance: color, power, two_sided: true });
        (format!("power {color:?} {power:?}"), scene)
    };
    kinds.iter().flat_map(|color| powers.iter().map(move |power| scene(*color, *power))).collect()
}

fn strands(profile: impl Fn(usize) -> Profile, count: usize, is_chain: bool) -> Geometry {
    let strand = |index: usize| {
        let start = index as f32 * if is_chain { 3.0 } else { 3.5 };
        let points = [0, 1, 2, 3].map(|k| Vec3::new(start + k as f32, (k * k) as f32 * 0.0 + 0.5, -0.25));
        let end = |index: usize| 0.1 / (1.0 + index as f32);
        Strand { points, width: [end(index), end(index + 1)], profile: profile(index) }
    };
    Geometry::Curves((0..count).map(strand).collect())
}

fn geometries() -> Vec<(String, Scene)> {
    let spheres = |count: usize, radius: f64| {
        let sphere = |k: usize| Sphere {
            center: DVec3::new(k as f64 / 3.0, 0.1, -0.0),
            radius: radius * (1 + k % 2) as f64,
        };
        Geometry::Spheres((0..count).map(sphere).collect())
    };
    let patches = |count: u32| {
        let vertices = 4 * count;
        let positions =
            (0..vertices).map(|k| Vec3::new((k % 2) as f32, (k / 2) as f32, (k as f32).sqrt())).collect();
        Geometry::Bilinear(Arc::new(Patches {
            positions,
            patches: (0..count).map(|k| [0, 1, 2, 3].map(|corner| 4 * k + corner)).collect(),
            normals: (0..vertices).map(|_| unit()).collect(),
            uvs: (0..vertices).map(|k| Vec2::new(k as f32, 0.1)).collect(),
        }))
    };
    let up = |index: usize| if index.is_multiple_of(2) { unit() } else { Vec3::Z };
    let ribbon = move |index: usize| Profile::Ribbon([up(index), up(index + 1)]);
    let variants = vec![
        Geometry::Sphere(Sphere { center: DVec3::new(0.1, 0.2, 0.3), radius: 1.0 / 3.0 }),
        spheres(3, 0.1),
        spheres(30, 0.1),
        Geometry::Quad { corner: DVec3::ZERO, edge_u: DVec3::X / 3.0, edge_v: DVec3::Y / 7.0 },
        Geometry::Disk { center: DVec3::Y, normal: DVec3::new(0.1, 0.2, 0.3), radius: 0.7 },
        Geometry::PartialSphere { radius: 2.0, z: [-2.0, 2.0], phi_max: 360.0 },
        Geometry::PartialSphere { radius: 2.0, z: [-1.0, 1.5], phi_max: 200.0 },
        Geometry::PartialDisk { height: 0.0, radius: 2.0, inner_radius: 0.0, phi_max: 360.0 },
        Geometry::PartialDisk { height: 1.5, radius: 2.0, inner_radius: 0.5, phi_max: 200.0 },
        Geometry::Cylinder { radius: 2.0, z: [-1.0, 1.5], phi_max: 200.0 },
        patches(2),
        patches(9),
        strands(|_| Profile::Flat, 3, true),
        strands(|_| Profile::Cylinder, 30, false),
        strands(ribbon, 2, true),
        strands(ribbon, 40, true),
        strands(ribbon, 3, false),
    ];
    let index = |geometry: &Geometry| match geometry {
        Geometry::Sphere(_) => 0,
        Geometry::Spheres(_) => 1,
        Geometry::Quad { .. } => 2,
        Geometry::Disk { .. } => 3,
        Geometry::PartialSphere { .. } => 4,
        Geometry::PartialDisk { .. } => 5,
        Geometry::Cylinder { .. } => 6,
        Geometry::Bilinear(_) => 7,
        Geometry::Curves(_) => 8,
        // By `meshes`.
        Geometry::Mesh(_) => 9,
    };
    let mut scenes = Vec::new();
    for matrix in [DMat4::IDENTITY, shear(), DMat4::from_translation(DVec3::new(1.0, 2.0, 1.0 / 3.0))] {
        scenes.extend(each("geometry", variants.clone(), index, |scene, geometry| {
            (scene.shapes[0].geometry, scene.shapes[0].world_from_object) = (geometry, matrix);
        }));
    }
    scenes
}

fn meshes() -> Vec<(String, Scene)> {
    let vertices = 20;
    let vector = |k: u32| Vec3::new(k as f32, 1.0 / (k as f32 + 1.0), -0.0);
    let vectors = |seed: u32| (0..vertices).map(|k| vector(k + seed)).collect::<Vec<_>>();
    let uvs = |seed: u32| (0..vertices).map(|k| Vec2::new(k as f32, seed as f32)).collect::<Vec<_>>();
    let plain = Mesh {
        name: "m".to_owned(),
        positions: vectors(0),
        // Not all have an area.
        triangles: (0..vertices - 2).map(|k| [k, k + 1, k + 2]).chain([[0, 0, 1]]).collect(),
        ..Mesh::default()
    };
    let all = Mesh {
        normals: vectors(1),
        uvs: uvs(1),
        more_uvs: vec![uvs(2), uvs(3)],
        colors: (0..vertices).map(|k| [k as f32, 300.0, 1e-9]).collect(),
        opacities: (0..vertices).map(|k| k as f32 / 20.0).collect(),
        tangents: (0..vertices).map(|k| Vec4::new(k as f32, 0.0, 0.0, -1.0)).collect(),
        displacement: Some(TEXTURE),
        is_of_solid: true,
        ..plain.clone()
    };
    let far = Mesh { positions: vectors(0).iter().map(|p| *p + Vec3::splat(1e6)).collect(), ..plain.clone() };
    let later = vec![MeshPose { positions: vectors(3), normals: vectors(4) }; 2];
    let moving = Mesh { normals: vectors(1), later, ..plain.clone() };
    let no_first_uvs = Mesh { more_uvs: vec![uvs(2)], ..plain.clone() };
    let small = Mesh {
        positions: vectors(0)[..3].to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 1]],
        normals: vectors(1)[..3].to_vec(),
        uvs: uvs(1)[..3].to_vec(),
        colors: vec![[0.5, 0.25, 2.0]; 3],
        displacement: Some(Scalar::Value(0.25)),
        ..plain.clone()
    };
    let scene = |(number, mesh): (usize, Mesh)| {
        let mut scene = base();
        scene.meshes.push(mesh);
        let shape = Shape { geometry: Geometry::Mesh(MeshId(0)), ..scene.shapes[0].clone() };
        // Shared by shapes of an object, which may change their form.
        scene.objects.push(Object { name: "o".to_owned(), at: here(), shapes: vec![shape.clone()] });
        let motion = Motion::of_maps(vec![shear(), DMat4::IDENTITY, shear()]).map(Arc::new);
        for motion in [None, motion] {
            let world_from_object = shear();
            let (at, object, material) = (here(), ObjectId(0), Some(MaterialId(0)));
            scene.instances.push(Instance { at, object, world_from_object, material, motion });
        }
        if scene.meshes[0].later.is_empty() {
            scene.shapes.push(shape);
        }
        (format!("mesh {number}"), scene)
    };
    [plain, all, far, moving, no_first_uvs, small].into_iter().enumerate().map(scene).collect()
}

fn media() -> Vec<(String, Scene)> {
    let numbers = |seed: u32| {
        let values: Vec<f32> = (0..5 * 3 * 9).map(|k| ((k + seed) % 7) as f32 / 3.0).collect();
        let grid = Grid::from_values([5, 3, 9], &values).expect("a grid");
        Placed { grid: Arc::new(grid), bounds: [Vec3::splat(-0.5), Vec3::new(1.0, 2.0, 3.3)] }
    };
    let colors = |seed: u32| {
        let values: Vec<[f32; 3]> = (0..5 * 3 * 9).map(|k| [0.5, ((k + seed) % 7) as f32, 0.0]).collect();
        let grid = Grid::from_values([5, 3, 9], &values).expect("a grid");
        Placed { grid: Arc::new(grid), bounds: [Vec3::NEG_ONE, Vec3::ONE] }
    };
    let variation = |density| Variation {
        world_from_medium: shear(),
        bounds: Some([Vec3::splat(-0.1), Vec3::splat(1.7)]),
        density,
        emission_scale: None,
        temperature: None,
    };
    let hot = Some(Temperature { grid: numbers(2), offset: 10.0, scale: 300.0 });
    let even = Density::Texture { of: Scalar::Value(1.0), most: 1.0 };
    let mut variants = vec![
        variation(Density::Grid(numbers(0))),
        variation(Density::Colors {
            absorption: Some(colors(1)),
            scattering: Some(colors(2)),
            emission: Some(colors(3)),
        }),
        variation(Density::Colors { absorption: None, scattering: Some(colors(2)), emission: None }),
        variation(Density::Cloud { density: 2.0, wispiness: 0.5, frequency: 4.0 }),
        variation(Density::Texture { of: TEXTURE, most: 2.0 }),
        Variation { temperature: hot.clone(), ..variation(Density::Grid(numbers(0))) },
        Variation { temperature: hot, bounds: None, emission_scale: Some(numbers(4)), ..variation(even) },
    ];
    variants.push(Variation { emission_scale: Some(numbers(1)), bounds: None, ..variants[0].clone() });
    let index = |variation: &Variation| match &variation.density {
        Density::Grid(_) => 0,
        Density::Colors { .. } => 1,
        Density::Cloud { .. } => 2,
        Density::Texture { .. } => 3,
        other => panic!("a density of a new kind has no words: {other:?}"),
    };
    let mut scenes = each("medium", variants, index, |scene, variation| {
        let is_hot = variation.temperature.is_some();
        scene.media[0] = Medium {
            extinction: match index(&variation) {
                0 => Extinction::Sum { sum: Color::Curve(TABLE), albedo: Color::gray(0.25) },
                _ => Extinction::Parts { absorption: Color::Curve(TABLE), scattering: Color::gray(0.5) },
            },
            scale: 3.0,
            emission: if is_hot { Color::BLACK } else { Color::Curve(CurveId(2)) },
            emission_scale: 5.0,
            variation: Some(variation),
            ..scene.media[0].clone()
        };
        let sides = Sides { inside: Some(MediumId(0)), outside: None };
        scene.shapes[0].sides = Some(sides);
    });
    let mut homogeneous = base();
    homogeneous.media[0] =
        Medium { droplets: Some(12.5), g: 0.0, scale: 2.0, ..homogeneous.media[0].clone() };
    homogeneous.shapes[0].sides = Some(Sides { inside: Some(MediumId(1)), outside: Some(MediumId(0)) });
    let mut two_lobes = homogeneous.clone();
    let draine = Some(DraineLobe { g: -0.5, alpha: 2.0, share: 0.25 });
    two_lobes.media[0] = Medium { droplets: None, g: 0.75, draine, ..two_lobes.media[0].clone() };
    scenes.push(("medium of droplets".to_owned(), homogeneous));
    scenes.push(("medium of two lobes".to_owned(), two_lobes));
    let mut vacuum = base();
    vacuum.shapes[0].sides = Some(Sides { inside: None, outside: None });
    scenes.push(("vacuum".to_owned(), vacuum));
    scenes
}

fn cameras() -> Vec<(String, Scene)> {
    let surface =
        |curvature_radius, index| LensSurface { curvature_radius, thickness: 1.25, index, diameter: 10.1 };
    let system = |shape, convention| {
        Projection::LensSystem(Arc::new(LensSystem {
            name: "lens".to_owned(),
            surfaces: vec![surface(35.98738, 1.54), surface(0.0, 0.0), surface(-24.7, 1.0)],
            stop_diameter: Some(5.7),
            shape,
            focus_distance: 1.0 / 3.0,
            film_diagonal: 43.3,
            millimetre: 0.0123,
            convention,
        }))
    };
    let picture = Arc::new(base().images[0].clone());
    let shapes = [
        ApertureShape::Circle,
        ApertureShape::Gaussian,
        ApertureShape::Square,
        ApertureShape::Pentagon,
        ApertureShape::Star,
        ApertureShape::Image(picture),
    ];
    let mut variants = vec![
        Projection::Perspective { fov: 33.3 },
        Projection::Orthographic { height: 3.3 },
        Projection::Equirectangular,
        Projection::EquirectangularPbrt,
        Projection::Octahedral,
        Projection::Irradiance { surface: "measured".to_owned() },
    ];
    variants.extend(shapes.map(|shape| system(shape, LensConvention::Pbrt)));
    let index = |projection: &Projection| match projection {
        Projection::Perspective { .. } => 0,
        Projection::Orthographic { .. } => 1,
        Projection::Equirectangular => 2,
        Projection::EquirectangularPbrt => 3,
        Projection::Octahedral => 4,
        Projection::LensSystem(system) => match system.shape {
            ApertureShape::Circle => 6,
            ApertureShape::Gaussian => 7,
            ApertureShape::Square => 8,
            ApertureShape::Pentagon => 9,
            ApertureShape::Star => 10,
            ApertureShape::Image(_) => 11,
        },
        Projection::Irradiance { .. } => 5,
    };
    let target = Target { lookat: DVec3::new(0.1, 0.2, 0.3), up: DVec3::Z };
    let views = [
        (View::Look { lookfrom: DVec3::new(0.1, 2.0, 3.0), lookat: DVec3::ZERO, up: DVec3::Z }, None),
        (View::Matrix(shear()), Some(target)),
        (View::Matrix(shear()), None),
        (Camera::default().view, None),
    ];
    let mut scenes = Vec::new();
    for (view, target) in views {
        scenes.extend(each("camera", variants.clone(), index, |scene, projection| {
            let is_flat =
                matches!(projection, Projection::Perspective { .. } | Projection::Orthographic { .. });
            let lens = Lens { radius: 0.1, focus_distance: 1.0 / 3.0 };
            scene.shapes[0].name = Some("measured".to_owned());
            scene.camera = Some(Camera {
                clip: Some([0.25, 1e4]),
                at: here(),
                view,
                target,
                projection,
                lens: is_flat.then_some(lens),
                window: is_flat.then_some(Window { x: [-0.1, 0.7], y: [-1.0, 1.0 / 3.0] }),
                distance: 2.0,
                medium: Some(MediumId(1)),
                shutter: 0.5,
                motion: Motion::of_maps(vec![DMat4::IDENTITY, shear()]).map(Arc::new),
            });
        }));
    }
    scenes
}

fn settings() -> Vec<(String, Scene)> {
    let filters = vec![
        FilterShape::Box.of_radius(0.7),
        FilterShape::Triangle.of_radius(1.0),
        FilterShape::Gaussian { sigma: 0.7 }.of_radius(2.0),
        FilterShape::Mitchell { b: 0.25, c: 0.5 }.of_radius(2.0),
        FilterShape::BlackmanHarris.of_radius(1.7),
        FilterShape::Sinc { tau: 2.5 }.of_radius(3.0),
    ];
    let of_filter = |filter: &lookfrom_scene::settings::Filter| match filter.shape {
        FilterShape::Box => 0,
        FilterShape::Triangle => 1,
        FilterShape::Gaussian { .. } => 2,
        FilterShape::Mitchell { .. } => 3,
        FilterShape::BlackmanHarris => 4,
        FilterShape::Sinc { .. } => 5,
    };
    let mut scenes = each("filter", filters, of_filter, |scene, mut filter| {
        filter.radius[1] *= 0.5;
        scene.image.filter = filter;
    });
    let mut integrators: Vec<Integrator> =
        Integrator::WORDS.iter().map(|(_, integrator)| *integrator).collect();
    integrators.push(Integrator::AmbientOcclusion { cosine: false });
    let of_integrator = |integrator: &Integrator| match integrator {
        Integrator::Raycast => 0,
        Integrator::Whitted => 1,
        Integrator::Path => 2,
        Integrator::SimplePath => 3,
        Integrator::RandomWalk => 4,
        Integrator::AmbientOcclusion { cosine: false } => 5,
        Integrator::AmbientOcclusion { cosine: true } => 6,
        Integrator::Normals => 7,
        Integrator::Depth => 8,
        Integrator::Uv => 9,
        Integrator::Id => 10,
    };
    scenes.extend(each("integrator", integrators, of_integrator, |scene, integrator| {
        scene.render = RenderSettings {
            integrator,
            samples: 3,
            allocation: Allocation::Adaptive,
            depth: 1000,
            min_contribution: 0.1,
            sampler: Sampler::Independent,
            seed: u64::MAX,
            transparent_shadows: false,
            color: ColorMode::Spectral,
            light_sampler: LightSampler::Power,
            portals: Portals::Auto,
            regularize: true,
            occlusion_distance: 1.5,
            media: false,
            thin_passages_count: false,
            open_fronts: true,
            hide_lights: true,
        };
        scene.vertex_normals = VertexNormals::AsGiven;
    }));
    let backgrounds =
        vec![Background::Environment, Background::Transparent, Background::Color([0.1, 0.2, 0.3])];
    let of_background = |background: &Background| match background {
        Background::Environment => 0,
        Background::Transparent => 1,
        Background::Color(_) => 2,
    };
    scenes.extend(each("background", backgrounds, of_background, |scene, background| {
        let layer = LightPathLayer {
            name: "a b".to_owned(),
            expression: "C<RD>L".to_owned(),
            at: Location::default(),
        };
        scene.image = ImageSettings {
            width: 33,
            height: 21,
            crop: Some(PixelBounds { x0: 1, y0: 2, x1: 30, y1: 20 }),
            exposure: -1.5,
            tonemap: Tonemap::Agx,
            sensor: Sensor {
                camera: CameraSensor::named("nikon_d810"),
                imaging_ratio: 0.5,
                white_balance: Some(5000.0),
                max_component: 12.5,
            },
            layers: Layers::Motion,
            light_paths: vec![layer],
            spectral_film: Some(SpectralFilm { buckets: 7, range: [400.0, 700.5], bands: bands() }),
            background,
            denoise: true,
            ..ImageSettings::default()
        };
    }));
    scenes
}

/// A band with each kind of response.
fn bands() -> Vec<Band> {
    let table = |count: usize| Curve::Tabulated {
        wavelengths: (0..count).map(|k| 400.0 + 0.25 * k as f32).collect(),
        values: (0..count).map(|k| (k % 7) as f32 * 0.125).collect(),
    };
    let responses = [table(5), table(900), Curve::Constant(0.5), Curve::Blackbody { kelvin: 3000.0 }];
    let names = ["a", "b-1", "c_2", "d"].map(str::to_owned);
    names.into_iter().zip(responses).map(|(name, response)| Band { name, response }).collect()
}

/// Shapes with each of their other properties.
fn looks() -> Vec<(String, Scene)> {
    let mut scene = base();
    scene.shapes[0] = Shape {
        name: Some("ball".to_owned()),
        alpha: Some(TEXTURE),
        reverse_orientation: true,
        single_sided: true,
        emission: Some(Emission::new(COLOR, false)),
        world_from_object: DMat4::from_translation(DVec3::Y) * DMat4::from_scale(DVec3::new(1.0, 2.0, 3.0)),
        ..scene.shapes[0].clone()
    };
    let mut clear = base();
    clear.shapes[0].alpha = Some(Scalar::Value(0.5));
    vec![("look".to_owned(), scene), ("alpha".to_owned(), clear)]
}

/// Compares scenes by all that has an effect on their pictures.
///
/// # Errors
/// The first difference of two scenes.
pub(super) fn same(before: &Scene, after: &Scene) -> Result<(), String> {
    let (before, after) = (told(before), told(after));
    match before.iter().zip(&after).find(|(before, after)| before != after) {
        Some((before, after)) => Err(format!("{before}\nhas become\n{after}")),
        None if before.len() != after.len() => {
            Err(format!("{} parts, and not {}", after.len(), before.len()))
        }
        None => Ok(()),
    }
}

/// The parts of a scene, in words that tell what is referred to instead of its number.
fn told(scene: &Scene) -> Vec<String> {
    let Scene { vertex_normals, camera, image, render, shapes, instances, lights, .. } = scene;
    let mut told = vec![format!("{vertex_normals:?} {render:?}")];
    let paths = image.light_paths.iter().map(|layer| LightPathLayer { at: here(), ..layer.clone() });
    told.push(format!("{:?}", ImageSettings { light_paths: paths.collect(), ..image.clone() }));
    let shape = |shape: &Shape| format!("{:?}", Shape { at: here(), ..shape.clone() });
    told.push(camera.as_ref().map_or(String::new(), camera_in_words));
    told.extend(shapes.iter().map(shape));
    for instance in instances {
        told.push(format!("{:?}", Instance { at: here(), ..instance.clone() }));
        told.extend(scene.objects[instance.object.index()].shapes.iter().map(shape));
    }
    told.extend(lights.iter().map(|light| format!("{:?}", Light { at: here(), ..light.clone() })));
    told.iter().map(|part| resolved(scene, part)).collect()
}

fn camera_in_words(camera: &Camera) -> String {
    let mut camera = Camera { at: here(), ..camera.clone() };
    if let Projection::LensSystem(system) = &camera.projection {
        let mut system = LensSystem { name: String::new(), ..(**system).clone() };
        if let ApertureShape::Image(image) = &system.shape {
            let mut image = (**image).clone();
            image.name.clear();
            system.shape = ApertureShape::Image(Arc::new(image));
        }
        camera.projection = Projection::LensSystem(Arc::new(system));
    }
    format!("{camera:?}")
}

/// A text with what numbers refer to in their place.
fn resolved(scene: &Scene, text: &str) -> String {
    const KINDS: [&str; 7] =
        ["TextureId(", "CurveId(", "MaterialId(", "MediumId(", "ImageId(", "MeshId(", "ObjectId("];
    let first = KINDS.iter().filter_map(|kind| text.find(kind).map(|at| (at, *kind))).min();
    let Some((at, kind)) = first else { return text.to_owned() };
    let (number, rest) = text[at + kind.len()..].split_once(')').expect("a number in brackets");
    let index: usize = number.parse().expect("a number");
    let of = match kind {
        "TextureId(" => format!("{:?}", scene.textures[index].kind),
        "CurveId(" => format!("{:?}", scene.curves[index]),
        "MaterialId(" => {
            let Material { kind, bump_mapping, bump_guard, medium, back_face, .. } = &scene.materials[index];
            format!("{kind:?} {bump_mapping:?} {bump_guard:?} {medium:?} {back_face:?}")
        }
        "MediumId(" => {
            let medium = &scene.media[index];
            let plain = Medium { name: String::new(), at: here(), variation: None, ..medium.clone() };
            format!("{plain:?} {}", medium.variation.as_ref().map_or(String::new(), variation_in_words))
        }
        "ImageId(" => {
            let image = &scene.images[index];
            let texels: Vec<[f32; 4]> = (0..image.len()).map(|texel| image.rgba(texel)).collect();
            format!("{}×{} {texels:?}", image.width, image.height)
        }
        "MeshId(" => format!("{:?}", Mesh { name: String::new(), ..scene.meshes[index].clone() }),
        _ => "an object".to_owned(),
    };
    format!("{}{}{}", &text[..at], resolved(scene, &of), resolved(scene, rest))
}

/// A variation with the values of its grids, however they are stored.
fn variation_in_words(variation: &Variation) -> String {
    fn values<T: Copy + Default + PartialEq + std::fmt::Debug>(placed: &Placed<T>) -> String {
        let [x, y, z] = placed.grid.size().map(|cells| cells as i32);
        let cells = (0..x * y * z).map(|index| [index % x, index / x % y, index / x / y]);
        let values: Vec<T> = cells.map(|cell| placed.grid.value(cell)).collect();
        format!("{:?} {values:?}", placed.bounds)
    }
    let Variation { world_from_medium, bounds, density, emission_scale, temperature } = variation;
    let density = match density {
        Density::Grid(placed) => values(placed),
        Density::Colors { absorption, scattering, emission } => {
            [absorption, scattering, emission].map(|of| of.as_ref().map_or(String::new(), values)).join(" ")
        }
        other => format!("{other:?}"),
    };
    let emission = emission_scale.as_ref().map_or(String::new(), values);
    let hot = temperature
        .as_ref()
        .map_or(String::new(), |hot| format!("{} {} {}", values(&hot.grid), hot.offset, hot.scale));
    format!("{world_from_medium:?} {bounds:?} {density} {emission} {hot}")
}
