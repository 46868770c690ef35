//! Scenes with each shape.

use std::sync::Arc;

use glam::{DMat4, DVec3, Vec2, Vec3, Vec4};
use lookfrom_scene::Scene;
use lookfrom_scene::material::Scalar;
use lookfrom_scene::motion::Motion;
use lookfrom_scene::scene::{Instance, MaterialId, MeshId, Object, ObjectId};
use lookfrom_scene::shape::{
    Geometry, Mesh, MeshPose, Patches, Piece, Pieces, Profile, Shape, Sphere, Strand,
};
use lookfrom_scene::solid::{Body, Combination, Form, Operation, Solid};

use super::{TEXTURE, base, each, here, shear, unit};

fn strands(profile: impl Fn(usize) -> Profile, count: usize, is_chain: bool) -> Geometry {
    let strand = |index: usize| {
        let start = index as f32 * if is_chain { 3.0 } else { 3.5 };
        let points = [0, 1, 2, 3].map(|k| Vec3::new(start + k as f32, (k * k) as f32 * 0.0 + 0.5, -0.25));
        let end = |index: usize| 0.1 / (1.0 + index as f32);
        Strand { points, width: [end(index), end(index + 1)], profile: profile(index) }
    };
    Geometry::Curves((0..count).map(strand).collect())
}

/// A solid of one of each form of bodies.
fn solid() -> Arc<Solid> {
    let body = |form: Form, map: DMat4| Body::new(form, map).expect("an inverse");
    let bodies = vec![
        body(Form::Cuboid { min: DVec3::splat(-1.0), max: DVec3::new(1.0, 1.0 / 3.0, 1.0) }, DMat4::IDENTITY),
        body(Form::Ball { center: DVec3::X, radius: 0.7 }, shear()),
        body(Form::Cylinder { radius: 0.1, z: [0.0, 2.0] }, DMat4::from_translation(DVec3::X / 7.0)),
        body(Form::Torus { radius: 1.0, tube: 0.2 }, DMat4::from_rotation_x(0.4)),
    ];
    let cutters = vec![Combination::Body(1), Combination::Body(2)];
    let operands =
        vec![Combination::Body(0), Combination::Combined(Operation::Union, cutters), Combination::Body(3)];
    Arc::new(Solid::new(bodies, Combination::Combined(Operation::Difference, operands)))
}

pub(super) fn geometries() -> Vec<(String, Scene)> {
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
        Geometry::Torus { radius: 2.0, tube: 1.0 / 3.0 },
        Geometry::SolidSurface { solid: solid(), body: 0 },
        patches(2),
        patches(9),
        strands(|_| Profile::Flat, 3, true),
        strands(|_| Profile::Cylinder, 30, false),
        strands(|_| Profile::PbrtCylinder, 3, true),
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
        Geometry::Torus { .. } => 9,
        Geometry::SolidSurface { .. } => 10,
        // By `meshes`.
        Geometry::Mesh(_) => 11,
    };
    let mut scenes = Vec::new();
    for matrix in [DMat4::IDENTITY, shear(), DMat4::from_translation(DVec3::new(1.0, 2.0, 1.0 / 3.0))] {
        scenes.extend(each("geometry", variants.clone(), index, |scene, geometry| {
            scene.shapes[0].world_from_object = matrix;
            if let Geometry::SolidSurface { solid, .. } = &geometry {
                // One shape does not tell of all bodies.
                let surface = |body: u32| Geometry::SolidSurface { solid: solid.clone(), body };
                let first = scene.shapes[0].clone();
                let others = (1..solid.bodies().len() as u32)
                    .map(|body| Shape { geometry: surface(body), ..first.clone() });
                scene.shapes.splice(1..1, others);
            }
            scene.shapes[0].geometry = geometry;
        }));
    }
    scenes
}

pub(super) fn meshes() -> Vec<(String, Scene)> {
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
        let pieces = [(0, Some("chair \"2\"".into())), (1, None)].map(|(first, name)| Piece { first, name });
        let pieces = Pieces::new(pieces.to_vec());
        let shape = Shape { geometry: Geometry::Mesh(MeshId(0)), pieces, ..scene.shapes[0].clone() };
        // Shared by shapes of an object, which may change their form.
        scene.objects.push(Object { name: "o".to_owned(), at: here(), shapes: vec![shape.clone()] });
        let motion = Motion::of_maps(vec![shear(), DMat4::IDENTITY, shear()]).map(Arc::new);
        for (name, motion) in [(None, None), (Some(Arc::new("a \"b\"".to_owned())), motion)] {
            let world_from_object = shear();
            let (at, object, material) = (here(), ObjectId(0), Some(MaterialId(0)));
            scene.instances.push(Instance { name, at, object, world_from_object, material, motion });
        }
        if scene.meshes[0].later.is_empty() {
            scene.shapes.push(shape);
        }
        (format!("mesh {number}"), scene)
    };
    [plain, all, far, moving, no_first_uvs, small].into_iter().enumerate().map(scene).collect()
}
