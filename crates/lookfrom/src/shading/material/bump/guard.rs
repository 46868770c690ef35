//! The guard of bent normals: light from directions on which the two normals disagree, and shadows of bumps on one another.

use lookfrom_scene::material::BumpGuard;
use lookfrom_simd::{Float, Real};

use crate::core::vector::Vector;

/// The guard of normals that a map has bent, at any width.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Guard<R = f32> {
    /// The shading normal without the map, of unit length.
    pub(crate) ns: Vector<R>,
    /// The square of the roughness α of the bumps that the bent normal stands for; 0 where they cast no shadows.
    pub(crate) alpha_squared: R,
}

impl Guard<f32> {
    /// The guard of the bent normal `n` on a surface with the normal `ns`. An eighth of the bent normal's tan² is the α² of microfacets
    /// of which it is a typical one (Conty Estevez, Lecocq & Stein 2019, "A Microfacet-Based Shadowing Function to Solve the Bump
    /// Terminator Problem").
    pub(crate) fn of(guard: BumpGuard, ns: Vector<f32>, n: Vector<f32>) -> Self {
        let cos = ns.dot(n);
        let alpha_squared = (0.125 * (1.0 - cos * cos).max(0.0) / (cos * cos)).min(1.0);
        Self { ns, alpha_squared: if guard.shadows { alpha_squared } else { 0.0 } }
    }
}

impl<R: Real> Guard<R> {
    /// The share of the light from `wi` that gets to a surface with the bent normal `n`: Smith's masking of Trowbridge–Reitz microfacets,
    /// 2 / (1 + √(1 + α² tan² θ)); nothing, where `wi` is above the surface by one normal and below it by the other.
    #[inline(always)]
    pub(crate) fn lets_through(&self, wi: Vector<R>, n: Vector<R>) -> R {
        let (zero, one) = (self.alpha_squared.like(0.0), self.alpha_squared.like(1.0));
        let cos = wi.dot(self.ns);
        let cos_squared = cos * cos;
        let tan_squared = Float::max(one - cos_squared, zero) / cos_squared;
        let share = one.like(2.0) / (one + Float::sqrt(one + self.alpha_squared * tan_squared));
        R::select((cos * wi.dot(n)).gt(zero), share, zero)
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::shading::material::Bending;

    /// Values of Mitsuba 3.9's `normalmap` over a white diffuse BSDF, times the cosine: `flip_invalid_normals` and
    /// `use_shadowing_function`, the first alone, the second alone.
    #[test]
    fn values_are_mitsubas() {
        for (n, wo, wi, expected) in [
            ([0.5, 0.2, 1.0], [0.3, -0.4, 0.8], [-0.2, 0.6, 0.7], [0.212_331_7, 0.213_891_1, 0.212_331_7]),
            ([1.0, 1.0, 1.0], [-1.0, -1.0, 0.5], [0.1, 0.2, 1.0], [0.125_153_2, 0.125_543_1, 0.0]),
            ([1.0, 1.0, 1.0], [-1.0, -1.0, 0.5], [1.0, 0.2, 0.3], [0.0; 3]),
            ([2.0, 0.0, 1.0], [1.0, 0.1, 0.4], [0.9, 0.5, 0.2], [0.113_700_7, 0.271_455_6, 0.113_700_7]),
            ([2.0, 0.0, 1.0], [1.0, 0.1, 0.4], [-0.9, 0.5, 0.3], [0.0; 3]),
            ([0.3, 0.3, 1.0], [0.2, 0.1, 0.9], [0.2, 0.1, -0.5], [0.0; 3]),
        ] {
            let [n, wo, wi] = [n, wo, wi].map(|v| Vec3::from(v).normalize());
            for ((turns, shadows), expected) in
                [(true, true), (true, false), (false, true)].into_iter().zip(expected)
            {
                let [x, y, z] = [Vec3::X, Vec3::Y, Vec3::Z].map(Vector::from);
                let bending = Bending { ng_facing: z, facing: 1.0, ns: z, dpdu: x, dpdv: y, wo: wo.into() };
                let n: Vec3 = bending.limited(n.into(), false, turns).into();
                let guard = Guard::of(BumpGuard { turns, shadows }, Vec3::Z.into(), n.into());
                // Diffuse surfaces are black from behind there.
                let f = if wo.dot(n) > 0.0 { wi.dot(n).max(0.0) / std::f32::consts::PI } else { 0.0 };
                let value = f * guard.lets_through(wi.into(), n.into());
                assert!((value - expected).abs() < 1e-6, "{n} {wo} {wi}: {value}, not {expected}");
            }
        }
    }

    #[test]
    fn light_in_the_surface_is_no_light() {
        let guard = Guard { ns: Vec3::Z.into(), alpha_squared: 1.0 };
        for z in [0.0, 1e-20, 1e-30, -1e-20] {
            let share = guard.lets_through(Vec3::new(1.0, 0.0, z).into(), Vec3::Z.into());
            assert!((0.0..1e-6).contains(&share), "{z}: {share}");
        }
    }
}
