//! Hits about which chance decides, eight at a time: paths go on behind surfaces that fail the alpha test, and one
//! of mixed materials is chosen.

use lookfrom_bvh::OriginPrimitive;
use lookfrom_simd::{Kernel, LaneMask, Simd};

use super::class_hits::ClassHits;
use super::class_points::{ClassPoints, PointsKernel};
use super::vertices::VertexColumns;
use crate::core::lanes::{Columns, LANES, by_lane, gather, lanes_where, row, shade_together, store};
use crate::integrator::Probe;
use crate::integrator::path::{HitBatch, Path, PathTracer, StepOutput, dimension};
use crate::shading::material::Material;
use crate::shading::texture::FloatTexture;
use crate::world::{HitClass, ShapeClass, World};

/// Decided hits.
pub(super) struct Decided {
    /// The lanes whose surfaces are there.
    pub(super) there: u32,
    /// Indices of their materials, of which none is mixed.
    pub(super) materials: [u32; LANES],
}

impl PathTracer {
    /// The material of a hit, if it is known to be there whatever the textures are at the point: a random number decides about constants.
    pub(super) fn decided_at_once(batch: &HitBatch<'_>, class: HitClass, index: usize) -> Option<u32> {
        let (world, numbers) = (batch.world, || presence(batch, &batch.paths[index]));
        let constant = |number: FloatTexture| match number {
            FloatTexture::Constant(value) => Some(value),
            FloatTexture::Texture(_) => None,
        };
        if let Some(alpha) = class.alpha
            && !is_there(constant(world.alphas[alpha as usize].texture)?, numbers)
        {
            return None;
        }
        match class.bsdf {
            Some(_) => Some(class.material),
            None => Material::chosen(&world.materials, class.material, constant, || numbers()[1])
                .map(|(chosen, _)| chosen),
        }
    }

    /// Decides about up to eight paths' hits on shapes of one kind. Those whose surfaces are not there go on behind them, as those do that pass back faces.
    pub(super) fn decide<P: Probe>(
        &self,
        batch: &HitBatch<'_>,
        (shape, indices): (ShapeClass, &[u32]),
        points: &mut ClassPoints,
        output: &mut StepOutput<'_, P>,
    ) -> Decided {
        let (world, materials) = (batch.world, [0; LANES]);
        let Some(class_hits) = ClassHits::undecided(batch, shape, indices, |path| output.time(path)) else {
            return Decided { there: 0, materials };
        };
        PointsKernel { world, class_hits: &class_hits, points }.set_points();
        let hits = &class_hits.hits;
        let active = class_hits.pass_back_faces(indices.len(), points, output);

        // Test the alphas, and go on behind surfaces that are not there.
        let alphas = class_hits.alphas(world, points);
        let there = lanes_where(active, |lane| is_there(alphas[lane], || presence(batch, hits[lane].path)));
        class_hits.go_on_behind(active & !there, points, output);

        Decided {
            there,
            materials: class_hits
                .chosen_materials(world, points, there, |lane| presence(batch, hits[lane].path)[1]),
        }
    }
}

/// The random numbers of a hit: for the alpha test, and for the choice between mixed materials.
fn presence(batch: &HitBatch<'_>, path: &Path) -> [f32; 2] {
    batch.streams.of(path).two(dimension::PRESENCE)
}

/// The alpha test: a random number decides where the alpha is between 0 and 1.
#[inline]
fn is_there(alpha: f32, numbers: impl FnOnce() -> [f32; 2]) -> bool {
    alpha >= 1.0 || alpha > 0.0 && numbers()[0] < alpha
}

impl ClassHits<'_> {
    /// Lets paths in the lanes of a mask go on behind their surfaces, as if these were not there.
    #[inline(always)]
    pub(super) fn go_on_behind<P: Probe>(
        &self,
        lanes: u32,
        points: &ClassPoints,
        output: &mut StepOutput<'_, P>,
    ) {
        if lanes == 0 {
            return;
        }
        let paths = by_lane!(lane => self.hits[lane].path);
        let origins = origins_behind(&points.surfaces, &paths);
        let behind =
            |lane: usize| paths[lane].behind(row(&origins, lane), OriginPrimitive::of(self.hits[lane].hit));
        output.paths.extend(LaneMask(lanes).map(behind));
    }

    /// The materials of hits in the lanes of a mask, by random numbers by lane where they are mixed.
    fn chosen_materials(
        &self,
        world: &World,
        points: &ClassPoints,
        lanes: u32,
        number: impl Fn(usize) -> f32,
    ) -> [u32; LANES] {
        let mut materials = by_lane!(lane => self.hits[lane].binding.material);
        let mixed = lanes_where(lanes, |lane| world.materials[materials[lane] as usize].is_mixture());
        if mixed != 0 {
            let at = self.points_alone(world, points);
            for lane in LaneMask(mixed) {
                let amount = |amount: FloatTexture| Some(world.textures.float(amount, &at[lane]));
                let chosen = Material::chosen(&world.materials, materials[lane], amount, || number(lane));
                materials[lane] = chosen.map_or(materials[lane], |(chosen, _)| chosen);
            }
        }
        materials
    }
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
