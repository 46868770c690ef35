//! The part of a step that is generic over the class of BSDFs: evaluation of eight materials, and the kernel that scatters by them. All else of
//! the step takes the class as a value, so that it is compiled once.

use super::class_hits::ClassHit;
use super::class_points::ClassPoints;
use super::kernel::{ScatterKernel, Scattered, Task};
use super::vertices::VertexColumns;
use crate::core::lanes::{LANES, by_lane};
use crate::integrator::path::{HitBatch, PathTracer, Vertex, dimension};
use crate::integrator::{Queues, SampleStream};
use crate::shading::bsdf::lanes::RowBsdf;
use crate::shading::bsdf::types::*;
use crate::shading::bsdf::{Bsdf, BsdfClass, bsdf_classes};
use crate::shading::material::{MaterialRow, ShadingContext, Side};
use crate::shading::texture::TexturePoint;
use crate::world::World;

/// Calls a generic function with the type of a class.
macro_rules! with_class {
    ($class:expr, $function:ident $arguments:tt) => {
        bsdf_classes!(call_with_class($class, $function, $arguments))
    };
}

macro_rules! call_with_class {
    (
        ($class:expr, $function:ident, $arguments:tt)
        lanes { $($(#[$doc:meta])* $lane:ident($type:ty $(| $_whole:ident.$_part:ident)?),)* }
        wholes { $($_wholes:tt)* }
        one_by_one { $($_rest:tt)* }
    ) => {
        match $class {
            $(BsdfClass::$lane => call!($function, $type, $arguments),)*
        }
    };
}

macro_rules! call {
    ($function:ident, $type:ty, ($($argument:expr),*)) => {
        $function::<$type>($($argument),*)
    };
}

/// Scatters vertices by the BSDFs of their class.
pub(super) fn scatter_vertices(
    class: BsdfClass,
    world: &World,
    vertices: &[&Vertex; LANES],
    task: &Task<'_>,
    scattered: &mut Scattered,
) {
    with_class!(class, scatter_by(world, vertices, task, scattered));
}

fn scatter_by<B: RowBsdf>(
    world: &World,
    vertices: &[&Vertex; LANES],
    task: &Task<'_>,
    scattered: &mut Scattered,
) {
    let Some(first) = B::of(&vertices[0].shading.bsdf) else { return };
    let bsdfs = by_lane!(lane => B::of(&vertices[lane].shading.bsdf).unwrap_or(first));
    let surfaces = &VertexColumns::of_vertices(vertices);
    ScatterKernel { world, surfaces, bsdfs: &bsdfs, task, scattered }.scatter();
}

/// Hits on shapes whose materials have BSDFs of one class.
pub(super) struct MaterialHits<'a> {
    pub(super) tracer: &'a PathTracer,
    pub(super) batch: &'a HitBatch<'a>,
    pub(super) hits: &'a [ClassHit<'a>; LANES],
    /// The texture points, if any material varies.
    pub(super) varying: Option<&'a [TexturePoint<'a>; LANES]>,
    /// As [`Task::wants_shares`].
    pub(super) wants_shares: bool,
}

impl MaterialHits<'_> {
    /// Evaluates the materials, bends the frames of the points, and scatters. The BSDFs are left in `told` if somebody listens. False if
    /// there are none.
    pub(super) fn scatter(
        &self,
        class: BsdfClass,
        points: &mut ClassPoints,
        queues: &mut Queues,
        scattered: &mut Scattered,
        told: Option<&mut [Option<Bsdf>; LANES]>,
    ) -> bool {
        with_class!(class, scatter_hits_by(self, points, queues, scattered, told))
    }

    /// Bends the frames that were noted.
    #[inline]
    fn bend(&self, points: &mut ClassPoints) {
        let &mut ClassPoints { ref mut surfaces, ref uv, front, ref mut bent, .. } = points;
        if let Some(varying) = self.varying {
            bent.look_up_heights(self.batch.world, self.hits, varying, (surfaces, uv));
        }
        bent.bend(surfaces, front);
    }

    /// The rows of the materials' BSDFs. Frames that are bent alone are replaced; those that are bent together are noted.
    #[inline(always)]
    fn rows<B: MaterialRow>(&self, points: &mut ClassPoints, queues: &mut Queues) -> [Option<B>; LANES] {
        let Self { tracer, batch, hits, varying, .. } = *self;
        let world = batch.world;
        let &mut ClassPoints { ref mut surfaces, front, smooth, ref mut bent, .. } = points;
        let mut rows = [None; LANES];
        for (lane, hit) in hits.iter().enumerate() {
            let ClassHit { path, material, .. } = hit;
            let point = varying.map_or(&TexturePoint::NOWHERE, |points| &points[lane]);
            let mut throughput = path.beta;
            let context = ShadingContext {
                mode: &mut queues.modes[path.slot as usize],
                throughput: &mut throughput,
                interior: path.interior,
                u: 0.0,
                seed: seed_of_walks::<B>(&batch.streams.of(path)),
            };
            let side = Side { material: hit.material_index, front: front & 1 << lane != 0 };
            let at = (side, point);
            let bends_in_lanes = material.bends_in_lanes();
            if bends_in_lanes && (smooth & 1 << lane != 0 || material.has_bumps()) {
                bent.note(lane, material, material.local_normal(&world.textures, point));
            }
            let mut row: Option<B> = if material.bends_frames() && !bends_in_lanes {
                let geometry = bent.geometry(surfaces, lane, side.front);
                material.bent_row(&world.materials, world.relief(), &geometry, at, context).map(
                    |(row, axes, guard)| {
                        surfaces.set_frame(lane, axes);
                        surfaces.set_guard(lane, guard.as_ref());
                        row
                    },
                )
            } else {
                material.row(&world.materials, &world.textures, at, context)
            };
            if tracer.regularize && path.blurred {
                row.iter_mut().for_each(B::regularize);
            }
            rows[lane] = row;
        }
        rows
    }
}

fn scatter_hits_by<B: MaterialRow>(
    hits: &MaterialHits<'_>,
    points: &mut ClassPoints,
    queues: &mut Queues,
    scattered: &mut Scattered,
    told: Option<&mut [Option<Bsdf>; LANES]>,
) -> bool {
    let rows = hits.rows::<B>(points, queues);
    hits.bend(points);
    if let Some(told) = told {
        *told = rows.map(|row| row.map(B::bsdf));
    }
    let Some(first) = &rows[0] else { return false };
    let bsdfs = by_lane!(lane => rows[lane].as_ref().unwrap_or(first));
    let MaterialHits { tracer, batch, hits, wants_shares, .. } = *hits;
    let streams = by_lane!(lane => batch.streams.of(hits[lane].path));
    let (paths, streams) = (by_lane!(lane => hits[lane].path), by_lane!(lane => &streams[lane]));
    let task = &tracer.task(paths, streams, queues, wants_shares);
    let (world, surfaces) = (batch.world, &points.surfaces);
    ScatterKernel { world, surfaces, bsdfs: &bsdfs, task, scattered }.scatter();
    true
}

/// [`ShadingContext::seed`], where BSDFs of a class take one.
#[inline]
fn seed_of_walks<B: MaterialRow>(stream: &SampleStream) -> f32 {
    if B::TAKES_SEED { stream.two(dimension::WALK)[0] } else { 0.0 }
}
