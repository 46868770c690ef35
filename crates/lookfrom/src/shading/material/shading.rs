//! The BSDF of a material at a point, in a shading frame.

use glam::Vec3;
use lookfrom_scene::material::BackFace;

use super::{Guard, Material, bump};
use crate::core::points::Lift;
use crate::core::spectrum::Spectrum;
use crate::shading::bsdf::lanes::LaneBsdf;
use crate::shading::bsdf::{Bsdf, MicrofacetFactors};
use crate::shading::interaction::SurfaceInteraction;

/// A BSDF at a point, with its shading frame.
#[derive(Clone, Copy, Debug)]
pub struct Shading {
    /// In the local frame.
    pub bsdf: Bsdf,
    frame: Frame,
    /// The geometric normal to the outside, to prevent light leaks where the shading normal differs from it.
    ng: Vec3,
    /// The smooth surface that the mesh stands for.
    lift: Option<Lift<f32>>,
    /// The guard of a bent normal.
    guard: Option<Guard>,
    /// Whether the surface is black from behind.
    is_one_sided: bool,
}

/// An orthonormal frame of unit vectors in render space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    pub(super) s: Vec3,
    pub(super) t: Vec3,
    pub(super) n: Vec3,
}

impl Frame {
    pub(super) fn local(&self, v: Vec3) -> Vec3 {
        Vec3::new(v.dot(self.s), v.dot(self.t), v.dot(self.n))
    }

    pub(super) fn render(&self, v: Vec3) -> Vec3 {
        v.x * self.s + v.y * self.t + v.z * self.n
    }

    pub(super) fn axes(&self) -> [[f32; 3]; 3] {
        [self.s, self.t, self.n].map(|axis| axis.to_array())
    }

    /// The frame with the first axis turned toward a direction.
    pub(super) fn along(&self, direction: Vec3) -> Self {
        bump::around(self.n, direction)
    }
}

impl Shading {
    /// A matte surface without bump mapping.
    pub fn matte(surface: &SurfaceInteraction, reflectance: Spectrum) -> Self {
        Self::plain(surface, Bsdf::diffuse(reflectance))
    }

    /// A BSDF at a surface without bump mapping.
    pub(crate) fn plain(surface: &SurfaceInteraction, bsdf: Bsdf) -> Self {
        Self::with_frame(surface, bump::plain(&surface.shading_geometry()), bsdf)
    }

    /// The BSDF of a material at a surface in the frame of these axes, the third of which is the shading normal, with the guard of that.
    pub(crate) fn in_frame(
        material: &Material,
        surface: &SurfaceInteraction,
        axes: [[f32; 3]; 3],
        guard: Option<Guard>,
        bsdf: Bsdf,
    ) -> Self {
        let [s, t, n] = axes.map(Vec3::from);
        Self { guard, ..Self::of(material, surface, Frame { s, t, n }, bsdf) }
    }

    /// The BSDF of a material at a surface, in a frame.
    pub(super) fn of(material: &Material, surface: &SurfaceInteraction, frame: Frame, bsdf: Bsdf) -> Self {
        let guard = material.guard(surface.ns, frame.n);
        let is_one_sided = material.back_face == BackFace::Black;
        Self { guard, is_one_sided, ..Self::with_frame(surface, frame, bsdf) }
    }

    /// A BSDF at a surface in a frame, without a guard, that is seen from both sides.
    fn with_frame(surface: &SurfaceInteraction, frame: Frame, bsdf: Bsdf) -> Self {
        let (ng, lift) = (surface.ng.as_vec3(), surface.lift());
        Self { bsdf, frame, ng, lift, guard: None, is_one_sided: false }
    }

    /// The shading normal to the outside, unit length.
    pub fn n(&self) -> Vec3 {
        self.frame.n
    }

    /// The axes of the shading frame; the third is the shading normal.
    pub(crate) fn axes(&self) -> [[f32; 3]; 3] {
        self.frame.axes()
    }

    /// The cosine of the angle between a unit direction and the shading normal.
    pub fn cos(&self, w: Vec3) -> f32 {
        w.dot(self.frame.n)
    }

    /// The guard of its normal, if that is bent.
    pub(crate) fn guard(&self) -> Option<&Guard> {
        self.guard.as_ref()
    }

    /// Whether the surface is black in the direction `wo`, in render space.
    pub(crate) fn is_black_toward(&self, wo: Vec3) -> bool {
        self.is_one_sided && self.cos(wo) <= 0.0
    }

    /// True if the geometric and the shading normal agree whether two directions are on one side. pbrt's materials
    /// do without this test.
    fn agrees(&self, wo: Vec3, wi: Vec3) -> bool {
        let on_one_side = |n: Vec3| wo.dot(n) * wi.dot(n) > 0.0;
        let is_above = || self.lift.is_some_and(|lift| lift.is_above(wi.into()));
        !matches!(self.bsdf, Bsdf::Principled(_) | Bsdf::OpenPbr(_))
            || (on_one_side(self.ng) || is_above()) == on_one_side(self.frame.n)
    }

    /// The factors of its microfacets for two unit directions in render space ([`Bsdf::factors`]), with ω_m there.
    pub fn factors(&self, wo: Vec3, wi: Vec3, is_specular: bool) -> Vec<MicrofacetFactors> {
        let [wo, wi] = [wo, wi].map(|w| self.frame.local(w));
        let mut all = self.bsdf.factors(wo, wi, is_specular);
        all.iter_mut().for_each(|factors| factors.wm = self.frame.render(factors.wm));
        all
    }

    /// The BSDF for a fixed outgoing direction `wo` as a function of the incident one, without a cosine. Both have unit
    /// length and are in render space.
    pub fn f_toward(&self, wo: Vec3) -> impl Fn(Vec3) -> Spectrum {
        let prepared = self.bsdf.prepare(self.frame.local(wo).into());
        move |wi| match self.agrees(wo, wi) && !self.is_black_toward(wo) {
            true => {
                let f = LaneBsdf::f(&self.bsdf, &prepared, self.frame.local(wi).into());
                self.guard.map_or(f, |guard| f * guard.lets_through(wi.into(), self.frame.n.into()))
            }
            false => Spectrum::BLACK,
        }
    }
}
