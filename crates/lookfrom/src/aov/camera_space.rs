//! Camera space, that of AOVs: from surfaces in render space, one by one or eight side by side.

use glam::{DMat4, DVec3, Vec3};
use lookfrom_simd::{Float, Kernel, LaneMask, Real, Simd, dispatch, f32x8, level};

use super::{AovColumns, Aovs, FirstSurfaceColumns};
use crate::core::lanes::{LANES, load, load_f64, store};
use crate::core::vector::Vector;
use crate::medium::{Cover, Way};
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::interior_stack::InteriorStack;
use crate::shading::material;
use crate::world::World;

/// The map from render space to camera space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CameraSpace {
    /// The axes of the view space of the notes, in which x is to the left, and its translation.
    view_from_world: [DVec3; 4],
    /// The origin of render space.
    origin: DVec3,
    /// The bodies and the medium that the camera is in, if light is scattered in media.
    pub(super) media: Option<InteriorStack>,
}

impl CameraSpace {
    /// The space of a camera, by its view space and the origin of render space, and the bodies and the medium that it is in, of a picture
    /// with media that scatter or emit light.
    pub(crate) fn new(world_from_view: DMat4, origin: DVec3, media: Option<InteriorStack>) -> Self {
        let view_from_world = world_from_view.inverse();
        let [x, y, z, w] = std::array::from_fn(|column| view_from_world.col(column).truncate());
        Self { view_from_world: [x, y, z, w], origin, media }
    }

    /// The AOVs of a medium, as it covers a way. Its shading normal faces the camera: so it differs from what surrounds it, which is white
    /// and without a normal.
    pub(super) fn aovs_of_medium(&self, cover: &Cover, way: &Way) -> Aovs {
        let point = (way.origin + way.direction * cover.distance).as_dvec3().to_array();
        let position: [f32; 3] = self.position::<f32>(Vector::from(point)).into();
        let ns = -Vec3::from(position).normalize_or_zero();
        Aovs { albedo: cover.albedo.to_array(), ns: ns.to_array(), position, ..Aovs::default() }
    }

    /// The AOVs of a surface interaction, with its albedo where that is known.
    pub(super) fn aovs(&self, world: &World, surface: &SurfaceInteraction, albedo: Option<[f32; 3]>) -> Aovs {
        let World { materials, textures, .. } = world;
        let point = world.shading_point(surface);
        let ns = material::normal(materials, world.relief(), surface, &point);
        let [ng, ns] = [surface.ng.as_vec3(), ns]
            .map(|n| self.normal(Vector::from(n.to_array()), Vector::from(surface.wo.to_array())).into());
        let albedo = albedo.unwrap_or_else(|| {
            material::albedo(materials, textures, &materials[surface.material as usize], &point)
        });
        let position = self.position::<f32>(Vector::from(surface.point.position)).into();
        Aovs { albedo, ng, ns, position, uv: surface.uv.to_array() }
    }

    /// Sets the AOVs of a block of surfaces, by slot.
    #[inline(never)]
    pub(super) fn set_aovs(&self, surfaces: &FirstSurfaceColumns, aovs: &mut [AovColumns]) {
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
    surfaces: &'a FirstSurfaceColumns,
    /// By slot.
    aovs: &'a mut [AovColumns],
}

impl Kernel for AovKernel<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { space, surfaces, aovs } = self;
        let wo = load(simd, &surfaces.wo);
        let ng = store(space.normal(load(simd, &surfaces.ng), wo));
        // Most surfaces are not smoothed.
        let ns = match surfaces.ns == surfaces.ng {
            true => ng,
            false => store(space.normal(load(simd, &surfaces.ns), wo)),
        };
        let columns = AovColumns {
            albedo: surfaces.albedo,
            ng,
            ns,
            position: store::<f32x8<S>>(space.position(load_f64(simd, &surfaces.position))),
            uv: surfaces.uv,
            hits: surfaces.lanes,
        };
        for lane in LaneMask(surfaces.lanes) {
            let slot = surfaces.slots[lane] as usize;
            aovs[slot / LANES].set(slot % LANES, &columns.of(lane));
        }
    }
}
