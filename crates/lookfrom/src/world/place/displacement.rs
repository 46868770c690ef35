//! Displacement of meshes: vertices are moved along their normals by a texture.

use glam::{DMat4, Vec2};
use lookfrom_scene::material::Scalar;
use lookfrom_scene::shape::Mesh as WrittenMesh;

use crate::core::math;
use crate::shading::texture::{FloatTexture, MORE_UV_SETS, TexturePoint, Textures};

/// A mesh that is moved by `amount` along its normals, in its own space, and its new normals. Where the amount is not finite,
/// the mesh stays. Positions are in the space of textures after `world_from_object`.
pub(super) fn displaced(
    mesh: &WrittenMesh,
    amount: Scalar,
    textures: &Textures,
    world_from_object: &DMat4,
) -> WrittenMesh {
    let amount = FloatTexture::from(amount);
    let mean_normals = if mesh.normals.is_empty() { mesh.mean_normals() } else { Vec::new() };
    let normals = if mesh.normals.is_empty() { &mean_normals } else { &mesh.normals };
    let object_from_world = world_from_object.inverse();
    let moved = |vertex: usize| {
        let (position, n) = (mesh.positions[vertex], normals[vertex].normalize_or_zero());
        let uvs = |set: usize| mesh.more_uvs.get(set).map_or(Vec2::ZERO, |uvs| uvs[vertex]);
        let at = TexturePoint {
            uv: mesh.uvs.get(vertex).copied().unwrap_or_default(),
            more_uvs: std::array::from_fn::<_, MORE_UV_SETS, _>(uvs),
            world: world_from_object.transform_point3(position.as_dvec3()),
            color: mesh.colors.get(vertex).copied().unwrap_or([1.0; 3]),
            opacity: mesh.opacities.get(vertex).copied().unwrap_or(1.0),
            n: math::transform_normal(&object_from_world, n.as_dvec3()).normalize_or_zero().as_vec3(),
            ..TexturePoint::NOWHERE
        };
        let to = position + textures.float(amount, &at) * n;
        if to.is_finite() { to } else { position }
    };
    let positions = (0..mesh.positions.len()).map(moved).collect();
    let displaced = WrittenMesh { positions, displacement: None, tangents: Vec::new(), ..mesh.clone() };
    WrittenMesh { normals: displaced.mean_normals(), ..displaced }
}
