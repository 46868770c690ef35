//! What surfaces say besides their form: patterns that shine, parts and sides that are not there, further texture
//! coordinates, the frame of tangents.

use glam::{DMat4, DVec3, Vec2, Vec3};
use lookfrom::light::Light;
use lookfrom::render::Renderer;
use lookfrom::world::World;
use lookfrom_bvh::Ray;
use lookfrom_scene::camera::{Camera, Projection, View};
use lookfrom_scene::image::{Encoding, Image};
use lookfrom_scene::light::{Falloff, Light as WrittenLight, LightKind, Power};
use lookfrom_scene::material::{Color, Material, MaterialKind, Scalar};
use lookfrom_scene::scene::{ImageId, Instance, MaterialId, MeshId, Object, ObjectId, Scene, TextureId};
use lookfrom_scene::settings::{ColorMode, Integrator};
use lookfrom_scene::shape::{Emission, Geometry, Mesh, Shape};
use lookfrom_scene::texture::{Channel, Mapping, TexelFilter, Texture, TextureKind, Wrap};
use lookfrom_scene::{Location, Warning};

fn nowhere() -> Location {
    Location::default()
}

fn compiled(scene: Scene) -> World {
    let mut warnings: Vec<Warning> = Vec::new();
    World::compile(scene, &mut warnings).expect("a good scene")
}

/// The mean over the picture.
fn mean(scene: Scene) -> f64 {
    let renderer = Renderer::of_scene(scene, &mut Vec::new()).expect("a good scene");
    let rendered = renderer.render(None, &()).expect("a picture");
    assert_eq!(rendered.film.dropped(), 0);
    let pixels = rendered.film.picture().pixels;
    pixels.iter().flatten().map(|&c| f64::from(c)).sum::<f64>() / (3 * pixels.len()) as f64
}

/// A scene of one white material, seen from above (+y) in 8 × 8 pixels.
fn scene() -> Scene {
    let mut scene = Scene::default();
    let white = MaterialKind::Diffuse { reflectance: Color::gray(1.0) };
    scene.materials.push(Material::new("white", nowhere(), white));
    (scene.image.width, scene.image.height) = (8, 8);
    scene.render.integrator = Integrator::Path;
    scene.render.samples = 64;
    let view = View::Look { lookfrom: DVec3::new(0.0, 5.0, 0.0), lookat: DVec3::ZERO, up: DVec3::NEG_Z };
    let projection = Projection::Perspective { fov: 20.0 };
    scene.camera = Some(Camera { view, projection, ..Camera::default() });
    scene
}

/// A square of side 2 around the origin in the plane y = 0, outside up, of 2 · `cells`² triangles; u along x, v along −z.
fn square(cells: u32) -> Mesh {
    let side = cells + 1;
    let uv = |k: u32| Vec2::new((k % side) as f32, (k / side) as f32) / cells as f32;
    let cell = |k: u32| {
        let first = k / cells * side + k % cells;
        [[first, first + 1, first + side + 1], [first, first + side + 1, first + side]]
    };
    Mesh {
        positions: (0..side * side)
            .map(uv)
            .map(|uv| Vec3::new(2.0 * uv.x - 1.0, 0.0, 1.0 - 2.0 * uv.y))
            .collect(),
        uvs: (0..side * side).map(uv).collect(),
        triangles: (0..cells * cells).flat_map(cell).collect(),
        ..Mesh::default()
    }
}

fn push(scene: &mut Scene, mesh: Mesh) -> Shape {
    scene.meshes.push(mesh);
    Shape::new(nowhere(), Geometry::Mesh(MeshId(scene.meshes.len() as u32 - 1)), MaterialId(0))
}

fn picture_of(scene: &mut Scene, image: Image, channel: Channel, mapping: Mapping) -> TextureId {
    scene.images.push(image);
    let image = ImageId(scene.images.len() as u32 - 1);
    let (wrap, filter) = ([Wrap::Clamp; 2], TexelFilter::Nearest);
    push_texture(
        scene,
        TextureKind::Image { image, mapping, wrap, filter, channel, scale: 1.0, invert: false },
    )
}

fn push_texture(scene: &mut Scene, kind: TextureKind) -> TextureId {
    scene.textures.push(Texture { name: String::new(), at: nowhere(), kind });
    TextureId(scene.textures.len() as u32 - 1)
}

/// One texel of `side`² shines.
fn spot(side: u32) -> Image {
    let mut texels = vec![[0, 0, 0, 255]; (side * side) as usize];
    texels[(side * (side / 4) + 11 * side / 16) as usize] = [255, 255, 255, 255];
    Image::from_bytes("spot", side, side, texels, Encoding::Srgb)
}

/// A floor under a lamp of 2 · `cells`² triangles that shines where `glow` says.
fn under_lamp(cells: u32, glow: impl FnOnce(&mut Scene) -> Color) -> Scene {
    let mut scene = scene();
    let floor = push(&mut scene, square(1));
    let mut lamp = push(&mut scene, square(cells));
    let glow = glow(&mut scene);
    lamp.emission = Some(Emission::new(glow, false));
    // Turned over and aside: the camera sees none of it.
    lamp.world_from_object = DMat4::from_translation(DVec3::new(0.0, 0.5, 1.5)) * DMat4::from_rotation_x(3.0);
    scene.shapes = vec![floor, lamp];
    scene
}

/// What is asked and what is found by chance come to the same, however a pattern lies on its triangles.
#[test]
fn patterns_shine_as_bright_as_they_are_found_by_chance() {
    for color in [ColorMode::Rgb, ColorMode::Spectral] {
        let lit = |cells, integrator, samples| {
            let mut scene = under_lamp(cells, |scene| {
                let spot = picture_of(scene, spot(4), Channel::Rgb, Mapping::UV);
                let (a, b) = (Color::Texture(spot), Color::gray(100.0));
                Color::Texture(push_texture(scene, TextureKind::Product { a, b }))
            });
            (scene.render.integrator, scene.render.samples, scene.render.color) =
                (integrator, samples, color);
            scene.render.depth = 1;
            mean(scene)
        };
        let by_chance = lit(1, Integrator::RandomWalk, 1 << 16);
        for cells in [1, 40] {
            let asked = lit(cells, Integrator::Path, 4096);
            assert!(asked > 1e-3 && (asked / by_chance - 1.0).abs() < 0.05, "{cells}: {asked} {by_chance}");
        }
    }
}

#[test]
fn triangles_of_a_pattern_are_asked_where_it_shines() {
    let world = compiled(under_lamp(32, |scene| {
        Color::Texture(picture_of(scene, spot(16), Channel::Rgb, Mapping::UV))
    }));
    let Light::Area(lamp) = &world.lights()[0] else { panic!("{:?}", world.lights()[0]) };
    assert!(lamp.is_sampled() && (lamp.mean_of_pattern().unwrap() * 256.0 - 1.0).abs() < 1e-3);
    for k in 0..256 {
        let u = [(k % 16) as f32 / 16.0, (k / 16) as f32 / 16.0];
        let point = lamp.sample_point(DVec3::ZERO, u).expect("a point");
        // The triangles of the spot's four cells.
        assert!((point.uv * 16.0 - Vec2::new(11.5, 11.5)).abs().max_element() < 0.501, "{:?}", point.uv);
    }
    // The box around what is asked is small.
    let extent = lamp.emitter_bounds();
    assert!((extent.max - extent.min).max_element() < 0.2, "{extent:?}");

    // What shines nowhere is not asked.
    let dark = Image::from_bytes("dark", 1, 1, vec![[0, 0, 0, 255]], Encoding::Srgb);
    let world =
        compiled(under_lamp(4, |scene| Color::Texture(picture_of(scene, dark, Channel::Rgb, Mapping::UV))));
    let Light::Area(lamp) = &world.lights()[0] else { panic!("{:?}", world.lights()[0]) };
    assert!(!lamp.is_sampled() && lamp.sample_point(DVec3::ZERO, [0.5; 2]).is_none());
    let at = lookfrom::light::LightSampleContext { point: DVec3::ZERO, n: Vec3::Z, time: 0.0 };
    assert!(world.light_choice().sample(&at, 0.5).is_none());
}

/// A point light over a white floor, and between light and floor (seen from above) whatever `between` is.
fn lit_floor(integrator: Integrator, between: impl FnOnce(&mut Scene) -> Option<Shape>) -> f64 {
    let mut scene = scene();
    scene.render.integrator = integrator;
    scene.render.depth = 8;
    let mut floor = push(&mut scene, square(1));
    floor.world_from_object = DMat4::from_scale(DVec3::splat(20.0));
    scene.shapes.push(floor);
    if let Some(mut shape) = between(&mut scene) {
        shape.world_from_object = DMat4::from_translation(DVec3::Y) * shape.world_from_object;
        scene.shapes.push(shape);
    }
    let kind = LightKind::Point {
        position: DVec3::new(0.0, 4.0, 0.0),
        intensity: Color::gray(10.0),
        falloff: Falloff::Quadratic,
    };
    scene.lights.push(WrittenLight { name: None, at: nowhere(), kind, power: Power::AS_WRITTEN });
    mean(scene)
}

const ALL: [Integrator; 3] = [Integrator::Path, Integrator::Whitted, Integrator::Raycast];

#[test]
fn what_is_not_there_is_neither_seen_nor_casts_shadows() {
    let alpha = |opacity: f32| {
        move |scene: &mut Scene| {
            let mut sheet = square(4);
            sheet.opacities = vec![opacity; sheet.positions.len()];
            let mut sheet = push(scene, sheet);
            let white = Image::from_bytes("", 1, 1, vec![[0, 0, 0, 255]], Encoding::Srgb);
            let a = Color::Texture(picture_of(scene, white, Channel::Alpha, Mapping::UV));
            let b = Color::Texture(push_texture(scene, TextureKind::VertexAlpha));
            sheet.alpha = Some(Scalar::Texture(push_texture(scene, TextureKind::Product { a, b })));
            Some(sheet)
        }
    };
    for integrator in ALL {
        let [free, clear, half, whole] = [
            lit_floor(integrator, |_| None),
            lit_floor(integrator, alpha(0.0)),
            lit_floor(integrator, alpha(0.5)),
            lit_floor(integrator, alpha(1.0)),
        ];
        assert!((clear / free - 1.0).abs() < 0.02, "{integrator:?}: {clear} {free}");
        assert!((whole / free - 1.0).abs() > 0.1, "{integrator:?}: {whole} {free}");
        assert!(
            (half / free - 1.0).abs() > 0.02 && (half / whole - 1.0).abs() > 0.02,
            "{integrator:?}: {half}"
        );
    }
}

#[test]
fn the_camera_sees_through_backs_but_light_does_not() {
    let sheet = |single_sided: bool, turn: f64| {
        move |scene: &mut Scene| {
            let mut sheet = push(scene, square(1));
            sheet.single_sided = single_sided;
            sheet.world_from_object = DMat4::from_rotation_x(turn);
            Some(sheet)
        }
    };
    let over = std::f64::consts::PI;
    for integrator in ALL {
        let plain = [0.0, over].map(|turn| lit_floor(integrator, sheet(false, turn)));
        let single = [0.0, over].map(|turn| lit_floor(integrator, sheet(true, turn)));
        assert!((single[0] / plain[0] - 1.0).abs() < 1e-6, "{integrator:?}: the front is seen");
        // In place of the lit sheet the floor in its shadow.
        assert!(single[1] < 0.8 * plain[1], "{integrator:?}: {single:?} {plain:?}");
    }
}

/// A scene of one mesh with three materials: white, brushed, and a mixture of both; the mesh is brushed.
fn brushed(mesh: &Mesh, place: DMat4, as_instance: bool, reverse: bool) -> Scene {
    let mut scene = scene();
    let kind = MaterialKind::Conductor {
        metal: lookfrom_scene::material::Metal::Reflectance(Color::gray(0.5)),
        roughness: lookfrom_scene::material::Roughness::of_alphas(Scalar::Value(0.1), Scalar::Value(0.5)),
        energy: lookfrom_scene::material::Energy::SingleScattering,
        specular_reflectance: Color::gray(1.0),
    };
    scene.materials.push(Material::new("brushed", nowhere(), kind));
    let mixed = MaterialKind::Mix { materials: [MaterialId(0), MaterialId(1)], amount: Scalar::Value(0.5) };
    scene.materials.push(Material::new("mixed", nowhere(), mixed));
    let mut shape = push(&mut scene, mesh.clone());
    shape.material = MaterialId(1);
    shape.reverse_orientation = reverse;
    if as_instance {
        scene.objects.push(Object { name: String::new(), at: nowhere(), shapes: vec![shape] });
        scene.instances.push(Instance::new(nowhere(), ObjectId(0), place));
    } else {
        shape.world_from_object = place;
        scene.shapes.push(shape);
    }
    scene
}

/// The surface that a ray downward at (0.3, z = 0.4) meets.
fn met_in(scene: Scene) -> lookfrom::shading::interaction::SurfaceInteraction {
    let world = compiled(scene);
    let origin = (DVec3::new(0.3, 3.0, 0.4) - world.origin()).as_vec3();
    let ray = Ray::new(origin.to_array(), [0.0, -1.0, 0.0]);
    let hit = world.bvh().closest_hit(&ray);
    assert!(hit.is_hit());
    world.surface(&ray, &hit)
}

fn met(
    mesh: &Mesh,
    place: DMat4,
    as_instance: bool,
    reverse: bool,
) -> lookfrom::shading::interaction::SurfaceInteraction {
    met_in(brushed(mesh, place, as_instance, reverse))
}

/// Derivatives are there where brushed metal or bumps need them, by a mixture and an instance's own material as well.
#[test]
fn only_meshes_with_a_grain_have_derivatives() {
    let has_derivatives = |scene| met_in(scene).dpdu != Vec3::ZERO;
    for (material, expected) in [(0, false), (1, true), (2, true)] {
        let mut scene = brushed(&square(1), DMat4::IDENTITY, false, false);
        scene.shapes[0].material = MaterialId(material);
        assert_eq!(has_derivatives(scene), expected, "material {material}");
        let mut scene = brushed(&square(1), DMat4::IDENTITY, true, false);
        scene.objects[0].shapes[0].material = MaterialId(0);
        scene.instances[0].material = Some(MaterialId(material));
        assert_eq!(has_derivatives(scene), expected, "an instance's material {material}");
    }
}

/// Tangents say on which side v grows, and that side stays the same one of the picture, however the mesh is placed.
#[test]
fn frames_of_tangents_follow_their_hands_through_mirrors() {
    for (w, uv_side) in [(1.0, 1.0), (-1.0, -1.0)] {
        let mut mesh = square(1);
        // With w = −1 the picture is mirrored: v grows along +z.
        for uv in &mut mesh.uvs {
            uv.y *= uv_side;
        }
        mesh.normals = vec![Vec3::Y; 4];
        mesh.tangents = vec![Vec3::X.extend(w); 4];
        let turned = DMat4::from_rotation_y(0.4);
        for place in [
            DMat4::IDENTITY,
            turned,
            turned * DMat4::from_scale(DVec3::new(-1.0, 1.0, 1.0)),
            turned * DMat4::from_scale(DVec3::new(1.0, 1.0, -2.0)),
            turned * DMat4::from_scale(DVec3::new(1.0, -1.0, 1.0)),
            turned * DMat4::from_scale(DVec3::new(-1.0, -1.0, -1.0)),
        ] {
            for reverse in [false, true] {
                let surface = met(&mesh, place, false, reverse);
                let expected =
                    [DVec3::X, DVec3::Z * -f64::from(uv_side)].map(|along| place.transform_vector3(along));
                for (found, expected) in
                    [surface.shading_dpdu, surface.shading_dpdv].into_iter().zip(expected)
                {
                    let cos = found.as_dvec3().normalize().dot(expected.normalize());
                    assert!(cos > 0.999, "{w} {place:?} {reverse}: {found} is not {expected}");
                }
                if !reverse {
                    let other = met(&mesh, place, true, false);
                    assert!(other.shading_dpdv.normalize().dot(surface.shading_dpdv.normalize()) > 0.999);
                }
            }
        }
    }
}

#[test]
fn further_coordinates_and_opacities_come_with_the_surface() {
    let mut mesh = square(1);
    let moved = |by: f32| mesh.uvs.iter().map(|uv| *uv + by).collect::<Vec<Vec2>>();
    mesh.more_uvs = vec![moved(1.0), vec![Vec2::ZERO; 4], moved(3.0), moved(4.0)];
    mesh.opacities = mesh.uvs.iter().map(|uv| uv.x).collect();
    for as_instance in [false, true] {
        let mut scene = scene();
        let first = push(&mut scene, square(1));
        let mut shape = push(&mut scene, mesh.clone());
        let place = DMat4::from_translation(DVec3::Y);
        if as_instance {
            scene.objects.push(Object { name: String::new(), at: nowhere(), shapes: vec![shape] });
            scene.instances.push(Instance::new(nowhere(), ObjectId(0), place));
            scene.shapes.push(first);
        } else {
            shape.world_from_object = place;
            scene.shapes = vec![first, shape];
        }
        let world = compiled(scene);
        let at = |from: DVec3| {
            let ray = Ray::new((from - world.origin()).as_vec3().to_array(), [0.0, -1.0, 0.0]);
            let surface = world.surface(&ray, &world.bvh().closest_hit(&ray));
            (surface, world.texture_point(&surface))
        };
        let (_, point) = at(DVec3::new(0.5, 3.0, 0.5));
        let near = |a: Vec2, b: [f32; 2]| assert!(a.distance(b.into()) < 1e-5, "{a} is not {b:?}");
        near(point.uv, [0.75, 0.25]);
        near(point.more_uvs[0], [1.75, 1.25]);
        near(point.more_uvs[1], [0.0, 0.0]);
        near(point.more_uvs[2], [3.75, 3.25]);
        assert!((point.opacity - 0.75).abs() < 1e-5);
        let (surface, below) = at(DVec3::new(0.5, 0.5, 0.5));
        assert_eq!((surface.vertex_data, below.opacity, below.more_uvs), (None, 1.0, [Vec2::ZERO; 3]));
    }
}
