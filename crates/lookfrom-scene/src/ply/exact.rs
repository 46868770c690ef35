//! Meshes of PLY files of our own, by the comment in their headers: as they were, bit by bit.
//!
//! Nothing is rounded, welded, moved or left out, and floating-point colours are linear whatever their size. Properties beyond the usual ones
//! are further texture coordinates (`s1`, `t1` …), opacity, tangents (`tx` … `tw`), and the vertices of a mesh that changes its form at
//! later times (`x_1` … `nz_1`, `x_2` …).

use glam::{Vec2, Vec3, Vec4};

use super::header::{Element, Format, Header, PropertyKind, Scalar};
use crate::error::{Error, ErrorKind, Location, Result};
use crate::files::LoadContext;
use crate::model::surface::push_vertex_colors;
use crate::scene::{MeshId, Scene};
use crate::shape::{Geometry, Mesh, MeshPose, Part};

/// Bytes of a triangle: the number of its corners, and these.
const TRIANGLE: usize = 13;

/// The most sets of texture coordinates, and the most later times.
const MOST: usize = 256;

/// The attributes of the vertices of a file, in its order.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Columns {
    normals: bool,
    uvs: bool,
    more_uvs: usize,
    colors: bool,
    opacities: bool,
    tangents: bool,
    later: usize,
}

impl Columns {
    /// The attributes of a mesh.
    pub(super) fn of(mesh: &Mesh) -> Self {
        Self {
            normals: !mesh.normals.is_empty(),
            uvs: !mesh.uvs.is_empty(),
            more_uvs: mesh.more_uvs.len(),
            colors: !mesh.colors.is_empty(),
            opacities: !mesh.opacities.is_empty(),
            tangents: !mesh.tangents.is_empty(),
            later: mesh.later.len(),
        }
    }

    /// The columns that properties with these names are; `None` if there are other names among them.
    fn of_names(names: &[&str]) -> Option<Self> {
        let has = |name: &str| names.contains(&name);
        let count = |first: usize, name: &dyn Fn(usize) -> String| {
            (first..first + MOST).take_while(|index| has(&name(*index))).count()
        };
        let columns = Self {
            normals: has("nx"),
            uvs: has("s"),
            more_uvs: count(1, &|set| format!("s{set}")),
            colors: has("red"),
            opacities: has("opacity"),
            tangents: has("tx"),
            later: count(1, &|time| format!("x_{time}")),
        };
        columns.names().iter().eq(names).then_some(columns)
    }

    /// The names of the properties.
    pub(super) fn names(&self) -> Vec<String> {
        let place = |time: &str| ["x", "y", "z"].map(|axis| format!("{axis}{time}"));
        let normal = |time: &str| ["nx", "ny", "nz"].map(|axis| format!("{axis}{time}"));
        let plain = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
        let mut names = place("").to_vec();
        if self.normals {
            names.extend(normal(""));
        }
        if self.uvs {
            names.extend(plain(&["s", "t"]));
        }
        for set in 1..=self.more_uvs {
            names.extend([format!("s{set}"), format!("t{set}")]);
        }
        if self.colors {
            names.extend(plain(&["red", "green", "blue"]));
        }
        if self.opacities {
            names.extend(plain(&["opacity"]));
        }
        if self.tangents {
            names.extend(plain(&["tx", "ty", "tz", "tw"]));
        }
        for time in 1..=self.later {
            let time = format!("_{time}");
            names.extend(place(&time));
            if self.normals {
                names.extend(normal(&time));
            }
        }
        names
    }
}

/// Reads the content after the header.
///
/// # Errors
/// `Syntax` for elements other than those that are written, and for bytes that are missing; `Invalid` for numbers that are not finite and
/// corners that there are not; `Limit`.
pub(super) fn read(
    bytes: &[u8],
    header: &Header,
    is_of_solid: bool,
    file: &Location,
    context: &mut LoadContext<'_>,
    scene: &mut Scene,
) -> Result<Vec<Part>> {
    let unlike = || {
        Error::syntax(
            file,
            "a comment says that this mesh was written by lookfrom, but its header is another",
        )
        .hint("take the comment out of a file that another program has changed")
    };
    let [vertices, faces] = &header.elements[..] else { return Err(unlike()) };
    let names: Vec<&str> = vertices.properties.iter().map(|property| property.name.as_str()).collect();
    let are_floats =
        vertices.properties.iter().all(|property| property.kind == PropertyKind::One(Scalar::F32));
    let is_list = |element: &Element| {
        let [list] = &element.properties[..] else { return false };
        list.kind == PropertyKind::List { count: Scalar::U8, item: Scalar::U32 }
    };
    let columns = Columns::of_names(&names).filter(|_| {
        header.format == Format::LittleEndian
            && (&*vertices.name, &*faces.name) == ("vertex", "face")
            && are_floats
            && is_list(faces)
    });
    let columns = columns.ok_or_else(unlike)?;
    let most = context.limits.elements.min(u32::MAX.into());
    if vertices.count.max(faces.count) > most {
        let message =
            format!("{} elements are more than the limit of {most}", vertices.count.max(faces.count));
        return Err(Error::new(ErrorKind::Limit, file, message));
    }
    let (rows, corners) = bytes
        .split_at_checked((vertices.count * names.len() as u64 * 4) as usize)
        .filter(|(_, corners)| corners.len() as u64 >= faces.count * TRIANGLE as u64)
        .ok_or_else(|| {
            Error::syntax(file, "the file ends before all its values").hint("the file may be cut off")
        })?;
    context.keep((rows.len() + corners.len()) as u64, "the mesh", file)?;
    if !floats(rows).all(f32::is_finite) {
        return Err(Error::invalid(file, "a number of a vertex is infinite or not a number"));
    }
    let mut mesh = of_rows(rows, names.len(), &columns);
    mesh.triangles = triangles(corners, faces.count as usize, vertices.count, file)?;
    (mesh.name, mesh.is_of_solid) = (file.file.to_string(), is_of_solid);
    let material = (!mesh.colors.is_empty()).then(|| push_vertex_colors(scene, file));
    let geometry = Geometry::Mesh(MeshId(scene.meshes.len() as u32));
    scene.meshes.push(mesh);
    Ok(vec![Part { material, ..Part::new(None, geometry) }])
}

/// The numbers of bytes.
fn floats(bytes: &[u8]) -> impl Iterator<Item = f32> {
    bytes.as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes))
}

/// The vertices of rows of numbers.
fn of_rows(rows: &[u8], width: usize, columns: &Columns) -> Mesh {
    let mut mesh = Mesh {
        more_uvs: vec![Vec::new(); columns.more_uvs],
        later: vec![MeshPose::default(); columns.later],
        ..Mesh::default()
    };
    for row in rows.chunks_exact(4 * width) {
        let mut numbers = floats(row);
        let mut next = || numbers.next().unwrap_or_default();
        mesh.positions.push(Vec3::new(next(), next(), next()));
        if columns.normals {
            mesh.normals.push(Vec3::new(next(), next(), next()));
        }
        if columns.uvs {
            mesh.uvs.push(Vec2::new(next(), next()));
        }
        mesh.more_uvs.iter_mut().for_each(|uvs| uvs.push(Vec2::new(next(), next())));
        if columns.colors {
            mesh.colors.push([next(), next(), next()]);
        }
        if columns.opacities {
            mesh.opacities.push(next());
        }
        if columns.tangents {
            mesh.tangents.push(Vec4::new(next(), next(), next(), next()));
        }
        for pose in &mut mesh.later {
            pose.positions.push(Vec3::new(next(), next(), next()));
            if columns.normals {
                pose.normals.push(Vec3::new(next(), next(), next()));
            }
        }
    }
    mesh
}

fn triangles(bytes: &[u8], count: usize, vertices: u64, file: &Location) -> Result<Vec<[u32; 3]>> {
    let corner = |face: &[u8; TRIANGLE], index: usize| {
        u32::from_le_bytes([1, 2, 3, 4].map(|byte| face[4 * index + byte]))
    };
    let of = |face: &[u8; TRIANGLE]| {
        let triangle = [0, 1, 2].map(|index| corner(face, index));
        if face[0] != 3 {
            return Err(Error::syntax(file, format!("a face of {} corners; expected triangles", face[0])));
        }
        match triangle.iter().find(|vertex| u64::from(**vertex) >= vertices) {
            None => Ok(triangle),
            Some(vertex) => Err(Error::invalid(
                file,
                format!(
                    "vertex index {vertex} is out of range: {}",
                    crate::plural::there_are(vertices, "vertex")
                ),
            )),
        }
    };
    bytes.as_chunks::<TRIANGLE>().0.iter().take(count).map(of).collect()
}
