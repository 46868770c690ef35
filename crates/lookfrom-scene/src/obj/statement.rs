//! Parser for the statements of OBJ files.
//!
//! One pass over the text (Wavefront, "Object Files (.obj)", Advanced Visualizer manual, appendix B1). Triangles and
//! normals are left to [`super::build`], materials to [`super::mtl`].

use std::collections::HashMap;
use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3};

use super::color::Colors;
use super::look::MOST_LIBRARIES;
use crate::error::{Error, ErrorKind, Location, Result};
use crate::files::LoadContext;
use crate::model::number::{parse_f32, parse_f64};
use crate::model::place::{Place, placed};
use crate::model::scan::{Scanner, shown};
use crate::model::tally::Tally;

/// Placeholder for an index that a corner does not have.
pub(super) const NONE: u32 = u32::MAX;

/// A corner of a face: indices, from 0, of its position, texture coordinates and normal.
#[derive(Clone, Copy)]
pub(super) struct Corner {
    pub(super) position: u32,
    pub(super) uv: u32,
    pub(super) normal: u32,
}

/// A polygon.
pub(super) struct Face {
    /// The number of its corners: ≥ 3.
    pub(super) corners: u32,
    pub(super) line: u32,
    /// The smoothing group; 0 is flat.
    pub(super) smoothing: u32,
    /// The index of its object's name, or [`NONE`].
    pub(super) object: u32,
}

/// The faces of one material.
#[derive(Default)]
pub(super) struct Group {
    /// The name in `usemtl`, in bytes.
    pub(super) material: Option<Vec<u8>>,
    /// The name of the object in which it was used first.
    pub(super) object: Option<Arc<str>>,
    pub(super) faces: Vec<Face>,
    /// The corners of all faces, one face after the other.
    pub(super) corners: Vec<Corner>,
    /// The positions of the ends of lines.
    pub(super) lines: Vec<[u32; 2]>,
}

/// All statements of a file that are supported.
#[derive(Default)]
pub(super) struct Statements {
    pub(super) positions: Vec<Vec3>,
    /// The place of the positions in the world.
    pub(super) place: Place,
    /// Linear colours of positions; may be shorter than `positions`: the rest is white.
    pub(super) colors: Vec<[f32; 3]>,
    pub(super) uvs: Vec<Vec2>,
    pub(super) normals: Vec<Vec3>,
    pub(super) groups: Vec<Group>,
    /// The names of objects.
    pub(super) objects: Vec<Arc<str>>,
    /// The locations and names of the libraries of `mtllib`.
    pub(super) libraries: Vec<(Location, Vec<u8>)>,
}

/// The largest index of a kind, and where it is: indices may precede the elements that they refer to.
struct Largest<'a> {
    count: usize,
    at: Scanner<'a>,
}

struct Parser<'a> {
    file: &'a Location,
    scanner: Scanner<'a>,
    elements: usize,
    statements: Statements,
    /// The positions as in the file.
    positions: Vec<DVec3>,
    /// The colours as in the file.
    colors: Colors,
    group_of_material: HashMap<Option<Vec<u8>>, usize>,
    group: usize,
    index_of_object: HashMap<Arc<str>, u32>,
    /// The indices of the last names in `o` and in `g`, or [`NONE`].
    named: [u32; 2],
    smoothing: u32,
    largest: [Largest<'a>; 3],
    /// The first index of a position that does not exist.
    first_broken: Option<Error>,
    /// Faces and lines with such indices.
    broken: Tally,
    loose: Tally,
    thin: Tally,
    curves: Tally,
    calls: Tally,
    unknown: Tally,
    unknown_name: String,
    /// Indices of texture coordinates or normals in a file without any.
    missing: [Tally; 3],
    /// Indices of texture coordinates or normals out of range.
    outside: [Tally; 3],
}

/// Parses the statements of a file.
///
/// # Errors
/// `Syntax` for malformed numbers, `Invalid` for indices out of range where nothing else is left, `Limit` for too many elements.
pub(super) fn parse(text: &[u8], file: &Location, context: &mut LoadContext<'_>) -> Result<Statements> {
    let largest = || Largest { count: 0, at: Scanner::joining_lines(text) };
    let mut parser = Parser {
        file,
        scanner: Scanner::joining_lines(text),
        // Indices must also fit in 32 bits.
        elements: context.limits.elements.min(u64::from(u32::MAX) / 4) as usize,
        statements: Statements::default(),
        positions: Vec::new(),
        colors: Colors::default(),
        group_of_material: HashMap::new(),
        group: 0,
        index_of_object: HashMap::new(),
        named: [NONE; 2],
        smoothing: 0,
        largest: [largest(), largest(), largest()],
        first_broken: None,
        broken: Tally::default(),
        loose: Tally::default(),
        thin: Tally::default(),
        curves: Tally::default(),
        calls: Tally::default(),
        unknown: Tally::default(),
        unknown_name: String::new(),
        missing: [Tally::default(); 3],
        outside: [Tally::default(); 3],
    };
    parser.use_material(None);
    loop {
        parser.line()?;
        if !parser.scanner.next_line() {
            break;
        }
    }
    (parser.statements.positions, parser.statements.place) = placed(&parser.positions, false);
    parser.positions = Vec::new();
    parser.statements.colors = std::mem::take(&mut parser.colors).linear(file, context);
    parser.drop_missing();
    parser.drop_outside();
    parser.leave_out_broken()?;
    parser.warn(context);
    Ok(parser.statements)
}

impl Parser<'_> {
    fn line(&mut self) -> Result<()> {
        let keyword = self.scanner.word();
        match keyword {
            b"" => {}
            b"v" => self.position()?,
            b"vn" => {
                let ([x, y, z], _) = self.numbers(3, parse_f32)?;
                self.statements.normals.push(Vec3::new(x, y, z));
            }
            b"vt" => {
                let ([u, v], _) = self.numbers(1, parse_f32)?;
                self.statements.uvs.push(Vec2::new(u, v));
            }
            b"f" | b"fo" => self.face()?,
            b"s" => {
                let word = self.scanner.word();
                self.smoothing = match std::str::from_utf8(word).ok().and_then(|word| word.parse().ok()) {
                    Some(group) => group,
                    None => u32::from(word == b"on"),
                };
            }
            b"usemtl" => {
                let name = self.scanner.rest_of_line();
                self.use_material((!name.is_empty()).then_some(name));
            }
            b"o" => self.named[0] = self.name(),
            b"g" => self.named[1] = self.name(),
            b"mtllib" => {
                let name = self.scanner.rest_of_line();
                let at = self.scanner.at(self.file);
                let libraries = &mut self.statements.libraries;
                // One more than are read, to tell that there are more.
                if libraries.len() <= MOST_LIBRARIES && !libraries.iter().any(|(_, other)| other == name) {
                    libraries.push((at, name.to_vec()));
                }
            }
            b"l" => self.polyline()?,
            b"p" => self.loose.add(self.scanner.line()),
            b"curv" | b"curv2" | b"surf" => self.curves.add(self.scanner.line()),
            b"call" | b"csh" => self.calls.add(self.scanner.line()),
            // Attributes of curves and surfaces, and display attributes.
            b"vp" | b"cstype" | b"deg" | b"bmat" | b"step" | b"parm" | b"trim" | b"hole" | b"scrv"
            | b"sp" | b"end" | b"con" | b"mg" | b"bevel" | b"c_interp" | b"d_interp" | b"lod"
            | b"shadow_obj" | b"trace_obj" | b"ctech" | b"stech" | b"usemap" | b"maplib" => {}
            b"#MRGB" => self.polypaint(),
            [b'#', ..] => {}
            other => {
                if self.unknown.count() == 0 {
                    self.unknown_name = shown(other);
                }
                self.unknown.add(self.scanner.line());
            }
        }
        let statements = &self.statements;
        let elements = self.positions.len().max(statements.uvs.len()).max(statements.normals.len());
        if elements > self.elements {
            return Err(self.too_many("vertices"));
        }
        Ok(())
    }

    /// The index of the object that the rest of the line names.
    fn name(&mut self) -> u32 {
        let name = self.scanner.rest_of_line();
        if name.is_empty() {
            return NONE;
        }
        let objects = &mut self.statements.objects;
        let name: Arc<str> = String::from_utf8_lossy(name).into();
        *self.index_of_object.entry(name).or_insert_with_key(|name| {
            objects.push(name.clone());
            objects.len() as u32 - 1
        })
    }

    /// The index of the object that faces belong to: that of `o`; before the first, that of `g`.
    fn object(&self) -> u32 {
        let [object, group] = self.named;
        if object == NONE { group } else { object }
    }

    fn position(&mut self) -> Result<()> {
        let (values, count) = self.numbers::<f64, 7>(3, parse_f64)?;
        let [x, y, z, ..] = values;
        self.colors.add(self.positions.len(), &values[3..count]);
        self.positions.push(DVec3::new(x, y, z));
        Ok(())
    }

    /// `#MRGB` and colours of the next vertices, as ZBrush writes them: for each a mask, red, green and blue in hexadecimal.
    fn polypaint(&mut self) {
        for color in self.scanner.rest_of_line().chunks_exact(8) {
            let color =
                std::str::from_utf8(color).ok().and_then(|digits| u32::from_str_radix(digits, 16).ok());
            let Some(color) = color.filter(|_| self.colors.count() < self.positions.len()) else { return };
            let [_, rgb @ ..] = color.to_be_bytes();
            self.colors.add(self.colors.count(), &rgb.map(|channel| f64::from(channel) / 255.0));
        }
    }

    /// Up to N numbers, at least `least`; more than N are ignored.
    fn numbers<T: Copy + Default, const N: usize>(
        &mut self,
        least: usize,
        parse: fn(&[u8]) -> Option<T>,
    ) -> Result<([T; N], usize)> {
        let mut values = [T::default(); N];
        let mut count = 0;
        while count < N {
            let word = self.scanner.word();
            if word.is_empty() || word[0] == b'#' {
                break;
            }
            values[count] = parse(word).ok_or_else(|| {
                let found = shown(word);
                Error::syntax(&self.scanner.at(self.file), format!("expected a number, found `{found}`"))
            })?;
            count += 1;
        }
        if count < least {
            let message = format!("expected {}, found {count}", crate::plural::counted(least, "number"));
            return Err(Error::syntax(&self.scanner.at(self.file), message));
        }
        Ok((values, count))
    }

    fn face(&mut self) -> Result<()> {
        let group = &self.statements.groups[self.group];
        let start = group.corners.len();
        loop {
            let word = self.scanner.word();
            if word.is_empty() || word[0] == b'#' {
                break;
            }
            let corner = self.corner(word)?;
            self.statements.groups[self.group].corners.push(corner);
        }
        let (line, object) = (self.scanner.line(), self.object());
        let group = &mut self.statements.groups[self.group];
        let corners = group.corners.len() - start;
        let is_broken = group.corners[start..].iter().any(|corner| corner.position == NONE);
        if corners < 3 || is_broken {
            group.corners.truncate(start);
            if is_broken { &mut self.broken } else { &mut self.thin }.add(line);
            return Ok(());
        }
        group.faces.push(Face { corners: corners as u32, line, smoothing: self.smoothing, object });
        if group.corners.len() > self.elements { Err(self.too_many("corners of faces")) } else { Ok(()) }
    }

    /// `l v v …` or `l v/vt v/vt …`: a line through these positions.
    fn polyline(&mut self) -> Result<()> {
        let mut previous = None;
        loop {
            let word = self.scanner.word();
            if word.is_empty() || word[0] == b'#' {
                break;
            }
            let end = self.corner(word)?.position;
            if end == NONE {
                self.broken.add(self.scanner.line());
                previous = None;
                continue;
            }
            let lines = &mut self.statements.groups[self.group].lines;
            lines.extend(previous.map(|previous| [previous, end]));
            previous = Some(end);
        }
        let lines = self.statements.groups[self.group].lines.len();
        if lines > self.elements { Err(self.too_many("lines")) } else { Ok(()) }
    }

    /// `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    fn corner(&mut self, word: &[u8]) -> Result<Corner> {
        let counts = [self.positions.len(), self.statements.uvs.len(), self.statements.normals.len()];
        let mut indices = [NONE; 3];
        let mut rest = word;
        for kind in 0..3 {
            let length = rest.iter().position(|&byte| byte == b'/').unwrap_or(rest.len());
            let (number, tail) = rest.split_at(length);
            if !number.is_empty() || kind == 0 {
                indices[kind] = self.index(number, word, kind, counts[kind])?;
            }
            match tail {
                [b'/', tail @ ..] if kind < 2 => rest = tail,
                [] => break,
                _ => return Err(self.bad_corner(word)),
            }
        }
        Ok(Corner { position: indices[0], uv: indices[1], normal: indices[2] })
    }

    fn index(&mut self, number: &[u8], word: &[u8], kind: usize, count: usize) -> Result<u32> {
        let (back, digits) = match number {
            [b'-', digits @ ..] => (true, digits),
            [b'+', digits @ ..] => (false, digits),
            digits => (false, digits),
        };
        if digits.is_empty() || digits.len() > 18 || !digits.iter().all(u8::is_ascii_digit) {
            return Err(self.bad_corner(word));
        }
        let value = digits.iter().fold(0_usize, |value, digit| 10 * value + usize::from(digit - b'0'));
        if back && count == 0 && kind > 0 {
            self.missing[kind].add(self.scanner.line());
            return Ok(NONE);
        }
        if value == 0 || (back && value > count) {
            if kind > 0 {
                self.outside[kind].add(self.scanner.line());
            } else if self.first_broken.is_none() {
                self.first_broken = Some(self.out_of_range(&self.scanner, &shown(number), count));
            }
            return Ok(NONE);
        }
        if back {
            return Ok((count - value) as u32);
        }
        // The element may follow later: checked at the end.
        if value > count && value > self.largest[kind].count {
            self.largest[kind] = Largest { count: value, at: self.scanner.clone() };
        }
        Ok((value - 1).min(NONE as usize - 1) as u32)
    }

    fn bad_corner(&self, word: &[u8]) -> Error {
        let message = format!("expected a corner as `1`, `1/2`, `1//3` or `1/2/3`, found `{}`", shown(word));
        Error::syntax(&self.scanner.at(self.file), message)
    }

    fn out_of_range(&self, at: &Scanner<'_>, written: &str, count: usize) -> Error {
        let message = format!("index {written} is out of range: there are {count} vertices (v)");
        Error::invalid(&at.at(self.file), message)
            .hint("indices count from 1; negative ones count back from the last")
    }

    fn too_many(&self, what: &str) -> Error {
        let message = format!("more than {} {what}", self.elements);
        Error::new(ErrorKind::Limit, &self.file.at(self.scanner.line(), 0), message)
            .hint("split the model into several files")
    }

    fn use_material(&mut self, name: Option<&[u8]>) {
        let object = self.statements.objects.get(self.object() as usize).cloned();
        let groups = &mut self.statements.groups;
        self.group = *self.group_of_material.entry(name.map(<[u8]>::to_vec)).or_insert_with(|| {
            let material = name.map(<[u8]>::to_vec);
            groups.push(Group { material, object, ..Group::default() });
            groups.len() - 1
        });
    }

    /// Corners lose texture coordinates or normals that the file has none of: exporters write their indices all the same.
    fn drop_missing(&mut self) {
        let counts = [self.statements.uvs.len(), self.statements.normals.len()];
        for (kind, count) in (1..).zip(counts) {
            let largest = &mut self.largest[kind];
            if count > 0 || largest.count == 0 {
                continue;
            }
            largest.count = 0;
            self.missing[kind].add(largest.at.line());
            for corner in self.statements.groups.iter_mut().flat_map(|group| &mut group.corners) {
                *(if kind == 1 { &mut corner.uv } else { &mut corner.normal }) = NONE;
            }
        }
    }

    /// Corners lose indices of texture coordinates and normals that are larger than their number.
    fn drop_outside(&mut self) {
        let counts = [self.statements.uvs.len(), self.statements.normals.len()];
        for (kind, count) in (1..).zip(counts) {
            let Largest { count: largest, at } = &self.largest[kind];
            if *largest <= count {
                continue;
            }
            for corner in self.statements.groups.iter_mut().flat_map(|group| &mut group.corners) {
                let index = if kind == 1 { &mut corner.uv } else { &mut corner.normal };
                if *index != NONE && *index as usize >= count {
                    *index = NONE;
                    self.outside[kind].add(at.line());
                }
            }
        }
    }

    /// Leaves out faces and lines with positions that do not exist.
    fn leave_out_broken(&mut self) -> Result<()> {
        let count = self.statements.positions.len();
        if self.largest[0].count > count {
            let Largest { count: written, at } = &self.largest[0];
            let error = self.out_of_range(at, &written.to_string(), count);
            self.first_broken.get_or_insert(error);
            let exists = |position: u32| (position as usize) < count;
            for group in &mut self.statements.groups {
                let mut start = 0;
                let mut corners = Vec::with_capacity(group.corners.len());
                group.faces.retain(|face| {
                    let own = &group.corners[start..start + face.corners as usize];
                    start += own.len();
                    let is_whole = own.iter().all(|corner| exists(corner.position));
                    if is_whole {
                        corners.extend_from_slice(own);
                    } else {
                        self.broken.add(face.line);
                    }
                    is_whole
                });
                group.corners = corners;
                let lines = group.lines.len();
                group.lines.retain(|ends| ends.iter().all(|&end| exists(end)));
                self.broken.add_many((lines - group.lines.len()) as u64, 0);
            }
        }
        let is_empty =
            self.statements.groups.iter().all(|group| group.faces.is_empty() && group.lines.is_empty());
        self.first_broken.take().filter(|_| is_empty).map_or(Ok(()), Err)
    }

    fn warn(&self, context: &mut LoadContext<'_>) {
        let file = self.file;
        if self.statements.groups.iter().any(|group| !group.faces.is_empty() || !group.lines.is_empty()) {
            self.loose.warn("point element", "left out: only faces and lines are drawn", file, context);
        }
        self.thin.notice("face", "left out: fewer than three corners", file, context);
        let kinds = [(1, "texture coordinates (vt)"), (2, "normals (vn)")];
        for (kind, name) in kinds.into_iter().filter(|(kind, _)| self.missing[*kind].count() > 0) {
            let at = file.at(self.missing[kind].first_line(), 0);
            context.warn(&at, format!("faces name {name}, but the file has none: they are ignored"));
        }
        for (kind, name) in [(1, "texture coordinate"), (2, "normal")] {
            self.outside[kind].warn(name, "of corners ignored: an index is out of range", file, context);
        }
        self.broken.warn("element", "left out: an index of a vertex (v) is out of range", file, context);
        self.curves.warn("curve or surface", "left out: free-form geometry is not supported", file, context);
        self.calls.warn(
            "`call` or `csh` statement",
            "ignored: no other files or programs are run",
            file,
            context,
        );
        let what = format!("with an unknown keyword ignored, such as `{}`", self.unknown_name);
        self.unknown.warn("line", &what, file, context);
    }
}
