//! Area lights that are sampled in lanes: triangles and whole spheres of uniform emission.

use lookfrom_simd::{Simd, f32x8, f64x8, mask32x8, mask64x8, prelude::*};

use super::{
    AreaLight, AreaSamples, LightShape, LightTriangle, SphereLights, gather_spheres, sample_triangles,
};
use crate::core::lanes::{LANES, bitmask, by_lane};
use crate::core::vector::Vector;

impl AreaLight {
    /// Whether all points of it are sampled in lanes.
    pub(crate) fn is_in_lanes(&self) -> bool {
        self.is_uniform()
            && match &self.shape {
                LightShape::Mesh(light) => light.has_one_normal_per_triangle(),
                LightShape::Quadric(light) => light.sphere().is_some(),
                _ => false,
            }
    }

    /// The triangle that `u0` chooses, its probability, and the remapped `u0`; only for meshes of uniform emission.
    #[inline]
    fn triangle(&self, u0: f32) -> Option<(&LightTriangle, f32, f32)> {
        match &self.shape {
            LightShape::Mesh(light) if self.is_uniform() => light.triangle(u0),
            _ => None,
        }
    }

    /// The whole sphere that it is, which is sampled by direction; only one of uniform emission.
    #[inline]
    fn sphere(&self) -> Option<&SphereLights<f32>> {
        match &self.shape {
            LightShape::Quadric(light) if self.is_uniform() => light.sphere(),
            _ => None,
        }
    }
}

/// Points of the area lights that are sampled in lanes, and which those are: triangles and whole spheres of uniform
/// emission.
#[inline(always)]
pub(crate) fn sample_area_lights<S: Simd>(
    simd: S,
    lights: &[Option<&AreaLight>; LANES],
    [u0, u1]: [f32x8<S>; 2],
    from: Vector<f64x8<S>>,
) -> (Option<AreaSamples<f32x8<S>>>, u32) {
    let triangles = by_lane!(lane => lights[lane].and_then(|light| light.triangle(u0[lane])));
    let (mut samples, mut in_lanes) = (None, 0);
    if let Some((first, ..)) = triangles.iter().flatten().next() {
        let of = by_lane!(lane => triangles[lane].map_or(*first, |(triangle, ..)| triangle));
        let probability = by_lane!(lane => triangles[lane].map_or(1.0, |(_, probability, _)| probability));
        let rest = by_lane!(lane => triangles[lane].map_or(0.0, |(_, _, rest)| rest));
        let [probability, rest] = [f32x8::load_array(simd, probability), f32x8::load_array(simd, rest)];
        samples = Some(sample_triangles(simd, &of, probability, [rest, u1], from));
        in_lanes = bitmask(&by_lane!(lane => triangles[lane].is_some()));
    }
    let spheres = by_lane!(lane => lights[lane].and_then(AreaLight::sphere));
    if let Some(first) = spheres.iter().flatten().next() {
        let of = gather_spheres(simd, &by_lane!(lane => spheres[lane].unwrap_or(first)));
        let (on_spheres, _) = of.sample(from, [u0, u1]);
        let are_spheres = bitmask(&by_lane!(lane => spheres[lane].is_some()));
        let masks = (
            mask32x8::from_bitmask(simd, are_spheres.into()),
            mask64x8::from_bitmask(simd, are_spheres.into()),
        );
        samples = Some(match samples {
            Some(samples) => AreaSamples::select(masks.0, masks.1, on_spheres, samples),
            None => on_spheres,
        });
        in_lanes |= are_spheres;
    }
    (samples, in_lanes)
}
