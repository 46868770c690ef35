//! Bilinear patches.
//!
//! The u of an intersection is a root of a quadratic (Reshetov 2019, "Cool Patches"), solved here in f64; each
//! intersection is then refined by Newton's method in (u, v, t), so that the side of the patch on which a ray starts is
//! decided by its distance from the patch alone, however grazing the ray.

use glam::{DMat3, DVec3, Vec2, Vec3};
use lookfrom_bvh::{Aabb, Point, Procedural, ProceduralHit, Ray};

use super::{MaterialBinding, SurfacePoint};

/// Unit of rounding of f64, 2⁻⁵³.
const UNIT: f64 = 0.5 * f64::EPSILON;

/// Tolerance in u and v beyond an edge: neighbours have no crack between them.
const SLACK: f64 = 1e-12;

/// Texture coordinates that change less than this along a patch's sides are taken to be constant there.
const LEAST_CHANGE: f64 = 1e-8;

/// Number of cells along u and v in the numerical integration of a patch's area.
const CELLS: u32 = 16;

/// Bilinear patches of one shape: `(1−u)(1−v) p0 + u(1−v) p1 + (1−u)v p2 + uv p3`.
#[derive(Clone, Debug)]
pub struct Patches {
    /// Vertices.
    pub positions: Vec<Vec3>,
    /// Four vertices per patch.
    pub patches: Vec<[u32; 4]>,
    /// Unit shading normals (zero where unknown), none or one per vertex.
    pub normals: Vec<Vec3>,
    /// Texture coordinates, none or one per vertex.
    pub uvs: Vec<Vec2>,
    /// Whether the outside is the side of `∂p/∂v × ∂p/∂u`: after a reflection, or a reversal, but not both.
    pub flip: bool,
    /// Its attributes.
    pub binding: MaterialBinding,
}

/// The bilinear polynomial of a patch.
#[derive(Clone, Copy, Debug)]
struct Blend {
    /// At (0, 0).
    start: DVec3,
    /// From there to (1, 0).
    along_u: DVec3,
    /// From there to (0, 1).
    along_v: DVec3,
    /// Offset of the fourth corner from the parallelogram of the others.
    twist: DVec3,
}

impl Blend {
    fn new([p00, p10, p01, p11]: [DVec3; 4]) -> Self {
        Self { start: p00, along_u: p10 - p00, along_v: p01 - p00, twist: (p11 - p01) - (p10 - p00) }
    }

    fn at(&self, u: f64, v: f64) -> DVec3 {
        self.start + u * self.along_u + v * (self.along_v + u * self.twist)
    }

    fn derivatives(&self, u: f64, v: f64) -> [DVec3; 2] {
        [self.along_u + v * self.twist, self.along_v + u * self.twist]
    }
}

impl Patches {
    /// The corners of a patch: at (0, 0), (1, 0), (0, 1), (1, 1).
    pub fn corners(&self, index: usize) -> [DVec3; 4] {
        self.patches[index].map(|vertex| self.positions[vertex as usize].as_dvec3())
    }

    /// `∂p/∂u × ∂p/∂v` at a point: its length is the area element.
    pub fn area_vector(&self, index: usize, u: f64, v: f64) -> DVec3 {
        let [du, dv] = Blend::new(self.corners(index)).derivatives(u, v);
        du.cross(dv)
    }

    /// The area of a patch.
    pub fn area(&self, index: usize) -> f64 {
        let cell = |i: u32| (f64::from(i) + 0.5) / f64::from(CELLS);
        let sum: f64 = (0..CELLS * CELLS)
            .map(|k| self.area_vector(index, cell(k % CELLS), cell(k / CELLS)).length())
            .sum();
        sum / f64::from(CELLS * CELLS)
    }

    /// The outward unit normal at a point.
    pub fn normal(&self, index: usize, u: f64, v: f64) -> DVec3 {
        let along = self.area_vector(index, u, v).try_normalize();
        // Where two corners coincide there is no normal; take one nearby.
        let nearby = || self.area_vector(index, 0.001 + 0.998 * u, 0.001 + 0.998 * v).normalize_or(DVec3::Z);
        let n = along.unwrap_or_else(nearby) * if self.flip { -1.0 } else { 1.0 };
        let smooth = self.smooth(index, u, v);
        // The mesh's normals decide which side is outside.
        if smooth.is_some_and(|ns| ns.dot(n) < 0.0) { -n } else { n }
    }

    /// The shading normal at a point, of unit length, where there is one.
    fn smooth(&self, index: usize, u: f64, v: f64) -> Option<DVec3> {
        if self.normals.is_empty() {
            return None;
        }
        let normals = self.patches[index].map(|vertex| self.normals[vertex as usize].as_dvec3());
        Blend::new(normals).at(u, v).try_normalize()
    }

    /// The point at (u, v) of a patch.
    pub fn point(&self, index: usize, u: f32, v: f32) -> SurfacePoint {
        let (patch_u, patch_v) = (u, v);
        let (u, v) = (f64::from(u), f64::from(v));
        let corners = self.corners(index);
        let blend = Blend::new(corners);
        let [mut dpdu, mut dpdv] = blend.derivatives(u, v);
        let area_vector = dpdu.cross(dpdv);

        // The error: rounding, and the curvature over the distance by which rounding an origin to f32 moves it
        // sideways.
        let position = blend.at(u, v);
        let size = corners.iter().fold(DVec3::ZERO, |size, p| size.max(p.abs()));
        let sideways = (position.abs() * f64::from(f32::EPSILON)).length_squared();
        let bend = sideways * dpdu.length() * dpdv.length() * blend.twist.dot(area_vector).abs()
            / (area_vector.length_squared() * area_vector.length());
        let error = 32.0 * UNIT * size + DVec3::splat(if bend.is_finite() { bend } else { 0.0 });
        let point = Point { position: position.to_array(), error: error.to_array() };

        // With texture coordinates of the mesh, the derivatives are by those.
        let mut uv = Vec2::new(patch_u, patch_v);
        if !self.uvs.is_empty() {
            let corners = self.patches[index].map(|vertex| self.uvs[vertex as usize].as_dvec2().extend(0.0));
            let texture = Blend::new(corners);
            let [by_u, by_v] = texture.derivatives(u, v);
            let inverse = |x: f64| if x.abs() < LEAST_CHANGE { 0.0 } else { 1.0 / x };
            let dpds = dpdu * inverse(by_u.x) + dpdv * inverse(by_v.x);
            let dpdt = dpdu * inverse(by_u.y) + dpdv * inverse(by_v.y);
            let turned = dpds.cross(dpdt).dot(area_vector);
            if turned != 0.0 {
                (dpdu, dpdv) = (dpds, if turned < 0.0 { -dpdt } else { dpdt });
            }
            uv = texture.at(u, v).as_vec3().truncate();
        }

        let ng = self.normal(index, u, v);
        let mut of_patch = SurfacePoint::plain(point, ng, uv, [dpdu, dpdv], self.binding);
        if let Some(ns) = self.smooth(index, u, v) {
            // The derivatives rotate with the normal.
            let turned = |d: DVec3| turn(d, ng, ns);
            of_patch.ns = ns;
            let along = turned(dpdu);
            of_patch.shading_dpdu = along - along.dot(ns) * ns;
            of_patch.shading_dpdv = turned(dpdv);
        }
        of_patch
    }
}

/// `v` after the shortest rotation that takes one unit vector to another, which must not be its opposite.
fn turn(v: DVec3, from: DVec3, to: DVec3) -> DVec3 {
    let axis = from.cross(to);
    let cos = from.dot(to);
    v * cos + axis.cross(v) + axis * (axis.dot(v) / (1.0 + cos))
}

impl Procedural for Patches {
    fn count(&self) -> u32 {
        self.patches.len() as u32
    }

    fn bounds(&self, primitive: u32) -> Aabb {
        let corners = self.patches[primitive as usize].map(|vertex| self.positions[vertex as usize]);
        let min = corners.iter().fold(corners[0], |min, p| min.min(*p));
        let max = corners.iter().fold(corners[0], |max, p| max.max(*p));
        Aabb { min: min.to_array().map(f32::next_down), max: max.to_array().map(f32::next_up) }
    }

    fn intersect(&self, primitive: u32, ray: &Ray) -> Option<ProceduralHit> {
        let blend = Blend::new(self.corners(primitive as usize));
        let [origin, direction] = [ray.origin, ray.direction].map(|v| Vec3::from_array(v).as_dvec3());
        meetings(&blend, origin, direction)
            .into_iter()
            .filter_map(|[u, v, t]| {
                let t = t as f32;
                let range = -SLACK..=1.0 + SLACK;
                let there = t > ray.t_min && t < ray.t_max && range.contains(&u) && range.contains(&v);
                let [u, v] = [u, v].map(|x| x.clamp(0.0, 1.0) as f32);
                there.then_some(ProceduralHit { t, u, v })
            })
            .min_by(|a, b| a.t.total_cmp(&b.t))
    }
}

/// Up to two intersections (u, v, t) of a line with the whole surface of which a patch is a part; NaN where there is
/// none.
fn meetings(blend: &Blend, origin: DVec3, direction: DVec3) -> [[f64; 3]; 2] {
    // a + b u + c u² vanishes where the line of constant u intersects the ray.
    let start = blend.start - origin;
    let a = start.cross(direction).dot(blend.along_v);
    let c = blend.along_u.cross(blend.twist).dot(-direction);
    let whole = (start + blend.along_u).cross(direction).dot(blend.along_v + blend.twist);
    let b = whole - a - c;
    let discriminant = b * b - 4.0 * a * c;
    let q = -0.5 * (b + discriminant.sqrt().copysign(b));
    [q / c, a / q].map(|u| {
        if !(-0.5..=1.5).contains(&u) {
            return [f64::NAN; 3];
        }
        // Along that line, the point nearest to the ray; then all three unknowns at once.
        let line = blend.along_v + u * blend.twist;
        let from = start + u * blend.along_u;
        let across = direction.cross(line);
        let scale = 1.0 / across.length_squared();
        let v = across.cross(from).dot(direction) * scale;
        let t = across.cross(from).dot(line) * scale;
        sharpened(blend, start, direction, [u, v, t])
    })
}

/// One step of Newton's method towards `patch(u, v) = origin + t · direction`; `start` is seen from the origin.
fn sharpened(blend: &Blend, start: DVec3, direction: DVec3, [u, v, t]: [f64; 3]) -> [f64; 3] {
    let [du, dv] = blend.derivatives(u, v);
    let from_origin = Blend { start, ..*blend };
    let off = from_origin.at(u, v) - t * direction;
    let matrix = DMat3::from_cols(du, dv, -direction);
    let determinant = du.cross(dv).dot(-direction);
    if determinant == 0.0 || !off.is_finite() {
        return [u, v, t];
    }
    let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
    let step = DVec3::new(y.cross(z).dot(off), z.cross(x).dot(off), x.cross(y).dot(off)) / determinant;
    if step.is_finite() { [u - step.x, v - step.y, t - step.z] } else { [u, v, t] }
}
