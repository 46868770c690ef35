//! Many elements of one shape, in lists or as arrays of NumPy: spheres, bilinear patches over shared vertices, separate curves.

use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3};

use super::Reader;
use super::curve::PROFILES;
use super::mesh::{finite, too_many};
use super::shape::point;
use super::table::Table;
use super::value::{Value, unit};
use crate::error::{Error, Result};
use crate::shape::{Geometry, Patches, Profile, Sphere, Strand};

impl Reader<'_, '_> {
    /// `[[spheres]]`: centres, and a radius for all or one for each.
    pub(super) fn spheres(&mut self, table: &Table<'_>) -> Result<Geometry> {
        let centers = table.need("centers", "[[0, 0, 0], [1, 0, 0]]", Vec::new(), |value| {
            Ok(match self.array(value)? {
                Some(rows) => rows.into_iter().map(DVec3::from_array).collect(),
                None => {
                    value.list("a list of points, [x, y, z]")?.map(Value::vector).collect::<Result<_>>()?
                }
            })
        });
        let count = centers.len();
        let radii = table.need("radii", "0.1", Vec::new(), |value| {
            if value.is_number() {
                return Ok(vec![value.positive()?; count]);
            }
            let expected = format!("a number greater than 0, or a list of {count}");
            let radii: Vec<f64> = match self.array::<1>(value)? {
                Some(rows) => rows.into_iter().map(|[radius]| radius).collect(),
                None => value.list(&expected)?.map(Value::positive).collect::<Result<_>>()?,
            };
            let are_radii = radii.len() == count && radii.iter().all(|radius| *radius > 0.0);
            if are_radii { Ok(radii) } else { Err(value.wrong(&expected)) }
        });
        table.sound(&["centers", "radii"])?;
        self.check_count(table, count)?;
        let spheres = centers.into_iter().zip(radii).map(|(center, radius)| Sphere { center, radius });
        Ok(Geometry::Spheres(spheres.collect()))
    }

    /// `[[patch]]` with `positions`: many bilinear patches over shared vertices.
    pub(super) fn patches(&mut self, table: &Table<'_>) -> Result<Geometry> {
        table.one_of(&["positions", "corners"]);
        let positions: Vec<Vec3> =
            table.need("positions", "[[0, 0, 0]]", Vec::new(), |value| match self.array(value)? {
                Some(rows) => rows.iter().map(|row| finite(value, *row).map(Vec3::from_array)).collect(),
                None => value.list("a list of points, [x, y, z]")?.map(point).collect(),
            });
        let count = positions.len();
        let patches = table.need("patches", "[[0, 1, 2, 3]]", Vec::new(), |value| {
            let vertices = |row: [f64; 4]| {
                let is_vertex = |number: f64| number >= 0.0 && number < count as f64 && number.fract() == 0.0;
                match row.into_iter().all(is_vertex) {
                    true => Ok(row.map(|number| number as u32)),
                    false => Err(value
                        .error(format!("a patch has a vertex that `positions` has not: it has {count}"))
                        .hint("vertices count from 0")),
                }
            };
            match self.array::<4>(value)? {
                Some(rows) => rows.into_iter().map(vertices).collect(),
                None => value
                    .list("a list of patches, [i, j, k, l]")?
                    .map(|item| vertices(item.numbers("four vertices, [i, j, k, l]")?))
                    .collect(),
            }
        });
        let normals = self.for_vertices(table, "normals", count, point, Vec3::from_array);
        let pair = |item: Value<'_>| item.singles("two numbers, [u, v]").map(Vec2::from_array);
        let uvs = self.for_vertices(table, "uvs", count, pair, Vec2::from_array);
        table.sound(&["positions", "patches", "normals", "uvs"])?;
        self.check_count(table, count.max(patches.len()))?;
        Ok(Geometry::Bilinear(Arc::new(Patches { positions, patches, normals, uvs })))
    }

    /// `[[curve]]` with `separate`: four points, two widths and, of ribbons, two normals for each of many curves.
    pub(super) fn separate_curves(&mut self, table: &Table<'_>) -> Result<Geometry> {
        let is_separate = table.or("separate", true, Value::boolean);
        if !is_separate {
            return super::curve::curve(table, self.context.limits.elements);
        }
        let vectors = |reader: &Self, value: Value<'_>, of_item: fn(Value<'_>) -> Result<Vec3>| match reader
            .array(
            value,
        )? {
            Some(rows) => rows.iter().map(|row| finite(value, *row).map(Vec3::from_array)).collect(),
            None => value.list("a list of points, [x, y, z]")?.map(of_item).collect::<Result<Vec<Vec3>>>(),
        };
        let points =
            table.need("points", "[[0, 0, 0], [0, 1, 0], [1, 1, 0], [1, 2, 0]]", Vec::new(), |value| {
                let points = vectors(self, value, point)?;
                match points.len() % 4 {
                    0 => Ok(points),
                    _ => Err(value.wrong("four points for each curve")),
                }
            });
        let ends = points.len() / 2;
        let widths = table.need("width", "0.1", Vec::new(), |value| {
            let is_width = |width: f32| width > 0.0;
            let expected = format!("a number greater than 0, or a list of {ends}, two for each curve");
            if value.is_number() {
                return Ok(vec![value.single_where(&expected, is_width)?; ends]);
            }
            let widths: Vec<f32> = match self.array::<1>(value)? {
                Some(rows) => {
                    rows.iter().map(|row| finite(value, *row).map(|[width]| width)).collect::<Result<_>>()?
                }
                None => value.list(&expected)?.map(Value::single).collect::<Result<_>>()?,
            };
            let are_widths = widths.len() == ends && widths.iter().all(|width| is_width(*width));
            if are_widths { Ok(widths) } else { Err(value.wrong(&expected)) }
        });
        let profile = table.or("profile", Profile::Flat, |value| value.choice(PROFILES));
        let is_ribbon = matches!(profile, Profile::Ribbon(_));
        let normals = table.or("normals", Vec::new(), |value| {
            let normals = vectors(self, value, |item| Ok(unit(item)?.as_vec3()))?;
            match normals.len() == ends && is_ribbon {
                true => Ok(normals),
                false => Err(value.wrong(&format!("{ends} vectors, two for each curve, of ribbons alone"))),
            }
        });
        table.sound(&["points", "width", "profile", "normals"])?;
        if is_ribbon && normals.is_empty() && ends > 0 {
            table.lacks(&["normals"], table.missing("normals", "[[0, 0, 1], [0, 0, 1]]"));
            return Err(Error::untold());
        }
        self.check_count(table, points.len() / 4)?;
        let strands = points.as_chunks::<4>().0.iter().enumerate().map(|(index, points)| Strand {
            points: *points,
            width: [widths[2 * index], widths[2 * index + 1]],
            profile: match profile {
                Profile::Ribbon(_) => Profile::Ribbon([normals[2 * index], normals[2 * index + 1]]),
                other => other,
            },
        });
        Ok(Geometry::Curves(strands.collect()))
    }

    /// Counts the memory of elements, which must not be more than the limit.
    fn check_count(&mut self, table: &Table<'_>, count: usize) -> Result<()> {
        let limit = self.context.limits.elements;
        if count as u64 > limit {
            return Err(too_many(table, count as u64, limit));
        }
        let bytes = count as u64 * size_of::<Strand>() as u64;
        self.context.keep(bytes, "the elements of a shape", &table.at())
    }
}
