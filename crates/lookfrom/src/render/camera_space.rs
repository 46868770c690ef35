//! From surfaces in render space to AOVs in camera space, one by one or eight side by side.

use glam::DVec3;
use lookfrom_simd::{Float, Kernel, LaneMask, Real, Simd, dispatch, f32x8, level};

use super::Renderer;
use crate::core::lanes::{LANES, load, load_f64, store};
use crate::core::vector::Vector;
use crate::film::{AovColumns, Aovs};
use crate::integrator::{FirstSurface, FirstSurfaceColumns};

/// From render space to the space of AOVs.
#[derive(Clone, Copy)]
pub(super) struct CameraSpace {
    /// The axes of the view space of the notes, in which x is to the left, and its translation.
    view_from_world: [DVec3; 4],
    /// The origin of render space.
    origin: DVec3,
}

impl CameraSpace {
    pub(super) fn of(renderer: &Renderer) -> Self {
        let view_from_world = renderer.view.camera.world_from_view().inverse();
        let [x, y, z, w] = std::array::from_fn(|column| view_from_world.col(column).truncate());
        Self { view_from_world: [x, y, z, w], origin: renderer.world.origin }
    }

    /// The AOVs of a surface.
    pub(super) fn aovs(&self, surface: &FirstSurface) -> Aovs {
        let FirstSurface { position, ng, ns, wo, uv, albedo } = *surface;
        let [ng, ns] = [ng, ns].map(|n| self.normal(Vector::from(n), Vector::from(wo)).into());
        let position = self.position::<f32>(Vector::from(position)).into();
        Aovs { albedo, ng, ns, position, uv: uv.to_array() }
    }

    /// The AOVs of surfaces, by slot.
    #[inline(never)]
    pub(super) fn set_aovs(&self, surfaces: &[FirstSurfaceColumns], aovs: &mut [AovColumns]) {
        dispatch(level(), AovKernel { space: self, surfaces, aovs });
    }

    #[inline(always)]
    fn position<R: Real>(&self, position: Vector<R::Double>) -> Vector<R> {
        let [x, y, z, w] = &self.view_from_world;
        let p = splat(position.x, &self.origin) + position;
        mirrored(splat(p.x, x) * p.x + splat(p.x, y) * p.y + splat(p.x, z) * p.z + splat(p.x, w))
    }

    /// A normal on the viewer's side, of unit length; 0 if it has none.
    #[inline(always)]
    fn normal<R: Real>(&self, n: Vector<R>, wo: Vector<R>) -> Vector<R> {
        let zero = n.x.like(0.0);
        let n = n.negate_where(n.dot(wo).lt(zero)).widen();
        let [x, y, z, _] = &self.view_from_world;
        let turned = splat(n.x, x) * n.x + splat(n.x, y) * n.y + splat(n.x, z) * n.z;
        let (n, has_length) = mirrored::<R>(turned).try_normalize();
        Vector::select(has_length, n, Vector::splat(zero, [0.0; 3]))
    }
}

#[inline(always)]
fn splat<F: Float<Scalar = f64>>(like: F, v: &DVec3) -> Vector<F> {
    Vector::splat(like, v.to_array())
}

/// From the view space of the notes to one with x to the right.
#[inline(always)]
fn mirrored<R: Real>(v: Vector<R::Double>) -> Vector<R> {
    Vector::narrow(Vector { x: -v.x, ..v })
}

struct AovKernel<'a> {
    space: &'a CameraSpace,
    surfaces: &'a [FirstSurfaceColumns],
    aovs: &'a mut [AovColumns],
}

impl Kernel for AovKernel<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { space, surfaces, aovs } = self;
        for eight in surfaces {
            let wo = load(simd, &eight.wo);
            let ng = store(space.normal(load(simd, &eight.ng), wo));
            // Most surfaces are not smoothed.
            let ns = match eight.ns == eight.ng {
                true => ng,
                false => store(space.normal(load(simd, &eight.ns), wo)),
            };
            let columns = AovColumns {
                albedo: eight.albedo,
                ng,
                ns,
                position: store::<f32x8<S>>(space.position(load_f64(simd, &eight.position))),
                uv: eight.uv,
                hits: eight.lanes,
            };
            for lane in LaneMask(eight.lanes) {
                let slot = eight.slots[lane] as usize;
                aovs[slot / LANES].set(slot % LANES, &columns.of(lane));
            }
        }
    }
}
