//! What scenes of pbrt mean.

use std::path::{Path, PathBuf};

use glam::{DMat4, DVec3, Vec3};
use lookfrom_scene::camera::{Projection, View, Window};
use lookfrom_scene::lens::{ApertureShape, LensConvention, LensSystem};
use lookfrom_scene::light::{LightKind, Power, Sky};
use lookfrom_scene::material::{
    Color, Energy, Illuminant, Ior, MaterialKind, Metal, Pigment, Scalar, Subsurface, SubsurfaceMedium,
};
use lookfrom_scene::medium::Sides;
use lookfrom_scene::scene::{MaterialId, MediumId, MeshId};
use lookfrom_scene::settings::{
    ColorMode, Filter, FilterShape, Integrator, Layers, PixelBounds, Sampler, SpectralFilm,
};
use lookfrom_scene::shape::{Geometry, Profile};
use lookfrom_scene::spectrum::{CameraSensor, Curve};
use lookfrom_scene::texture::{Mapping, MipFilter, TexelFilter, TextureKind};
use lookfrom_scene::{LoadContext, Memory, Scene, load};

fn read_files(files: &[(&str, &str)]) -> (Scene, Vec<String>) {
    let memory =
        Memory(files.iter().map(|(name, text)| (PathBuf::from(name), text.as_bytes().to_vec())).collect());
    let mut context = LoadContext::new(&memory);
    let scene = load::scene(Path::new(files[0].0), &mut context).unwrap_or_else(|error| panic!("{error}"));
    (scene, context.warnings.iter().map(ToString::to_string).collect())
}

/// A scene without warnings.
fn read(text: &str) -> Scene {
    let (scene, warnings) = read_files(&[("dir/a.pbrt", text)]);
    assert!(warnings.is_empty(), "{warnings:?}");
    scene
}

#[test]
fn what_is_not_written_is_pbrts_default() {
    let scene = read("WorldBegin");
    assert_eq!((scene.image.width, scene.image.height), (1280, 720));
    assert_eq!(scene.image.filter, FilterShape::Gaussian { sigma: 0.5 }.of_radius(1.5));
    let render = &scene.render;
    assert_eq!((render.integrator, render.depth, render.samples), (Integrator::Path, 5, 16));
    assert_eq!((render.sampler, render.color), (Sampler::Sobol, ColorMode::Spectral));
    assert_eq!(scene.camera.expect("one").projection, Projection::Perspective { fov: 90.0 });
}

#[test]
fn filters_have_a_radius_along_each_axis() {
    let scene = read(
        "PixelFilter \"gaussian\" \"float xradius\" 2 \"float yradius\" .75 \"float sigma\" .4\nWorldBegin",
    );
    let shape = FilterShape::Gaussian { sigma: 0.4 };
    assert_eq!(scene.image.filter, Filter { shape, radius: [2.0, 0.75] });
    assert_eq!(scene.image.filter.to_string(), "gaussian:2:0.75 sigma 0.4");
}

#[test]
fn the_camera_sees_what_pbrts_sees() {
    let scene = read(
        "LookAt 3 0 0  3 0 5  0 1 0\n Camera \"perspective\" \"float fov\" 30 \"float lensradius\" .5 \"float focaldistance\" 7\n \
         Film \"gbuffer\" \"integer xresolution\" 200 \"integer yresolution\" 400 \"float cropwindow\" [ 0 .5 .25 1 ] \"float iso\" 200\n\
         WorldBegin",
    );
    let camera = scene.camera.expect("one");
    let View::Matrix(world_from_camera) = camera.view else { panic!("{:?}", camera.view) };
    // x to the left in our camera space is x to the right in pbrt's.
    let point = world_from_camera.transform_point3(DVec3::new(-1.0, 2.0, 4.0));
    assert!((point - DVec3::new(4.0, 2.0, 4.0)).length() < 1e-12, "{point}");
    assert!(world_from_camera.determinant() < 0.0, "pbrt's world is left-handed");
    // What it looks at is known to who goes around it, whatever other transforms there are.
    let target = camera.target.expect("one");
    assert!(
        (target.lookat - DVec3::new(3.0, 0.0, 5.0)).length() < 1e-12 && target.up == DVec3::Y,
        "{target:?}"
    );
    let moved =
        read("Scale -1 1 1 LookAt 3 0 0  3 0 5  0 1 0 Translate 0 0 1 Camera \"perspective\" WorldBegin");
    let target = moved.camera.and_then(|camera| camera.target).expect("one");
    assert!((target.lookat - DVec3::new(3.0, 0.0, 4.0)).length() < 1e-12, "{target:?}");
    let reset = read("LookAt 3 0 0  3 0 5  0 1 0 Identity Camera \"perspective\" WorldBegin");
    assert_eq!(reset.camera.and_then(|camera| camera.target), None);
    // The field of view is that of the shorter side. Nothing fixes the sides of a picture that is asked for in another shape.
    let Projection::Perspective { fov } = camera.projection else { panic!("{:?}", camera.projection) };
    assert!(((fov.to_radians() / 2.0).tan() / 15_f64.to_radians().tan() - 2.0).abs() < 1e-12, "{fov}");
    assert_eq!(camera.window, None);
    let wide = read(
        "Film \"rgb\" \"integer xresolution\" 300 \"integer yresolution\" 100 Camera \"perspective\" WorldBegin",
    );
    let wide = wide.camera.expect("one");
    assert_eq!((wide.projection, wide.window), (Projection::Perspective { fov: 90.0 }, None));
    let framed =
        read("Camera \"orthographic\" \"float frameaspectratio\" .5 WorldBegin").camera.expect("one");
    assert_eq!(framed.window, Some(Window { x: [-1.0, 1.0], y: [-2.0, 2.0] }));
    let lens = camera.lens.expect("one");
    assert_eq!((lens.radius, lens.focus_distance), (0.5, 7.0));
    assert_eq!(scene.image.crop, Some(PixelBounds { x0: 0, y0: 100, x1: 100, y1: 400 }));
    assert_eq!((scene.image.layers, scene.image.sensor.imaging_ratio), (Layers::Geometry, 2.0));
}

/// A realistic camera with these parameters.
fn realistic(parameters: &str, lens: &str) -> lookfrom_scene::Result<(LensSystem, usize)> {
    let text = format!(
        "Camera \"realistic\" \"string lensfile\" \"a.dat\" {parameters}\n\
         Film \"rgb\" \"float diagonal\" 24 WorldBegin"
    );
    let mut files = Memory([("s.pbrt".into(), text.into_bytes())].into());
    if !lens.is_empty() {
        files.0.insert("a.dat".into(), lens.into());
    }
    let mut context = LoadContext::new(&files);
    let scene = load::scene(Path::new("s.pbrt"), &mut context)?;
    let Some(Projection::LensSystem(system)) = scene.camera.map(|camera| camera.projection) else {
        panic!("no lens system")
    };
    Ok(((*system).clone(), context.warnings.len()))
}

#[test]
fn realistic_cameras_have_lens_systems() {
    let lens = "# front\n30 4 1.5 20\n0 1 0 12\n-70 0 1 20\n";
    let (system, warnings) =
        realistic("\"float focusdistance\" 2 \"float aperturediameter\" 8", lens).expect("one");
    assert_eq!((system.surfaces.len(), system.stop_diameter, warnings), (3, Some(8.0), 0));
    assert_eq!((system.focus_distance, system.film_diagonal, system.millimetre), (2.0, 24.0, 1e-3));
    assert_eq!((system.shape, system.convention), (ApertureShape::Circle, LensConvention::Pbrt));
    let (system, _) = realistic("\"string aperture\" \"star\"", lens).expect("one");
    assert_eq!(
        (system.shape, system.stop_diameter, system.focus_distance),
        (ApertureShape::Star, Some(1.0), 10.0)
    );
    let (_, warnings) = realistic("\"float aperturediameter\" 13", lens).expect("one");
    assert_eq!(warnings, 1, "it is wider than its lens file allows");
    let without_stop = "30 4 1.5 20\n-70 0 1 20\n";
    let (system, warnings) = realistic("\"float aperturediameter\" 3", without_stop).expect("one");
    assert_eq!((system.stop_diameter, warnings), (None, 0), "most scenes say a diameter");
    let (system, warnings) = realistic("\"string aperture\" \"star\"", without_stop).expect("one");
    assert_eq!((system.shape, warnings), (ApertureShape::Circle, 1), "nothing has a shape");
    let (system, warnings) = realistic("", "30 4 1.5 20\n").expect("one");
    assert_eq!((system.surfaces.len(), warnings), (1, 1), "the film is in glass");

    let of =
        |parameters: &str, lens: &str| realistic(parameters, lens).expect_err("no lens system").to_string();
    assert!(of("", "").contains("a.dat"), "{}", of("", ""));
    let both = of("\"string aperture\" \"no.png\"", "");
    assert!(both.contains("a.dat") && both.contains("no.png"), "all that is missing: {both}");
    assert!(of("", "30 4 1.5\n").contains("a.dat: 3 numbers"));
    assert!(of("", "30 x 1.5 20\n").contains("a.dat:1"));
    assert!(of("\"float focusdistance\" 0", lens).contains("focusdistance"));
}

#[test]
fn films_have_sensors() {
    let scene = read(
        "Camera \"perspective\" \"float shutterclose\" .5\n\
         Film \"rgb\" \"string sensor\" \"nikon_d850\" \"float iso\" 300 \"float whitebalance\" 5000 \"float maxcomponentvalue\" 10\n\
         WorldBegin",
    );
    let sensor = scene.image.sensor;
    assert_eq!(sensor.camera, CameraSensor::named("nikon_d850"));
    assert_eq!((sensor.imaging_ratio, sensor.white_balance, sensor.max_component), (1.5, Some(5000.0), 10.0));
    let swapped = "Camera \"perspective\" \"float shutteropen\" .75 \"float shutterclose\" .25 WorldBegin";
    let (swapped, warnings) = read_files(&[("a.pbrt", swapped)]);
    assert_eq!((swapped.image.sensor.imaging_ratio, warnings.len()), (0.5, 1), "as by pbrt: {warnings:?}");
    let observer = read("Film \"rgb\" \"string sensor\" \"cie1931\" WorldBegin").image.sensor;
    assert_eq!(observer, read("WorldBegin").image.sensor);
}

#[test]
fn spectral_films_have_buckets() {
    let scene = read("Film \"spectral\" WorldBegin");
    assert_eq!(
        scene.image.spectral_film,
        Some(SpectralFilm { buckets: 16, range: [360.0, 830.0], ..SpectralFilm::NONE })
    );
    assert_eq!(scene.render.color, ColorMode::Spectral);
    let scene = read(
        "Film \"spectral\" \"integer nbuckets\" 31 \"float lambdamin\" 400 \"float lambdamax\" 710 \"float iso\" 300\n\
         \"string filename\" \"a.exr\" \"bool savefp16\" false WorldBegin",
    );
    assert_eq!(
        scene.image.spectral_film,
        Some(SpectralFilm { buckets: 31, range: [400.0, 710.0], ..SpectralFilm::NONE })
    );
    assert_eq!(scene.image.sensor.imaging_ratio, 3.0);
    assert_eq!(read("Film \"rgb\" WorldBegin").image.spectral_film, None);
}

#[test]
fn transforms_multiply_from_the_right_and_attributes_end() {
    let scene = read(
        "WorldBegin Translate 1 2 3 AttributeBegin Scale 2 2 2 Shape \"sphere\" CoordinateSystem \"here\" AttributeEnd\n\
         ReverseOrientation Shape \"disk\" \"float radius\" 3\n CoordSysTransform \"here\" Shape \"cylinder\"\n\
         Transform [ 1 0 0 0  0 1 0 0  0 0 1 0  5 6 7 1 ] Shape \"sphere\" \"float zmin\" -.5",
    );
    let place = DMat4::from_translation(DVec3::new(1.0, 2.0, 3.0));
    let large = place * DMat4::from_scale(DVec3::splat(2.0));
    let found: Vec<DMat4> = scene.shapes.iter().map(|shape| shape.world_from_object).collect();
    assert_eq!(found, [large, place, large, DMat4::from_translation(DVec3::new(5.0, 6.0, 7.0))]);
    let reversed: Vec<bool> = scene.shapes.iter().map(|shape| shape.reverse_orientation).collect();
    assert_eq!(reversed, [false, true, true, true]);
    assert!(matches!(
        scene.shapes[3].geometry,
        Geometry::PartialSphere { z: [-0.5, 1.0], phi_max: 360.0, .. }
    ));
}

#[test]
fn materials_are_found_by_name_before_and_after() {
    let scene = read(
        "WorldBegin Shape \"sphere\" NamedMaterial \"late\" Shape \"sphere\"\n\
         MakeNamedMaterial \"late\" \"string type\" \"dielectric\" \"spectrum eta\" \"glass-BK7\" \"float roughness\" .25\n\
         Material \"conductor\" \"float uroughness\" .1 \"bool remaproughness\" false Shape \"sphere\"",
    );
    assert!(
        matches!(scene.materials[0].kind, MaterialKind::Diffuse { reflectance } if reflectance == Color::gray(0.5))
    );
    let ids: Vec<MaterialId> = scene.shapes.iter().map(|shape| shape.material).collect();
    assert_eq!(ids, [MaterialId(0), MaterialId(1), MaterialId(2)]);
    let MaterialKind::Dielectric {
        eta: Ior::Curve(glass), roughness, energy: Energy::SingleScattering, ..
    } = &scene.materials[1].kind
    else {
        panic!("{:?}", scene.materials[1])
    };
    assert!(matches!(scene.curves[glass.index()], Curve::Tabulated { .. }));
    assert_eq!((roughness.u, roughness.v, roughness.remap), (Scalar::Value(0.25), Scalar::Value(0.25), true));
    let MaterialKind::Conductor {
        metal: Metal::Indices { eta, k, illuminant: Illuminant::D65 },
        roughness,
        energy: Energy::SingleScattering,
        ..
    } = &scene.materials[2].kind
    else {
        panic!("{:?}", scene.materials[2])
    };
    assert!(matches!((eta, k), (Color::Curve(_), Color::Curve(_))), "copper");
    assert_eq!((roughness.u, roughness.v, roughness.remap), (Scalar::Value(0.1), Scalar::Value(0.0), false));
}

#[test]
fn textures_of_numbers_and_of_colours_have_names_of_their_own() {
    let scene = read(
        "WorldBegin Texture \"t\" \"float\" \"constant\" \"float value\" .3\n\
         Texture \"t\" \"spectrum\" \"checkerboard\" \"float uscale\" 4 \"rgb tex1\" [ .1 .2 .3 ]\n\
         Texture \"half\" \"spectrum\" \"scale\" \"texture tex\" \"t\" \"texture scale\" \"t\"\n\
         Material \"coateddiffuse\" \"texture reflectance\" \"half\" \"texture roughness\" \"t\" \"texture displacement\" \"later\"\n\
         Texture \"later\" \"float\" \"constant\" \"float value\" 2\n Shape \"sphere\" \"texture alpha\" \"t\"",
    );
    let MaterialKind::CoatedDiffuse { reflectance: Color::Texture(half), coat } = &scene.materials[1].kind
    else {
        panic!("{:?}", scene.materials[1])
    };
    assert_eq!(coat.roughness.u, Scalar::Value(0.3));
    assert_eq!(scene.shapes[0].alpha, Some(Scalar::Value(0.3)));
    let TextureKind::Scale { color: Color::Texture(checker), by } = scene.textures[half.index()].kind else {
        panic!()
    };
    assert_eq!(by, Scalar::Value(0.3));
    let TextureKind::Checker { even, odd, footprint, mapping } = scene.textures[checker.index()].kind else {
        panic!()
    };
    assert_eq!(footprint, TexelFilter::PBRT_FOOTPRINT);
    assert_eq!((even, odd), (Color::Value([0.1, 0.2, 0.3]), Color::BLACK));
    assert_eq!(mapping, Mapping::Uv { scale: [4.0, 1.0], offset: [0.0; 2] });
}

#[test]
fn pictures_have_pbrts_filters() {
    let pictures = [
        "",
        "\"string filter\" \"trilinear\"",
        "\"string filter\" \"ewa\"",
        "\"string filter\" \"EWA\" \"float maxanisotropy\" 16",
        "\"string filter\" \"point\" \"float maxanisotropy\" 1000",
    ];
    let png = lookfrom_scene::image::encode_png(1, 1, &[255, 0, 0]).expect("it is a picture");
    let of = |index: usize| {
        let text = format!(
            "WorldBegin Texture \"a\" \"spectrum\" \"imagemap\" \"string filename\" \"a.png\" {}\n\
             Material \"diffuse\" \"texture reflectance\" \"a\" Shape \"sphere\"",
            pictures[index]
        );
        let files = Memory(
            [(PathBuf::from("a.pbrt"), text.into_bytes()), (PathBuf::from("a.png"), png.clone())].into(),
        );
        let scene = load::scene(Path::new("a.pbrt"), &mut LoadContext::new(&files)).expect("a scene");
        match scene.textures[0].kind {
            TextureKind::Image { filter: TexelFilter::Mip { filter, footprint: 0.125 }, .. } => filter,
            ref other => panic!("{other:?}"),
        }
    };
    let ewa = |anisotropy| MipFilter::Ewa { anisotropy };
    let expected = [MipFilter::Bilinear, MipFilter::Trilinear, ewa(8.0), ewa(16.0), MipFilter::Nearest];
    assert_eq!([0, 1, 2, 3, 4].map(of), expected);
}

#[test]
fn lights_are_as_bright_as_pbrts() {
    let scene = read(
        "WorldBegin LightSource \"point\" \"rgb I\" [ 3 3 3 ] \"point3 from\" [ 1 0 0 ]\n\
         LightSource \"distant\" \"float illuminance\" 5 \"float scale\" 2 \"blackbody L\" 6500\n\
         LightSource \"infinite\" \"rgb L\" [ .5 .5 .5 ] \"float illuminance\" 8\n\
         AreaLightSource \"diffuse\" \"rgb L\" [ 7 7 7 ] \"bool twosided\" true Shape \"sphere\"",
    );
    let pi = std::f32::consts::PI;
    let powers: Vec<Power> = scene.lights.iter().map(|light| light.power).collect();
    assert_eq!(powers[0], Power { scale: 1.0 / pi, total: None, absolute: false });
    assert_eq!(powers[1], Power { scale: 2.0, total: Some(5.0), absolute: false });
    assert_eq!(powers[2].total, Some(8.0));
    assert!((powers[2].scale - 0.5).abs() < 1e-6);
    assert!(matches!(scene.lights[1].kind, LightKind::Distant { direction: DVec3::Z, .. }));
    assert!(matches!(&scene.lights[2].kind, LightKind::Environment { sky: Sky::Constant(_), .. }));
    let emission = scene.shapes[0].emission.expect("it shines");
    assert_eq!(
        (emission.radiance, emission.two_sided, emission.power),
        (Color::Value([7.0; 3]), true, Power::AS_WRITTEN)
    );
}

#[test]
fn attributes_give_defaults_and_keep_their_colour_space() {
    let scene = read(
        "WorldBegin Attribute \"shape\" \"float radius\" 4 ColorSpace \"rec2020\"\n\
         Attribute \"material\" \"rgb reflectance\" [ .2 .5 .1 ] ColorSpace \"srgb\"\n\
         Material \"diffuse\" Shape \"sphere\" Shape \"sphere\" \"float radius\" 1",
    );
    let radii: Vec<f64> = scene
        .shapes
        .iter()
        .map(|shape| match shape.geometry {
            Geometry::PartialSphere { radius, .. } => radius,
            _ => 0.0,
        })
        .collect();
    assert_eq!(radii, [4.0, 1.0]);
    let MaterialKind::Diffuse { reflectance: Color::Value([red, green, _]) } = scene.materials[1].kind else {
        panic!()
    };
    // A green of rec. 2020 is greener than all of Rec. 709: red comes out lower, green higher.
    assert!(red < 0.1 && green > 0.5, "{red} {green}");
}

#[test]
fn objects_are_placed_by_instances() {
    let scene = read(
        "WorldBegin Translate 1 0 0 ObjectInstance \"ball\" AttributeBegin Scale 2 2 2\n\
         ObjectBegin \"ball\" Scale 3 3 3 Shape \"sphere\" ObjectEnd AttributeEnd \
         Translate 0 1 0 ObjectInstance \"ball\"",
    );
    assert_eq!((scene.shapes.len(), scene.objects.len(), scene.instances.len()), (0, 1, 2));
    let move_right = DMat4::from_translation(DVec3::X);
    assert_eq!(
        scene.objects[0].shapes[0].world_from_object,
        move_right * DMat4::from_scale(DVec3::splat(6.0))
    );
    let places = [move_right, move_right * DMat4::from_translation(DVec3::Y)];
    assert_eq!(scene.instances.iter().map(|instance| instance.world_from_object).collect::<Vec<_>>(), places);
}

#[test]
fn files_lie_beside_the_scene_and_models_are_read_once() {
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
               element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    let (scene, warnings) = read_files(&[
        (
            "dir/a.pbrt",
            "Include \"sub/b.pbrt\" WorldBegin Include \"sub/c.pbrt\" Shape \"plymesh\" \"string filename\" \"m.ply\"",
        ),
        ("dir/sub/b.pbrt", "Film \"rgb\" \"integer xresolution\" 7"),
        (
            "dir/sub/c.pbrt",
            "Include \"d.pbrt\" Shape \"plymesh\" \"string filename\" \"m.ply\" Translate 1 1 1",
        ),
        ("dir/sub/d.pbrt", "# found beside the file that names it\n"),
        ("dir/m.ply", ply),
    ]);
    assert!(warnings.is_empty(), "{warnings:?}");
    assert_eq!((scene.image.width, scene.meshes.len(), scene.shapes.len()), (7, 1, 2));
    assert!(scene.shapes.iter().all(|shape| matches!(shape.geometry, Geometry::Mesh(MeshId(0)))));
    assert_eq!(
        scene.shapes[1].world_from_object,
        DMat4::from_translation(DVec3::ONE),
        "an Include ends no attributes"
    );
}

#[test]
fn curves_taper_over_their_segments() {
    let scene = read(
        "WorldBegin Shape \"curve\" \"string basis\" \"bspline\" \"float width0\" 2 \"float width1\" 0\n\
         \"point3 P\" [ 0 0 0  1 0 0  2 0 0  3 0 0  4 0 0 ] \"string type\" \"cylinder\"",
    );
    let Geometry::Curves(strands) = &scene.shapes[0].geometry else { panic!() };
    assert_eq!(strands.len(), 2);
    assert_eq!((strands[0].width, strands[1].width), ([2.0, 1.0], [1.0, 2e-6]));
    assert!(
        strands[0].points[0].abs_diff_eq(Vec3::X, 1e-6)
            && strands[1].points[3].abs_diff_eq(3.0 * Vec3::X, 1e-6)
    );
    assert_eq!(strands[0].profile, Profile::PbrtCylinder);
}

#[test]
fn what_is_not_rendered_is_warned_of_once() {
    let (scene, warnings) = read_files(&[(
        "a.pbrt",
        "Integrator \"bdpt\" Sampler \"stratified\" \"integer xsamples\" 3 WorldBegin\n\
         Shape \"disk\"\n\
         Texture \"a\" \"spectrum\" \"ptex\" Texture \"b\" \"spectrum\" \"ptex\"\n\
         Shape \"sphere\" \"float raduis\" 2",
    )]);
    let expected = [
        "a.pbrt:1:1: the integrator \"bdpt\" is not supported: \"volpath\", which computes the same light, is used instead",
        "a.pbrt:3:1: textures of the type \"ptex\" are not supported: they are gray; give the mesh texture coordinates, bake the Ptex file to a picture, and write \"imagemap\"",
        "a.pbrt:4:16: Shape \"sphere\" has no parameter \"float raduis\"; did you mean \"radius\"?",
    ];
    assert_eq!(warnings, expected);
    assert_eq!(scene.render.samples, 12);
}

#[test]
fn lights_in_objects_emit_where_they_are_asked_to() {
    let text = "WorldBegin ObjectBegin \"lamp\" AreaLightSource \"diffuse\" Shape \"sphere\" Shape \"disk\" ObjectEnd\n\
                ObjectInstance \"lamp\"";
    let emitting = |instanced_lights: bool| {
        let memory = Memory([(PathBuf::from("a.pbrt"), text.as_bytes().to_vec())].into());
        let mut context = LoadContext::new(&memory);
        context.import.instanced_lights = instanced_lights;
        let scene = load::scene(Path::new("a.pbrt"), &mut context).unwrap_or_else(|error| panic!("{error}"));
        let count = scene.objects[0].shapes.iter().filter(|shape| shape.emission.is_some()).count();
        (count, context.warnings.iter().map(ToString::to_string).collect::<Vec<_>>())
    };
    assert_eq!(emitting(true), (2, Vec::new()));
    let (count, warnings) = emitting(false);
    let warning = "a.pbrt:1:57: area lights in objects do not emit light, as in pbrt";
    assert_eq!((count, warnings.len()), (0, 1));
    assert!(warnings[0].starts_with(warning) && warnings[0].contains("`instanced_lights`"), "{warnings:?}");
}

#[test]
fn hair_has_its_colour_in_one_of_three_ways() {
    let hair = |parameters: &str| {
        let text = format!("WorldBegin Material \"hair\" {parameters} Shape \"sphere\"");
        let (scene, warnings) = read_files(&[("a.pbrt", &text)]);
        let MaterialKind::Hair(hair) = &scene.materials[1].kind else { panic!("{:?}", scene.materials[1]) };
        ((**hair).clone(), warnings)
    };
    let number = Scalar::Value;
    let (brown, warnings) = hair("");
    assert_eq!((brown.pigment, warnings.len()), (Pigment::BROWN, 0));
    let numbers = [brown.eta, brown.beta_m, brown.beta_n, brown.alpha];
    assert_eq!(numbers, [number(1.55), number(0.3), number(0.3), number(2.0)]);

    let (red, _) =
        hair("\"float pheomelanin\" 2 \"float beta_m\" 0.1 \"float beta_n\" 0.2 \"float alpha\" 3");
    assert_eq!(red.pigment, Pigment::Melanin { eumelanin: number(0.0), pheomelanin: number(2.0) });
    assert_eq!([red.beta_m, red.beta_n, red.alpha], [number(0.1), number(0.2), number(3.0)]);

    let (dyed, _) = hair("\"rgb color\" [0.1 0.5 0.2]");
    assert_eq!(dyed.pigment, Pigment::Reflectance(Color::Value([0.1, 0.5, 0.2])));
    let (dark, warnings) = hair("\"rgb sigma_a\" [4 5 6] \"float eumelanin\" 1");
    assert_eq!(dark.pigment, Pigment::Absorption(Color::Value([4.0, 5.0, 6.0])));
    let message = "a.pbrt:1:12: the colour of hair is given in more than one way: only \"sigma_a\" is used";
    assert_eq!(warnings, [message]);
}

/// The material of the last shape.
fn subsurface(parameters: &str) -> (Subsurface, Vec<String>) {
    let (scene, warnings) = read_files(&[(
        "a.pbrt",
        &format!("WorldBegin Material \"subsurface\" {parameters} Shape \"sphere\""),
    )]);
    let MaterialKind::Subsurface(below) = &scene.materials[1].kind else {
        panic!("{:?}", scene.materials[1])
    };
    ((**below).clone(), warnings)
}

#[test]
fn media_below_surfaces_have_names_coefficients_or_effects() {
    let coefficients = |absorption, scattering| SubsurfaceMedium::Coefficients {
        absorption: Color::Value(absorption),
        scattering: Color::Value(scattering),
    };
    let (milk, warnings) = subsurface("");
    assert_eq!((milk.medium, milk.scale, milk.g, milk.eta), (SubsurfaceMedium::MILK, 1.0, 0.0, 1.33));
    assert_eq!((milk.roughness.u, milk.roughness.remap, warnings.len()), (Scalar::Value(0.0), true, 0));

    let (skin, warnings) = subsurface("\"string name\" \"Skin1\" \"float scale\" 12 \"float g\" 0.5");
    assert_eq!(skin.medium, coefficients([0.032, 0.17, 0.48], [0.74, 0.88, 1.01]));
    assert_eq!((skin.scale, skin.g), (12.0, 0.0));
    let message =
        "a.pbrt:1:12: \"g\" has no effect on a medium by \"name\": its coefficients are those for 0";
    assert_eq!(warnings, [message]);

    let (wax, _) = subsurface(
        "\"rgb sigma_a\" [ 1 2 3 ] \"rgb sigma_s\" [ 4 5 6 ] \"float g\" 0.5 \"float eta\" 1.4 \"float vroughness\" 0.2",
    );
    assert_eq!(wax.medium, coefficients([1.0, 2.0, 3.0], [4.0, 5.0, 6.0]));
    assert_eq!((wax.g, wax.eta, wax.roughness.v), (0.5, 1.4, Scalar::Value(0.2)));

    let (jade, _) = subsurface("\"rgb reflectance\" [ 0.3 0.7 0.4 ] \"rgb mfp\" [ 0.1 0.2 0.3 ]");
    let reflectance = Color::Value([0.3, 0.7, 0.4]);
    let mean_free_path = Color::Value([0.1, 0.2, 0.3]);
    assert_eq!(jade.medium, SubsurfaceMedium::Reflectance { reflectance, mean_free_path });
    // Of two ways to describe it the first counts, and the other has no effect.
    let (_, warnings) = subsurface("\"string name\" \"Apple\" \"rgb sigma_s\" [ 1 1 1 ]");
    assert_eq!(warnings.len(), 1, "{warnings:?}");
}

#[test]
fn media_are_around_the_camera_and_beside_shapes() {
    let made = "MakeNamedMedium \"a\" \"string type\" \"homogeneous\" \"rgb sigma_s\" [ 0 0 0 ]\n\
                MakeNamedMedium \"b\" \"string type\" \"homogeneous\" \"rgb sigma_s\" [ 0 0 0 ] \"rgb Le\" [ 1 0 0 ]\n\
                MakeNamedMedium \"c\" \"string type\" \"homogeneous\" \"string preset\" \"Skin1\"\n";
    let world = "Camera \"perspective\" WorldBegin Shape \"sphere\" MediumInterface \"a\" Shape \"sphere\"\n\
                 MediumInterface \"c\" \"\" Shape \"sphere\"";
    let of = |integrator: &str| {
        read_files(&[("a.pbrt", &format!("{integrator}\n{made}MediumInterface \"a\" \"b\"\n{world}"))])
    };
    for integrator in ["", "Integrator \"volpath\"", "Integrator \"simplevolpath\""] {
        let (scene, warnings) = of(integrator);
        assert!(warnings.is_empty(), "{warnings:?}");
        assert!(scene.render.media, "{integrator}");
        assert_eq!(scene.camera.expect("one").medium, Some(MediumId(1)));
        let sides: Vec<_> = scene.shapes.iter().map(|shape| shape.sides).collect();
        let border = Sides { inside: Some(MediumId(0)), outside: Some(MediumId(1)) };
        assert_eq!(sides, [Some(border), None, Some(Sides { inside: Some(MediumId(2)), outside: None })]);
    }
    for integrator in ["path", "simplepath", "randomwalk", "ambientocclusion"] {
        let (scene, warnings) = of(&format!("Integrator \"{integrator}\""));
        assert!(!scene.render.media, "{integrator}");
        assert_eq!(warnings.len(), 1);
        assert!(
            warnings[0]
                .starts_with(&format!("a.pbrt:1:1: the integrator {integrator:?} does not support media"))
        );
    }
    let unknown = "MediumInterface \"d\" Camera \"perspective\" WorldBegin";
    let files = Memory([(PathBuf::from("a.pbrt"), unknown.as_bytes().to_vec())].into());
    let error =
        load::scene(Path::new("a.pbrt"), &mut LoadContext::new(&files)).expect_err("an unknown medium");
    assert!(error.to_string().starts_with("a.pbrt:1:21: \"d\" is not a known medium"), "{error}");
}

#[test]
fn names_may_be_used_before_they_are_defined() {
    let scene = read(
        "WorldBegin MediumInterface \"fog\" \"\" Material \"mix\" \"string materials\" [ \"a\" \"b\" ] Shape \"sphere\"\n\
         MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"float g\" 0.5\n\
         MakeNamedMaterial \"b\" \"string type\" \"diffuse\" MakeNamedMaterial \"a\" \"string type\" \"conductor\"",
    );
    assert_eq!((scene.media.len(), scene.media[0].g), (1, 0.5));
    assert_eq!(scene.shapes[0].sides, Some(Sides { inside: Some(MediumId(0)), outside: None }));
    let MaterialKind::Mix { materials, .. } = scene.materials[scene.shapes[0].material.index()].kind else {
        panic!()
    };
    let kind = |id: MaterialId| &scene.materials[id.index()].kind;
    assert!(matches!(kind(materials[0]), MaterialKind::Conductor { .. }));
    assert!(matches!(kind(materials[1]), MaterialKind::Diffuse { .. }));
}

#[test]
fn old_blocks_are_those_of_attributes() {
    let text = "WorldBegin TransformBegin Translate 1 0 0 Material \"conductor\" TransformEnd Shape \"sphere\"\n\
                TransformBegin ReverseOrientation AttributeEnd Shape \"sphere\"";
    let (scene, warnings) = read_files(&[("a.pbrt", text)]);
    assert!(scene.shapes.iter().all(|shape| shape.material == MaterialId(0) && !shape.reverse_orientation));
    assert_eq!(warnings.len(), 3, "{warnings:?}");
    for option in ["\"bool disable-pixel-jitter\" false", "\"integer Seed\" 7"] {
        read(&format!("Option {option} WorldBegin"));
    }
    read("WorldBegin LightSource \"infinite\" \"string filename\" \"\" \"rgb L\" [ 1 1 1 ]");
}

#[test]
fn a_scene_without_an_ending_is_known_by_its_words() {
    let (scene, _) =
        read_files(&[("scene", "# a comment\nLookAt 0 0 0 0 0 1 0 1 0\nWorldBegin\nShape \"sphere\"\n")]);
    assert_eq!(scene.shapes.len(), 1);
}

#[test]
fn textures_of_numbers_prefer_the_opacity_of_a_picture() {
    // 2 × 1 texels: white and opaque, black and clear.
    let mut tga = vec![0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 1, 0, 32, 8 | 0x20];
    tga.extend([255, 255, 255, 255, 0, 0, 0, 0]);
    let text = "WorldBegin Texture \"a\" \"float\" \"imagemap\" \"string filename\" \"a.tga\"\n\
                Texture \"c\" \"spectrum\" \"imagemap\" \"string filename\" \"a.tga\" Shape \"disk\" \"texture alpha\" \"a\"";
    let memory = Memory([(PathBuf::from("a.pbrt"), text.as_bytes().to_vec()), ("a.tga".into(), tga)].into());
    let scene = load::scene(Path::new("a.pbrt"), &mut LoadContext::new(&memory))
        .unwrap_or_else(|error| panic!("{error}"));
    let alpha = [[1.0; 3], [0.0; 3]];
    assert_eq!((scene.images.len(), scene.images[0].texels().collect::<Vec<_>>()), (2, alpha.to_vec()));
    assert!(matches!(scene.shapes[0].alpha, Some(Scalar::Texture(_))));
}

#[test]
fn curves_that_are_alike_are_one_shape() {
    let curve = "Shape \"curve\" \"point3 P\" [ 0 0 0 1 0 0 2 0 0 3 0 0 ]\n";
    let scene = read(&format!(
        "WorldBegin {curve}{curve}Shape \"sphere\" {curve}Translate 1 0 0 {curve}{curve}{curve}"
    ));
    let counts: Vec<usize> = scene
        .shapes
        .iter()
        .map(|shape| match &shape.geometry {
            Geometry::Curves(strands) => strands.len(),
            _ => 0,
        })
        .collect();
    assert_eq!(counts, [2, 0, 1, 3]);
}

#[test]
fn a_filter_that_is_too_wide_is_narrowed_with_a_warning() {
    let text = "PixelFilter \"box\" \"float xradius\" 20 \"float yradius\" 3\nWorldBegin Shape \"sphere\"";
    let (scene, warnings) = read_files(&[("a.pbrt", text)]);
    assert_eq!(scene.image.filter.radius, [16.0, 3.0]);
    scene.validate().expect("it is valid");
    assert!(warnings.iter().any(|told| told.contains("20 × 3 pixels")), "{warnings:?}");
}
