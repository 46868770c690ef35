//! Triangles of one shape: what a mesh says about a point of it.
//!
//! Derivatives by texture coordinates are those of the plane through the triangle, as in Pharr, Jakob, Humphreys,
//! Physically Based Rendering; a mesh's tangents take the place of `∂p/∂u` in shading.

use glam::{DVec3, Vec2, Vec3};
use lookfrom_bvh::Point;

use super::{FormPoint, Look};
use crate::warp;

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
    /// Directions in which u grows, of any length, none or one a vertex.
    pub tangents: Vec<Vec3>,
    /// Whether anybody asks for derivatives by texture coordinates; otherwise they are 0.
    pub wants_derivatives: bool,
    /// Whether the outside is where the triangles run clockwise: after a mirror, or a reversal, but not both.
    pub flip: bool,
    /// Whose.
    pub look: Look,
}

/// Determinants of texture coordinates below this are taken for none.
const LEAST_DETERMINANT: f64 = 1e-9;

impl Mesh {
    /// The corners of a triangle.
    #[inline]
    pub fn corners(&self, index: usize) -> [[f32; 3]; 3] {
        self.triangles[index].map(|vertex| self.positions[vertex as usize])
    }

    /// The texture coordinates of a triangle's corners; a mesh without any has (0, 0), (1, 0), (1, 1) on each.
    pub fn corner_uvs(&self, index: usize) -> [Vec2; 3] {
        if self.uvs.is_empty() {
            [Vec2::ZERO, Vec2::X, Vec2::ONE]
        } else {
            self.triangles[index].map(|vertex| self.uvs[vertex as usize])
        }
    }

    /// The area of a triangle.
    pub fn area(&self, index: usize) -> f64 {
        let [p0, p1, p2] = self.corners(index).map(|p| Vec3::from_array(p).as_dvec3());
        0.5 * (p1 - p0).cross(p2 - p0).length()
    }

    /// The point with weight `u` of a triangle's second corner and `v` of its third.
    pub fn point(&self, index: usize, u: f32, v: f32) -> FormPoint {
        let corners = self.corners(index);
        let [p0, p1, p2] = corners;
        let (point, across) = Point::on_triangle_with_normal(p0, p1, p2, u, v);
        let winding = DVec3::from_array(across).normalize();
        let mut ng = if self.flip { -winding } else { winding };
        let weights = [1.0 - u - v, u, v];
        let vertices = self.triangles[index].map(|vertex| vertex as usize);
        let mix = |values: &[Vec3]| -> DVec3 {
            (weights[0] * values[vertices[0]]
                + weights[1] * values[vertices[1]]
                + weights[2] * values[vertices[2]])
                .as_dvec3()
        };

        let smooth = (!self.normals.is_empty()).then(|| mix(&self.normals).try_normalize()).flatten();
        // Who wrote normals knows better than the winding which side is outside.
        if smooth.is_some_and(|ns| ns.dot(ng) < 0.0) {
            ng = -ng;
        }
        let ns = smooth.unwrap_or(ng);
        let uvs = self.corner_uvs(index);
        let uv = weights[0] * uvs[0] + weights[1] * uvs[1] + weights[2] * uvs[2];
        let color = if self.colors.is_empty() {
            [1.0; 3]
        } else {
            std::array::from_fn(|c| (0..3).map(|k| weights[k] * self.colors[vertices[k]][c]).sum())
        };
        if !self.wants_derivatives {
            let none = DVec3::ZERO;
            let look = self.look;
            return FormPoint {
                point,
                ng,
                ns,
                uv,
                dpdu: none,
                dpdv: none,
                shading_dpdu: none,
                shading_dpdv: none,
                color,
                look,
            };
        }
        let corners = corners.map(|p| Vec3::from_array(p).as_dvec3());
        let [dpdu, dpdv] = derivatives(corners, uvs, winding);

        // Smoothing turns the derivatives into the plane across the shading normal.
        let tangent = (!self.tangents.is_empty()).then(|| mix(&self.tangents)).filter(|s| *s != DVec3::ZERO);
        let (mut shading_dpdu, mut shading_dpdv) = (dpdu, dpdv);
        if smooth.is_some() || tangent.is_some() {
            let along = tangent.unwrap_or(dpdu);
            let across = ns.cross(along);
            if across.length_squared() > 0.0 {
                (shading_dpdu, shading_dpdv) = (across.cross(ns), across);
            } else {
                let (s, t) = warp::orthonormal_basis(ns.as_vec3());
                (shading_dpdu, shading_dpdv) = (s.as_dvec3(), t.as_dvec3());
            }
        }
        FormPoint { point, ng, ns, uv, dpdu, dpdv, shading_dpdu, shading_dpdv, color, look: self.look }
    }
}

/// `∂p/∂u` and `∂p/∂v` of a triangle; any two directions in its plane where its texture coordinates say nothing.
fn derivatives([p0, p1, p2]: [DVec3; 3], uvs: [Vec2; 3], winding: DVec3) -> [DVec3; 2] {
    let [uv0, uv1, uv2] = uvs.map(Vec2::as_dvec2);
    let (along0, along1) = (uv0 - uv2, uv1 - uv2);
    let (edge0, edge1) = (p0 - p2, p1 - p2);
    let determinant = along0.x * along1.y - along0.y * along1.x;
    if determinant.abs() >= LEAST_DETERMINANT {
        let dpdu = (along1.y * edge0 - along0.y * edge1) / determinant;
        let dpdv = (along0.x * edge1 - along1.x * edge0) / determinant;
        if dpdu.is_finite() && dpdv.is_finite() {
            return [dpdu, dpdv];
        }
    }
    let (s, t) = warp::orthonormal_basis(-winding.as_vec3());
    [s.as_dvec3(), t.as_dvec3()]
}
