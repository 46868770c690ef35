//! Area lights in lanes agree with area lights one by one.

use std::sync::Arc;

use glam::{DMat3, DMat4, DVec3};
use lookfrom_simd::{Kernel, Level, Simd, dispatch, f32x8, prelude::*};

use super::{
    AreaSamples, DiskLight, DiskLights, LightPoint, MeshLight, QuadricLight, SphereLights, gather_disks,
    gather_spheres, sample_triangles,
};
use crate::core::hash;
use crate::core::lanes::{LANES, by_lane, gather_f64, scatter, scatter_f64};
use crate::primitive::{Disk, MaterialBinding, Mesh, Quadric, QuadricKind};

/// The numbers of a sample: direction, density, position, error, normal.
type Numbers = Option<([f32; 3], f32, [[f64; 3]; 3])>;

/// A number of any exponent from 2⁻⁸ to 2⁸.
fn number(count: u64) -> f64 {
    let bits = hash::pair(count, 21);
    let mantissa = (bits >> 40) as f64 / 16_777_216.0 - 0.5;
    mantissa * libm::exp2((bits % 17) as f64 - 8.0)
}

fn vector(count: u64) -> [f64; 3] {
    [number(4 * count), number(4 * count + 1), number(4 * count + 2)]
}

fn unit(count: u64) -> f32 {
    (hash::pair(count, 22) >> 40) as f32 / 16_777_216.0
}

fn one(sample: Option<LightPoint>) -> Numbers {
    let LightPoint { point, normal, wi, pdf, .. } = sample.filter(|at| at.pdf.is_finite() && at.pdf > 0.0)?;
    Some((wi.to_array(), pdf, [point.position, point.error, normal.to_array()]))
}

#[inline(always)]
fn eight<S: Simd>(samples: AreaSamples<f32x8<S>>) -> [Numbers; LANES] {
    let AreaSamples { points, normal, wi, pdf, is_valid } = samples;
    let (wi, vectors) = (scatter(wi), [points.position, points.error, normal].map(scatter_f64));
    std::array::from_fn(|lane| {
        let is_valid = is_valid.to_bitmask() & 1 << lane != 0;
        is_valid.then(|| (wi[lane], pdf[lane], vectors.map(|vector| vector[lane])))
    })
}

fn check(kernel: impl Fn(Level) -> [Numbers; LANES], alone: &[Numbers; LANES]) {
    let mut levels = vec![Level::baseline(), Level::new()];
    #[cfg(target_arch = "x86_64")]
    levels.extend(Level::new().as_avx2().map(Level::Avx2));
    for level in levels {
        assert_eq!(&kernel(level), alone);
    }
}

struct OnTriangles<'a> {
    lights: &'a [MeshLight; LANES],
    from: [[f64; 3]; LANES],
    u: [[f32; LANES]; 2],
}

impl Kernel for OnTriangles<'_> {
    type Output = [Numbers; LANES];
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let chosen = by_lane!(lane => self.lights[lane].triangle(self.u[0][lane]).expect("one normal"));
        let probability = f32x8::load_array(simd, by_lane!(lane => chosen[lane].1));
        let u = [by_lane!(lane => chosen[lane].2), self.u[1]].map(|u| f32x8::load_array(simd, u));
        let of = by_lane!(lane => chosen[lane].0);
        eight(sample_triangles(simd, &of, probability, u, gather_f64(simd, &self.from)))
    }
}

struct OnSpheres<'a> {
    spheres: [&'a SphereLights<f32>; LANES],
    from: [[f64; 3]; LANES],
    u: [[f32; LANES]; 2],
}

impl Kernel for OnSpheres<'_> {
    type Output = [Numbers; LANES];
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let u = self.u.map(|u| f32x8::load_array(simd, u));
        let (samples, _) = gather_spheres(simd, &self.spheres).sample(gather_f64(simd, &self.from), u);
        eight(samples)
    }
}

struct OnDisks<'a> {
    disks: [&'a DiskLights<f32>; LANES],
    from: [[f64; 3]; LANES],
    u: [[f32; LANES]; 2],
}

impl Kernel for OnDisks<'_> {
    type Output = [Numbers; LANES];
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let u = self.u.map(|u| f32x8::load_array(simd, u));
        eight(gather_disks(simd, &self.disks).sample(gather_f64(simd, &self.from), u).0)
    }
}

#[test]
fn eight_triangles_are_eight_one_by_one() {
    let light = |seed: u64| {
        let mesh = Mesh {
            positions: (0..4).map(|k| vector(4 * seed + k).map(|x| x as f32)).collect(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            normals: Vec::new(),
            uvs: Vec::new(),
            colors: Vec::new(),
            tangents: Vec::new(),
            more_uvs: Vec::new(),
            opacities: Vec::new(),
            wants_derivatives: false,
            flip: seed.is_multiple_of(2),
            is_lifted: false,
            later: Vec::new(),
            binding: MaterialBinding::NONE,
        };
        MeshLight::new(Arc::new(mesh)).expect("an area")
    };
    for round in 0..2000_u64 {
        let seed = |lane: usize| 8 * round + lane as u64;
        let lights: [MeshLight; LANES] = std::array::from_fn(|lane| light(seed(lane)));
        let from = std::array::from_fn(|lane| vector(seed(lane) + 1_000_000));
        let u: [[f32; LANES]; 2] =
            std::array::from_fn(|k| std::array::from_fn(|lane| unit(2 * seed(lane) + k as u64)));
        let alone = std::array::from_fn(|lane| {
            one(lights[lane].sample(DVec3::from_array(from[lane]), [u[0][lane], u[1][lane]]))
        });
        check(|level| dispatch(level, OnTriangles { lights: &lights, from, u }), &alone);
    }
}

#[test]
fn eight_spheres_are_eight_one_by_one() {
    let light = |seed: u64| {
        let radius = number(seed).abs();
        let axes = DMat3::from_cols_array_2d(&[vector(3 * seed), vector(3 * seed + 1), vector(3 * seed + 2)]);
        let matrix = DMat4::from_translation(DVec3::from_array(vector(seed + 77))) * DMat4::from_mat3(axes);
        let kind = QuadricKind::Sphere { radius, z: [-radius, radius] };
        let quadric = Quadric::new(kind, 360.0, &matrix, seed.is_multiple_of(3))?;
        QuadricLight::new(quadric, seed.is_multiple_of(2))
    };
    let mut lights = (0_u64..).filter_map(light);
    for round in 0..2000_u64 {
        let seed = |lane: usize| 8 * round + lane as u64;
        let lights: [QuadricLight; LANES] = std::array::from_fn(|_| lights.next().expect("more"));
        let from = std::array::from_fn(|lane| vector(seed(lane) + 2_000_000));
        let u: [[f32; LANES]; 2] =
            std::array::from_fn(|k| std::array::from_fn(|lane| unit(2 * seed(lane) + k as u64)));
        let alone = std::array::from_fn(|lane| {
            one(lights[lane].sample(DVec3::from_array(from[lane]), [u[0][lane], u[1][lane]]))
        });
        let spheres = std::array::from_fn(|lane| lights[lane].sphere().expect("whole"));
        check(|level| dispatch(level, OnSpheres { spheres, from, u }), &alone);
    }
}

/// A disk as a quadric of any transform.
fn quadric_disk(seed: u64) -> Option<Quadric> {
    let axes = DMat3::from_cols_array_2d(&[vector(3 * seed), vector(3 * seed + 1), vector(3 * seed + 2)]);
    let matrix = DMat4::from_translation(DVec3::from_array(vector(seed + 77))) * DMat4::from_mat3(axes);
    let kind = QuadricKind::Disk { height: number(seed + 5), radius: number(seed).abs(), inner_radius: 0.0 };
    Quadric::new(kind, 360.0, &matrix, seed.is_multiple_of(3))
}

#[test]
fn eight_disks_are_eight_one_by_one() {
    let mut quadrics = (0_u64..).filter_map(|seed| QuadricLight::new(quadric_disk(seed)?, false));
    let disk = |seed: u64| {
        let [center, axis_u, axis_v] = [0, 1, 2].map(|k| DVec3::from_array(vector(3 * seed + k)));
        DiskLight::new(Disk { center, axis_u, axis_v, flip: seed.is_multiple_of(2) })
    };
    let mut disks = (0_u64..).filter_map(disk);
    for round in 0..2000_u64 {
        let seed = |lane: usize| 8 * round + lane as u64;
        let quadrics: [QuadricLight; LANES] = std::array::from_fn(|_| quadrics.next().expect("more"));
        let disks: [DiskLight; LANES] = std::array::from_fn(|_| disks.next().expect("more"));
        let from = std::array::from_fn(|lane| vector(seed(lane) + 2_000_000));
        let u: [[f32; LANES]; 2] =
            std::array::from_fn(|k| std::array::from_fn(|lane| unit(2 * seed(lane) + k as u64)));
        let alone = std::array::from_fn(|lane| {
            let (from, u) = (DVec3::from_array(from[lane]), [u[0][lane], u[1][lane]]);
            one(if lane % 2 == 0 { quadrics[lane].sample(from, u) } else { disks[lane].sample(from, u) })
        });
        let disks = std::array::from_fn(|lane| match lane % 2 {
            0 => quadrics[lane].disk().expect("whole"),
            _ => disks[lane].in_lanes(),
        });
        check(|level| dispatch(level, OnDisks { disks, from, u }), &alone);
    }
}

#[test]
fn samples_of_whole_disks_are_points_of_the_quadric() {
    let mut count = 0;
    for seed in 0..4000 {
        let Some(quadric) = quadric_disk(seed) else { continue };
        let Some(light) = QuadricLight::new(quadric, true) else { continue };
        let (from, u) = (DVec3::from_array(vector(seed + 9)), [unit(2 * seed), unit(2 * seed + 1)]);
        let Some(sample) = light.sample(from, u) else { continue };
        let at = quadric.point(quadric.sample_in_object(u), MaterialBinding::NONE);
        let (point, expected) = (sample.point.position, at.point.position);
        for axis in 0..3 {
            let bound = sample.point.error[axis] + at.point.error[axis];
            assert!((point[axis] - expected[axis]).abs() <= bound, "{point:?} {expected:?} {bound:e}");
        }
        assert!(sample.normal.distance(at.ng) < 1e-9, "{} {}", sample.normal, at.ng);
        let way = DVec3::from_array(expected) - from;
        let pdf = way.length_squared() / (light.area() * at.ng.dot(way.normalize()).abs());
        let [pdf, own] = [pdf as f32, sample.pdf];
        assert!((own / pdf - 1.0).abs() < 1e-3 || at.ng.dot(way.normalize()).abs() < 1e-3, "{own} {pdf}");
        count += 1;
    }
    assert!(count > 2000, "{count}");
}
