//! Writer for PLY meshes.

use std::fmt::Write;

use super::exact::Columns;
use super::header::{MARK, SOLID};
use crate::shape::Mesh;

/// A mesh as a binary, little-endian PLY file. [`super::from_bytes`] gives the same mesh, bit by bit, except for its name and its displacement,
/// by a comment in the file; other programs see its vertices, normals, texture coordinates, colours and triangles.
pub fn write(mesh: &Mesh) -> Vec<u8> {
    let columns = Columns::of(mesh);
    let mut header = String::from("ply\nformat binary_little_endian 1.0\n");
    let [mark, solid] = [MARK, SOLID].map(String::from_utf8_lossy);
    // Writing to a string cannot fail.
    let _ = writeln!(
        header,
        "comment {mark}{}",
        if mesh.is_of_solid { format!(" {solid}") } else { String::new() }
    );
    let _ = writeln!(header, "element vertex {}", mesh.positions.len());
    for name in columns.names() {
        let _ = writeln!(header, "property float {name}");
    }
    let _ = writeln!(header, "element face {}", mesh.triangles.len());
    header.push_str("property list uchar uint vertex_indices\nend_header\n");

    let mut bytes = header.into_bytes();
    bytes.reserve(mesh.positions.len() * columns.names().len() * 4 + mesh.triangles.len() * 13);
    let mut put = |values: &[f32]| values.iter().for_each(|value| bytes.extend(value.to_le_bytes()));
    for vertex in 0..mesh.positions.len() {
        put(&mesh.positions[vertex].to_array());
        mesh.normals.get(vertex).into_iter().for_each(|normal| put(&normal.to_array()));
        for uvs in [&mesh.uvs].into_iter().chain(&mesh.more_uvs) {
            uvs.get(vertex).into_iter().for_each(|uv| put(&uv.to_array()));
        }
        mesh.colors.get(vertex).into_iter().for_each(|color| put(color));
        mesh.opacities.get(vertex).into_iter().for_each(|opacity| put(&[*opacity]));
        mesh.tangents.get(vertex).into_iter().for_each(|tangent| put(&tangent.to_array()));
        for pose in &mesh.later {
            put(&pose.positions[vertex].to_array());
            pose.normals.get(vertex).into_iter().for_each(|normal| put(&normal.to_array()));
        }
    }
    for triangle in &mesh.triangles {
        bytes.push(3);
        triangle.iter().for_each(|vertex| bytes.extend(vertex.to_le_bytes()));
    }
    bytes
}
