//! Area lights that are sampled in lanes: triangles, whole spheres and whole disks of uniform emission.

use lookfrom_simd::{Simd, f32x8, f64x8, mask32x8, mask64x8, prelude::*};

use super::{
    AreaLight, AreaSamples, DiskLights, LightShape, LightTriangle, SphereLights, gather_disks,
    gather_spheres, sample_triangles,
};
use crate::core::lanes::{LANES, bitmask, by_lane};
use crate::core::vector::Vector;

impl AreaLight {
    /// Whether all points of it are sampled in lanes.
    pub(crate) fn is_in_lanes(&self) -> bool {
        self.is_uniform()
            && match &self.shape {
                LightShape::Mesh(light) => light.has_one_normal_per_triangle(),
                LightShape::Quadric(light) => light.sphere().is_some() || light.disk().is_some(),
                LightShape::Disk(_) => true,
                LightShape::Patches(_) => false,
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

    /// The whole disk that it is; only one of uniform emission.
    #[inline]
    fn disk(&self) -> Option<&DiskLights<f32>> {
        match &self.shape {
            LightShape::Quadric(light) if self.is_uniform() => light.disk(),
            LightShape::Disk(light) if self.is_uniform() => Some(light.in_lanes()),
            _ => None,
        }
    }
}

/// Points of the area lights that are sampled in lanes, and which those are: triangles, whole spheres and whole disks of
/// uniform emission.
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
        let lanes = bitmask(&by_lane!(lane => spheres[lane].is_some()));
        samples = Some(chosen(simd, lanes, of.sample(from, [u0, u1]).0, samples));
        in_lanes |= lanes;
    }
    let disks = by_lane!(lane => lights[lane].and_then(AreaLight::disk));
    if let Some(first) = disks.iter().flatten().next() {
        let of = gather_disks(simd, &by_lane!(lane => disks[lane].unwrap_or(first)));
        let lanes = bitmask(&by_lane!(lane => disks[lane].is_some()));
        samples = Some(chosen(simd, lanes, of.sample(from, [u0, u1]).0, samples));
        in_lanes |= lanes;
    }
    (samples, in_lanes)
}

/// `these` in the lanes of a mask, `others` elsewhere.
#[inline(always)]
fn chosen<S: Simd>(
    simd: S,
    lanes: u32,
    these: AreaSamples<f32x8<S>>,
    others: Option<AreaSamples<f32x8<S>>>,
) -> AreaSamples<f32x8<S>> {
    let Some(others) = others else { return these };
    let mask = mask32x8::from_bitmask(simd, lanes.into());
    let wide_mask = mask64x8::from_bitmask(simd, lanes.into());
    AreaSamples::select(mask, wide_mask, these, others)
}
