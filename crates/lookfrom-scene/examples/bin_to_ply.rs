//! Turns a benchmark mesh into a PLY file that every program reads.
//!
//! ```sh
//! cargo run --release -p lookfrom-scene --example bin_to_ply -- bunny.bin bunny.ply
//! cargo run --release -p lookfrom-scene --example bin_to_ply -- bunny.bin large.ply 2
//! ```
//!
//! A third argument divides every triangle into four, so many times: for large meshes to measure with.
//!
//! The `.bin` format, little endian: the number of triangles and of vertices as `u32`, then `f32` x, y, z of each vertex,
//! then three `u32` vertex indices of each triangle.

use std::collections::HashMap;
use std::process::ExitCode;

use glam::Vec3;
use lookfrom_scene::ply;
use lookfrom_scene::shape::Mesh;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (from, to, divisions) = match arguments.as_slice() {
        [from, to] => (from, to, Some(0)),
        [from, to, divisions] => (from, to, divisions.parse::<u32>().ok()),
        _ => (&String::new(), &String::new(), None),
    };
    let Some(divisions) = divisions else {
        eprintln!("usage: bin_to_ply MESH.bin MESH.ply [DIVISIONS]");
        return ExitCode::from(2);
    };
    let done = std::fs::read(from)
        .map_err(|error| format!("{from}: {error}"))
        .and_then(|bytes| mesh(&bytes).ok_or_else(|| format!("{from}: not a whole benchmark mesh")))
        .map(|mesh| (0..divisions).fold(mesh, |mesh, _| divided(&mesh)))
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

/// Each triangle as four, with shared vertices in the middles of its edges.
fn divided(mesh: &Mesh) -> Mesh {
    let mut positions = mesh.positions.clone();
    let mut middles: HashMap<[u32; 2], u32> = HashMap::new();
    let mut triangles = Vec::with_capacity(4 * mesh.triangles.len());
    for &[a, b, c] in &mesh.triangles {
        let [ab, bc, ca] = [[a, b], [b, c], [c, a]].map(|[from, to]| {
            *middles.entry([from.min(to), from.max(to)]).or_insert_with(|| {
                positions.push(0.5 * (positions[from as usize] + positions[to as usize]));
                positions.len() as u32 - 1
            })
        });
        triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    Mesh { positions, triangles, ..Mesh::default() }
}
