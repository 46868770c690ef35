//! Meshes, wires and point clouds of PLY elements.

use std::collections::BTreeMap;
use std::path::Path;

use glam::{Vec2, Vec3};

use super::body::{Content, SPLAT_COLOR};
use super::header::{Element, Header};
use crate::error::{Location, Result};
use crate::files::LoadContext;
use crate::image::Encoding;
use crate::material::Whitted;
use crate::model::points;
use crate::model::polygon::{Triangulator, has_area};
use crate::model::surface::{
    picture, push_image, push_material, push_texture, push_vertex_colors, read_image,
};
use crate::model::tally::Tally;
use crate::model::weld::Weld;
use crate::scene::{MaterialId, MeshId, Scene};
use crate::shape::{Geometry, Mesh, Part};
use crate::texture::Wrap;

/// Adds the mesh (or the edges, or the points) and its material to the scene; and the number of triangles without area.
pub(super) fn parts(
    mut content: Content,
    header: &Header,
    path: &Path,
    context: &mut LoadContext<'_>,
    scene: &mut Scene,
) -> Result<(Vec<Part>, u64)> {
    let file = Location::file(path);
    let mut thin = Tally::default();
    thin.add_many(content.thin.0, content.thin.1);
    thin.notice("face", "left out: fewer than three corners", &file, context);
    content.longer.warn(
        "row",
        "with more values than the header declares: the rest of the line is skipped",
        &file,
        context,
    );
    if content.positions.is_empty() {
        context.warn(&file, "there are no vertices");
        return Ok((Vec::new(), 0));
    }
    if content.faces.is_empty() && !content.edges.is_empty() {
        let Content { edges, positions, colors, .. } = content;
        return Ok((edges.wires(&positions, &colors, &file, context, scene), 0));
    }
    if content.faces.is_empty() {
        let is_splat = |element: &Element| element.find(&[SPLAT_COLOR]).is_some();
        if header.elements.iter().any(is_splat) {
            context.warn(
                &file,
                "this is a cloud of 3D Gaussian splats (Kerbl et al. 2023): they are shown as points of one size, \
                 without their opacities and shapes",
            );
        }
        return Ok((points::cloud(&content.positions, &content.colors, &file, context, scene), 0));
    }
    make_values_finite(&mut content, &file, context);
    let (mut mesh, textures, flat) = mesh(content, &file, context);
    if mesh.triangles.is_empty() {
        return Ok((Vec::new(), flat));
    }
    mesh.name = file.file.to_string();
    let has_many = header.textures.len() > 1 && !mesh.uvs.is_empty();
    if has_many && textures.is_empty() {
        let message = format!("{} textures are named: only the first is used", header.textures.len());
        context.warn(&file, message);
    }
    let meshes = match has_many && !textures.is_empty() {
        true => by_texture(&mesh, &textures),
        false => vec![(0, mesh)],
    };
    let mut parts = Vec::with_capacity(meshes.len());
    for (texture, mesh) in meshes {
        let texture = header.textures.get(texture as usize).map(String::as_str);
        let material = material(&mesh, texture, path, context, scene);
        let geometry = Geometry::Mesh(MeshId(scene.meshes.len() as u32));
        scene.meshes.push(mesh);
        parts.push(Part { material, ..Part::new(None, geometry) });
    }
    Ok((parts, flat))
}

/// A mesh for each texture, of the triangles that have it; by the number of the texture.
fn by_texture(mesh: &Mesh, textures: &[u32]) -> Vec<(u32, Mesh)> {
    let mut triangles: BTreeMap<u32, Vec<[u32; 3]>> = BTreeMap::new();
    for (triangle, &texture) in mesh.triangles.iter().zip(textures) {
        triangles.entry(texture).or_default().push(*triangle);
    }
    let of_texture = |(texture, mut triangles): (u32, Vec<[u32; 3]>)| {
        let mut weld = Weld::new();
        triangles.iter_mut().for_each(|triangle| *triangle = triangle.map(|vertex| weld.id([vertex])));
        let keys = weld.keys();
        let mesh = Mesh {
            name: mesh.name.clone(),
            positions: select(&mesh.positions, keys),
            triangles,
            normals: select(&mesh.normals, keys),
            uvs: select(&mesh.uvs, keys),
            colors: select(&mesh.colors, keys),
            ..Mesh::default()
        };
        (texture, mesh)
    };
    triangles.into_iter().map(of_texture).collect()
}

fn make_values_finite(content: &mut Content, file: &Location, context: &mut LoadContext<'_>) {
    let mut tally = Tally::default();
    for normal in content.normals.iter_mut().filter(|normal| !normal.is_finite()) {
        *normal = Vec3::ZERO;
        tally.add(0);
    }
    for uv in content.uvs.iter_mut().chain(&mut content.corner_uvs).filter(|uv| !uv.is_finite()) {
        *uv = Vec2::ZERO;
        tally.add(0);
    }
    tally.warn("normal or texture coordinate", "ignored: infinite or not a number", file, context);
}

/// The mesh, the textures of its triangles (empty if faces have none), and the number of triangles without area.
fn mesh(content: Content, file: &Location, context: &mut LoadContext<'_>) -> (Mesh, Vec<u32>, u64) {
    let Content { mut positions, normals, uvs, colors, faces, corners, corner_uvs, .. } = content;
    let Content { face_colors, face_textures, .. } = content;
    let mut triangulator = Triangulator::new();
    let (mut not_finite, mut flat) = (Tally::default(), Tally::default());
    // Colours of vertices are finer than those of faces.
    let face_colors = if colors.is_empty() { face_colors } else { Vec::new() };
    // Triangles, as indices of corners, and the colours and textures of their faces.
    let mut triangles: Vec<[u32; 3]> = Vec::with_capacity(faces.len());
    let mut triangle_colors: Vec<[f32; 3]> = Vec::new();
    let mut triangle_textures: Vec<u32> = Vec::new();
    let (mut points, mut cut) = (Vec::new(), Vec::new());
    let mut start = 0;
    for (index, face) in faces.iter().enumerate() {
        points.clear();
        let end = start + face.corners as usize;
        points.extend(corners[start..end].iter().map(|&vertex| positions[vertex as usize]));
        if points.iter().all(|point| point.is_finite()) {
            cut.clear();
            triangulator.cut(&points, &mut cut);
            for triangle in &cut {
                if has_area(triangle.map(|i| points[i as usize])) {
                    triangles.push(triangle.map(|i| start as u32 + i));
                    triangle_colors.extend(face_colors.get(index));
                    triangle_textures.extend(face_textures.get(index));
                } else {
                    flat.add(face.line);
                }
            }
        } else {
            not_finite.add(face.line);
        }
        start = end;
    }
    not_finite.warn("face", "left out: a coordinate is infinite or not a number", file, context);
    flat.notice("triangle", "left out: without area", file, context);
    if triangulator.gave_up() {
        context.warn(
            file,
            "concave polygons with very many corners: some were triangulated as if they were convex",
        );
    }
    if corner_uvs.is_empty() && face_colors.is_empty() {
        for triangle in &mut triangles {
            *triangle = triangle.map(|corner| corners[corner as usize]);
        }
        // No triangle uses these.
        for position in positions.iter_mut().filter(|position| !position.is_finite()) {
            *position = Vec3::ZERO;
        }
        let mesh = Mesh { positions, triangles, normals, uvs, colors, ..Mesh::default() };
        return (mesh, triangle_textures, flat.count());
    }
    // A vertex with different texture coordinates or colours in different faces is split.
    let mut weld = Weld::new();
    for (index, triangle) in triangles.iter_mut().enumerate() {
        let [r, g, b] = triangle_colors.get(index).copied().unwrap_or_default().map(f32::to_bits);
        *triangle = triangle.map(|corner| {
            let uv = corner_uvs.get(corner as usize).copied().unwrap_or_default();
            weld.id([corners[corner as usize], uv.x.to_bits(), uv.y.to_bits(), r, g, b])
        });
    }
    let keys = weld.keys();
    let uv_of = |key: &Key| Vec2::new(f32::from_bits(key[1]), f32::from_bits(key[2]));
    let color_of = |key: &Key| [key[3], key[4], key[5]].map(f32::from_bits);
    let mesh = Mesh {
        positions: keys.iter().map(|key| positions[key[0] as usize]).collect(),
        triangles,
        normals: select(&normals, keys),
        uvs: if corner_uvs.is_empty() { select(&uvs, keys) } else { keys.iter().map(uv_of).collect() },
        colors: if face_colors.is_empty() {
            select(&colors, keys)
        } else {
            keys.iter().map(color_of).collect()
        },
        ..Mesh::default()
    };
    (mesh, triangle_textures, flat.count())
}

/// A vertex, its texture coordinates and its colour, as bits.
type Key = [u32; 6];

/// The values of vertices, by the first number of their keys.
fn select<T: Copy, const N: usize>(values: &[T], keys: &[[u32; N]]) -> Vec<T> {
    keys.iter().filter_map(|key| values.get(key[0] as usize).copied()).collect()
}

/// A material with an image that the file names, if there are texture coordinates, or else with the vertices' colours.
fn material(
    mesh: &Mesh,
    texture: Option<&str>,
    path: &Path,
    context: &mut LoadContext<'_>,
    scene: &mut Scene,
) -> Option<MaterialId> {
    let at = Location::file(path);
    if let (Some(name), false) = (texture, mesh.uvs.is_empty()) {
        match read_image(path, name, Encoding::Srgb, context) {
            Ok(image) => {
                let image = push_image(scene, image);
                let kind = picture(image, [1.0; 2], [0.0; 2], Wrap::Repeat);
                let diffuse = push_texture(scene, name, &at, kind);
                return Some(push_material(scene, name, &at, Whitted { diffuse, ..Whitted::default() }));
            }
            Err(error) => context.warn(&at, format!("texture `{name}`: {}; it is left out", error.message)),
        }
    }
    (!mesh.colors.is_empty()).then(|| push_vertex_colors(scene, &at))
}
