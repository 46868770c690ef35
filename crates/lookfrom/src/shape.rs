//! From a hit (ids, t, u, v) to the surface there: each form's point, normals and texture coordinates.
//!
//! Positions are in the space of the group that the form belongs to: render space, or the space of an instanced object.

use glam::{DVec3, Mat3, Vec2, Vec3};
use lookfrom_bvh::{Aabb, Hit, Point, Procedural, ProceduralHit, Ray};

use crate::texture;

/// Whose surface it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Look {
    /// Index into the world's materials.
    pub material: u32,
    /// Index into the world's lights, where the surface shines.
    pub light: Option<u32>,
    /// Which shape of the scene.
    pub shape: u32,
}

/// The primitives that share a geometry id of the kernel.
#[derive(Clone, Debug)]
pub enum Form {
    /// Triangles of one shape.
    Mesh(Box<Mesh>),
    /// Spheres of many shapes.
    Spheres(Spheres),
    /// Round plates of many shapes.
    Disks(Disks),
}

/// Triangles of one shape.
#[derive(Clone, Debug)]
pub struct Mesh {
    /// Vertices.
    pub positions: Vec<[f32; 3]>,
    /// Three vertices a triangle.
    pub triangles: Vec<[u32; 3]>,
    /// Unit shading normals (zero where unknown), none or one a vertex.
    pub normals: Vec<Vec3>,
    /// Texture coordinates, none or one a vertex.
    pub uvs: Vec<Vec2>,
    /// Linear colours, none or one a vertex.
    pub colors: Vec<[f32; 3]>,
    /// Whether the outside is where the triangles run clockwise (after a mirror).
    pub flip: bool,
    /// Whose.
    pub look: Look,
}

/// Spheres of many shapes.
#[derive(Clone, Debug, Default)]
pub struct Spheres {
    /// As the kernel has them.
    pub spheres: Vec<lookfrom_bvh::Sphere>,
    /// For each sphere, an index into `looks`.
    pub look_of: Vec<u32>,
    /// Whose, and the rotation (or mirror) to the shape's own axes, where its poles are on y.
    pub looks: Vec<(Look, Mat3)>,
}

/// A round plate, perhaps sheared to an ellipse: `center + x·axis_u + y·axis_v`, `x² + y² ≤ 1`, normal along `axis_u × axis_v`.
#[derive(Clone, Copy, Debug)]
pub struct Disk {
    /// Middle.
    pub center: DVec3,
    /// To the rim.
    pub axis_u: DVec3,
    /// To the rim.
    pub axis_v: DVec3,
}

/// Round plates of many shapes.
#[derive(Clone, Debug, Default)]
pub struct Disks {
    /// The plates.
    pub disks: Vec<Disk>,
    /// Whose.
    pub looks: Vec<Look>,
}

/// A point of a form.
#[derive(Clone, Copy, Debug)]
pub struct FormPoint {
    /// Where, with its error bound.
    pub point: Point,
    /// Geometric normal to the outside, unit length.
    pub ng: DVec3,
    /// Shading normal, unit length, on the side of `ng`.
    pub ns: DVec3,
    /// Texture coordinates.
    pub uv: Vec2,
    /// The mesh's own linear colour; white where it has none.
    pub color: [f32; 3],
    /// Whose.
    pub look: Look,
}

impl Form {
    /// The point that `hit` means for a ray from `origin` into `direction` (the one that was traced, in this form's space).
    pub fn point(&self, hit: &Hit, origin: DVec3, direction: DVec3) -> FormPoint {
        let index = hit.primitive as usize;
        match self {
            Self::Mesh(mesh) => mesh.point(index, hit.u, hit.v),
            Self::Spheres(spheres) => spheres.point(index, origin + f64::from(hit.t) * direction),
            Self::Disks(disks) => disks.point(index, origin + f64::from(hit.t) * direction),
        }
    }
}

impl Mesh {
    /// The corners of a triangle.
    pub fn corners(&self, index: usize) -> [[f32; 3]; 3] {
        self.triangles[index].map(|vertex| self.positions[vertex as usize])
    }

    /// The texture coordinates of a triangle's corners; a mesh without any has (0, 0), (1, 0), (0, 1) on each.
    pub fn corner_uvs(&self, index: usize) -> [Vec2; 3] {
        if self.uvs.is_empty() {
            [Vec2::ZERO, Vec2::X, Vec2::Y]
        } else {
            self.triangles[index].map(|vertex| self.uvs[vertex as usize])
        }
    }

    fn point(&self, index: usize, u: f32, v: f32) -> FormPoint {
        let [p0, p1, p2] = self.corners(index);
        let point = Point::on_triangle(p0, p1, p2, u, v);
        let [p0, p1, p2] = [p0, p1, p2].map(|p| Vec3::from_array(p).as_dvec3());
        let winding = (p1 - p0).cross(p2 - p0).normalize();
        let mut ng = if self.flip { -winding } else { winding };
        let weights = [1.0 - u - v, u, v];
        let vertices = self.triangles[index].map(|vertex| vertex as usize);

        let smooth = match self.normals.is_empty() {
            true => None,
            false => (weights[0] * self.normals[vertices[0]]
                + weights[1] * self.normals[vertices[1]]
                + weights[2] * self.normals[vertices[2]])
                .as_dvec3()
                .try_normalize(),
        };
        // Who wrote normals knows better than the winding which side is outside.
        if smooth.is_some_and(|ns| ns.dot(ng) < 0.0) {
            ng = -ng;
        }
        let uvs = self.corner_uvs(index);
        let uv = weights[0] * uvs[0] + weights[1] * uvs[1] + weights[2] * uvs[2];
        let color = if self.colors.is_empty() {
            [1.0; 3]
        } else {
            std::array::from_fn(|c| (0..3).map(|k| weights[k] * self.colors[vertices[k]][c]).sum())
        };
        FormPoint { point, ng, ns: smooth.unwrap_or(ng), uv, color, look: self.look }
    }
}

impl Spheres {
    fn point(&self, index: usize, near: DVec3) -> FormPoint {
        let sphere = self.spheres[index];
        let (look, object_from_form) = self.looks[self.look_of[index] as usize];
        let center = Vec3::from_array(sphere.center).as_dvec3();
        let point = Point::on_sphere(sphere.center, sphere.radius, near.to_array());
        let ng = (DVec3::from_array(point.position) - center).normalize();
        let uv = texture::sphere_uv(object_from_form * ng.as_vec3());
        FormPoint { point, ng, ns: ng, uv, color: [1.0; 3], look }
    }
}

impl Disk {
    /// The point at `(x, y)` of the plate.
    pub fn at(&self, on_disk: Vec2) -> Point {
        let Vec2 { x, y } = on_disk;
        let (u, v) = (f64::from(x) * self.axis_u, f64::from(y) * self.axis_v);
        // five roundings, each of at most 2⁻⁵³ of the sum of sizes
        let error = (self.center.abs() + u.abs() + v.abs()) * (5.0 * 0.5 * f64::EPSILON);
        Point { position: (self.center + u + v).to_array(), error: error.to_array() }
    }

    /// Not of unit length: the plate's area is π times its length.
    pub fn normal(&self) -> DVec3 {
        self.axis_u.cross(self.axis_v)
    }

    /// `(x, y)` of a point in the plate's plane.
    fn coordinates(&self, point: DVec3) -> [f64; 2] {
        let normal = self.normal();
        let q = point - self.center;
        let scale = 1.0 / normal.length_squared();
        [q.cross(self.axis_v).dot(normal) * scale, self.axis_u.cross(q).dot(normal) * scale]
    }
}

impl Disks {
    fn point(&self, index: usize, near: DVec3) -> FormPoint {
        let disk = &self.disks[index];
        let [x, y] = disk.coordinates(near);
        let on_disk = Vec2::new(x as f32, y as f32);
        let ng = disk.normal().normalize();
        let uv = 0.5 + 0.5 * on_disk;
        FormPoint { point: disk.at(on_disk), ng, ns: ng, uv, color: [1.0; 3], look: self.looks[index] }
    }
}

impl Procedural for Disks {
    fn count(&self) -> u32 {
        self.disks.len() as u32
    }

    fn bounds(&self, primitive: u32) -> Aabb {
        let disk = &self.disks[primitive as usize];
        let extent = (disk.axis_u * disk.axis_u + disk.axis_v * disk.axis_v).map(f64::sqrt);
        Aabb {
            min: (disk.center - extent).to_array().map(|x| (x as f32).next_down()),
            max: (disk.center + extent).to_array().map(|x| (x as f32).next_up()),
        }
    }

    fn intersect(&self, primitive: u32, ray: &Ray) -> Option<ProceduralHit> {
        let disk = &self.disks[primitive as usize];
        let [origin, direction] = [ray.origin, ray.direction].map(|v| Vec3::from_array(v).as_dvec3());
        let normal = disk.normal();
        let t = normal.dot(disk.center - origin) / normal.dot(direction);
        if !(t > f64::from(ray.t_min) && t < f64::from(ray.t_max)) {
            return None;
        }
        let [x, y] = disk.coordinates(origin + t * direction);
        (x * x + y * y <= 1.0).then_some(ProceduralHit { t: t as f32, u: x as f32, v: y as f32 })
    }
}
