//! Whether a model brings its own light: surfaces that light the rest of it, not only glow.
//!
//! Emission up to 1 is how models draw screens, labels and eyes: it is as bright as white paper in the studio. Brighter
//! surfaces are lamps if together they would light the model: if they are a small part of it, and their light, spread over
//! the sphere around the model, is not negligible beside the studio's. A row of glowing cubes is lit by the studio, a room
//! with a lamp by its lamp.

use glam::DVec3;

use crate::material::{Color, Scalar};
use crate::scene::{Bounds, Scene};
use crate::shape::{Geometry, Shape};
use crate::texture::TextureKind;

/// The radiance of white paper in the studio, with room for rounding and tints.
const PAPER: f64 = 1.01;
/// The irradiance, relative to π, that lights a model. A square lamp of radiance 15, as in the Cornell box, gives 0.07.
const LIT: f64 = 0.02;
/// The greatest part of a model's area that is a lamp for the rest.
const SMALL: f64 = 0.1;
/// Nested textures that are followed.
const DEEPEST: u32 = 16;

/// Whether a model's emissive surfaces are its light.
pub fn has_lamps(scene: &Scene) -> bool {
    let radius = scene.bounds().radius();
    let sphere = 4.0 * std::f64::consts::PI * radius * radius;
    // There may be many instances of an object.
    let areas =
        scene.objects.iter().map(|object| object.shapes.iter().map(|shape| area(scene, shape)).collect());
    let areas: Vec<Vec<f64>> = areas.collect();
    let instanced = scene.instances.iter().flat_map(|instance| {
        // Areas grow by the square of the mean scale.
        let scale = instance.world_from_object.determinant().abs().cbrt();
        let object = instance.object.index();
        let shapes = scene.objects[object].shapes.iter().zip(&areas[object]);
        shapes.map(move |(shape, area)| (shape, scale * scale * area))
    });
    let shapes = scene.shapes.iter().map(|shape| (shape, area(scene, shape))).chain(instanced);
    let mut means = Means { scene, of_images: vec![None; scene.images.len()] };
    let (mut flux, mut lamps) = (0.0, 0.0);
    for (shape, area) in shapes.clone() {
        let Some(emission) = &shape.emission else { continue };
        let [r, g, b] = means.of(&emission.radiance, DEEPEST);
        let radiance = f64::from(r.max(g).max(b));
        if radiance > PAPER {
            flux += radiance * area;
            lamps += area;
        }
    }
    flux > LIT * sphere && lamps < SMALL * shapes.map(|(_, area)| area).sum::<f64>()
}

/// Means of colours; those of images are computed once.
struct Means<'s> {
    scene: &'s Scene,
    of_images: Vec<Option<[f32; 3]>>,
}

impl Means<'_> {
    /// The mean of a colour over its image; 1 where it is not known.
    fn of(&mut self, color: &Color, deep: u32) -> [f32; 3] {
        let texture = match *color {
            Color::Value(value) => return value,
            Color::Texture(id) if deep > 0 => &self.scene.textures[id.index()].kind,
            _ => return [1.0; 3],
        };
        match texture {
            TextureKind::Image { image, scale, invert: false, .. } => {
                self.of_image(image.index()).map(|texel| texel * scale)
            }
            TextureKind::Product { a, b } => {
                let (a, b) = (self.of(a, deep - 1), self.of(b, deep - 1));
                [a[0] * b[0], a[1] * b[1], a[2] * b[2]]
            }
            TextureKind::Scale { color, by: Scalar::Value(by) } => {
                self.of(color, deep - 1).map(|value| value * by)
            }
            TextureKind::VertexColor { tint } => *tint,
            _ => [1.0; 3],
        }
    }

    fn of_image(&mut self, index: usize) -> [f32; 3] {
        *self.of_images[index].get_or_insert_with(|| self.scene.images[index].mean())
    }
}

/// The area of a shape, where it is placed: of a mesh exactly, of others that of the box around them.
fn area(scene: &Scene, shape: &Shape) -> f64 {
    if let Geometry::Mesh(id) = &shape.geometry {
        let mesh = &scene.meshes[id.index()];
        let corner = |vertex: u32| {
            shape.world_from_object.transform_point3(mesh.positions[vertex as usize].as_dvec3())
        };
        let areas = mesh.triangles.iter().map(|triangle| {
            let [a, b, c] = triangle.map(corner);
            0.5 * (b - a).cross(c - a).length()
        });
        return areas.sum();
    }
    let Bounds { min, max } = shape.bounds(&scene.meshes);
    let DVec3 { x, y, z } = max - min;
    2.0 * (x * y + y * z + z * x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Location;
    use crate::material::Whitted;
    use crate::model::surface::push_material;
    use crate::shape::Emission;

    /// A box of side 2 with one square of this side and radiance in its middle.
    fn model(side: f64, radiance: f32) -> Scene {
        let mut scene = Scene::default();
        let material = push_material(&mut scene, "white", &Location::default(), Whitted::default());
        let square = |side: f64, z: f64| Geometry::Quad {
            corner: DVec3::new(-0.5 * side, -0.5 * side, z),
            edge_u: side * DVec3::X,
            edge_v: side * DVec3::Y,
        };
        for (side, z) in [(2.0, -1.0), (2.0, 1.0), (side, 0.0)] {
            scene.shapes.push(Shape::new(Location::default(), square(side, z), material));
        }
        scene.shapes[2].emission = Some(Emission::new(Color::gray(radiance), true));
        scene
    }

    #[test]
    fn glow_is_no_lamp() {
        assert!(!has_lamps(&model(0.5, 0.0)));
        assert!(!has_lamps(&model(0.5, 1.0)));
        assert!(!has_lamps(&model(2.0, 1.0)));
    }

    #[test]
    fn what_lights_the_rest_is_one() {
        assert!(has_lamps(&model(0.5, 15.0)));
        assert!(has_lamps(&model(0.01, 1e5)));
        // Too small, and most of the model itself.
        assert!(!has_lamps(&model(0.01, 17.0)));
        assert!(!has_lamps(&model(2.0, 17.0)));
    }

    #[test]
    fn size_and_unit_do_not_matter() {
        for exponent in [-20, 20] {
            for (side, radiance) in [(0.5, 15.0), (2.0, 15.0), (0.5, 1.0)] {
                let mut scene = model(side, radiance);
                for shape in &mut scene.shapes {
                    let Geometry::Quad { corner, edge_u, edge_v } = &mut shape.geometry else { continue };
                    for v in [corner, edge_u, edge_v] {
                        *v *= 2_f64.powi(exponent);
                    }
                }
                assert_eq!(has_lamps(&scene), has_lamps(&model(side, radiance)), "{exponent} {side}");
            }
        }
    }
}
