//! Turns a benchmark mesh into a PLY file that every program reads.
//!
//! ```sh
//! cargo run --release -p lookfrom-scene --example bin_to_ply -- bunny.bin bunny.ply
//! ```
//!
//! The `.bin` format, little endian: the number of triangles and of vertices as `u32`, then `f32` x, y, z of each vertex,
//! then three `u32` vertex indices of each triangle.

use std::process::ExitCode;

use glam::Vec3;
use lookfrom_scene::ply;
use lookfrom_scene::shape::Mesh;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [from, to] = arguments.as_slice() else {
        eprintln!("usage: bin_to_ply MESH.bin MESH.ply");
        return ExitCode::from(2);
    };
    let done = std::fs::read(from)
        .map_err(|error| format!("{from}: {error}"))
        .and_then(|bytes| mesh(&bytes).ok_or_else(|| format!("{from}: not a whole benchmark mesh")))
        .and_then(|mesh| std::fs::write(to, ply::write(&mesh)).map_err(|error| format!("{to}: {error}")));
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}

/// The mesh in these bytes; `None` where their number is not what the first eight of them say, or an index is too large.
fn mesh(bytes: &[u8]) -> Option<Mesh> {
    let (numbers, rest) = bytes.as_chunks::<4>();
    let [triangles, vertices, values @ ..] = numbers else { return None };
    let [triangles, vertices] = [triangles, vertices].map(|bytes| u32::from_le_bytes(*bytes) as usize);
    if !rest.is_empty() || values.len() != 3 * (triangles + vertices) {
        return None;
    }
    let (positions, indices) = values.split_at(3 * vertices);
    let indices = indices.as_chunks::<3>().0.iter().map(|corners| corners.map(u32::from_le_bytes));
    let mesh = Mesh {
        positions: positions
            .as_chunks::<3>()
            .0
            .iter()
            .map(|p| Vec3::from_array(p.map(f32::from_le_bytes)))
            .collect(),
        triangles: indices.collect(),
        ..Mesh::default()
    };
    mesh.triangles.iter().flatten().all(|&vertex| (vertex as usize) < vertices).then_some(mesh)
}
