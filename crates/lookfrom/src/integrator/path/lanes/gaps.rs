//! Hits on meshes and spheres with an alpha, eight at a time: paths go on behind those that fail the alpha test.

use lookfrom_bvh::{OriginPrimitive, Ray};
use lookfrom_simd::{Kernel, LaneMask, Simd};

use super::class_hits::ClassHits;
use super::class_points::{ClassPoints, PointsKernel};
use super::vertices::VertexColumns;
use crate::core::lanes::{Columns, LANES, by_lane, gather, row, shade_together, store};
use crate::integrator::Probe;
use crate::integrator::path::{HitBatch, Path, PathTracer, StepOutput, dimension};

impl PathTracer {
    /// Tests the alpha of up to eight paths' hits. Those that fail go on behind them, as those do that pass back faces. Returns the lanes of
    /// the others.
    pub(super) fn pass_gaps<P: Probe>(
        &self,
        batch: &HitBatch<'_>,
        indices: &[u32],
        points: &mut ClassPoints,
        output: &mut StepOutput<'_, P>,
    ) -> u32 {
        let world = batch.world;
        let Some(class_hits) = ClassHits::of(batch, indices, |_| false) else { return 0 };
        // Alphas are those of a point, whatever the material is.
        let class_hits = ClassHits { pixels: None, ..class_hits };
        PointsKernel { world, class_hits: &class_hits, points }.set_points();
        let hits = &class_hits.hits;
        let active = self.pass_back_faces(batch, indices, (hits, points.front), output);

        let alphas = class_hits.alphas(world, points);
        let is_there = |lane: &usize| is_there(batch, hits[*lane].path, alphas[*lane]);
        let there = LaneMask(active).filter(is_there).fold(0, |lanes, lane| lanes | 1 << lane);

        let gaps = active & !there;
        if gaps != 0 {
            let paths = by_lane!(lane => hits[lane].path);
            let origins = origins_behind(&points.surfaces, &paths);
            output.paths.extend(LaneMask(gaps).map(|lane| Path {
                ray: Ray::new(row(&origins, lane), paths[lane].ray.direction),
                address: paths[lane].address + 1,
                origin_primitive: OriginPrimitive::of(hits[lane].hit),
                ..*paths[lane]
            }));
        }
        there
    }
}

/// The alpha test of what a path has hit: a random number decides where the alpha is between 0 and 1.
#[inline]
pub(super) fn is_there(batch: &HitBatch<'_>, path: &Path, alpha: f32) -> bool {
    alpha >= 1.0 || alpha > 0.0 && batch.streams.of(path).two(dimension::PRESENCE)[0] < alpha
}

/// The origins of rays that pass surfaces.
#[inline(never)]
fn origins_behind(surfaces: &VertexColumns, paths: &[&Path; LANES]) -> Columns<3> {
    shade_together(BehindKernel { surfaces, paths })
}

struct BehindKernel<'a> {
    surfaces: &'a VertexColumns,
    paths: &'a [&'a Path; LANES],
}

impl Kernel for BehindKernel<'_> {
    type Output = Columns<3>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Columns<3> {
        let direction = gather(simd, &by_lane!(lane => self.paths[lane].ray.direction));
        store(self.surfaces.load(simd).exits().toward(direction))
    }
}
