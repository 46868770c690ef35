//! A principled BSDF for one outgoing direction: its lobes.
//!
//! A surface seen from below is mirrored, so that here `wo.z > 0` always and `wi.z < 0` is transmission.

use std::f32::consts::FRAC_1_PI;

use lookfrom_simd::{Float, Mask, Real};

use super::facing::{Facing, Facings};
use super::layers::{Coat, Fibres};
use super::rough_diffuse::{self, RoughDiffuse};
use super::surface::{MEAN_COSINE, Surface};
use super::{Model, Principled};
use crate::core::math::both;
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::shading::bsdf::across;
use crate::shading::bsdf::albedo::{self, Split};

/// A surface with the terms that depend on `wo` alone.
#[derive(Debug)]
pub(super) struct PreparedSurface<R: Real, M> {
    pub(super) wo: Vector<R>,
    pub(super) is_inside: R::Mask,
    pub(super) surface: Surface<R, M>,
    /// The specular albedo along `wo`.
    pub(super) mirror: Split<R>,
    /// The fraction of light along `wo` that the specular layer leaves for the body below.
    left: Spectrum<R>,
    /// Reflected multiple scattering between facets, over the energy that they mask.
    again: Spectrum<R>,
    pub(super) sheen: Option<Fibres<R>>,
    pub(super) coat: Option<Coat<R>>,
    lane_weights: Spectrum<R>,
}

/// The direction above the surface: mirrored at it where it is below.
#[inline(always)]
fn upward<R: Real>(w: Vector<R>) -> Vector<R> {
    Vector { x: w.x, y: w.y, z: Float::abs(w.z) }
}

/// True where light passes through the surface.
#[inline(always)]
pub(super) fn is_below<R: Real>(wi: Vector<R>) -> R::Mask {
    wi.z.lt(wi.z.like(0.0))
}

impl<R: Real, M: Model<R>> PreparedSurface<R, M> {
    #[inline(always)]
    pub(super) fn new(look: &Principled<R, M>, from: Vector<R>) -> Self {
        let is_inside = is_below(from);
        let wo = Vector::select(is_inside, across(from), from);
        let mut surface = Surface::new(look);
        surface.model = M::seen(look, wo);
        let cos = Float::min(wo.z, wo.z.like(1.0));
        let mirror = surface.mirror(wo);
        let black = Spectrum::splat(cos.like(0.0));
        let left = if surface.has_matte().any() { surface.left(cos, mirror) } else { black };
        let mut prepared = Self {
            wo,
            is_inside,
            mirror,
            left,
            again: black,
            sheen: Fibres::new(look, wo, cos),
            coat: Coat::new(look, wo),
            lane_weights: look.lane_weights,
            surface,
        };
        prepared.again = prepared.again();
        prepared
    }

    /// The weight of a coloured lobe in the choice among lobes.
    #[inline(always)]
    pub(super) fn weigh(&self, lobe: Spectrum<R>) -> R {
        let [a, b, c, d] = (lobe * self.lane_weights).0;
        a + b + c + d
    }

    /// Reflected multiple scattering between facets, over the energy that they mask.
    #[inline(always)]
    fn again(&self) -> Spectrum<R> {
        let surface = &self.surface;
        let zero = self.wo.z.like(0.0);
        let mut sum = Spectrum::splat(zero);
        if surface.is_smooth().all() {
            return sum;
        }
        if surface.metal.gt(zero).any() {
            sum += match surface.model.open_pbr() {
                None => self.again_by(surface.base, zero.like(1.0)) * surface.metal,
                Some(open) => {
                    let plain = open.mean_of_metal(surface.base);
                    let reflected = surface.under_film(zero.like(MEAN_COSINE), surface.base, plain);
                    self.again_of(reflected * open.specular_weight) * surface.metal
                }
            };
        }
        if surface.has_matte().any() {
            sum += match surface.model.open_pbr() {
                None => self.again_by(surface.f0, surface.f90) * surface.matte,
                Some(_) => {
                    let plain = surface.gloss(zero.like(1.0 / 21.0));
                    let reflected = surface.under_film(zero.like(MEAN_COSINE), surface.f0, plain);
                    self.again_of(reflected) * surface.matte
                }
            };
        }
        let sheets = R::select(surface.is_solid, zero, surface.glass);
        if sheets.gt(zero).any() {
            let pane = surface.pane(zero.like(MEAN_COSINE), self.is_inside.like(false));
            sum += pane.mirrored * sheets;
        }
        Spectrum::select(surface.is_smooth(), Spectrum::splat(zero), sum)
    }

    /// Light scattered again between the facets of a reflector of which all is made.
    #[inline(always)]
    fn again_by(&self, f0: Spectrum<R>, f90: R) -> Spectrum<R> {
        // Schlick's mean over the hemisphere is F0 + (F90 − F0) / 21; a film's is about its value at 45°.
        let plain = f0 + (Spectrum::splat(f90) - f0) / f90.like(21.0);
        self.again_of(self.surface.under_film(f90.like(MEAN_COSINE), f0, plain))
    }

    /// Light scattered again between facets of a mean reflectance.
    #[inline(always)]
    fn again_of(&self, reflectance: Spectrum<R>) -> Spectrum<R> {
        let mean = self.surface.mean.all();
        reflectance.map(
            #[inline(always)]
            |fresnel| albedo::multiple(fresnel, mean),
        )
    }

    /// Multiple scattering through a thin sheet, likewise.
    #[inline(always)]
    fn again_through(&self) -> Spectrum<R> {
        let surface = &self.surface;
        let zero = self.wo.z.like(0.0);
        let black = Spectrum::splat(zero);
        let scatters = !surface.is_smooth() & surface.has_glass() & !surface.is_solid;
        if !scatters.any() {
            return black;
        }
        let pane = surface.pane(zero.like(MEAN_COSINE), self.is_inside.like(false));
        Spectrum::select(scatters, pane.passed * surface.tint() * surface.glass, black)
    }

    /// [`Self::again`] on a side.
    #[inline(always)]
    fn again_on(&self, through: R::Mask) -> Spectrum<R> {
        if !through.any() {
            return self.again;
        }
        Spectrum::select(through, self.again_through(), self.again)
    }

    /// π f of the nearly uniform lobes on a side, for the other direction (`up`: mirrored where it is below).
    #[inline(always)]
    fn matte(&self, up: Vector<R>, through: R::Mask) -> Spectrum<R> {
        let cos = up.z;
        let surface = &self.surface;
        let (zero, one) = (cos.like(0.0), cos.like(1.0));
        let black = Spectrum::splat(zero);
        let mirror = surface.mirror(up);
        let mut sum = black;
        let hidden = one - surface.mean.all();
        let is_hidden = hidden.gt(zero);
        if is_hidden.any() {
            let both = (one - self.mirror.all()) * (one - mirror.all()) / hidden;
            sum = Spectrum::select(is_hidden, self.again_on(through) * both, black);
        }
        if surface.has_matte().any() {
            sum += self.matte_body(up, mirror, through);
        }
        sum
    }

    /// π f of the diffuse body on a side, for the other direction (`up`) and the albedo of a mirror along it.
    #[inline(always)]
    fn matte_body(&self, up: Vector<R>, mirror: Split<R>, through: R::Mask) -> Spectrum<R> {
        let surface = &self.surface;
        let zero = up.z.like(0.0);
        let left = surface.left(up.z, mirror) * self.left;
        let left = left.zip(
            surface.mean_left,
            #[inline(always)]
            |left, mean| R::select(mean.gt(zero), left / mean, zero),
        );
        let body = match surface.model.open_pbr() {
            Some(open) if rough_diffuse::is_any(open.diffuse_roughness) => {
                self.rough_body(RoughDiffuse::new(open.diffuse_roughness), up, through)
            }
            _ => self.body(through),
        };
        Spectrum::select(surface.has_matte(), left * body, Spectrum::splat(zero))
    }

    /// The albedo of the diffuse body on a side.
    #[inline(always)]
    fn body(&self, through: R::Mask) -> Spectrum<R> {
        let surface = &self.surface;
        let one = surface.leaf.like(1.0);
        let reflected = surface.base * (surface.matte * (one - surface.leaf));
        Spectrum::select(through, surface.leaf_color * (surface.matte * surface.leaf), reflected)
    }

    /// π f of a rough diffuse body on a side, for the other direction.
    #[inline(always)]
    fn rough_body(&self, rough: RoughDiffuse<R>, up: Vector<R>, through: R::Mask) -> Spectrum<R> {
        let surface = &self.surface;
        let one = surface.leaf.like(1.0);
        let color = Spectrum::select(through, surface.leaf_color, surface.base);
        let share = R::select(through, surface.leaf, one - surface.leaf);
        rough.pi_f(color, self.wo, up) * (surface.matte * share)
    }

    /// The albedo of [`Self::matte`].
    #[inline(always)]
    pub(super) fn matte_albedo(&self, through: R::Mask) -> Spectrum<R> {
        let one = self.wo.z.like(1.0);
        self.again_on(through) * (one - self.mirror.all()) + self.left * self.body(through)
    }

    /// The fractions that coat and sheen leave for the surface.
    #[inline(always)]
    pub(super) fn below(&self, wi: Vector<R>) -> (R, R) {
        let one = wi.z.like(1.0);
        let through = is_below(wi);
        let up = upward(wi);
        let coat = match &self.coat {
            None => one,
            Some(coat) => {
                // Transmitted light passes the coat once, outside.
                let of_wi = coat.taken(&self.surface.model, coat.local(up));
                let passing = R::select(self.is_inside, of_wi, coat.taken);
                one - R::select(through, passing, Float::max(coat.taken, of_wi))
            }
        };
        let sheen = match &self.sheen {
            None => one,
            Some(sheen) => match self.surface.model.open_pbr() {
                None => one - Float::max(sheen.taken, sheen.taken(up.z)),
                // Transmitted light passes the fuzz outside.
                Some(_) => one - R::select(through & self.is_inside, sheen.taken(up.z), sheen.taken),
            },
        };
        (coat, sheen)
    }

    /// The transmittance of the layers above for light from `wi`: the fractions that coat and fibres pass, and the
    /// coat's colour.
    #[inline(always)]
    pub(super) fn below_all(&self, wi: Vector<R>) -> Spectrum<R> {
        let (coat, sheen) = self.below(wi);
        self.tinted_by_coat(wi, coat) * sheen
    }

    /// The fraction that the coat passes of light from `wi`, with its colour and its darkening.
    #[inline(always)]
    fn tinted_by_coat(&self, wi: Vector<R>, below: R) -> Spectrum<R> {
        let (Some(open), Some(coat)) = (self.surface.model.open_pbr(), &self.coat) else {
            return Spectrum::splat(below);
        };
        let one = below.like(1.0);
        let through = is_below(wi);
        let [of_wo, of_wi] = both(
            [coat.wo.z, coat.local(upward(wi)).z],
            #[inline(always)]
            |cos| Float::clamp(cos, 0.0, 1.0),
        );
        // Transmitted light passes the coat once, outside.
        let first = R::select(through & self.is_inside, of_wi, of_wo);
        let transmitted = open.coat_transmittance([first, of_wi], !through);
        let bare = one - coat.amount;
        let tint = transmitted * Float::max(below - bare, one.like(0.0)) + Spectrum::splat(bare);
        // What passes does not return to the base.
        let darkened = Spectrum::select(through, Spectrum::splat(one), open.darkened);
        tint * darkened
    }

    /// The index beyond the surface over the one on the side of `wo`.
    #[inline(always)]
    pub(super) fn relative_eta(&self) -> R {
        let surface = &self.surface;
        let one = surface.eta.like(1.0);
        let eta = R::select(self.is_inside, one / surface.eta, surface.eta);
        R::select(surface.is_solid & surface.bends(), eta, one)
    }

    /// As [`crate::shading::bsdf::Bsdf::f`], for `wi` in the mirrored frame and not grazing, by its facets.
    #[inline(always)]
    pub(super) fn f_by(&self, wi: Vector<R>, facets: &Facings<R>) -> Spectrum<R> {
        let zero = wi.z.like(0.0);
        let through = is_below(wi);
        let (below_coat, below_sheen) = self.below(wi);
        let mut f = self.matte(upward(wi), through) * zero.like(FRAC_1_PI);
        f += self.facets_f(wi, facets);
        if self.surface.model.open_pbr().is_some() {
            return self.under_fuzz(f * self.tinted_by_coat(wi, below_coat), wi, below_sheen);
        }
        f = f * below_sheen;
        if let Some(sheen) = &self.sheen
            && !through.all()
        {
            f += Spectrum::select(through, Spectrum::splat(zero), sheen.f(self.wo, wi));
        }
        f = f * below_coat;
        if let Some(coat) = &self.coat
            && !through.all()
        {
            f += Spectrum::splat(R::select(through, zero, coat.f(&self.surface.model, wi)));
        }
        f
    }

    /// The value with the coat's and the fuzz's own, from that of what is below the coat.
    #[inline(always)]
    fn under_fuzz(&self, below: Spectrum<R>, wi: Vector<R>, below_fuzz: R) -> Spectrum<R> {
        let zero = wi.z.like(0.0);
        let through = is_below(wi);
        let mut f = below;
        if let Some(coat) = &self.coat
            && !through.all()
        {
            f += Spectrum::splat(R::select(through, zero, coat.f(&self.surface.model, wi)));
        }
        f = f * below_fuzz;
        if let Some(fuzz) = &self.sheen
            && !through.all()
        {
            f += Spectrum::select(through, Spectrum::splat(zero), fuzz.f(self.wo, wi));
        }
        f
    }

    /// The part of [`Self::f_by`] that the diffuse body and sheen have.
    #[inline(always)]
    pub(super) fn diffuse_f(&self, wi: Vector<R>) -> Spectrum<R> {
        let cos = Float::abs(wi.z);
        let through = is_below(wi);
        let (below_coat, below_sheen) = self.below(wi);
        let mirror = self.surface.mirror(upward(wi));
        let body = self.matte_body(upward(wi), mirror, through);
        if self.surface.model.open_pbr().is_some() {
            let mut f = body * self.below_all(wi) * cos.like(FRAC_1_PI);
            if let Some(fuzz) = &self.sheen {
                f += Spectrum::select(through, Spectrum::splat(cos.like(0.0)), fuzz.f(self.wo, wi));
            }
            return f;
        }
        let mut f = body * (below_sheen * cos.like(FRAC_1_PI));
        if let Some(sheen) = &self.sheen {
            f += Spectrum::select(through, Spectrum::splat(cos.like(0.0)), sheen.f(self.wo, wi));
        }
        f * below_coat
    }

    /// Reflection and transmission by facets.
    #[inline(always)]
    fn facets_f(&self, wi: Vector<R>, facets: &Facings<R>) -> Spectrum<R> {
        let surface = &self.surface;
        let zero = wi.z.like(0.0);
        let black = Spectrum::splat(zero);
        let through = is_below(wi);
        let is_rough_body = surface.is_rough_body();
        let mut sum = black;
        let (first, back) = facets;
        let is_seen = first.exists & !(is_rough_body & through);
        if is_seen.any() {
            // With masking-shadowing by other facets.
            let up = upward(wi);
            let value =
                surface.roughness.d(first.wm) * surface.roughness.g(self.wo, up) / (self.wo.z * 4.0 * up.z);
            let glass = R::select(is_rough_body, zero, surface.glass);
            let facet = surface.facet_with(glass, first.cos, self.is_inside);
            let part = Spectrum::select(through, facet.passed, facet.mirrored);
            sum += Spectrum::select(is_seen, part * value, black);
        }
        let Some(back) = back else { return sum };
        // Without shadowing: all of the light leaves.
        let eta = R::select(through, self.relative_eta(), zero.like(1.0));
        self.add_pane(&mut sum, wi, first, eta);
        self.add_pane(&mut sum, wi, back, eta);
        sum
    }

    /// Adds reflection and transmission by a facet of a rough body.
    #[inline(always)]
    fn add_pane(&self, sum: &mut Spectrum<R>, wi: Vector<R>, facing: &Facing<R>, eta: R) {
        let surface = &self.surface;
        let is_seen = facing.exists & surface.is_rough_body();
        if !is_seen.any() {
            return;
        }
        let pane = surface.pane(facing.cos, self.is_inside);
        let part = Spectrum::select(is_below(wi), pane.passed * surface.tint(), pane.mirrored);
        let value = surface.glass * (facing.density / Float::abs(wi.z) / (eta * eta));
        *sum += Spectrum::select(is_seen, part * value, Spectrum::splat(value.like(0.0)));
    }
}
