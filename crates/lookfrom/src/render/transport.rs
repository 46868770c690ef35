//! Integrators behind a pointer: one virtual call per batch.

use std::sync::Arc;

use glam::DVec3;
use lookfrom_scene::settings::{Integrator as Kind, RenderSettings};

use super::{Batch, Rays, Renderer, SampleId};
use crate::integrator::{
    AmbientOcclusion, Event, FalseColor, Integrator, LightSampling, PathTracer, RayTree, Whitted,
};
use crate::view::camera::Camera;

/// An [`Integrator`] as the renderer calls it.
pub(super) trait Transport: std::fmt::Debug + Send + Sync {
    fn name(&self) -> &'static str;

    fn is_light(&self) -> bool;

    fn flies(&self) -> bool;

    /// Computes samples.
    fn trace(&self, renderer: &Renderer, ids: &[SampleId], batch: &mut Batch) -> Rays;

    /// [`Transport::trace`] for the inspector.
    fn trace_events(
        &self,
        renderer: &Renderer,
        ids: &[SampleId],
        events: &mut Vec<Event>,
        batch: &mut Batch,
    ) -> Rays;
}

impl<I: Integrator> Transport for I {
    fn name(&self) -> &'static str {
        Integrator::name(self)
    }

    fn is_light(&self) -> bool {
        I::IS_LIGHT
    }

    fn flies(&self) -> bool {
        I::FLIES
    }

    fn trace(&self, renderer: &Renderer, ids: &[SampleId], batch: &mut Batch) -> Rays {
        renderer.trace_with(self, ids, &mut (), batch)
    }

    fn trace_events(
        &self,
        renderer: &Renderer,
        ids: &[SampleId],
        events: &mut Vec<Event>,
        batch: &mut Batch,
    ) -> Rays {
        renderer.trace_with(self, ids, events, batch)
    }
}

/// The integrator that the settings name, for a camera at `eye` in render space.
pub(super) fn of_settings(settings: &RenderSettings, camera: &Camera, eye: DVec3) -> Arc<dyn Transport> {
    let &RenderSettings {
        integrator,
        depth,
        min_contribution,
        transparent_shadows,
        regularize,
        thin_passages_count,
        occlusion_distance,
        ..
    } = settings;
    let path =
        |light_sampling| Arc::new(PathTracer { depth, regularize, thin_passages_count, light_sampling });
    match integrator {
        Kind::Raycast => Arc::new(Whitted { tree: None, transparent_shadows }),
        Kind::Whitted => {
            Arc::new(Whitted { tree: Some(RayTree { depth, min_contribution }), transparent_shadows })
        }
        Kind::Path => path(LightSampling::MultipleImportance),
        Kind::SimplePath => path(LightSampling::NextEventEstimation),
        Kind::RandomWalk => path(LightSampling::None),
        Kind::AmbientOcclusion { cosine } => {
            Arc::new(AmbientOcclusion { cosine, distance: occlusion_distance })
        }
        Kind::Normals => Arc::new(FalseColor::Normals),
        Kind::Depth => Arc::new(FalseColor::Depth { eye, forward: camera.w().normalize() }),
        Kind::Uv => Arc::new(FalseColor::Uv),
        Kind::Id => Arc::new(FalseColor::Id),
    }
}
