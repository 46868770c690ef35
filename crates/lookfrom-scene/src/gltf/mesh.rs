//! Geometry of mesh primitives: triangles, or thin spheres and wires for points and lines (specification, §3.7).

mod topology;

use glam::{DVec3, Vec2, Vec3, Vec4};

use super::file::Document;
use super::json::{Primitive, Whole};
use super::material::{Colors, VertexColors};
use super::tangents;
use crate::budget::Reservation;
use crate::error::Result;
use crate::files::LoadContext;
use crate::model::polygon::has_area;
use crate::model::{lines, points};
use crate::scene::{MeshId, Scene};
use crate::shape::{Geometry, Mesh};
use crate::warning::Warning;

use self::topology::Topology;

/// The attributes of a primitive's vertices as in the file, except for v, which runs up.
#[derive(Clone, Debug, Default)]
pub(crate) struct Vertices {
    pub(crate) positions: Vec<Vec3>,
    /// Empty, or one per vertex.
    pub(crate) normals: Vec<Vec3>,
    /// Empty, or one per vertex; w is the sign of v's direction along normal × tangent.
    pub(crate) tangents: Vec<Vec4>,
    /// Texture coordinate sets, each empty or with one per vertex.
    pub(crate) uvs: Vec<Vec<Vec2>>,
    /// Empty, or one per vertex.
    pub(crate) colors: Vec<[f32; 3]>,
    /// Empty, or one per vertex.
    pub(crate) opacities: Vec<f32>,
    /// The vertex indices; `None` for all vertices in order.
    pub(crate) indices: Option<Vec<u32>>,
    /// Whether the indices are those of a Draco mesh: three per triangle, even where the mode says strips, which the
    /// extension allows without specifying the result.
    pub(crate) is_compressed: bool,
    /// The set of texture coordinates that its material needs tangents for.
    pub(crate) grain: Option<u32>,
}

impl Vertices {
    /// The vertex attributes that its material can use.
    pub(super) fn vertex_colors(&self) -> VertexColors {
        let colors = if self.colors.is_empty() { Colors::None } else { Colors::OfVertices };
        VertexColors { colors, opacities: self.opacities.iter().any(|&opacity| opacity != 1.0) }
    }

    /// The mean colour of some vertices, where they have colours.
    fn color<const N: usize>(&self, corners: [u32; N]) -> Option<[f32; 3]> {
        let colors = corners.iter().map(|&corner| self.colors.get(corner as usize).copied().map(Vec3::from));
        Some((colors.sum::<Option<Vec3>>()? / N as f32).to_array())
    }

    /// Keeps only the vertices of these triangles, in their order: primitives often share long accessors of which each
    /// uses a part.
    fn keep_used(&mut self, triangles: &mut [[u32; 3]]) {
        fn keep<T: Copy>(values: &mut Vec<T>, used: &[u32]) {
            if !values.is_empty() {
                *values = used.iter().map(|&vertex| values[vertex as usize]).collect();
            }
        }
        let mut place_of = vec![u32::MAX; self.positions.len()];
        triangles.iter().flatten().for_each(|&vertex| place_of[vertex as usize] = 0);
        let used: Vec<u32> =
            (0..).zip(&place_of).filter(|(_, place)| **place == 0).map(|(vertex, _)| vertex).collect();
        if used.len() == self.positions.len() {
            return;
        }
        (0..).zip(&used).for_each(|(place, &vertex)| place_of[vertex as usize] = place);
        triangles.iter_mut().flatten().for_each(|vertex| *vertex = place_of[*vertex as usize]);
        keep(&mut self.positions, &used);
        keep(&mut self.normals, &used);
        keep(&mut self.tangents, &used);
        self.uvs.iter_mut().for_each(|uvs| keep(uvs, &used));
        keep(&mut self.colors, &used);
        keep(&mut self.opacities, &used);
    }

    /// Appends a copy of a vertex, without its tangent, and returns its index.
    pub(super) fn repeat(&mut self, vertex: usize) -> u32 {
        fn again<T: Copy>(values: &mut Vec<T>, vertex: usize) {
            if let Some(&value) = values.get(vertex) {
                values.push(value);
            }
        }
        again(&mut self.positions, vertex);
        again(&mut self.normals, vertex);
        self.uvs.iter_mut().for_each(|uvs| again(uvs, vertex));
        again(&mut self.colors, vertex);
        again(&mut self.opacities, vertex);
        self.positions.len() as u32 - 1
    }
}

/// Reads the attributes and indices of a primitive at `pointer`. `None`, with a warning, if it has no positions.
/// The memory is that of the vertices.
///
/// # Errors
/// If an accessor cannot be read, or does not fit the attribute.
pub(crate) fn vertices(
    document: &Document,
    primitive: &Primitive,
    pointer: &str,
    context: &mut LoadContext<'_>,
) -> Result<Option<(Vertices, Reservation)>> {
    let place = |name: &str| format!("{pointer}/attributes/{name}");
    let find = |name: &str| primitive.attributes.get(name).copied();
    let Some(positions) = find("POSITION") else {
        let at = document.at(&format!("{pointer}/attributes"));
        context.warn(&at, "the primitive has no POSITION and is left out");
        return Ok(None);
    };
    let memory = document.budget.reserve(0, "a primitive", &document.at(pointer))?;
    let mut attributes = Attributes { document, memory };
    let positions: Vec<Vec3> = vectors(attributes.vectors(positions, &place("POSITION"))?);
    let count = positions.len();
    let mut vertices = Vertices { positions, ..Vertices::default() };
    if let Some(index) = find("NORMAL") {
        vertices.normals = vectors(attributes.vectors(index, &place("NORMAL"))?);
        check_count(document, vertices.normals.len(), count, &place("NORMAL"))?;
        vertices
            .normals
            .iter_mut()
            .filter(|normal| !normal.is_finite())
            .for_each(|normal| *normal = Vec3::ZERO);
        if let Some(index) = find("TANGENT") {
            let tangents = attributes.vectors(index, &place("TANGENT"))?;
            vertices.tangents = tangents.into_iter().map(Vec4::from_array).collect();
            check_count(document, vertices.tangents.len(), count, &place("TANGENT"))?;
            vertices
                .tangents
                .iter_mut()
                .filter(|t| !t.is_finite())
                .for_each(|t| *t = Vec4::new(0.0, 0.0, 0.0, 1.0));
        }
    }
    for set in 0..Mesh::MOST_UV_SETS {
        let name = format!("TEXCOORD_{set}");
        let uvs =
            find(&name).map(|index| coordinates(&mut attributes, index, count, &place(&name))).transpose()?;
        vertices.uvs.push(uvs.unwrap_or_default());
    }
    while vertices.uvs.last().is_some_and(Vec::is_empty) {
        vertices.uvs.pop();
    }
    if let Some(index) = find("COLOR_0") {
        colors(&mut attributes, index, count, &place("COLOR_0"), &mut vertices)?;
    }
    if let Some(index) = primitive.indices {
        vertices.indices = Some(attributes.indices(index, &format!("{pointer}/indices"))?);
    }
    if let Some(mesh) = primitive
        .extensions
        .draco
        .as_ref()
        .and_then(|draco| document.unpacked(draco.buffer_view, pointer).ok())
    {
        vertices.is_compressed = true;
        // A Draco mesh always has indices, but files may omit the accessor.
        vertices.indices.get_or_insert_with(|| mesh.indices.clone());
    }
    Ok(Some((vertices, attributes.memory)))
}

/// The bytes of the geometry that vertices become, besides their own.
pub(super) fn memory(vertices: &Vertices, primitive: &Primitive) -> u64 {
    /// Bytes of a corner: of a triangle's three there are twelve, of a point its position, colour and sphere, of a line its wire.
    const OF_SURFACE: u64 = 16;
    const OF_OTHERS: u64 = 128;
    let corners = vertices.indices.as_ref().map_or(vertices.positions.len(), Vec::len) as u64;
    corners * if is_surface(primitive) { OF_SURFACE } else { OF_OTHERS }
}

/// The accessors of a primitive, with the memory of all that was read.
struct Attributes<'a> {
    document: &'a Document,
    memory: Reservation,
}

impl Attributes<'_> {
    fn vectors<const N: usize>(&mut self, index: Whole, asked: &str) -> Result<Vec<[f32; N]>> {
        let values = self.document.vectors(index, asked)?;
        self.keep(&values, asked)?;
        Ok(values)
    }

    fn indices(&mut self, index: Whole, asked: &str) -> Result<Vec<u32>> {
        let values = self.document.whole_vectors::<1>(index, asked)?;
        self.keep(&values, asked)?;
        Ok(values.into_flattened())
    }

    fn keep<T>(&mut self, values: &[T], asked: &str) -> Result<()> {
        let (what, at) = (format!("an accessor of {} elements", values.len()), self.document.at(asked));
        self.memory.join(self.document.budget.reserve(size_of_val(values) as u64, &what, &at)?);
        Ok(())
    }
}

fn vectors(values: Vec<[f32; 3]>) -> Vec<Vec3> {
    values.into_iter().map(Vec3::from_array).collect()
}

fn check_count(document: &Document, found: usize, expected: usize, pointer: &str) -> Result<()> {
    if found == expected {
        return Ok(());
    }
    let message = format!(
        "{} for {}: there must be one for each",
        crate::plural::counted(found, "value"),
        crate::plural::counted(expected, "vertex")
    );
    Err(document.invalid(pointer, message).hint("the file was written wrongly: export it again"))
}

fn coordinates(
    attributes: &mut Attributes<'_>,
    index: Whole,
    count: usize,
    pointer: &str,
) -> Result<Vec<Vec2>> {
    let uvs = attributes.vectors::<2>(index, pointer)?;
    check_count(attributes.document, uvs.len(), count, pointer)?;
    // v runs down in glTF and up here.
    let flipped =
        |[u, v]: [f32; 2]| if u.is_finite() && v.is_finite() { Vec2::new(u, 1.0 - v) } else { Vec2::ZERO };
    Ok(uvs.into_iter().map(flipped).collect())
}

fn colors(
    attributes: &mut Attributes<'_>,
    index: Whole,
    count: usize,
    pointer: &str,
    vertices: &mut Vertices,
) -> Result<()> {
    let fit = |value: f32| if value >= 0.0 { value.min(1e30) } else { 0.0 };
    if attributes.document.shape(index, pointer)?.0 == 4 {
        let colors = attributes.vectors::<4>(index, pointer)?;
        vertices.colors = colors.iter().map(|&[r, g, b, _]| [r, g, b].map(fit)).collect();
        vertices.opacities = colors.iter().map(|&[_, _, _, a]| fit(a).min(1.0)).collect();
    } else {
        vertices.colors = attributes.vectors::<3>(index, pointer)?;
        vertices.colors.iter_mut().for_each(|color| *color = color.map(fit));
    }
    check_count(attributes.document, vertices.colors.len(), count, pointer)
}

/// The geometry of a primitive: triangles as a mesh of the scene, points as spheres, lines as curves; coloured points and lines
/// in groups, with the colour of each. Elements with invalid positions are left out with a warning.
///
/// # Errors
/// If an index is out of range, or the mode is not known.
pub(crate) fn geometry(
    document: &Document,
    primitive: &Primitive,
    mut vertices: Vertices,
    name: &str,
    pointer: &str,
    context: &mut LoadContext<'_>,
    scene: &mut Scene,
) -> Result<Vec<(Option<[f32; 3]>, Geometry)>> {
    let mode = primitive.mode.unwrap_or(Whole(4));
    let Some(topology) = Topology::of(mode) else {
        return Err(document
            .invalid(&format!("{pointer}/mode"), format!("the mode {} is not known", mode.0))
            .hint("modes are 0 (points) to 6 (fans)"));
    };
    let topology = if vertices.is_compressed { topology.listed() } else { topology };
    let count = vertices.positions.len();
    if let Some(&beyond) = vertices.indices.iter().flatten().find(|&&index| index as usize >= count) {
        let message = format!("vertex {beyond} is used, but there are only {count}");
        return Err(document
            .invalid(&format!("{pointer}/indices"), message)
            .hint("the file was written wrongly: export it again"));
    }
    let is_usable =
        |corners: &[u32]| corners.iter().all(|&corner| vertices.positions[corner as usize].is_finite());
    let order = Order { indices: vertices.indices.as_deref(), count };
    let at = document.at(pointer);

    let mut left_out = 0_usize;
    let mut usable = |corners: &[u32]| {
        let is_usable = is_usable(corners);
        left_out += usize::from(!is_usable);
        is_usable
    };
    let geometry = match topology {
        Topology::Points => {
            let mut used: Vec<u32> = (0..order.len()).map(|i| order.vertex(i)).collect();
            used.retain(|&vertex| usable(&[vertex]));
            let centers: Vec<DVec3> =
                used.iter().map(|&vertex| vertices.positions[vertex as usize].as_dvec3()).collect();
            let colors: Vec<[f32; 3]> = used.iter().filter_map(|&vertex| vertices.color([vertex])).collect();
            if centers.is_empty() { Vec::new() } else { points::spheres(&centers, &colors) }
        }
        Topology::Lines | Topology::LineLoop | Topology::LineStrip => {
            let mut ends = topology::lines(topology, &order);
            let segment = |line: &[u32; 2]| line.map(|vertex| vertices.positions[vertex as usize]);
            ends.retain(|line| usable(line) && segment(line)[0] != segment(line)[1]);
            let colors: Vec<[f32; 3]> = ends.iter().filter_map(|line| vertices.color(*line)).collect();
            let segments: Vec<[Vec3; 2]> = ends.iter().map(segment).collect();
            if segments.is_empty() { Vec::new() } else { lines::wires(&segments, &colors) }
        }
        Topology::Triangles | Topology::TriangleStrip | Topology::TriangleFan => {
            let mut triangles = topology::triangles(topology, &order);
            let corners = |triangle: &[u32; 3]| triangle.map(|vertex| vertices.positions[vertex as usize]);
            // Strips are joined by triangles without area, which no ray hits.
            triangles.retain(|triangle| usable(triangle) && has_area(corners(triangle)));
            vertices.keep_used(&mut triangles);
            if let Some(set) = vertices.grain {
                tangents::complete(&mut vertices, &mut triangles, set);
            }
            match triangles.is_empty() {
                true => Vec::new(),
                false => vec![(None, Geometry::Mesh(push_mesh(scene, name, vertices, triangles)))],
            }
        }
    };
    if left_out > 0 {
        let what = "left out: a position is infinite or not a number";
        let noun = match topology {
            Topology::Points => "point",
            Topology::Lines | Topology::LineLoop | Topology::LineStrip => "line",
            Topology::Triangles | Topology::TriangleStrip | Topology::TriangleFan => "triangle",
        };
        context.warnings.push(Warning::new(&at, what).of(left_out as u64, noun));
    }
    Ok(geometry)
}

/// Whether the mode of a primitive is one of triangles.
pub(super) fn is_surface(primitive: &Primitive) -> bool {
    primitive.mode.is_none_or(|mode| mode.0 >= 4)
}

/// The order in which vertices are used.
pub(super) struct Order<'a> {
    indices: Option<&'a [u32]>,
    count: usize,
}

impl Order<'_> {
    fn len(&self) -> usize {
        self.indices.map_or(self.count, <[u32]>::len)
    }

    fn vertex(&self, place: usize) -> u32 {
        self.indices.map_or(place as u32, |indices| indices[place])
    }
}

fn push_mesh(scene: &mut Scene, name: &str, vertices: Vertices, triangles: Vec<[u32; 3]>) -> MeshId {
    let Vertices { mut positions, normals, tangents, uvs, colors, opacities, .. } = vertices;
    forget_infinite(&mut positions);
    let mut sets = uvs.into_iter();
    let vertices = positions.len();
    // A set that is left out below others is 0 everywhere, which is what look-ups of it find.
    let whole = |set: Vec<Vec2>| if set.is_empty() { vec![Vec2::ZERO; vertices] } else { set };
    scene.meshes.push(Mesh {
        name: name.to_owned(),
        positions,
        triangles,
        normals,
        uvs: sets.next().unwrap_or_default(),
        more_uvs: sets.map(whole).collect(),
        colors,
        opacities,
        tangents,
        ..Mesh::default()
    });
    MeshId(scene.meshes.len() as u32 - 1)
}

/// Moves the vertices that are infinite or not numbers, which no triangle uses, to the origin.
fn forget_infinite(positions: &mut [Vec3]) {
    positions.iter_mut().filter(|position| !position.is_finite()).for_each(|position| *position = Vec3::ZERO);
}

/// A mesh with its positions transformed by a singular matrix, such as one that flattens it; without normals and tangents,
/// which such a matrix does not transform.
pub(super) fn flattened(mesh: &Mesh, matrix: &glam::DMat4) -> Mesh {
    let mut positions: Vec<Vec3> =
        mesh.positions.iter().map(|p| matrix.transform_point3(p.as_dvec3()).as_vec3()).collect();
    let corners = |triangle: &[u32; 3]| triangle.map(|vertex| positions[vertex as usize]);
    let triangles =
        mesh.triangles.iter().filter(|t| corners(t).iter().all(|p| p.is_finite()) && has_area(corners(t)));
    let triangles = triangles.copied().collect();
    forget_infinite(&mut positions);
    Mesh { triangles, positions, normals: Vec::new(), tangents: Vec::new(), ..mesh.clone() }
}
