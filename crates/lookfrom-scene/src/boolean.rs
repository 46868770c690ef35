//! Booleans of solids: the union, intersection and difference of closed triangle meshes.
//!
//! The geometry is the work of a port of Manifold, in `f64` and with the same bits everywhere; here meshes become its solids and
//! solids meshes again. A triangle of a result is a piece of a triangle of an operand and has its normals, texture coordinates
//! and colours, interpolated.

use std::panic::{AssertUnwindSafe, catch_unwind};

use glam::{DMat3, DMat4, DVec3, Vec2, Vec3};
use manifold_rust::manifold::Manifold;
use manifold_rust::types::{BooleanEngine, Error as Status, MeshGLP, OpType, WindingRule};

use crate::budget::Reservation;
use crate::duplicates::turned;
use crate::error::Result;
use crate::model::weld::Weld;
use crate::shape::Mesh;
use crate::solid::Operation;

/// Numbers of a vertex: its position, normal, texture coordinates and colour.
const STRIDE: usize = 3 + 3 + 2 + 3;

/// Bytes that a boolean takes for each triangle of its operands, measured with two spheres that cross.
pub(crate) const BYTES_PER_TRIANGLE: u64 = 600;

/// The most triangles of a surface that crosses itself: it is taken apart with rational numbers, which are slow.
const MOST_CROSSING: usize = 50_000;

/// Why a mesh bounds no solid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Flaw {
    /// Somewhere there are not two triangles at an edge, one on each side.
    Open,
    /// Triangles intersect others, too many to take them apart.
    Crossing,
    /// The volume inside is 0.
    Flat,
    /// Positions are not finite as `f32`.
    Far,
}

/// A part of the surface of a solid, before booleans.
pub(crate) struct OperandSurface<'a> {
    /// The number by which a result knows it.
    pub(crate) number: u32,
    pub(crate) mesh: &'a Mesh,
    /// From the mesh to the space of the boolean.
    pub(crate) matrix: DMat4,
}

/// A solid that closed meshes bound, possibly empty.
#[derive(Clone)]
pub(crate) struct MeshSolid(Manifold);

impl MeshSolid {
    /// The solid that surfaces bound together, whichever side their front is on. What crosses itself (if it may), as the
    /// triangles of a letter may by a hair, is the union of what it surrounds. Vertices at the same place, as `f32`, are one: there
    /// faces of different operands that are meant to be flush are.
    pub(crate) fn new(surfaces: &[OperandSurface<'_>], may_cross: bool) -> std::result::Result<Self, Flaw> {
        let mut soup = Soup::default();
        for surface in surfaces {
            soup.add(surface)?;
        }
        let volume = soup.volume();
        if volume < 0.0 {
            soup.turn();
        }
        let manifold = Manifold::from_mesh_glp(&soup.into_mesh());
        match manifold.status() {
            Status::NoError if volume == 0.0 || manifold.is_empty() => Err(Flaw::Flat),
            Status::NoError if !(may_cross && manifold.has_self_intersections()) => Ok(Self(manifold)),
            Status::NoError if manifold.num_tri() > MOST_CROSSING => Err(Flaw::Crossing),
            Status::NoError => {
                let united = exactly(|| manifold.rebuild_solid(WindingRule::Positive));
                united.filter(|united| !united.is_empty()).map(Self).ok_or(Flaw::Crossing)
            }
            Status::NonFiniteVertex => Err(Flaw::Far),
            _ => Err(Flaw::Open),
        }
    }

    /// The first solid, united or intersected with all others, or without them. Each boolean asks for the memory that it takes
    /// for each triangle, and has it until it is done.
    pub(crate) fn combined(
        operation: Operation,
        mut solids: Vec<Self>,
        reserve: &impl Fn(u64) -> Result<Reservation>,
    ) -> Result<Self> {
        match operation {
            Operation::Union => Self::in_pairs(OpType::Add, solids, reserve),
            Operation::Intersection => Self::in_pairs(OpType::Intersect, solids, reserve),
            Operation::Difference => {
                let cutters = solids.split_off(1.min(solids.len()));
                let cutters = Self::in_pairs(OpType::Add, cutters, reserve)?;
                solids.push(cutters);
                Self::in_pairs(OpType::Subtract, solids, reserve)
            }
        }
    }

    /// Combines neighbours, and then the results: of many small solids few are combined with a large one.
    fn in_pairs(
        operation: OpType,
        mut solids: Vec<Self>,
        reserve: &impl Fn(u64) -> Result<Reservation>,
    ) -> Result<Self> {
        while solids.len() > 1 {
            let pair = |pair: &[Self]| match pair {
                [a, b] => {
                    let _memory = reserve((a.0.num_tri() + b.0.num_tri()) as u64)?;
                    Ok(a.combined_with(b, operation))
                }
                _ => Ok(pair[0].clone()),
            };
            solids = solids.chunks(2).map(pair).collect::<Result<_>>()?;
        }
        Ok(solids.pop().unwrap_or_else(|| Self(Manifold::empty())))
    }

    /// The boolean of two solids. Where sides of both are flush, the fast one may leave what is in both twice, with triangles that are
    /// the same: then it is made anew with rational numbers.
    fn combined_with(&self, other: &Self, operation: OpType) -> Self {
        let fast = self.0.boolean(&other.0, operation);
        let is_right = !has_equal_triangles(&fast);
        let exact = || exactly(|| self.0.boolean_with_engine(&other.0, operation, BooleanEngine::Robust));
        Self(if is_right { fast } else { exact().unwrap_or(fast) })
    }

    /// The remaining parts of the surfaces, each with its number, facing outward. Attributes that a surface did not have are empty.
    pub(crate) fn surfaces(&self) -> Vec<(u32, Mesh)> {
        let whole: MeshGLP<f64, u32> = self.0.get_mesh_glp(-1);
        let runs = whole.run_index.windows(2).zip(&whole.run_original_id).zip(&whole.run_flags);
        let surfaces = runs.map(|((ends, &number), &flags)| {
            let corners = &whole.tri_verts[ends[0] as usize..ends[1] as usize];
            // A cutter's surface is seen from its other side.
            (number, mesh(&whole.vert_properties, corners, flags & 1 != 0))
        });
        surfaces.filter(|(_, mesh)| !mesh.triangles.is_empty()).collect()
    }
}

/// Result of the engine of rational numbers; `None` where it gives up, which it does by a panic: one in 170,000 heaps of random
/// triangles leaves it no direction in which to count what a ray crosses.
fn exactly(make: impl FnOnce() -> Manifold) -> Option<Manifold> {
    catch_unwind(AssertUnwindSafe(make)).ok()
}

/// True if two triangles have the same corners, as `f32`, in the same order.
fn has_equal_triangles(solid: &Manifold) -> bool {
    let solid = solid.as_impl();
    let mut triangles: Vec<[[u32; 3]; 3]> = (0..solid.num_tri())
        .map(|triangle| {
            turned([0, 1, 2].map(|corner| {
                let vertex = solid.halfedge[3 * triangle + corner].start_vert;
                let place = solid.vert_pos[vertex as usize];
                position(&[place.x, place.y, place.z]).to_array().map(f32::to_bits)
            }))
        })
        .collect();
    triangles.sort_unstable();
    triangles.windows(2).any(|pair| pair[0] == pair[1])
}

/// The vertices that some triangles use, and these triangles.
fn mesh(vertices: &[f64], corners: &[u32], is_turned: bool) -> Mesh {
    let mut ids = vec![u32::MAX; vertices.len() / STRIDE];
    let mut mesh = Mesh::default();
    for corner in corners.chunks_exact(3) {
        let numbers = [corner[0], corner[1], corner[2]].map(|id| &vertices[id as usize * STRIDE..][..STRIDE]);
        let [a, b, c] = numbers.map(position);
        if a == b || b == c || c == a {
            // Too small for `f32`: its neighbours meet.
            continue;
        }
        mesh.triangles.push([0, 1, 2].map(|k| {
            let (id, numbers) = (&mut ids[corner[k] as usize], numbers[k]);
            if *id == u32::MAX {
                *id = mesh.positions.len() as u32;
                let normal = DVec3::from_slice(&numbers[3..]).as_vec3();
                mesh.positions.push(position(numbers));
                mesh.normals.push(if is_turned { -normal } else { normal });
                mesh.uvs.push(Vec2::new(numbers[6] as f32, numbers[7] as f32));
                mesh.colors.push([8, 9, 10].map(|index| numbers[index] as f32));
            }
            *id
        }));
    }
    if mesh.normals.iter().all(|&normal| normal == Vec3::ZERO) {
        mesh.normals.clear();
    }
    if mesh.uvs.iter().all(|&uv| uv == Vec2::ZERO) {
        mesh.uvs.clear();
    }
    if mesh.colors.iter().all(|&color| color == [1.0; 3]) {
        mesh.colors.clear();
    }
    mesh
}

/// The position of a vertex as `f32`, without negative zeros.
fn position(numbers: &[f64]) -> Vec3 {
    DVec3::from_slice(numbers).as_vec3() + Vec3::ZERO
}

/// Triangles of several surfaces.
#[derive(Default)]
struct Soup {
    vertices: Vec<f64>,
    triangles: Vec<[u32; 3]>,
    /// The number of each surface, and its first triangle.
    runs: Vec<(u32, usize)>,
    /// For each vertex the first one at its place.
    places: Vec<u32>,
    first_at: Vec<u32>,
    weld: Option<Weld<3>>,
}

impl Soup {
    fn add(&mut self, surface: &OperandSurface<'_>) -> std::result::Result<(), Flaw> {
        let OperandSurface { number, mesh, matrix } = surface;
        let of_normals = DMat3::from_mat4(*matrix).inverse().transpose();
        let is_mirrored = matrix.determinant() < 0.0;
        let first = self.places.len() as u32;
        let weld = self.weld.get_or_insert_with(Weld::new);
        for (index, position) in mesh.positions.iter().enumerate() {
            // Without negative zeros, which are at the same place as others.
            let position = matrix.transform_point3(position.as_dvec3()).as_vec3() + Vec3::ZERO;
            if !position.is_finite() {
                return Err(Flaw::Far);
            }
            let place = weld.id(position.to_array().map(f32::to_bits)) as usize;
            if place == self.first_at.len() {
                self.first_at.push(first + index as u32);
            }
            self.places.push(self.first_at[place]);
            let normal = mesh.normals.get(index).map_or(DVec3::ZERO, |normal| {
                let normal = (of_normals * normal.as_dvec3()).normalize_or_zero();
                if normal.is_finite() { normal } else { DVec3::ZERO }
            });
            let finite = |number: f32| if number.is_finite() { f64::from(number) } else { 0.0 };
            let uv = mesh.uvs.get(index).map_or([0.0; 2], |uv| uv.to_array().map(finite));
            let color = mesh.colors.get(index).map_or([1.0; 3], |color| color.map(finite));
            self.vertices.extend(position.as_dvec3().to_array());
            self.vertices.extend(normal.to_array());
            self.vertices.extend(uv);
            self.vertices.extend(color);
        }
        self.runs.push((*number, self.triangles.len()));
        for &[a, b, c] in &mesh.triangles {
            let [a, b, c] = [a, b, c].map(|vertex| first + vertex);
            let [p, q, r] = [a, b, c].map(|vertex| self.places[vertex as usize]);
            if p != q && q != r && r != p {
                self.triangles.push(if is_mirrored { [a, c, b] } else { [a, b, c] });
            }
        }
        Ok(())
    }

    /// The volume inside (the divergence theorem): negative if the front is inside.
    fn volume(&self) -> f64 {
        let corner = |vertex: u32| DVec3::from_slice(&self.vertices[vertex as usize * STRIDE..]);
        let middle = self.triangles.first().map_or(DVec3::ZERO, |triangle| corner(triangle[0]));
        let parts = self.triangles.iter().map(|triangle| {
            let [a, b, c] = triangle.map(|vertex| corner(vertex) - middle);
            a.dot(b.cross(c)) / 6.0
        });
        parts.sum()
    }

    /// Makes the back the front.
    fn turn(&mut self) {
        for triangle in &mut self.triangles {
            triangle.swap(1, 2);
        }
        for vertex in self.vertices.chunks_exact_mut(STRIDE) {
            for number in &mut vertex[3..6] {
                *number = -*number;
            }
        }
    }

    fn into_mesh(self) -> MeshGLP<f64, u32> {
        let doubles = self.places.iter().enumerate().filter(|&(vertex, &place)| vertex as u32 != place);
        let (merge_from_vert, merge_to_vert) = doubles.map(|(vertex, &place)| (vertex as u32, place)).unzip();
        let starts = self.runs.iter().map(|&(_, first)| first).chain([self.triangles.len()]);
        MeshGLP {
            num_prop: STRIDE as u32,
            vert_properties: self.vertices,
            run_index: starts.map(|first| 3 * first as u32).collect(),
            run_original_id: self.runs.iter().map(|&(number, _)| number).collect(),
            tri_verts: self.triangles.into_flattened(),
            merge_from_vert,
            merge_to_vert,
            ..MeshGLP::default()
        }
    }
}
