//! Shapes of every kind under random maps, each with its twin: the formula of its points by u and v.

use std::f64::consts::PI;
use std::sync::Arc;

use glam::{DMat4, DQuat, DVec3, Vec2, Vec3};
use lookfrom::world::World;
use lookfrom_bvh::{Hit, Ray};
use lookfrom_scene::camera::{Camera, View};
use lookfrom_scene::error::Location;
use lookfrom_scene::material::{BumpMapping, Color, Material, MaterialKind, Scalar};
use lookfrom_scene::scene::{MaterialId, MeshId, Scene};
use lookfrom_scene::shape::{Emission, Geometry, Mesh, Patches, Shape};

/// Random numbers, the same in every run.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// In [0, 1).
    pub(crate) fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((bits ^ (bits >> 31)) >> 40) as f64 / 16_777_216.0
    }

    /// In [low, high).
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + self.unit() * (high - low)
    }

    /// In [0, 1)².
    pub(crate) fn square(&mut self) -> [f32; 2] {
        [self.unit() as f32, self.unit() as f32]
    }

    /// Uniform, of unit length.
    pub(crate) fn direction(&mut self) -> DVec3 {
        let z = self.between(-1.0, 1.0);
        let (sin, cos) = self.between(0.0, 2.0 * PI).sin_cos();
        let ring = (1.0 - z * z).sqrt();
        DVec3::new(ring * cos, ring * sin, z)
    }

    /// Turns, stretches by up to 2 an axis, perhaps mirrors and shears, scales by 2^±20, and moves by `far` sizes.
    pub(crate) fn map(&mut self, far: f64) -> DMat4 {
        let mut turn =
            || DMat4::from_quat(DQuat::from_axis_angle(self.direction(), self.between(0.0, 2.0 * PI)));
        let (first, second) = (turn(), turn());
        let sign = if self.unit() < 0.5 { -1.0 } else { 1.0 };
        let stretch =
            DVec3::new(self.between(0.7, 1.4) * sign, self.between(0.7, 1.4), self.between(0.7, 1.4));
        let size = 2f64.powf(self.between(-20.0, 20.0));
        let away = far * self.direction();
        DMat4::from_scale(DVec3::splat(size))
            * DMat4::from_translation(away)
            * first
            * DMat4::from_scale(stretch)
            * second
    }
}

/// A shape in its own space, and its points by u and v.
pub(crate) struct Form {
    /// For messages.
    pub(crate) name: &'static str,
    /// As it is written.
    pub(crate) geometry: Geometry,
    /// The twin.
    pub(crate) at: fn(f64, f64) -> DVec3,
}

fn around(phi: f64, ring: f64, z: f64) -> DVec3 {
    DVec3::new(ring * phi.cos(), ring * phi.sin(), z)
}

const CORNERS: [[f32; 3]; 4] = [[-1.0, -0.8, 0.0], [1.0, -1.0, 0.4], [-0.7, 1.0, 0.3], [0.9, 0.8, -0.3]];

/// One of each kind whose points have a formula.
pub(crate) fn forms() -> Vec<Form> {
    let patches = Patches {
        positions: CORNERS.map(Vec3::from_array).to_vec(),
        patches: vec![[0, 1, 2, 3]],
        ..Patches::default()
    };
    let flat = Patches {
        positions: [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.5], [-1.0, 1.0, 0.0], [1.0, 1.0, 0.5]]
            .map(Vec3::from_array)
            .to_vec(),
        ..patches.clone()
    };
    vec![
        Form {
            name: "whole sphere",
            geometry: Geometry::PartialSphere { radius: 1.0, z: [-1.0, 1.0], phi_max: 360.0 },
            at: |u, v| around(2.0 * PI * u, (PI * v).sin(), -(PI * v).cos()),
        },
        Form {
            name: "partial sphere",
            geometry: Geometry::PartialSphere { radius: 1.25, z: [0.8, -0.6], phi_max: 250.0 },
            at: |u, v| {
                let [low, high] = [-0.6, 0.8].map(|z: f64| (z / 1.25).acos());
                let theta = low + v * (high - low);
                around(250f64.to_radians() * u, 1.25 * theta.sin(), 1.25 * theta.cos())
            },
        },
        Form {
            name: "partial disk",
            geometry: Geometry::PartialDisk { height: 0.3, radius: 1.2, inner_radius: 0.4, phi_max: 290.0 },
            at: |u, v| around(290f64.to_radians() * u, 1.2 + v * (0.4 - 1.2), 0.3),
        },
        Form {
            name: "cylinder",
            geometry: Geometry::Cylinder { radius: 0.8, z: [-0.9, 0.7], phi_max: 300.0 },
            at: |u, v| around(300f64.to_radians() * u, 0.8, -0.9 + v * 1.6),
        },
        Form {
            name: "patch",
            geometry: Geometry::Bilinear(Arc::new(patches)),
            at: |u, v| {
                let [a, b, c, d] = CORNERS.map(|p| Vec3::from_array(p).as_dvec3());
                a.lerp(b, u).lerp(c.lerp(d, u), v)
            },
        },
        Form {
            name: "parallelogram",
            geometry: Geometry::Bilinear(Arc::new(flat)),
            at: |u, v| DVec3::new(2.0 * u - 1.0, 2.0 * v - 1.0, 0.5 * u),
        },
        Form {
            name: "torus",
            geometry: Geometry::Torus { radius: 0.9, tube: 0.4 },
            at: |u, v| around(2.0 * PI * u, 0.9 + 0.4 * (2.0 * PI * v).cos(), 0.4 * (2.0 * PI * v).sin()),
        },
    ]
}

impl Form {
    /// The twin as triangles, `cells` along u and v.
    pub(crate) fn triangles(&self, cells: u32) -> Mesh {
        let mut mesh = Mesh::default();
        for row in 0..=cells {
            for column in 0..=cells {
                let [u, v] = [column, row].map(|i| f64::from(i) / f64::from(cells));
                mesh.positions.push((self.at)(u, v).as_vec3());
                mesh.uvs.push(Vec2::new(u as f32, v as f32));
            }
        }
        for row in 0..cells {
            for column in 0..cells {
                let start = row * (cells + 1) + column;
                let [a, b, c, d] = [start, start + 1, start + cells + 1, start + cells + 2];
                mesh.triangles.extend([[a, b, d], [a, d, c]]);
            }
        }
        mesh
    }
}

/// A shape without a look.
pub(crate) fn shape(geometry: Geometry, world_from_object: DMat4) -> Shape {
    Shape { world_from_object, ..Shape::new(Location::default(), geometry, MaterialId(0)) }
}

/// A shape that shines.
pub(crate) fn shining(geometry: Geometry, map: DMat4, two_sided: bool, reverse_orientation: bool) -> Shape {
    let emission = Some(Emission::new(Color::Value([1.0; 3]), two_sided));
    Shape { emission, reverse_orientation, ..shape(geometry, map) }
}

/// One shape, seen from an eye at the origin, so that render space is the world.
pub(crate) fn scene_of(shape: Shape, meshes: Vec<Mesh>) -> Scene {
    let view = View::Look { lookfrom: DVec3::ZERO, lookat: DVec3::NEG_Z, up: DVec3::Y };
    let camera = Some(Camera { view, ..Camera::default() });
    // A material that asks for derivatives.
    let bump_mapping = BumpMapping::Bump(Scalar::Value(0.0));
    let kind = MaterialKind::Diffuse { reflectance: Color::gray(0.5) };
    let materials = vec![Material { bump_mapping, ..Material::new("bumped", Location::default(), kind) }];
    Scene { camera, materials, meshes, shapes: vec![shape], ..Scene::default() }
}

/// The world of one shape.
pub(crate) fn world(shape: Shape, meshes: Vec<Mesh>) -> World {
    World::compile(scene_of(shape, meshes), &mut Vec::new()).unwrap_or_else(|error| panic!("{error}"))
}

/// The twin's world.
pub(crate) fn twin(form: &Form, map: DMat4, cells: u32) -> World {
    world(shape(Geometry::Mesh(MeshId(0)), map), vec![form.triangles(cells)])
}

/// A ray that passes near the middle of a mapped shape.
pub(crate) fn ray(random: &mut Random, map: &DMat4) -> Ray {
    let from = 3.0 * random.direction();
    let to = random.between(0.0, 1.1) * random.direction();
    let origin = map.transform_point3(from).as_vec3();
    let direction = map.transform_point3(to).as_vec3() - origin;
    Ray::new(origin.to_array(), (direction * random.between(0.1, 3.0) as f32).to_array())
}

/// Where a ray is at a hit.
pub(crate) fn place(ray: &Ray, hit: &Hit) -> DVec3 {
    let [origin, direction] = [ray.origin, ray.direction].map(|v| Vec3::from_array(v).as_dvec3());
    origin + f64::from(hit.t) * direction
}
