//! Triangle meshes.
//!
//! Derivatives by texture coordinates are those of the triangle's plane, as in Pharr, Jakob, Humphreys, Physically
//! Based Rendering; a mesh's tangents replace `∂p/∂u` in shading.

use glam::{DVec3, Vec2, Vec3, Vec4};
use lookfrom_bvh::Point;

use super::{MaterialBinding, SurfacePoint};
use crate::core::warp;
use crate::shading::texture::MORE_UV_SETS;

/// Triangles of one shape.
#[derive(Clone, Debug)]
pub struct Mesh {
    /// Vertices.
    pub positions: Vec<[f32; 3]>,
    /// Three vertices per triangle.
    pub triangles: Vec<[u32; 3]>,
    /// Unit shading normals (zero where unknown), none or one per vertex.
    pub normals: Vec<Vec3>,
    /// Texture coordinates, none or one per vertex.
    pub uvs: Vec<Vec2>,
    /// Linear colours, none or one per vertex.
    pub colors: Vec<[f32; 3]>,
    /// Tangents, in the direction of u, of any length; w is the sign of the bitangent (in this space, with the normals
    /// of this mesh): v grows along normal × tangent where w > 0. None or one per vertex.
    pub tangents: Vec<Vec4>,
    /// Texture coordinates of further sets, none or one per vertex in each.
    pub more_uvs: Vec<Vec<Vec2>>,
    /// Opacities, none or one per vertex.
    pub opacities: Vec<f32>,
    /// Whether derivatives by texture coordinates are needed; otherwise they are 0.
    pub wants_derivatives: bool,
    /// Whether the outside is the side from which triangles are clockwise: after a reflection, or a reversal, but not
    /// both.
    pub flip: bool,
    /// Its attributes.
    pub binding: MaterialBinding,
}

/// Vertex data that few meshes have: kept apart from [`SurfacePoint`], which is computed for every hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VertexData {
    /// Texture coordinates of further sets; (0, 0) where there is none.
    pub more_uvs: [Vec2; MORE_UV_SETS],
    /// Opacity; 1 where there is none.
    pub opacity: f32,
}

/// Determinants of texture coordinates below this count as degenerate.
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

    /// Whether there is any [`VertexData`] at all.
    pub fn has_vertex_data(&self) -> bool {
        !self.more_uvs.is_empty() || !self.opacities.is_empty()
    }

    /// The interpolated vertex data at the point with weight `u` of a triangle's second corner and `v` of its third.
    pub fn vertex_data(&self, index: usize, u: f32, v: f32) -> VertexData {
        let weights = [1.0 - u - v, u, v];
        let vertices = self.triangles[index].map(|vertex| vertex as usize);
        let more_uvs = std::array::from_fn(|set| {
            let of_set = |uvs: &Vec<Vec2>| (0..3).map(|k| weights[k] * uvs[vertices[k]]).sum();
            self.more_uvs.get(set).filter(|uvs| !uvs.is_empty()).map_or(Vec2::ZERO, of_set)
        });
        let opacity = match self.opacities.as_slice() {
            [] => 1.0,
            opacities => (0..3).map(|k| weights[k] * opacities[vertices[k]]).sum(),
        };
        VertexData { more_uvs, opacity }
    }

    /// The mesh's own colour at such a point; white where it has none.
    pub fn color(&self, index: usize, u: f32, v: f32) -> [f32; 3] {
        if self.colors.is_empty() {
            return [1.0; 3];
        }
        let weights = [1.0 - u - v, u, v];
        let vertices = self.triangles[index].map(|vertex| vertex as usize);
        std::array::from_fn(|c| (0..3).map(|k| weights[k] * self.colors[vertices[k]][c]).sum())
    }

    /// The area of a triangle.
    pub fn area(&self, index: usize) -> f64 {
        let [p0, p1, p2] = self.corners(index).map(|p| Vec3::from_array(p).as_dvec3());
        0.5 * (p1 - p0).cross(p2 - p0).length()
    }

    /// The point with weight `u` of a triangle's second corner and `v` of its third.
    pub fn point(&self, index: usize, u: f32, v: f32) -> SurfacePoint {
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
        // The mesh's normals, not the winding, decide which side is outside.
        if smooth.is_some_and(|ns| ns.dot(ng) < 0.0) {
            ng = -ng;
        }
        let ns = smooth.unwrap_or(ng);
        let uvs = self.corner_uvs(index);
        let uv = weights[0] * uvs[0] + weights[1] * uvs[1] + weights[2] * uvs[2];
        let color = self.color(index, u, v);
        if !self.wants_derivatives {
            let none = DVec3::ZERO;
            let binding = self.binding;
            return SurfacePoint {
                point,
                ng,
                ns,
                uv,
                dpdu: none,
                dpdv: none,
                shading_dpdu: none,
                shading_dpdv: none,
                color,
                binding,
            };
        }
        let corners = corners.map(|p| Vec3::from_array(p).as_dvec3());
        let [dpdu, dpdv] = derivatives(corners, uvs, winding);

        // Rotate the derivatives into the plane perpendicular to the interpolated normal.
        let tangent = self.tangent(weights, vertices).filter(|(s, _)| *s != DVec3::ZERO);
        let (mut shading_dpdu, mut shading_dpdv) = (dpdu, dpdv);
        if smooth.is_some() || tangent.is_some() {
            let (along, is_left) = tangent.unwrap_or((dpdu, true));
            let across = ns.cross(along);
            if across.length_squared() > 0.0 {
                (shading_dpdu, shading_dpdv) = (across.cross(ns), if is_left { across } else { -across });
            } else {
                let (s, t) = warp::orthonormal_basis(ns.as_vec3());
                (shading_dpdu, shading_dpdv) = (s.as_dvec3(), t.as_dvec3());
            }
        }
        SurfacePoint {
            point,
            ng,
            ns,
            uv,
            dpdu,
            dpdv,
            shading_dpdu,
            shading_dpdv,
            color,
            binding: self.binding,
        }
    }
}

impl Mesh {
    /// The interpolated tangent, and whether v grows to the left of it, seen from outside.
    fn tangent(&self, weights: [f32; 3], vertices: [usize; 3]) -> Option<(DVec3, bool)> {
        if self.tangents.is_empty() {
            return None;
        }
        let [a, b, c] = vertices.map(|vertex| self.tangents[vertex]);
        let mixed = weights[0] * a + weights[1] * b + weights[2] * c;
        Some((mixed.truncate().as_dvec3(), mixed.w >= 0.0))
    }
}

/// `∂p/∂u` and `∂p/∂v` of a triangle; any two directions in its plane where its texture coordinates are degenerate.
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
