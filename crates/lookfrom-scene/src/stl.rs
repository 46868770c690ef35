//! Reader for STL files.
//!
//! Triangles without shared vertices, in text or binary (3D Systems, "StereoLithography Interface Specification", 1989).
//! Vertices with equal bits are merged. The normals of facets are ignored: they are often wrong, and flat shading follows
//! from the triangles. Colours in the attribute bytes of binary files are read in both dialects: VisCAM's and, if the
//! header contains `COLOR=`, Magics'. Where no facet has a colour, that of the header counts, if it is not black.

use std::path::Path;

use glam::{DVec3, Vec3};

use crate::error::{Error, ErrorKind, Location, Result};
use crate::files::{Limits, LoadContext};
use crate::image::linear_from_srgb;
use crate::model::number::parse_f64;
use crate::model::place::{Place, placed};
use crate::model::polygon::{Triangulator, has_area};
use crate::model::scan::{Scanner, shown};
use crate::model::surface::push_vertex_colors;
use crate::model::tally::Tally;
use crate::model::text;
use crate::model::weld::Weld;
use crate::scene::{MeshId, Scene};
use crate::shape::{Geometry, Mesh, Part};

/// Bytes before the triangles of a binary file: 80 bytes of free text, then their number.
const HEADER: usize = 84;
/// Bytes per triangle: normal, three vertices, attributes.
const TRIANGLE: usize = 50;
/// Placeholder for a facet without a colour of its own.
const NO_COLOR: u32 = u32::MAX;

/// Reads the content of an STL file: one part per solid.
/// Messages name `path`.
///
/// # Errors
/// `Limit` and `Syntax`; at line and column, or at a byte in binary files.
pub fn from_bytes(
    bytes: &[u8],
    path: &Path,
    context: &mut LoadContext<'_>,
    scene: &mut Scene,
) -> Result<Vec<Part>> {
    let file = Location::file(path);
    let mut triangles = Triangles::new(&context.limits);
    let (solids, place) = if is_text(bytes) {
        let facets = read_text(&text::utf8(bytes), &file, triangles.limit, context)?;
        facets.solids(&mut triangles)
    } else {
        let (mesh, place) = read_binary(bytes, &file, &mut triangles, context)?;
        (vec![(None, mesh)], place)
    };
    triangles.not_finite.warn(
        "triangle",
        "left out: a coordinate is infinite or not a number",
        &file,
        context,
    );
    let flat = triangles.flat.count();
    triangles.flat.notice("triangle", "left out: without area", &file, context);
    let (mut parts, first) = (Vec::new(), scene.meshes.len());
    for (name, mut mesh) in solids {
        if mesh.triangles.is_empty() {
            continue;
        }
        mesh.name = file.file.to_string();
        let material = (!mesh.colors.is_empty()).then(|| push_vertex_colors(scene, &file));
        let geometry = Geometry::Mesh(MeshId(scene.meshes.len() as u32));
        parts.push(Part { material, ..Part::new(name, geometry) });
        scene.meshes.push(mesh);
    }
    if parts.is_empty() {
        context.warn(&file, "there are no triangles");
    }
    place.put(&mut parts, &scene.meshes[first..], flat, &file, context);
    Ok(parts)
}

/// Whether a content is that of an STL file: text that begins as one, or of the length of a binary one.
pub(crate) fn is_stl(bytes: &[u8]) -> bool {
    is_binary_by_length(bytes) || is_text(bytes)
}

/// Whether the length matches a binary file with the number of triangles in its header.
fn is_binary_by_length(bytes: &[u8]) -> bool {
    claimed_triangles(bytes)
        .is_some_and(|count| HEADER as u64 + TRIANGLE as u64 * count == bytes.len() as u64)
}

/// Whether the file has the text format. Headers of binary files may start with `solid`, too; but the numbers
/// behind them have zeros among their bytes, which no text has.
fn is_text(bytes: &[u8]) -> bool {
    let text = text::utf8(&bytes[..bytes.len().min(1 << 12)]).to_ascii_lowercase();
    let is_word = |word: &[u8]| text.windows(word.len()).any(|window| window == word);
    !is_binary_by_length(bytes)
        && !text.contains(&0)
        && text.trim_ascii_start().starts_with(b"solid")
        && (is_word(b"facet") || is_word(b"endsolid"))
}

fn claimed_triangles(bytes: &[u8]) -> Option<u64> {
    let count = bytes.get(HEADER - 4..HEADER)?;
    Some(u64::from(u32::from_le_bytes([count[0], count[1], count[2], count[3]])))
}

/// Collects the triangles of one solid at a time.
struct Triangles {
    /// Vertices by the bits of their coordinates, and the colour.
    weld: Weld<4>,
    triangles: Vec<[u32; 3]>,
    limit: usize,
    not_finite: Tally,
    flat: Tally,
}

impl Triangles {
    fn new(limits: &Limits) -> Self {
        Self {
            weld: Weld::new(),
            triangles: Vec::new(),
            limit: limits.elements.min(u64::from(u32::MAX) / 4) as usize,
            not_finite: Tally::default(),
            flat: Tally::default(),
        }
    }

    fn push(&mut self, points: [Vec3; 3], color: u32, line: u32) {
        if !points.iter().all(|point| point.is_finite()) {
            self.not_finite.add(line);
        } else if !has_area(points) {
            self.flat.add(line);
        } else {
            self.triangles.push(points.map(|point| {
                // Adding 0 makes −0 and 0 equal.
                let [x, y, z] = point.to_array().map(|value| (value + 0.0).to_bits());
                self.weld.id([x, y, z, color])
            }));
        }
    }

    fn take_mesh(&mut self) -> Mesh {
        let weld = std::mem::replace(&mut self.weld, Weld::new());
        let keys = weld.keys();
        let mut mesh = Mesh { triangles: std::mem::take(&mut self.triangles), ..Mesh::default() };
        mesh.positions = keys
            .iter()
            .map(|key| Vec3::new(f32::from_bits(key[0]), f32::from_bits(key[1]), f32::from_bits(key[2])))
            .collect();
        if keys.iter().any(|key| key[3] != NO_COLOR) {
            mesh.colors = keys.iter().map(|key| linear_color(key[3])).collect();
        }
        mesh
    }
}

/// Linear colour of 5 bits each of red (highest), green and blue, sRGB-encoded.
fn linear_color(color: u32) -> [f32; 3] {
    if color == NO_COLOR {
        return [0.8; 3];
    }
    [color >> 10 & 31, color >> 5 & 31, color & 31].map(|part| linear_from_srgb(part as f32 / 31.0))
}

fn read_binary(
    bytes: &[u8],
    file: &Location,
    triangles: &mut Triangles,
    context: &mut LoadContext<'_>,
) -> Result<(Mesh, Place)> {
    let Some(claimed) = claimed_triangles(bytes) else {
        let message = format!("{} too few for an STL file", crate::plural::are(bytes.len() as u64, "byte"));
        return Err(Error::syntax(file, message).hint("the file may be empty or cut off"));
    };
    let body = &bytes[HEADER..];
    let there = (body.len() / TRIANGLE) as u64;
    let is_whole = body.len().is_multiple_of(TRIANGLE);
    let count = match claimed {
        _ if claimed == there => claimed,
        // Some programs write the header before they know the number.
        0 | 0xffff_ffff if is_whole && there > 0 => {
            context.notice(
                file,
                format!("the header does not tell the number of triangles; all {there} are read"),
            );
            there
        }
        _ if is_whole && there > 0 => {
            let message = format!("{claimed} triangles are declared, but there are {there}; all are read");
            context.warn(file, message);
            there
        }
        _ if claimed > there => {
            let message = format!(
                "{} declared, but there are only bytes for {there}",
                crate::plural::are(claimed, "triangle")
            );
            return Err(
                Error::syntax(file, message).hint("the file may be cut off, or it may not be an STL file")
            );
        }
        _ => claimed,
    };
    if count as usize > triangles.limit {
        let message = format!("{count} triangles are more than the limit of {}", triangles.limit);
        return Err(Error::new(ErrorKind::Limit, file, message).hint("split the model into several files"));
    }
    let used = TRIANGLE * count as usize;
    let rest = body.len() - used;
    if rest > 0 {
        let message = format!(
            "{} after the last triangle {} ignored",
            crate::plural::counted(rest as u64, "byte"),
            crate::plural::be(rest as u64)
        );
        // The rest may contain triangles; less than one is padding.
        if rest >= TRIANGLE { context.warn(file, message) } else { context.notice(file, message) }
    }
    let header = &bytes[..HEADER - 4];
    let magics = header.windows(6).position(|window| window == b"COLOR=");
    let default_color = magics.and_then(|at| header.get(at + 6..at + 9)).map_or(NO_COLOR, |rgb| {
        u32::from(rgb[0] >> 3) << 10 | u32::from(rgb[1] >> 3) << 5 | u32::from(rgb[2] >> 3)
    });
    let attributes = |facet: &[u8]| u16::from_le_bytes([facet[48], facet[49]]);
    let facets = || body[..used].chunks_exact(TRIANGLE);
    // Writers that know no colours leave all attributes 0, or set the bit of validity alone: none is meant to be black.
    let first = facets().next().map_or(0, attributes);
    let has_colors = first & 0x7fff != 0 || facets().any(|facet| attributes(facet) != first);
    let default_color = if default_color == 0 && !has_colors { NO_COLOR } else { default_color };
    let number =
        |facet: &[u8], i: usize| f32::from_le_bytes([facet[i], facet[i + 1], facet[i + 2], facet[i + 3]]);
    let point = |facet: &[u8], i: usize| [i, i + 4, i + 8].map(|i| f64::from(number(facet, i)));
    let corners = |facet| [12, 24, 36].map(|i| DVec3::from(point(facet, i)));
    let (positions, place) = placed(&facets().flat_map(corners).collect::<Vec<_>>(), true);
    for (facet, points) in facets().zip(positions.as_chunks().0) {
        let bits = u32::from(attributes(facet));
        let color = match (magics.is_some(), bits >> 15 == 1) {
            _ if !has_colors => default_color,
            (true, true) => default_color,
            (true, false) => (bits & 31) << 10 | (bits & 0x3e0) | bits >> 10,
            (false, true) => bits & 0x7fff,
            (false, false) => NO_COLOR,
        };
        triangles.push(*points, color, 0);
    }
    Ok((triangles.take_mesh(), place))
}

type Solid = (Option<String>, Mesh);

/// The triangles of a text.
#[derive(Default)]
struct Facets {
    /// Three for each triangle.
    corners: Vec<DVec3>,
    /// Their lines.
    lines: Vec<u32>,
    /// The names of the solids, and the number of triangles up to their ends.
    ends: Vec<(Option<String>, usize)>,
}

impl Facets {
    fn end_solid(&mut self, name: Option<String>) {
        self.ends.push((name, self.lines.len()));
    }

    /// The meshes of the solids, and where they are.
    fn solids(self, triangles: &mut Triangles) -> (Vec<Solid>, Place) {
        let (positions, place) = placed(&self.corners, false);
        let mut facets = positions.as_chunks().0.iter().zip(self.lines);
        let mut done = 0;
        let mut mesh = |end: usize| {
            for (points, line) in facets.by_ref().take(end - done) {
                triangles.push(*points, NO_COLOR, line);
            }
            done = end;
            triangles.take_mesh()
        };
        (self.ends.into_iter().map(|(name, end)| (name, mesh(end))).collect(), place)
    }
}

fn read_text(text: &[u8], file: &Location, limit: usize, context: &mut LoadContext<'_>) -> Result<Facets> {
    let mut scanner = Scanner::new(text);
    let mut triangulator = Triangulator::new();
    let mut facets = Facets::default();
    let mut name = None;
    let (mut points, mut cut) = (Vec::new(), Vec::new());
    let mut is_open = false;
    let mut is_in_facet = false;
    loop {
        let word = scanner.word_across_lines();
        let mut keyword = word.to_ascii_lowercase();
        // Some programs write `end loop`, `end facet` and `end solid`.
        if keyword == b"end" {
            keyword.extend(scanner.word().to_ascii_lowercase());
        }
        match keyword.as_slice() {
            b"" => break,
            b"solid" => {
                if is_open {
                    facets.end_solid(name.take());
                }
                let rest = scanner.rest_of_line();
                name = (!rest.is_empty()).then(|| String::from_utf8_lossy(rest).into_owned());
                is_open = true;
            }
            // The rest of the line is the normal.
            b"facet" => {
                scanner.rest_of_line();
                is_in_facet = true;
            }
            b"outer" => {
                scanner.rest_of_line();
                points.clear();
            }
            b"vertex" => points.push(vertex(&mut scanner, file)?),
            b"endloop" => {
                if points.len() < 3 {
                    let message = format!(
                        "a facet with {}, expected 3",
                        crate::plural::counted(points.len(), "vertex")
                    );
                    return Err(Error::syntax(&scanner.at(file), message));
                }
                let line = scanner.line();
                cut.clear();
                if points.iter().all(|point: &DVec3| point.is_finite()) {
                    let local: Vec<Vec3> =
                        points.iter().map(|&point| (point - points[0]).as_vec3()).collect();
                    triangulator.cut(&local, &mut cut);
                } else {
                    cut.push([0, 1, 2]);
                }
                for triangle in &cut {
                    facets.corners.extend(triangle.map(|i| points[i as usize]));
                    facets.lines.push(line);
                }
                points.clear();
                if facets.lines.len() > limit {
                    let message = format!("more than {limit} triangles");
                    let error = Error::new(ErrorKind::Limit, &scanner.at(file), message);
                    return Err(error.hint("split the model into several files"));
                }
            }
            b"endfacet" => is_in_facet = false,
            b"endsolid" => {
                scanner.rest_of_line();
                facets.end_solid(name.take());
                is_open = false;
            }
            b"color" | b"material" => drop(scanner.rest_of_line()),
            _ => {
                let message = format!("expected `facet`, `vertex` or `endsolid`, found `{}`", shown(word));
                return Err(Error::syntax(&scanner.at(file), message));
            }
        }
    }
    if is_in_facet || !points.is_empty() {
        return Err(Error::syntax(&file.at(scanner.line(), 0), "the file ends within a facet")
            .hint("the file may be cut off"));
    }
    if is_open {
        context.warn(&file.at(scanner.line(), 0), "`endsolid` is missing: the file may be cut off");
        facets.end_solid(name.take());
    }
    Ok(facets)
}

fn vertex(scanner: &mut Scanner<'_>, file: &Location) -> Result<DVec3> {
    let mut point = [0.0; 3];
    for value in &mut point {
        let word = scanner.word_across_lines();
        *value = parse_f64(word).ok_or_else(|| {
            let found =
                if word.is_empty() { "the end of the file".to_owned() } else { format!("`{}`", shown(word)) };
            Error::syntax(&scanner.at(file), format!("expected a coordinate, found {found}"))
        })?;
    }
    Ok(DVec3::from_array(point))
}
