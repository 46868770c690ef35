//! First-hit visualisation in false colours: normals, depth, texture coordinates, shape ids.

use glam::{DVec3, Vec3};
use lookfrom_bvh::Hit;

use crate::core::hash;
use crate::core::spectrum::Spectrum;
use crate::integrator::{Event, Integrator, Path, Probe, SampleStream, StepOutput, Term};
use crate::shading::interaction::SurfaceInteraction;
use crate::world::World;

/// The quantity of the first hit that is shown in place of light; black where nothing is hit.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum FalseColor {
    /// The shading normal in the world: `½ + ½ n` in red, green, blue.
    Normals,
    /// The distance from the camera along the view axis, in the scene's units, in all three channels.
    Depth {
        /// The camera's position in render space.
        eye: DVec3,
        /// The view axis, of unit length.
        forward: DVec3,
    },
    /// u in red, v in green, each without its whole part.
    Uv,
    /// A colour for each shape.
    Id,
}

impl Integrator for FalseColor {
    const IS_LIGHT: bool = false;

    type State = ();

    fn name(&self) -> &'static str {
        match self {
            Self::Normals => "normals",
            Self::Depth { .. } => "depth",
            Self::Uv => "uv",
            Self::Id => "id",
        }
    }

    fn step<P: Probe>(
        &self,
        world: &World,
        _: &SampleStream,
        path: &Path,
        hit: &Hit,
        output: &mut StepOutput<'_, P>,
    ) {
        if !hit.is_hit() {
            output.shows_background(path);
            return;
        }
        let surface = world.surface_at(&path.ray, hit, output.time(path));
        // Surfaces whose alpha is below one half are not shown.
        if path.goes_through(world, &surface, 0.5) {
            output.paths.push(path.passed(&surface));
            return;
        }
        output.leave_first_surface(world, path, &surface, || None);
        output.probe.notice(|| Event::Surface {
            address: path.address,
            surface: Box::new(surface),
            coefficients: None,
        });
        output.add(path, Term::View, path.beta * Spectrum::from_rgb(self.color(&surface)));
    }
}

impl FalseColor {
    fn color(self, surface: &SurfaceInteraction) -> [f32; 3] {
        match self {
            Self::Normals => (0.5 + 0.5 * surface.ns).to_array(),
            Self::Depth { eye, forward } => {
                [forward.dot(DVec3::from_array(surface.point.position) - eye) as f32; 3]
            }
            Self::Uv => {
                let uv = surface.uv - surface.uv.floor();
                [uv.x, uv.y, 0.0]
            }
            Self::Id => id_color(surface.shape),
        }
    }
}

/// A bright colour for each number, by a hash.
fn id_color(id: u32) -> [f32; 3] {
    let bits = hash::pair(u64::from(id), 0);
    let channel = |shift: u32| 0.1 + 0.9 * ((bits >> shift & 0xff) as f32 / 255.0);
    Vec3::new(channel(0), channel(8), channel(16)).to_array()
}
