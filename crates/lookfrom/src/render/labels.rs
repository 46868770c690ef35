//! Labels: which object is seen at the middle of each pixel, and where; for data sets, not for light.

use glam::{DVec3, Vec3};
use lookfrom_bvh::{Hit, NONE};
use lookfrom_scene::settings::ImageSettings;

use super::Renderer;
use crate::core::parallel;
use crate::integrator::Path;

/// The first visible surface at the centre of a pixel, through the centre of the lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Label {
    /// Index of the shape in the world's [names](crate::world::Names::shapes); [`Label::NONE`] where nothing is seen.
    pub shape: u32,
    /// Index of the instance that it is in; [`Label::NONE`] outside of instances.
    pub instance: u32,
    /// Index of the material in the world's [names](crate::world::Names::materials).
    pub material: u32,
    /// Index of the primitive within its shape: of a mesh, the triangle.
    pub primitive: u32,
    /// Its point in the world; NaN where nothing is seen.
    pub point: DVec3,
    /// Shading normal there, in the world, on the viewer's side, of unit length; NaN where nothing is seen.
    pub n: Vec3,
}

impl Label {
    /// The index of nothing.
    pub const NONE: u32 = NONE;

    /// Nothing is seen.
    const NOTHING: Self = Self {
        shape: NONE,
        instance: NONE,
        material: NONE,
        primitive: NONE,
        point: DVec3::NAN,
        n: Vec3::NAN,
    };
}

/// Surfaces of low opacity that are seen through before nothing is.
const MOST_PASSED: usize = 64;

impl Renderer {
    /// The labels of all pixels of the picture, row by row from the top left; of those outside of the crop, too. Seen through are
    /// backs of single-sided surfaces, and what has an alpha below one half.
    pub fn labels(&self) -> Vec<Label> {
        let ImageSettings { width, height, .. } = self.view.image;
        let row = |row: usize| (0..width).map(move |column| self.label([column, row as u32]));
        parallel::collect(height as usize, |y| row(y).collect::<Vec<_>>()).concat()
    }

    /// The label of a pixel when the shutter opens, by column and row from the top left; nothing is seen in a measurement, and outside
    /// of the picture.
    pub fn label(&self, [x, y]: [u32; 2]) -> Label {
        let ImageSettings { width, height, .. } = self.view.image;
        if self.surface.is_some() || x >= width || y >= height {
            return Label::NOTHING;
        }
        let middle = [f64::from(x) + 0.5, f64::from(height - 1 - y) + 0.5];
        let mut path: Path = self.root(self.kernel_ray(&self.view.camera.ray(middle, [0.5; 2])));
        for _ in 0..MOST_PASSED {
            let hit: Hit = self.world.bvh.query().origin(path.origin_primitive).closest_hit(&path.ray);
            if !hit.is_hit() {
                break;
            }
            let surface = self.world.surface(&path.ray, &hit);
            if path.goes_through(&self.world, &surface, 0.5) || self.world.is_interface(&surface) {
                path = path.passed(&surface);
                continue;
            }
            let ns = if surface.front { surface.ns } else { -surface.ns };
            return Label {
                shape: surface.shape,
                instance: hit.instance,
                material: surface.material,
                primitive: surface.primitive,
                point: self.world.origin() + DVec3::from_array(surface.point.position),
                n: ns,
            };
        }
        Label::NOTHING
    }
}
