//! Triangle meshes.

pub(crate) mod lanes;

use glam::{Vec2, Vec3, Vec4};
use lookfrom_bvh::Point;

use super::SurfacePoints;
use super::triangle::{Tangent, Triangles};
use super::{MaterialBinding, SurfacePoint};
use crate::core::vector::Vector;
use crate::shading::texture::{MORE_UV_SETS, TexturePoint};

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
    /// Whether rays that leave it start at the smooth surface that its normals describe, so that the facets of a coarse mesh
    /// cast no shadows on themselves near the terminator.
    pub is_lifted: bool,
    /// Positions and unit shading normals at further times, equally spaced until the shutter closes; none if it keeps its form.
    pub later: Vec<Pose>,
    /// Its attributes.
    pub binding: MaterialBinding,
}

/// The vertices of a mesh at one time.
#[derive(Clone, Debug)]
pub struct Pose {
    /// As many as those of the mesh.
    pub positions: Vec<[f32; 3]>,
    /// As many as those of the mesh; zero where unknown.
    pub normals: Vec<Vec3>,
}

/// The vertices of a mesh at two times, and the parts of each at a time between.
struct Between<'a> {
    positions: [&'a [[f32; 3]]; 2],
    normals: [&'a [Vec3]; 2],
    parts: [f32; 2],
}

/// Vertex data that few meshes have: kept apart from [`SurfacePoint`], which is computed for every hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VertexData {
    /// Texture coordinates of further sets; (0, 0) where there is none.
    pub more_uvs: [Vec2; MORE_UV_SETS],
    /// Opacity; 1 where there is none.
    pub opacity: f32,
}

impl Mesh {
    /// The texture coordinates of each triangle's corners in a mesh without any.
    const NO_UVS: [[f32; 2]; 3] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]];

    /// The corners of a triangle.
    #[inline]
    pub fn corners(&self, index: usize) -> [[f32; 3]; 3] {
        self.triangles[index].map(|vertex| self.positions[vertex as usize])
    }

    /// The corners of a triangle at a time of the shutter (0 … 1).
    pub fn corners_at(&self, index: usize, time: f32) -> [[f32; 3]; 3] {
        if self.later.is_empty() {
            return self.corners(index);
        }
        let Between { positions, parts, .. } = self.between(time);
        let [a, b] =
            positions.map(|positions| self.triangles[index].map(|vertex| positions[vertex as usize]));
        // As the kernel interpolates them, bit for bit.
        std::array::from_fn(|k| std::array::from_fn(|axis| a[k][axis] * parts[0] + b[k][axis] * parts[1]))
    }

    /// The vertices before and after a time, of a mesh that has later ones.
    fn between(&self, time: f32) -> Between<'_> {
        let (earlier, fraction) = lookfrom_bvh::moment(self.later.len() + 1, time);
        let later = &self.later[earlier];
        let (positions, normals) = match earlier.checked_sub(1).map(|before| &self.later[before]) {
            None => (&*self.positions, &*self.normals),
            Some(pose) => (&*pose.positions, &*pose.normals),
        };
        Between {
            positions: [positions, &later.positions],
            normals: [normals, &later.normals],
            parts: [1.0 - fraction, fraction],
        }
    }

    /// The texture coordinates of a triangle's corners; a mesh without any has (0, 0), (1, 0), (1, 1) on each.
    pub fn corner_uvs(&self, index: usize) -> [Vec2; 3] {
        if self.uvs.is_empty() {
            Self::NO_UVS.map(Vec2::from_array)
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

    /// A texture point at such a point, completed by the mesh's own colour and vertex data there.
    #[inline]
    pub(crate) fn completed<'a>(
        &self,
        at: TexturePoint<'a>,
        index: usize,
        u: f32,
        v: f32,
    ) -> TexturePoint<'a> {
        let at = TexturePoint { color: self.color(index, u, v), ..at };
        if !self.has_vertex_data() {
            return at;
        }
        let VertexData { more_uvs, opacity } = self.vertex_data(index, u, v);
        TexturePoint { more_uvs, opacity, ..at }
    }

    /// The area of a triangle.
    pub fn area(&self, index: usize) -> f64 {
        let [p0, p1, p2] = self.corners(index).map(|p| Vec3::from_array(p).as_dvec3());
        0.5 * (p1 - p0).cross(p2 - p0).length()
    }

    /// The point with weight `u` of a triangle's second corner and `v` of its third.
    pub fn point(&self, index: usize, u: f32, v: f32) -> SurfacePoint {
        self.point_at(index, [u, v], 0.0)
    }

    /// [`Self::point`] at a time of the shutter (0 … 1).
    pub fn point_at(&self, index: usize, [u, v]: [f32; 2], time: f32) -> SurfacePoint {
        let SurfacePoints { points, ng, ns, uv: [s, t], dpdu, dpdv, shading_dpdu, shading_dpdv, lift } =
            self.triangle_at(index, time).points(u, v);
        let point = Point { position: points.position.into(), error: points.error.into() };
        SurfacePoint {
            point,
            ng: ng.into(),
            ns: ns.into(),
            uv: Vec2::new(s, t),
            dpdu: dpdu.into(),
            dpdv: dpdv.into(),
            shading_dpdu: shading_dpdu.into(),
            shading_dpdv: shading_dpdv.into(),
            lift: lift.into(),
            color: self.color(index, u, v),
            binding: self.binding,
        }
    }

    /// A triangle with what its vertices have, at a time of the shutter (0 … 1).
    pub(crate) fn triangle_at(&self, index: usize, time: f32) -> Triangles<f32> {
        let triangle = self.triangle(index);
        if self.later.is_empty() {
            return triangle;
        }
        let Between { normals: [before, after], parts, .. } = self.between(time);
        let vertices = self.triangles[index].map(|vertex| vertex as usize);
        let normal = |vertex: usize| match (before.get(vertex), after.get(vertex)) {
            (Some(a), Some(b)) => (*a * parts[0] + *b * parts[1]).normalize_or_zero().into(),
            _ => Vector::from(Vec3::ZERO),
        };
        let positions = self.corners_at(index, time).map(|[x, y, z]| Vector { x, y, z });
        Triangles { positions, normals: vertices.map(normal), ..triangle }
    }

    /// A triangle with what its vertices have when the shutter opens.
    pub(crate) fn triangle(&self, index: usize) -> Triangles<f32> {
        let vertices = self.triangles[index].map(|vertex| vertex as usize);
        let vector = |[x, y, z]: [f32; 3]| Vector { x, y, z };
        let tangent = |tangent: Vec4| Tangent { along: tangent.truncate().into(), sign: tangent.w };
        Triangles {
            positions: vertices.map(|vertex| vector(self.positions[vertex])),
            orientation: if self.flip { -1.0 } else { 1.0 },
            normals: vertices.map(|vertex| self.normals.get(vertex).copied().unwrap_or_default().into()),
            uvs: self.corner_uvs(index).map(|uv| uv.to_array()),
            tangents: vertices.map(|vertex| tangent(self.tangents.get(vertex).copied().unwrap_or_default())),
            have_normals: !self.normals.is_empty(),
            have_tangents: !self.tangents.is_empty(),
            want_derivatives: self.wants_derivatives,
            are_lifted: self.is_lifted,
        }
    }
}
