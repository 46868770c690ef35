//! Area lights that are sampled in lanes: triangles, whole spheres and whole disks of uniform emission.

use lookfrom_simd::{Simd, f32x8, f64x8, mask32x8, mask64x8, prelude::*};

use super::{
    AreaLight, AreaSamples, DiskLights, LightShape, LightTriangle, MeshLight, SphereLights, gather_disks,
    gather_spheres, sample_triangles,
};
use crate::core::lanes::{LANES, bitmask, by_lane};
use crate::core::vector::Vector;

/// The shapes that the lanes sample.
struct Chosen<'a> {
    triangles: [Option<&'a LightTriangle>; LANES],
    /// The probabilities of the triangles, and what is left of the numbers that chose them.
    probability: [f32; LANES],
    rest: [f32; LANES],
    spheres: [Option<&'a SphereLights<f32>>; LANES],
    disks: [Option<&'a DiskLights<f32>>; LANES],
}

impl<'a> Chosen<'a> {
    #[inline(always)]
    fn new(lights: &[Option<&'a AreaLight>; LANES], u0: &[f32; LANES]) -> Self {
        let mut chosen = Self {
            triangles: [None; LANES],
            probability: [1.0; LANES],
            rest: [0.0; LANES],
            spheres: [None; LANES],
            disks: [None; LANES],
        };
        for (lane, light) in lights.iter().enumerate() {
            let Some(light) = light.filter(|light| light.is_uniform()) else { continue };
            match &light.shape {
                LightShape::Mesh(mesh) => {
                    if let Some((triangle, probability, rest)) = mesh.triangle(u0[lane]) {
                        chosen.triangles[lane] = Some(triangle);
                        (chosen.probability[lane], chosen.rest[lane]) = (probability, rest);
                    }
                }
                LightShape::Quadric(quadric) => {
                    (chosen.spheres[lane], chosen.disks[lane]) = (quadric.sphere(), quadric.disk());
                }
                LightShape::Disk(disk) => chosen.disks[lane] = Some(disk.in_lanes()),
                LightShape::Patches(_) | LightShape::Curves(_) => {}
            }
        }
        chosen
    }
}

/// The mesh of uniform emission that is the only light in all lanes that have one.
#[inline(always)]
fn only_mesh<'a>(lights: &[Option<&'a AreaLight>; LANES]) -> Option<&'a MeshLight> {
    let first = *lights.iter().flatten().next()?;
    let LightShape::Mesh(mesh) = &first.shape else { return None };
    let are_same = bitmask(&by_lane!(lane => lights[lane].is_none_or(|light| std::ptr::eq(light, first))));
    (are_same == (1 << LANES) - 1 && first.is_uniform()).then_some(mesh)
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
    // Most often all lanes sample one mesh.
    if let Some(mesh) = only_mesh(lights)
        && let Some((of, probability, rest)) = mesh.triangles(simd, u0)
    {
        let lanes = bitmask(&by_lane!(lane => lights[lane].is_some()));
        return (Some(sample_triangles(simd, &of, probability, [rest, u1], from)), lanes);
    }
    let Chosen { triangles, probability, rest, spheres, disks } = Chosen::new(lights, &u0.into());
    let (mut samples, mut in_lanes) = (None, 0);
    if let Some(first) = triangles.iter().flatten().next() {
        let of = by_lane!(lane => triangles[lane].unwrap_or(first));
        let [probability, rest] = [f32x8::load_array(simd, probability), f32x8::load_array(simd, rest)];
        samples = Some(sample_triangles(simd, &of, probability, [rest, u1], from));
        in_lanes = bitmask(&by_lane!(lane => triangles[lane].is_some()));
    }
    if let Some(first) = spheres.iter().flatten().next() {
        let of = gather_spheres(simd, &by_lane!(lane => spheres[lane].unwrap_or(first)));
        let lanes = bitmask(&by_lane!(lane => spheres[lane].is_some()));
        samples = Some(chosen(simd, lanes, of.sample(from, [u0, u1]).0, samples));
        in_lanes |= lanes;
    }
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
