//! Parser for the elements of PLY files.
//!
//! Vertices, faces and edges; other elements and properties are skipped. Headers are not trusted: declared sizes are compared
//! with the remaining bytes before memory is allocated.

use glam::{DVec3, Vec2, Vec3};

use super::edges::Edges;
use super::header::{Element, Format, Header, PropertyKind, Scalar};
use super::values::Reader;
use crate::error::{Error, ErrorKind, Location, Result};
use crate::files::{Limits, LoadContext};
use crate::image::linear_from_srgb;
use crate::model::colors::{Range, range};
use crate::model::place::{Place, placed};
use crate::model::scan::shown;
use crate::model::tally::Tally;
use crate::plural::{are, counted};

/// The supported content of a file.
#[derive(Default)]
pub(super) struct Content {
    /// Not necessarily finite.
    pub(super) positions: Vec<Vec3>,
    /// The place of the positions in the world.
    pub(super) place: Place,
    /// Empty, or one per vertex.
    pub(super) normals: Vec<Vec3>,
    /// Empty, or one per vertex.
    pub(super) uvs: Vec<Vec2>,
    /// Empty, or one per vertex; linear.
    pub(super) colors: Vec<[f32; 3]>,
    pub(super) faces: Vec<Face>,
    /// The vertices of all faces, one face after the other; each index is below the number of vertices.
    pub(super) corners: Vec<u32>,
    /// Empty, or the texture coordinates of each corner.
    pub(super) corner_uvs: Vec<Vec2>,
    /// Empty, or one per face; linear.
    pub(super) face_colors: Vec<[f32; 3]>,
    /// Empty, or the number of each face's texture among those that the header names, from 0.
    pub(super) face_textures: Vec<u32>,
    pub(super) edges: Edges,
    /// Rows of a text with more values than the header declares.
    pub(super) longer: Tally,
    /// The number of faces with fewer than three corners, and the line of the first.
    pub(super) thin: (u64, u32),
}

/// A polygon.
pub(super) struct Face {
    pub(super) corners: u32,
    /// 0 in binary formats.
    pub(super) line: u32,
}

/// The first property of the colours of Gaussian splats: coefficients of the constant spherical harmonic.
pub(super) const SPLAT_COLOR: &str = "f_dc_0";
/// That harmonic, ½ / √π.
const CONSTANT_HARMONIC: f64 = 0.282_094_791_773_878_1;

/// Names of vertex properties, in the order of the values in `read_vertices`.
pub(super) const VERTEX: [&[&str]; 11] = [
    &["x"],
    &["y"],
    &["z"],
    &["nx", "normal_x"],
    &["ny", "normal_y"],
    &["nz", "normal_z"],
    &["s", "u", "texture_u", "texture_s", "s0", "u0"],
    &["t", "v", "texture_v", "texture_t", "t0", "v0"],
    COLORS[0],
    COLORS[1],
    COLORS[2],
];

/// Names of the channels of colours.
pub(super) const COLORS: [&[&str]; 3] = [
    &["red", "r", "diffuse_red", SPLAT_COLOR],
    &["green", "g", "diffuse_green", "f_dc_1"],
    &["blue", "b", "diffuse_blue", "f_dc_2"],
];

/// Parses the values after the header.
///
/// # Errors
/// `Syntax` for missing or malformed values, `Invalid` for indices out of range, `Limit`.
pub(super) fn read(bytes: &[u8], header: &Header, file: &Location, limits: &Limits) -> Result<Content> {
    let mut content = Content::default();
    let vertices = header.elements.iter().find(|element| element.name == "vertex").map_or(0, |e| e.count);
    let mut reader = Reader::new(bytes, header, file);
    for element in &header.elements {
        let least = element.least_row(header.format);
        // The last value of a text needs no space after it.
        let there = reader.left() as u64 + u64::from(header.format == Format::Ascii);
        if element.count.checked_mul(least).is_none_or(|bytes| bytes > there) {
            return Err(too_short(element, least, there));
        }
        if element.count > limits.elements.min(u64::from(u32::MAX) / 4) && least > 0 {
            let message = format!(
                "{} rows of `{}` are more than the limit",
                element.count,
                shown(element.name.as_bytes())
            );
            return Err(
                Error::new(ErrorKind::Limit, &element.at, message).hint("split the model into several files")
            );
        }
        match element.name.as_str() {
            "vertex" => read_vertices(element, header.is_gray, &mut reader, &mut content)?,
            "face" | "tristrips" | "tristrip" => {
                read_faces(element, header.is_gray, vertices, limits, &mut reader, &mut content)?;
            }
            "edge" if element.find(&["vertex1"]).is_some() => {
                content.edges = Edges::read(element, &mut reader)?;
            }
            _ => skip(element, least, &mut reader)?,
        }
    }
    content.longer = reader.longer;
    Ok(content)
}

fn too_short(element: &Element, least: u64, there: u64) -> Error {
    let Element { name, count, at, .. } = element;
    let message = format!(
        "{} of `{}` {} declared, of at least {} each, but only {} left",
        counted(*count, "row"),
        shown(name.as_bytes()),
        crate::plural::be(*count),
        counted(least, "byte"),
        are(there, "byte")
    );
    Error::syntax(at, message).hint("the file may be cut off, or its header may be wrong")
}

fn read_vertices(
    element: &Element,
    is_gray: bool,
    reader: &mut Reader<'_>,
    content: &mut Content,
) -> Result<()> {
    let columns = VERTEX.map(|names| {
        element.find(names).filter(|&index| matches!(element.properties[index].kind, PropertyKind::One(_)))
    });
    for axis in 0..3 {
        if columns[axis].is_none() {
            let message = format!("element `vertex` has no property `{}`", VERTEX[axis][0]);
            return Err(Error::syntax(&element.at, message));
        }
    }
    let has = |range: std::ops::Range<usize>| range.into_iter().all(|slot| columns[slot].is_some());
    let count = element.count as usize;
    let mut positions = Vec::with_capacity(count);
    let is_single = |slot: usize| {
        columns[slot].is_some_and(|column| element.properties[column].kind == PropertyKind::One(Scalar::F32))
    };
    let is_single = reader.is_binary() && (0..3).all(is_single);
    let (normals, uvs, colors) = (has(3..6), has(6..8), has(8..if is_gray { 9 } else { 11 }));
    let mut slots = vec![VERTEX.len(); element.properties.len()];
    for (slot, column) in columns.into_iter().enumerate() {
        if let Some(column) = column {
            slots[column] = slot;
        }
    }
    let red = columns[8].map(|column| &element.properties[column]);
    let decode_plain = color_decoder(red.map(|red| red.kind));
    let is_splat = red.is_some_and(|red| red.name == SPLAT_COLOR);
    let decode = |value: f64| match is_splat && value.is_finite() {
        true => linear_from_srgb((0.5 + CONSTANT_HARMONIC * value).clamp(0.0, 1.0) as f32),
        false => decode_plain(value),
    };
    for _ in 0..count {
        // One slot more than there are names, for properties that are skipped.
        let mut row = [0.0_f64; VERTEX.len() + 1];
        for (property, &slot) in element.properties.iter().zip(&slots) {
            match property.kind {
                PropertyKind::One(scalar) if slot < 3 => row[slot] = reader.exact_value(scalar)?,
                PropertyKind::One(scalar) => row[slot] = reader.value(scalar)?,
                PropertyKind::List { count, item } => reader.list(count, item, |_| {})?,
            }
        }
        let [_, _, _, nx, ny, nz, s, t, ..] = row.map(|value| value as f32);
        positions.push(DVec3::new(row[0], row[1], row[2]));
        if normals {
            content.normals.push(Vec3::new(nx, ny, nz));
        }
        if uvs {
            content.uvs.push(Vec2::new(s, t));
        }
        if colors {
            let channel = |channel: usize| decode(row[if is_gray { 8 } else { 8 + channel }]);
            content.colors.push(std::array::from_fn(channel));
        }
        reader.end_row();
    }
    (content.positions, content.place) = placed(&positions, is_single);
    Ok(())
}

/// The conversion of a colour to linear light: integers are sRGB-encoded, floating-point values are linear if they reach from
/// 0 to 1, see [`Content::settle_colors`].
pub(super) fn color_decoder(kind: Option<PropertyKind>) -> impl Fn(f64) -> f32 {
    let bytes: Vec<f32> = (0..=255).map(|byte| linear_from_srgb(byte as f32 / 255.0)).collect();
    let full = match kind {
        Some(PropertyKind::One(Scalar::F32 | Scalar::F64)) | None => 0.0,
        Some(PropertyKind::One(Scalar::U16 | Scalar::I16)) => 65535.0,
        Some(_) => 255.0,
    };
    move |value| match full {
        _ if !value.is_finite() => 1.0,
        0.0 => value.max(0.0) as f32,
        255.0 => bytes[value.clamp(0.0, 255.0) as usize],
        full => linear_from_srgb((value.clamp(0.0, full) / full) as f32),
    }
}

fn read_faces(
    element: &Element,
    is_gray: bool,
    vertices: u64,
    limits: &Limits,
    reader: &mut Reader<'_>,
    content: &mut Content,
) -> Result<()> {
    let is_list = |index: &usize| matches!(element.properties[*index].kind, PropertyKind::List { .. });
    let strips = element.name != "face";
    let Some(indices) = element.find(&["vertex_indices", "vertex_index"]).filter(is_list) else {
        if element.count == 0 {
            return Ok(());
        }
        let message = format!("element `{}` has no list property `vertex_indices`", element.name);
        return Err(Error::syntax(&element.at, message));
    };
    let texcoords = element.find(&["texcoord"]).filter(is_list);
    let is_one = |index: &usize| matches!(element.properties[*index].kind, PropertyKind::One(_));
    let columns = [8, 9, 10].map(|slot| element.find(VERTEX[slot]).filter(is_one));
    let has_colors = columns[..if is_gray { 1 } else { 3 }].iter().all(Option::is_some);
    let decode = color_decoder(columns[0].map(|column| element.properties[column].kind));
    let texture_number = element.find(&["texnumber"]).filter(is_one);
    let (mut face, mut uvs) = (Vec::new(), Vec::new());
    for _ in 0..element.count {
        let mut line = 0;
        let mut place = 0;
        uvs.clear();
        let mut color = [0.0; 3];
        let mut texture = 0;
        for (index, property) in element.properties.iter().enumerate() {
            match property.kind {
                PropertyKind::One(scalar) => {
                    let value = reader.value(scalar)?;
                    if let Some(channel) = columns.iter().position(|column| *column == Some(index)) {
                        color[channel] = decode(value);
                    } else if texture_number == Some(index) {
                        texture = if value >= 0.0 { value as u32 } else { u32::MAX };
                    }
                }
                PropertyKind::List { count, item } if index == indices => {
                    face.clear();
                    place = reader.position();
                    reader.list(count, item, |value| face.push(value))?;
                    line = reader.line();
                }
                PropertyKind::List { count, item } if Some(index) == texcoords => {
                    reader.list(count, item, |value| uvs.push(value as f32))?;
                }
                PropertyKind::List { count, item } => reader.list(count, item, |_| {})?,
            }
        }
        for value in &face {
            let is_restart = strips && *value == -1.0;
            if !is_restart && (value.fract() != 0.0 || *value < 0.0 || *value >= vertices as f64) {
                let message = format!(
                    "vertex index {value} is out of range: {}",
                    crate::plural::there_are(vertices, "vertex")
                );
                return Err(reader.error_at(line, place, ErrorKind::Invalid, message));
            }
        }
        reader.end_row();
        if strips {
            content.push_strips(&face, line);
        } else {
            content.push_face(&face, &uvs, line);
        }
        if has_colors {
            let color = if is_gray { [color[0]; 3] } else { color };
            content.face_colors.resize(content.faces.len(), color);
        }
        if texture_number.is_some() {
            content.face_textures.resize(content.faces.len(), texture);
        }
        if content.corners.len() as u64 > limits.elements.min(u64::from(u32::MAX) / 4) {
            return Err(Error::new(
                ErrorKind::Limit,
                &element.at,
                "more corners of faces than the limit allows",
            )
            .hint("split the model into several files"));
        }
    }
    Ok(())
}

impl Content {
    /// Decodes floating-point colours that reach from 0 to 255, which are sRGB-encoded as bytes are.
    pub(super) fn settle_colors(&mut self, file: &Location, context: &mut LoadContext<'_>) {
        let Self { colors, face_colors, edges, .. } = self;
        let all = || colors.iter().chain(&*face_colors).chain(edges.colors());
        if range(all().flatten().copied(), "they are taken as they are", file, context) == Range::Bytes {
            for color in colors.iter_mut().chain(face_colors).chain(edges.colors_mut()) {
                *color = color.map(|value| linear_from_srgb(value / 255.0));
            }
        }
    }

    fn push_face(&mut self, face: &[f64], uvs: &[f32], line: u32) {
        if face.len() < 3 {
            let first = if self.thin.0 == 0 { line } else { self.thin.1 };
            self.thin = (self.thin.0 + 1, first);
            return;
        }
        let corners = self.corners.len();
        self.faces.push(Face { corners: face.len() as u32, line });
        self.corners.extend(face.iter().map(|&index| index as u32));
        if uvs.len() == 2 * face.len() {
            self.corner_uvs.resize(corners, Vec2::ZERO);
            self.corner_uvs.extend(uvs.chunks_exact(2).map(|uv| Vec2::new(uv[0], uv[1])));
        } else if !self.corner_uvs.is_empty() {
            self.corner_uvs.resize(self.corners.len(), Vec2::ZERO);
        }
    }

    /// Adds the triangles of strips; −1 ends a strip. Every second triangle of a strip is reversed.
    fn push_strips(&mut self, indices: &[f64], line: u32) {
        for strip in indices.split(|&index| index == -1.0) {
            for (i, triangle) in strip.windows(3).enumerate() {
                let [a, b, c] = [triangle[0], triangle[1], triangle[2]];
                // Strips are joined by degenerate triangles, which name a vertex twice.
                if a != b && b != c && c != a {
                    self.push_face(&if i % 2 == 0 { [a, b, c] } else { [b, a, c] }, &[], line);
                }
            }
        }
    }
}

fn skip(element: &Element, least: u64, reader: &mut Reader<'_>) -> Result<()> {
    let fixed = element.properties.iter().all(|property| matches!(property.kind, PropertyKind::One(_)));
    if least == 0 || (fixed && reader.skip_bytes(element.count * least)) {
        return Ok(());
    }
    for _ in 0..element.count {
        for property in &element.properties {
            match property.kind {
                PropertyKind::One(scalar) => drop(reader.value(scalar)?),
                PropertyKind::List { count, item } => reader.list(count, item, |_| {})?,
            }
        }
        reader.end_row();
    }
    Ok(())
}
