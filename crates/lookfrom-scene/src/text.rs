//! Text as solids: the outlines of a font's glyphs, filled and drawn out.
//!
//! Glyphs stand side by side by their advances and the font's kerning (table `kern`), in the order of the characters: scripts whose letters
//! join or change places need a program that shapes text. Curves become straight pieces, within a thousandth of the em.
//! Contours that overlap, as in variable fonts, are one shape (non-zero winding).

use std::collections::BTreeMap;

use glam::{DVec2, DVec3, Vec2};
use lyon_tessellation::math::{Point, point};
use lyon_tessellation::path::Path;
use lyon_tessellation::{BuffersBuilder, FillOptions, FillRule, FillTessellator, FillVertex, VertexBuffers};
use ttf_parser::{Face, GlyphId, OutlineBuilder};

use crate::shape::Mesh;

/// Units of the em in which glyphs are filled.
const EM: f64 = 1024.0;

/// The greatest distance of a straight piece from its curve, in these units.
const TOLERANCE: f64 = 1.0;

/// The most straight pieces of a curve.
const MOST_PIECES: f64 = 64.0;

/// Cosine of the greatest angle between neighbouring sides of a solid that are smooth: 35°.
const SMOOTH: f64 = 0.82;

/// The layout of a text.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TextLayout {
    /// The em.
    pub(crate) size: f64,
    /// Depth of the solid; 0 is a sheet.
    pub(crate) depth: f64,
    pub(crate) align: Align,
    /// Distance of lines over that of the font.
    pub(crate) line_spacing: f64,
}

/// The point of a line that is at x = 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Align {
    Left,
    Center,
    Right,
}

/// Text as a mesh.
pub(crate) struct Solid {
    pub(crate) mesh: Mesh,
    /// Characters that the font lacks, each once; their place is left empty.
    pub(crate) missing: Vec<char>,
}

/// The solid of a text: its baseline is on the x axis, that of further lines below, and its front faces +z, at `depth`. `None` if the
/// bytes are no font.
pub(crate) fn solid(font: &[u8], text: &str, layout: TextLayout) -> Option<Solid> {
    let face = Face::parse(font, 0).ok()?;
    let to_em = 1.0 / f64::from(face.units_per_em());
    let line_height = f64::from(face.height()) + f64::from(face.line_gap());
    let mut solid = Solid { mesh: Mesh { name: "text".to_owned(), ..Mesh::default() }, missing: Vec::new() };
    let mut glyphs: BTreeMap<GlyphId, Flat> = BTreeMap::new();
    for (number, line) in text.lines().enumerate() {
        let (placed, width) = line_of(&face, line, &mut solid.missing);
        let start = match layout.align {
            Align::Left => 0.0,
            Align::Center => -0.5 * width,
            Align::Right => -width,
        };
        let y = -(number as f64) * line_height * layout.line_spacing;
        for (glyph, x) in placed {
            let flat = glyphs.entry(glyph).or_insert_with(|| Flat::of(&face, glyph));
            let origin = DVec2::new(start + x, y) * (to_em * layout.size);
            flat.draw_out(origin, layout, &mut solid.mesh);
        }
    }
    Some(solid)
}

/// The glyphs of a line with their places, in the font's units, and the width of the line.
fn line_of(face: &Face<'_>, line: &str, missing: &mut Vec<char>) -> (Vec<(GlyphId, f64)>, f64) {
    let (mut placed, mut x) = (Vec::new(), 0.0);
    let mut before = None;
    for character in line.chars().filter(|character| !character.is_control()) {
        let glyph = face.glyph_index(character);
        if glyph.is_none() && !missing.contains(&character) {
            missing.push(character);
        }
        let shown = glyph.unwrap_or(GlyphId(0));
        if let (Some(left), Some(right)) = (before, glyph) {
            x += kerning(face, left, right);
        }
        placed.extend(glyph.map(|glyph| (glyph, x)));
        x += f64::from(face.glyph_hor_advance(shown).unwrap_or(0));
        before = glyph;
    }
    (placed, x)
}

fn kerning(face: &Face<'_>, left: GlyphId, right: GlyphId) -> f64 {
    let Some(table) = face.tables().kern else { return 0.0 };
    let subtables = table.subtables.into_iter().filter(|table| table.horizontal && !table.variable);
    subtables.filter_map(|table| table.glyphs_kerning(left, right)).map(f64::from).sum()
}

/// A filled glyph: triangles in the plane, counter-clockwise, whose em is 1.
struct Flat {
    points: Vec<DVec2>,
    triangles: Vec<[u32; 3]>,
    /// The sides of its border, with what is filled at their left, and the normals at both ends.
    border: Vec<([u32; 2], [DVec2; 2])>,
}

impl Flat {
    fn of(face: &Face<'_>, glyph: GlyphId) -> Self {
        let scale = EM / f64::from(face.units_per_em());
        let mut pen = Pen { scale, builder: Path::builder(), at: DVec2::ZERO, is_open: false };
        let _ = face.outline_glyph(glyph, &mut pen);
        pen.close();
        let path = pen.builder.build();
        let mut filled: VertexBuffers<Point, u32> = VertexBuffers::new();
        let options = FillOptions::default().with_fill_rule(FillRule::NonZero).with_tolerance(0.01);
        let mut buffers = BuffersBuilder::new(&mut filled, |vertex: FillVertex<'_>| vertex.position());
        if FillTessellator::new().tessellate_path(&path, &options, &mut buffers).is_err() {
            // Only of coordinates that are not finite, which fonts do not have.
            filled = VertexBuffers::new();
        }
        let points: Vec<DVec2> =
            filled.vertices.iter().map(|p| DVec2::new(p.x.into(), p.y.into()) / EM).collect();
        let area = |[a, b, c]: [u32; 3]| {
            let [a, b, c] = [a, b, c].map(|vertex| points[vertex as usize]);
            (b - a).perp_dot(c - a)
        };
        let triangles: Vec<[u32; 3]> = filled
            .indices
            .chunks_exact(3)
            .map(|t| if area([t[0], t[1], t[2]]) < 0.0 { [t[0], t[2], t[1]] } else { [t[0], t[1], t[2]] })
            .filter(|&triangle| area(triangle) > 0.0)
            .collect();
        let border = border(&points, &triangles);
        Self { points, triangles, border }
    }

    /// Adds the glyph's solid at a place of its origin.
    fn draw_out(&self, origin: DVec2, layout: TextLayout, mesh: &mut Mesh) {
        let TextLayout { size, depth, .. } = layout;
        let push = |mesh: &mut Mesh, point: DVec2, z: f64, normal: DVec3| {
            let at = point * size + origin;
            mesh.positions.push(at.extend(z).as_vec3());
            mesh.normals.push(normal.as_vec3());
            mesh.uvs.push(Vec2::new((at.x / size) as f32, (at.y / size) as f32));
            mesh.positions.len() as u32 - 1
        };
        for (z, normal, is_front) in [(depth, DVec3::Z, true), (0.0, DVec3::NEG_Z, false)] {
            if !is_front && depth == 0.0 {
                return;
            }
            let first = mesh.positions.len() as u32;
            for &point in &self.points {
                push(mesh, point, z, normal);
            }
            mesh.triangles.extend(self.triangles.iter().map(|&[a, b, c]| {
                let [a, b, c] = [a + first, b + first, c + first];
                if is_front { [a, b, c] } else { [a, c, b] }
            }));
        }
        for &([a, b], [of_a, of_b]) in &self.border {
            let [from, to] = [a, b].map(|vertex| self.points[vertex as usize]);
            let corner = |mesh: &mut Mesh, point, z, normal: DVec2| push(mesh, point, z, normal.extend(0.0));
            let [p, q] = [corner(mesh, from, 0.0, of_a), corner(mesh, to, 0.0, of_b)];
            let [r, s] = [corner(mesh, to, depth, of_b), corner(mesh, from, depth, of_a)];
            mesh.triangles.extend([[p, q, r], [p, r, s]]);
        }
    }
}

/// The sides of triangles that no other one has in the opposite direction, with their normals: smooth along curves.
fn border(points: &[DVec2], triangles: &[[u32; 3]]) -> Vec<([u32; 2], [DVec2; 2])> {
    let sides = || triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let all: std::collections::BTreeSet<[u32; 2]> = sides().collect();
    let open: Vec<[u32; 2]> = all.iter().copied().filter(|&[a, b]| !all.contains(&[b, a])).collect();
    let normal = |[a, b]: [u32; 2]| {
        let way = points[b as usize] - points[a as usize];
        DVec2::new(way.y, -way.x).normalize_or_zero()
    };
    // The side that begins and the one that ends at each vertex; `None` where there are several.
    let mut meeting: BTreeMap<u32, [Option<DVec2>; 2]> = BTreeMap::new();
    let mut counts: BTreeMap<u32, u32> = BTreeMap::new();
    for &side in &open {
        for (end, vertex) in side.into_iter().enumerate() {
            meeting.entry(vertex).or_default()[end] = Some(normal(side));
            *counts.entry(vertex).or_default() += 1;
        }
    }
    let at = |side: [u32; 2], end: usize| {
        let own = normal(side);
        let other = meeting.get(&side[end]).and_then(|both| both[1 - end]);
        match other.filter(|other| counts[&side[end]] == 2 && own.dot(*other) >= SMOOTH) {
            Some(other) => (own + other).normalize_or_zero(),
            None => own,
        }
    };
    open.iter().map(|&side| (side, [at(side, 0), at(side, 1)])).collect()
}

/// Turns the curves of an outline into straight pieces.
struct Pen {
    scale: f64,
    builder: lyon_tessellation::path::path::Builder,
    at: DVec2,
    is_open: bool,
}

impl Pen {
    fn scaled(&self, x: f32, y: f32) -> DVec2 {
        DVec2::new(x.into(), y.into()) * self.scale
    }

    fn line(&mut self, to: DVec2) {
        if self.is_open && to != self.at {
            self.builder.line_to(point(to.x as f32, to.y as f32));
            self.at = to;
        }
    }

    /// Straight pieces of a Bézier curve of which the greatest second difference is given, times degree (degree − 1) / 8
    /// (Wang 1984).
    fn curve(&mut self, bend: f64, at: impl Fn(f64) -> DVec2) {
        let pieces = (bend / TOLERANCE).sqrt().ceil().clamp(1.0, MOST_PIECES);
        for k in 1..=pieces as u32 {
            self.line(at(f64::from(k) / pieces));
        }
    }
}

impl OutlineBuilder for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        self.close();
        self.at = self.scaled(x, y);
        self.builder.begin(point(self.at.x as f32, self.at.y as f32));
        self.is_open = true;
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.line(self.scaled(x, y));
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let [a, b, c] = [self.at, self.scaled(x1, y1), self.scaled(x, y)];
        self.curve((a - b * 2.0 + c).length() * 0.25, |t| a.lerp(b, t).lerp(b.lerp(c, t), t));
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let [a, b, c, d] = [self.at, self.scaled(x1, y1), self.scaled(x2, y2), self.scaled(x, y)];
        let bend = (a - b * 2.0 + c).length().max((b - c * 2.0 + d).length()) * 0.75;
        self.curve(bend, |t| {
            let [ab, bc, cd] = [a.lerp(b, t), b.lerp(c, t), c.lerp(d, t)];
            ab.lerp(bc, t).lerp(bc.lerp(cd, t), t)
        });
    }

    fn close(&mut self) {
        if std::mem::take(&mut self.is_open) {
            self.builder.end(true);
        }
    }
}
