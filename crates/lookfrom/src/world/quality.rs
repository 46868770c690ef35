//! The quality of a world's BVHs, on which its light does not depend: by the rays that its picture is expected to take.

use lookfrom_bvh::Quality;
use lookfrom_scene::Scene;
use lookfrom_scene::count::Counts;
use lookfrom_scene::settings::{Integrator, RenderSettings};

/// Number of primitives from which on trees differ.
const FEW: u64 = 1024;

/// Rays for each primitive from which on the best tree is worth its time. It takes up to 4 µs more for each triangle and saves 2
/// to 5 % of a ray's time, of bounces up to 30 % (docs/benchmarks/shading.md).
const RAYS_OF_PRIMITIVE: u64 = 128;

/// Number of surfaces that the average path does not exceed, whatever its depth may be.
const LONGEST: u32 = 8;

/// The quality of the trees for a scene's picture.
pub(super) fn quality(scene: &Scene) -> Quality {
    let counts = Counts::of(scene);
    of_picture(counts.triangles + counts.spheres, [scene.image.width, scene.image.height], &scene.render)
}

/// The quality of the trees over a number of primitives for a picture of a width and a height.
fn of_picture(primitives: u64, [width, height]: [u32; 2], render: &RenderSettings) -> Quality {
    let along_a_path = match render.integrator {
        Integrator::Whitted | Integrator::Path | Integrator::SimplePath | Integrator::RandomWalk => {
            1 + render.depth.min(LONGEST)
        }
        Integrator::Raycast | Integrator::AmbientOcclusion { .. } => 2,
        Integrator::Normals | Integrator::Depth | Integrator::Uv | Integrator::Id => 1,
    };
    let samples = (u64::from(width) * u64::from(height)).saturating_mul(render.samples.into());
    let rays = samples.saturating_mul(along_a_path.into());
    match primitives >= FEW && rays / primitives >= RAYS_OF_PRIMITIVE {
        true => Quality::Best,
        false => Quality::Balanced,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_best_tree_is_for_pictures_of_many_rays() {
        let of = |primitives, integrator, depth, samples| {
            let render = RenderSettings { integrator, depth, samples, ..RenderSettings::default() };
            of_picture(primitives, [100, 100], &render)
        };
        // 10,000 pixels: at 16 samples, 16 camera rays for each of 10,000 primitives.
        assert_eq!(of(10_000, Integrator::Path, 0, 16), Quality::Balanced);
        assert_eq!(of(10_000, Integrator::Path, 6, 16), Quality::Balanced);
        assert_eq!(of(10_000, Integrator::Path, 7, 16), Quality::Best);
        assert_eq!(of(10_000, Integrator::Normals, 7, 16), Quality::Balanced);
        assert_eq!(of(10_000, Integrator::Normals, 7, 128), Quality::Best);
        // Paths do not become longer because they may.
        assert_eq!(of(100_000, Integrator::Path, u32::MAX, 16), Quality::Balanced);
        assert_eq!(of(10_000, Integrator::Path, u32::MAX, u32::MAX), Quality::Best);
        // Trees of few primitives are the same.
        assert_eq!(of(0, Integrator::Path, 8, 4096), Quality::Balanced);
        assert_eq!(of(1023, Integrator::Path, 8, 4096), Quality::Balanced);
    }
}
