#![no_main]
//! Any bits as coordinates: every tree is valid and every question answered. Where sizes and distances are within 2⁴⁰ of one
//! another, all trees and all questions agree to the last bit. (A sphere of 10⁻¹¹ seen from 10³⁴ away is noise even in f64.)

use lookfrom_bvh::{Builder, Bvh, Hit, Quality, Ray, Sphere, Triangles};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let (&[split, mode, ..], numbers) = (bytes, bytes.as_chunks::<4>().0) else { return };
    let is_tame = mode % 4 != 0;
    let number = |bytes: &[u8; 4]| {
        let wild = f32::from_le_bytes(*bytes);
        if is_tame { tame(wild) } else { wild }
    };
    let points: Vec<[f32; 3]> = numbers.iter().map(number).collect::<Vec<_>>().as_chunks().0.to_vec();
    if points.len() > 256 {
        return;
    }
    let (geometry, rays) = points.split_at(usize::from(split).min(points.len()));
    let build = |quality| {
        let mut builder = Builder::new();
        builder.quality(quality);
        let corners = geometry.len() as u32 / 3 * 3;
        let indices: Vec<[u32; 3]> = (0..corners / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        builder.triangles(Triangles { positions: geometry, indices: &indices });
        let spheres = geometry.iter().step_by(5).map(|&center| Sphere { center, radius: center[0] });
        builder.spheres(&spheres.collect::<Vec<_>>());
        builder.build().expect("indices are in range")
    };
    let trees: [Bvh; 3] = [Quality::Fast, Quality::Balanced, Quality::Best].map(build);
    for tree in &trees {
        tree.validate().expect("a valid tree");
    }
    for pair in rays.as_chunks::<2>().0 {
        let ray = Ray::new(pair[0], pair[1]);
        let mut all = Vec::new();
        trees[0].query().all_hits(&ray, &mut all);
        if !is_tame {
            trees.iter().for_each(|tree| _ = (tree.closest_hit(&ray), tree.occluded(&ray)));
            continue;
        }
        assert!(all.is_sorted_by(|a, b| a.t <= b.t), "sorted by t");
        let nearest = all.first().copied().unwrap_or(Hit::MISS);
        for tree in &trees {
            assert_eq!(tree.closest_hit(&ray), nearest, "the nearest of all hits");
            assert_eq!(tree.occluded(&ray), nearest.is_hit());
            let mut same = Vec::new();
            tree.query().all_hits(&ray, &mut same);
            assert_eq!(same, all, "whatever the tree");
        }
    }
});

/// The same sign and digits, with an exponent between −20 and 20; zero stays zero.
fn tame(x: f32) -> f32 {
    let bits = x.to_bits();
    let exponent = 107 + (bits >> 23 & 0xff) % 41;
    if x == 0.0 { x } else { f32::from_bits(bits & 0x807f_ffff | exponent << 23) }
}
