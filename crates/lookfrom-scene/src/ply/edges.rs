//! Edges of PLY files, as wires.

use glam::Vec3;

use super::body::{VERTEX, color_decoder};
use super::header::{Element, PropertyKind};
use super::values::Reader;
use crate::error::{Location, Result};
use crate::files::LoadContext;
use crate::material::{Color, Whitted};
use crate::model::lines;
use crate::model::surface::push_material;
use crate::model::tally::Tally;
use crate::scene::Scene;
use crate::shape::Part;

/// The edges of a file.
#[derive(Default)]
pub(super) struct Edges {
    /// The two vertices of each, as in the file: not necessarily indices of any.
    vertices: Vec<[f64; 2]>,
    /// Empty, or one per edge; linear.
    colors: Vec<[f32; 3]>,
}

impl Edges {
    /// Parses the rows of an element with the properties `vertex1` and `vertex2`, without which there are no edges.
    pub(super) fn read(element: &Element, reader: &mut Reader<'_>) -> Result<Self> {
        let is_one = |index: &usize| matches!(element.properties[*index].kind, PropertyKind::One(_));
        let column = |names: &[&str]| element.find(names).filter(is_one);
        let ends = [column(&["vertex1"]), column(&["vertex2"])];
        let channels = [8, 9, 10].map(|slot| column(VERTEX[slot]));
        let (has_ends, has_colors) = (ends.iter().all(Option::is_some), channels.iter().all(Option::is_some));
        let decode = color_decoder(channels[0].map(|column| element.properties[column].kind));
        let mut edges = Self::default();
        for _ in 0..element.count {
            let (mut vertices, mut color) = ([0.0; 2], [0.0; 3]);
            for (index, property) in element.properties.iter().enumerate() {
                let scalar = match property.kind {
                    PropertyKind::One(scalar) => scalar,
                    PropertyKind::List { count, item } => {
                        reader.list(count, item, |_| {})?;
                        continue;
                    }
                };
                let value = reader.value(scalar)?;
                if let Some(end) = ends.iter().position(|column| *column == Some(index)) {
                    vertices[end] = value;
                } else if let Some(channel) = channels.iter().position(|column| *column == Some(index)) {
                    color[channel] = decode(value);
                }
            }
            reader.end_row();
            if has_ends {
                edges.vertices.push(vertices);
                edges.colors.extend(has_colors.then_some(color));
            }
        }
        Ok(edges)
    }

    pub(super) fn colors(&self) -> &[[f32; 3]] {
        &self.colors
    }

    pub(super) fn colors_mut(&mut self) -> &mut [[f32; 3]] {
        &mut self.colors
    }

    pub(super) fn is_empty(&self) -> bool {
        self.vertices.is_empty()
    }

    /// Wires along the edges between vertices at these positions. Edges without colours have the mean of their vertices',
    /// if these have any.
    pub(super) fn wires(
        &self,
        positions: &[Vec3],
        vertex_colors: &[[f32; 3]],
        file: &Location,
        context: &mut LoadContext<'_>,
        scene: &mut Scene,
    ) -> Vec<Part> {
        let (mut ends, mut colors) = (Vec::new(), Vec::new());
        let (mut stray, mut not_finite) = (Tally::default(), Tally::default());
        for (number, vertices) in self.vertices.iter().enumerate() {
            let is_index =
                |&index: &f64| index >= 0.0 && index.fract() == 0.0 && index < positions.len() as f64;
            if !vertices.iter().all(is_index) {
                stray.add(0);
                continue;
            }
            let vertices = vertices.map(|index| index as usize);
            let [a, b] = vertices.map(|index| positions[index]);
            if !a.is_finite() || !b.is_finite() {
                not_finite.add(0);
            } else if a != b {
                ends.push([a, b]);
                let of_vertices = || {
                    let [a, b] = vertices.map(|index| vertex_colors.get(index).copied().map(Vec3::from));
                    Some(a?.midpoint(b?).to_array())
                };
                colors.extend(self.colors.get(number).copied().or_else(of_vertices));
            }
        }
        stray.warn("edge", "left out: there is no vertex of this index", file, context);
        not_finite.warn("edge", "left out: a coordinate is infinite or not a number", file, context);
        if ends.is_empty() {
            return Vec::new();
        }
        let part = |(color, wires): (Option<[f32; 3]>, _)| {
            let material = color.map(|color| {
                let whitted = Whitted { diffuse: Color::Value(color), ..Whitted::default() };
                push_material(scene, "edges", file, whitted)
            });
            Part { material, ..Part::new(None, wires) }
        };
        lines::wires(&ends, &colors).into_iter().map(part).collect()
    }
}
