//! Writer for PLY meshes.

use std::fmt::Write;

use crate::shape::Mesh;

/// A mesh as a binary, little-endian PLY file. [`super::read`] gives the same mesh, bit by bit, except for its name and for
/// triangles without area.
pub fn write(mesh: &Mesh) -> Vec<u8> {
    let (normals, uvs, colors) = (!mesh.normals.is_empty(), !mesh.uvs.is_empty(), !mesh.colors.is_empty());
    let mut header = String::from("ply\nformat binary_little_endian 1.0\n");
    let mut properties = vec!["x", "y", "z"];
    for (has, names) in
        [(normals, &["nx", "ny", "nz"][..]), (uvs, &["s", "t"]), (colors, &["red", "green", "blue"])]
    {
        properties.extend(names.iter().filter(|_| has));
    }
    // Writing to a string cannot fail.
    let _ = writeln!(header, "element vertex {}", mesh.positions.len());
    for property in properties {
        let _ = writeln!(header, "property float {property}");
    }
    let _ = writeln!(header, "element face {}", mesh.triangles.len());
    header.push_str("property list uchar uint vertex_indices\nend_header\n");

    let mut bytes = header.into_bytes();
    let mut put = |values: &[f32]| values.iter().for_each(|value| bytes.extend(value.to_le_bytes()));
    for (vertex, position) in mesh.positions.iter().enumerate() {
        put(&position.to_array());
        if normals {
            put(&mesh.normals[vertex].to_array());
        }
        if uvs {
            put(&mesh.uvs[vertex].to_array());
        }
        if colors {
            put(&mesh.colors[vertex]);
        }
    }
    for triangle in &mesh.triangles {
        bytes.push(3);
        triangle.iter().for_each(|vertex| bytes.extend(vertex.to_le_bytes()));
    }
    bytes
}
