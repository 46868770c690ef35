//! Exact duplicates: triangles of a mesh, spheres of a cloud and instances that are the same in every number. A ray tests all that lie in
//! one place, and sees one of them: a file of a million points at the origin would take a million tests a ray.
//!
//! Surfaces of solids stay as they are: where one touches itself, rounding can make two of its triangles the same, and it is closed
//! by both.
//!
//! Triangles are the same whichever corner comes first, but not the other way round. Few duplicates among many cost little: a sample
//! tells whether to search for them.

use std::collections::{HashMap, HashSet};
use std::hash::Hash;

use crate::error::Location;
use crate::files::LoadContext;
use crate::scene::{Instance, Scene};
use crate::shape::{Geometry, Mesh, Shape, Sphere};

/// Number of elements in a sample.
const SAMPLES: usize = 4096;

/// Keeps the first of equal elements in each mesh and cloud, and among the instances, with a note.
pub(crate) fn remove(scene: &mut Scene, file: &Location, context: &mut LoadContext<'_>) {
    let of_mesh = |mesh: &mut Mesh| match !mesh.is_of_solid && mesh.later.is_empty() {
        true => of_mesh(mesh),
        false => Vec::new(),
    };
    let gone: Vec<Vec<u32>> = scene.meshes.iter_mut().map(of_mesh).collect();
    let triangles = gone.iter().map(Vec::len).sum();
    let in_objects = scene.objects.iter_mut().flat_map(|object| &mut object.shapes);
    let mut spheres = 0;
    for shape in scene.shapes.iter_mut().chain(in_objects) {
        spheres += of_cloud(shape);
        if let Geometry::Mesh(id) = shape.geometry
            && !gone[id.index()].is_empty()
        {
            let left = scene.meshes[id.index()].triangles.len();
            shape.pieces = shape.pieces.without(&gone[id.index()], left);
        }
    }
    let instances = of_instances(&mut scene.instances);
    for (count, noun) in [(triangles, "triangle"), (spheres, "sphere"), (instances, "instance")] {
        if count > 0 {
            let plural = if count == 1 { "" } else { "s" };
            context.notice(file, format!("{count} {noun}{plural} left out: exactly the same as others"));
        }
    }
}

/// Whether two elements of a sample have the same key.
fn is_suspicious<K: Eq + Hash>(count: usize, key: impl Fn(usize) -> K) -> bool {
    let mut seen = HashSet::new();
    (0..count).step_by(count.div_ceil(SAMPLES).max(1)).any(|index| !seen.insert(key(index)))
}

/// The numbers of the triangles that are left out, in order.
fn of_mesh(mesh: &mut Mesh) -> Vec<u32> {
    // The other numbers of vertices are looked at only where places are the same.
    let place = |vertex: u32| mesh.positions[vertex as usize].to_array().map(|x| (x + 0.0).to_bits());
    if !is_suspicious(mesh.triangles.len(), |index| turned(mesh.triangles[index].map(place))) {
        return Vec::new();
    }
    let mut known = HashMap::new();
    let first: Vec<u32> = (0..mesh.positions.len())
        .map(|vertex| *known.entry(numbers(mesh, vertex)).or_insert(vertex as u32))
        .collect();
    let mut gone = Vec::new();
    let mut seen = HashSet::new();
    let mut number = 0;
    mesh.triangles.retain(|triangle| {
        let is_new = seen.insert(turned(triangle.map(|vertex| first[vertex as usize])));
        if !is_new {
            gone.push(number);
        }
        number += 1;
        is_new
    });
    gone
}

/// The corners, with the least one first.
pub(crate) fn turned<T: Ord>(mut corners: [T; 3]) -> [T; 3] {
    let least = (0..3).min_by_key(|&k| &corners[k]).unwrap_or(0);
    corners.rotate_left(least);
    corners
}

/// All numbers of a vertex, as bits.
fn numbers(mesh: &Mesh, vertex: usize) -> Vec<u32> {
    let Mesh { positions, normals, uvs, more_uvs, colors, opacities, tangents, .. } = mesh;
    let mut numbers = positions[vertex].to_array().to_vec();
    numbers.extend(normals.get(vertex).iter().flat_map(|normal| normal.to_array()));
    for uvs in more_uvs.iter().chain([uvs]) {
        numbers.extend(uvs.get(vertex).iter().flat_map(|uv| uv.to_array()));
    }
    numbers.extend(colors.get(vertex).into_iter().flatten());
    numbers.extend(opacities.get(vertex));
    numbers.extend(tangents.get(vertex).iter().flat_map(|tangent| tangent.to_array()));
    // Adding 0 makes −0 and 0 equal.
    numbers.into_iter().map(|number| (number + 0.0).to_bits()).collect()
}

fn of_cloud(shape: &mut Shape) -> usize {
    let Geometry::Spheres(spheres) = &shape.geometry else { return 0 };
    let key = |sphere: &Sphere| {
        let [x, y, z] = sphere.center.to_array();
        [x, y, z, sphere.radius].map(|number| (number + 0.0).to_bits())
    };
    if !is_suspicious(spheres.len(), |index| key(&spheres[index])) {
        return 0;
    }
    let mut seen = HashSet::new();
    let kept: Vec<Sphere> = spheres.iter().filter(|sphere| seen.insert(key(sphere))).copied().collect();
    let count = spheres.len() - kept.len();
    shape.geometry = Geometry::Spheres(kept.into());
    count
}

fn of_instances(instances: &mut Vec<Instance>) -> usize {
    let key = |instance: &Instance| {
        let matrix = instance.world_from_object.to_cols_array().map(|number| (number + 0.0).to_bits());
        (instance.object, instance.material, matrix)
    };
    if !is_suspicious(instances.len(), |index| key(&instances[index])) {
        return 0;
    }
    let before = instances.len();
    let mut seen = HashSet::new();
    instances.retain(|instance| instance.motion.is_some() || seen.insert(key(instance)));
    before - instances.len()
}

#[cfg(test)]
mod tests {
    use glam::{DVec3, Vec2, Vec3};

    use super::*;
    use crate::files::Memory;
    use crate::scene::{MaterialId, MeshId};
    use crate::shape::{Piece, Pieces};

    #[test]
    fn what_differs_in_anything_stays() {
        let corners = [Vec3::ZERO, Vec3::X, Vec3::Y];
        let positions = [corners, corners, corners].concat();
        let uvs = (0..9).map(|vertex| Vec2::splat(if vertex < 6 { 0.0 } else { 1.0 })).collect();
        // The second is the first; the third has other texture coordinates, and the fourth looks the other way.
        let triangles = vec![[0, 1, 2], [4, 5, 3], [6, 7, 8], [0, 2, 1], [1, 2, 0]];
        let mut mesh = Mesh { positions, uvs, triangles, ..Mesh::default() };
        assert_eq!(of_mesh(&mut mesh), [1, 4]);
        assert_eq!(mesh.triangles, [[0, 1, 2], [6, 7, 8], [0, 2, 1]]);
        assert!(of_mesh(&mut mesh).is_empty());
    }

    #[test]
    fn what_is_left_keeps_its_name() {
        let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::ONE];
        let triangles = vec![[0, 1, 2], [1, 2, 0], [1, 2, 3]];
        let mesh = Mesh { positions: corners.to_vec(), triangles, ..Mesh::default() };
        let piece = |first, name: &str| Piece { first, name: Some(name.into()) };
        let pieces = Pieces::new(vec![piece(0, "a"), piece(1, "a again"), piece(2, "b")]);
        let geometry = Geometry::Mesh(MeshId(0));
        let shape = Shape { pieces, ..Shape::new(Location::default(), geometry, MaterialId(0)) };
        let mut scene = Scene { shapes: vec![shape], meshes: vec![mesh], ..Scene::default() };
        let files = Memory::default();
        remove(&mut scene, &Location::default(), &mut LoadContext::new(&files));
        assert_eq!(scene.shapes[0].pieces, Pieces::new(vec![piece(0, "a"), piece(1, "b")]));
    }

    #[test]
    fn clouds_at_one_place_are_a_sphere() {
        let sphere = |x: f64, radius: f64| Sphere { center: DVec3::new(x, 0.0, 0.0), radius };
        let mut spheres = vec![sphere(0.0, 1.0); 100_000];
        spheres.extend([sphere(-0.0, 1.0), sphere(1.0, 1.0), sphere(0.0, 2.0)]);
        let shape = Shape::new(Location::default(), Geometry::Spheres(spheres.into()), MaterialId(0));
        let mut scene = Scene { shapes: vec![shape], ..Scene::default() };
        let files = Memory::default();
        let mut context = LoadContext::new(&files);
        remove(&mut scene, &Location::default(), &mut context);
        let Geometry::Spheres(left) = &scene.shapes[0].geometry else { panic!() };
        assert_eq!(**left, [sphere(0.0, 1.0), sphere(1.0, 1.0), sphere(0.0, 2.0)]);
        assert_eq!(context.warnings[0].message, "100000 spheres left out: exactly the same as others");
    }
}
