//! False colours, for looking at a scene: normals, depth, texture coordinates, shapes.

use glam::{DVec3, Vec3};
use lookfrom_bvh::Hit;

use crate::hash;
use crate::integrator::{Event, Integrator, Next, Numbers, Path, Probe, Term};
use crate::spectrum::Spectrum;
use crate::surface::Surface;
use crate::world::World;

/// What is shown in place of light. Where nothing is met, black.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum View {
    /// The shading normal in the world: `½ + ½ n` in red, green, blue.
    Normals,
    /// The distance from the eye along the view axis, in the scene's units, in all three.
    Depth,
    /// u in red, v in green, each without its whole part.
    Uv,
    /// A colour for each shape.
    Id,
}

impl Integrator for View {
    fn step<P: Probe>(&self, world: &World, _: &Numbers, path: &Path, hit: &Hit, next: &mut Next<'_, P>) {
        if !hit.is_hit() {
            return;
        }
        let surface = world.surface(&path.ray, hit);
        // What is more clear than not is not shown.
        if path.goes_through(world, &surface, 0.5) {
            next.samples.paths.push(path.passed(&surface));
            return;
        }
        next.probe.notice(|| Event::Surface {
            address: path.address,
            surface: Box::new(surface),
            coefficients: None,
        });
        next.add(path, Term::View, path.beta * Spectrum::from_rgb(self.color(world, &surface)));
    }
}

impl View {
    fn color(self, world: &World, surface: &Surface) -> [f32; 3] {
        match self {
            Self::Normals => (0.5 + 0.5 * surface.ns).to_array(),
            Self::Depth => {
                let from_eye =
                    world.origin - world.camera.lookfrom() + DVec3::from_array(surface.point.position);
                [(world.camera.w().normalize().dot(from_eye)) as f32; 3]
            }
            Self::Uv => {
                let uv = surface.uv - surface.uv.floor();
                [uv.x, uv.y, 0.0]
            }
            Self::Id => id_color(surface.shape),
        }
    }
}

/// A bright colour of its own for each number.
fn id_color(id: u32) -> [f32; 3] {
    let bits = hash::pair(u64::from(id), 0);
    let channel = |shift: u32| 0.1 + 0.9 * ((bits >> shift & 0xff) as f32 / 255.0);
    Vec3::new(channel(0), channel(8), channel(16)).to_array()
}
