//! `[[heightfield]]`: terrain whose heights are the texels of a picture.

use glam::{Vec2, Vec3};

use super::Reader;
use super::mesh::too_many;
use super::table::Table;
use super::value::Value;
use crate::error::Result;
use crate::image::Image;
use crate::scene::ImageId;
use crate::shape::{Geometry, Mesh};

impl Reader<'_, '_> {
    /// A mesh with a vertex for each texel, centred on the origin in x and z; the picture's upper edge is towards −z.
    pub(super) fn heightfield(&mut self, table: &Table<'_>) -> Result<Geometry> {
        let image =
            table.need("file", "\"heights.png\"", ImageId(0), |value| self.image_as(value, None, true));
        let size = table.or("size", [1.0, 1.0], |value| {
            let expected = "two numbers > 0, [width, depth]";
            let size = value.numbers(expected)?;
            if size.iter().all(|side| *side > 0.0) { Ok(size) } else { Err(value.wrong(expected)) }
        });
        let height = table.or("height", 1.0, Value::number);
        table.sound(&["file", "size", "height"])?;
        let image = &self.scene.images[image.index()];
        if image.width < 2 || image.height < 2 {
            let message = format!("a picture of {} × {} texels is no terrain", image.width, image.height);
            return Err(table.error_at("file", message).hint("it needs two texels in each direction"));
        }
        let count = 2 * u64::from(image.width) * u64::from(image.height);
        if count > self.context.limits.elements {
            return Err(too_many(table, count, self.context.limits.elements));
        }
        // A vertex has a position, a normal and texture coordinates; a height before, and two triangles.
        let _memory = self.context.budget.reserve(count / 2 * 64, "the terrain", &table.at())?;
        let mesh = terrain(image, size, height);
        self.mesh(table, mesh)
    }
}

fn terrain(image: &Image, [width, depth]: [f64; 2], height: f64) -> Mesh {
    let (columns, rows) = (image.width as usize, image.height as usize);
    let heights: Vec<f64> =
        image.texels().map(|[r, g, b]| height * (f64::from(r) + f64::from(g) + f64::from(b)) / 3.0).collect();
    let at = |column: usize, row: usize| heights[row * columns + column];
    let [dx, dz] = [width / (columns - 1) as f64, depth / (rows - 1) as f64];
    let mut mesh = Mesh { name: "heightfield".to_owned(), ..Mesh::default() };
    for row in 0..rows {
        for column in 0..columns {
            let place = [column as f64 * dx - 0.5 * width, at(column, row), row as f64 * dz - 0.5 * depth];
            mesh.positions.push(Vec3::from_array(place.map(|x| x as f32)));
            // Central differences; one-sided at the edges.
            let [left, right] = [column.saturating_sub(1), (column + 1).min(columns - 1)];
            let [behind, before] = [row.saturating_sub(1), (row + 1).min(rows - 1)];
            let along_x = (at(right, row) - at(left, row)) / ((right - left) as f64 * dx);
            let along_z = (at(column, before) - at(column, behind)) / ((before - behind) as f64 * dz);
            mesh.normals.push(glam::DVec3::new(-along_x, 1.0, -along_z).normalize().as_vec3());
            let [u, v] = [column as f64 / (columns - 1) as f64, 1.0 - row as f64 / (rows - 1) as f64];
            mesh.uvs.push(Vec2::new(u as f32, v as f32));
        }
    }
    for row in 0..rows - 1 {
        for column in 0..columns - 1 {
            let a = (row * columns + column) as u32;
            let (b, c, d) = (a + 1, a + columns as u32, a + columns as u32 + 1);
            // The diagonal whose ends differ less: ridges stay whole.
            let [main, other] = [
                (at(column, row) - at(column + 1, row + 1)).abs(),
                (at(column + 1, row) - at(column, row + 1)).abs(),
            ];
            let halves = if main < other { [[a, c, d], [a, d, b]] } else { [[a, c, b], [b, c, d]] };
            mesh.triangles.extend(halves);
        }
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slope_is_a_plane() {
        let texels = (0..12).map(|index| [(index % 4) as f32 * 0.5; 3]).collect();
        let mesh = terrain(&Image::from_linear("slope", 4, 3, texels), [6.0, 2.0], 2.0);
        assert_eq!(
            (mesh.positions[0], mesh.positions[11]),
            (Vec3::new(-3.0, 0.0, -1.0), Vec3::new(3.0, 3.0, 1.0))
        );
        assert_eq!((mesh.uvs[0], mesh.uvs[11]), (Vec2::new(0.0, 1.0), Vec2::new(1.0, 0.0)));
        let normal = Vec3::new(-0.5, 1.0, 0.0).normalize();
        assert!(mesh.normals.iter().all(|found| found.distance(normal) < 1e-6));
        assert_eq!(mesh.triangles.len(), 12);
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize]);
            assert!((b - a).cross(c - a).normalize().distance(normal) < 1e-5);
        }
    }
}
