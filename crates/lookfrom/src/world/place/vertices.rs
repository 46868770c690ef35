//! Placement of meshes, patches and curves.

use std::sync::Arc;

use glam::{DMat4, DVec3, Vec2, Vec3, Vec4};
use lookfrom_scene::material::Color;
use lookfrom_scene::scene::VertexNormals;
use lookfrom_scene::shape::{
    Emission, Geometry, Mesh as WrittenMesh, MeshPose, Patches as WrittenPatches, Profile, Shape, Strand,
};
use lookfrom_scene::{Error, ErrorKind, Result, Warning};

use super::{Compiler, Group, Placing, inverse, not_invertible};
use crate::core::math;
use crate::light::{CurveLight, LightShape, MeshLight, PatchLight};
use crate::primitive::{Curves, Mesh, Patches, Pose, Primitives, SEGMENTS};
use crate::shading::texture::{FloatTexture, MORE_UV_SETS, SpectrumType};

/// A patch is a parallelogram if its fourth corner deviates from it by less than this part of its distance from the
/// origin (or of 1, for texture coordinates): the rounding of numbers in f32.
const FLATNESS: f32 = 4.0 * f32::EPSILON;

impl Compiler<'_> {
    pub(super) fn mesh(&mut self, placing: Placing, mesh: &WrittenMesh, group: &mut Group) -> Result<()> {
        let Placing { shape, matrix, binding } = placing;
        countable(placing, mesh.positions.len().max(mesh.triangles.len()))?;
        // A reflection keeps the outside outside, but changes the handedness of the frame of tangent, normal and v.
        let flip = placing.mirrors() != shape.reverse_orientation;
        let side = if flip { -1.0 } else { 1.0 };
        let tangent = |s: &Vec4| {
            let along = matrix.transform_vector3(s.truncate().as_dvec3()).as_vec3();
            along.extend(side * s.w)
        };
        let more_uvs = mesh.more_uvs.iter().take(MORE_UV_SETS).cloned().collect();
        let positions = |of: &[Vec3]| of.iter().map(|p| moved(matrix, *p).to_array()).collect();
        let pose = |pose: &MeshPose| {
            Ok(Pose { positions: positions(&pose.positions), normals: normals(placing, &pose.normals)? })
        };
        let mut placed = Mesh {
            positions: positions(&mesh.positions),
            triangles: mesh.triangles.clone(),
            normals: normals(placing, &mesh.normals)?,
            uvs: mesh.uvs.clone(),
            colors: mesh.colors.clone(),
            tangents: mesh.tangents.iter().map(tangent).collect(),
            more_uvs,
            opacities: mesh.opacities.clone(),
            wants_derivatives: self.has_grain(placing),
            flip,
            is_lifted: self.scene.vertex_normals == VertexNormals::Smooth && !mesh.normals.is_empty(),
            later: mesh.later.iter().map(pose).collect::<Result<_>>()?,
            binding,
        };
        placed.binding.vertex_data = placed.has_vertex_data().then_some(self.vertex_data.len() as u32);
        placed.binding.light = Some(self.next_light());
        let mut placed = Arc::new(placed);
        let (textures, origin) = (self.lights.textures, self.lights.origin);
        let light = self.area_light(placing, |_| {
            let light = match shape.emission.map(|emission| emission.radiance) {
                Some(pattern @ Color::Texture(_)) => {
                    let pattern = textures.spectrum_texture(pattern, SpectrumType::Illuminant);
                    let alpha = shape.alpha.map(FloatTexture::from);
                    MeshLight::patterned(placed.clone(), origin, &|at| {
                        let brightest = textures.rgb(&pattern, at).into_iter().fold(0.0, f32::max);
                        brightest * alpha.map_or(1.0, |alpha| textures.float(alpha, at))
                    })
                }
                _ => MeshLight::new(placed.clone()),
            };
            light.map(LightShape::Mesh)
        });
        if light.is_none() {
            Arc::make_mut(&mut placed).binding.light = None;
        }
        if placed.has_vertex_data() {
            self.vertex_data.push(placed.clone());
        }
        group.own.push(Primitives::Mesh(placed));
        Ok(())
    }

    pub(super) fn patches(
        &mut self,
        placing: Placing,
        patches: &WrittenPatches,
        group: &mut Group,
    ) -> Result<()> {
        let Placing { shape, matrix, binding } = placing;
        countable(placing, patches.positions.len().max(patches.patches.len()))?;
        if let Some(mesh) = parallelograms(patches) {
            return self.mesh(placing, &mesh, group);
        }
        let mut placed = Patches {
            positions: patches.positions.iter().map(|p| moved(matrix, *p)).collect(),
            patches: patches.patches.clone(),
            normals: normals(placing, &patches.normals)?,
            uvs: patches.uvs.clone(),
            flip: placing.mirrors() != shape.reverse_orientation,
            binding,
        };
        placed.binding.light = Some(self.next_light());
        let mut placed = Arc::new(placed);
        let light = self.area_light(placing, |_| PatchLight::new(placed.clone()).map(LightShape::Patches));
        if light.is_none() {
            Arc::make_mut(&mut placed).binding.light = None;
        }
        group.own.push(Primitives::Patches(placed));
        Ok(())
    }

    pub(super) fn curves(
        &mut self,
        placing: Placing,
        strands: &Arc<[Strand]>,
        group: &mut Group,
    ) -> Result<()> {
        let Placing { shape, matrix, binding } = placing;
        countable(placing, strands.len().saturating_mul(SEGMENTS as usize))?;
        let mut curves =
            Curves::new(strands.clone(), math::affine(matrix), shape.reverse_orientation, binding)
                .ok_or_else(|| not_invertible(&shape.at))?;
        // Curves that face all rays have no back; their light would not be seen from behind.
        let has_back = strands.iter().any(|strand| matches!(strand.profile, Profile::Ribbon(_)));
        let emission = shape
            .emission
            .map(|emission| Emission { two_sided: emission.two_sided || !has_back, ..emission });
        let shining = Shape { emission, geometry: Geometry::Curves(Arc::default()), ..shape.clone() };
        let scale = libm::cbrt(matrix.determinant().abs());
        let light = self.area_light(Placing { shape: &shining, ..placing }, |_| {
            CurveLight::new(&curves, scale).map(LightShape::Curves)
        });
        if light.is_some() {
            let message =
                "curves that emit light are not sampled: only the paths that meet them find their light";
            self.warnings.push(Warning::notice(&shape.at, message));
        }
        curves.binding.light = light;
        group.own.push(Primitives::Curves(Arc::new(curves)));
        Ok(())
    }
}

fn countable(placing: Placing, count: usize) -> Result<()> {
    if u32::try_from(count).is_ok() {
        return Ok(());
    }
    Err(Error::new(ErrorKind::Limit, &placing.shape.at, "more than 2³² vertices or primitives in one shape"))
}

fn moved(matrix: &DMat4, p: Vec3) -> Vec3 {
    matrix.transform_point3(p.as_dvec3()).as_vec3()
}

/// Unit shading normals after the shape's transform, flipped where the shape's orientation is reversed.
fn normals(placing: Placing, written: &[Vec3]) -> Result<Vec<Vec3>> {
    let inverse = inverse(&placing.shape.at, placing.matrix)?;
    let side = if placing.shape.reverse_orientation { -1.0 } else { 1.0 };
    let normal =
        |n: &Vec3| (side * math::transform_normal(&inverse, n.as_dvec3()).normalize_or_zero()).as_vec3();
    Ok(written.iter().map(normal).collect())
}

pub(super) fn quad(corner: DVec3, edge_u: DVec3, edge_v: DVec3) -> WrittenMesh {
    let corners = [corner, corner + edge_u, corner + edge_u + edge_v, corner + edge_v];
    WrittenMesh {
        name: "quad".into(),
        positions: corners.map(DVec3::as_vec3).to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        uvs: [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(Into::into).to_vec(),
        ..WrittenMesh::default()
    }
}

/// Patches that are all parallelograms, with texture coordinates that are linear over them, as two triangles each,
/// which are faster to intersect and better to sample.
fn parallelograms(patches: &WrittenPatches) -> Option<WrittenMesh> {
    if !patches.normals.is_empty() {
        return None;
    }
    let mut mesh = WrittenMesh { name: "parallelograms".into(), ..WrittenMesh::default() };
    for patch in &patches.patches {
        let [p00, p10, p01, p11] = patch.map(|vertex| patches.positions[vertex as usize]);
        let size = p00.abs().max(p10.abs()).max(p01.abs()).max(p11.abs()).max_element();
        let uvs = if patches.uvs.is_empty() {
            [Vec2::ZERO, Vec2::X, Vec2::Y, Vec2::ONE]
        } else {
            patch.map(|vertex| patches.uvs[vertex as usize])
        };
        let [uv00, uv10, uv01, uv11] = uvs;
        let even = |twist: f32, size: f32| twist <= FLATNESS * size;
        if !(even((p00 - p10 - p01 + p11).abs().max_element(), size)
            && even((uv00 - uv10 - uv01 + uv11).abs().max_element(), 1.0))
        {
            return None;
        }
        let first = u32::try_from(mesh.positions.len()).ok()?;
        mesh.positions.extend([p00, p10, p01, p11]);
        mesh.uvs.extend(uvs);
        mesh.triangles.extend([[first, first + 1, first + 3], [first, first + 3, first + 2]]);
    }
    Some(mesh)
}
