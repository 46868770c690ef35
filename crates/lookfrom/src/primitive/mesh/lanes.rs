//! Triangles of eight meshes side by side, and points on them.

use lookfrom_bvh::Hit;
use lookfrom_simd::{LaneMask, Simd, f32x4, f32x8, f64x8, mask64x8, prelude::*};

use super::Mesh;
use crate::core::lanes::{LANES, bitmask, by_lane, from_rows, load, row_at, set_row};
use crate::core::points::{StoredPlacement, gather_placements};
use crate::core::vector::Vector;
use crate::primitive::SurfacePoints;
use crate::primitive::triangle::{Tangent, Triangles};

/// A triangle in each lane: its mesh and its index there. Texture coordinates are 0 where neither they nor derivatives are
/// wanted.
#[inline(always)]
pub(crate) fn gather_triangles<S: Simd>(
    simd: S,
    meshes: &[&Mesh; LANES],
    indices: &[u32; LANES],
    wants_uvs: bool,
) -> Triangles<f32x8<S>> {
    let zero = f32x8::splat(simd, 0.0);
    let none = Vector { x: zero, y: zero, z: zero };
    let mut corners = [[0; 3]; LANES];
    let mut orientation = [1.0; LANES];
    let (mut have_normals, mut have_tangents, mut want_derivatives, mut are_lifted) = (0, 0, 0, 0);
    for (lane, mesh) in meshes.iter().enumerate() {
        corners[lane] = mesh.triangles[indices[lane] as usize];
        orientation[lane] = if mesh.flip { -1.0 } else { 1.0 };
        have_normals |= u32::from(!mesh.normals.is_empty()) << lane;
        have_tangents |= u32::from(!mesh.tangents.is_empty()) << lane;
        want_derivatives |= u32::from(mesh.wants_derivatives) << lane;
        are_lifted |= u32::from(mesh.is_lifted) << lane;
    }
    let mut triangles = Triangles {
        positions: [
            from_rows(simd, by_lane!(lane => row_at(simd, &meshes[lane].positions, corners[lane][0]))),
            from_rows(simd, by_lane!(lane => row_at(simd, &meshes[lane].positions, corners[lane][1]))),
            from_rows(simd, by_lane!(lane => row_at(simd, &meshes[lane].positions, corners[lane][2]))),
        ],
        orientation: f64x8::load_array(simd, orientation),
        normals: [none; 3],
        uvs: [[zero; 2]; 3],
        tangents: [Tangent { along: none, sign: zero }; 3],
        have_normals: mask64x8::from_bitmask(simd, have_normals.into()),
        have_tangents: mask64x8::from_bitmask(simd, have_tangents.into()),
        want_derivatives: mask64x8::from_bitmask(simd, want_derivatives.into()),
        are_lifted: mask64x8::from_bitmask(simd, are_lifted.into()),
    };
    if have_normals != 0 {
        triangles.normals = [
            from_rows(simd, by_lane!(lane => normal_row(simd, meshes[lane], corners[lane][0]))),
            from_rows(simd, by_lane!(lane => normal_row(simd, meshes[lane], corners[lane][1]))),
            from_rows(simd, by_lane!(lane => normal_row(simd, meshes[lane], corners[lane][2]))),
        ];
    }
    if wants_uvs || want_derivatives != 0 {
        let mut corner = 0;
        while corner < 3 {
            let uvs = by_lane!(lane => match meshes[lane].uvs.get(corners[lane][corner] as usize) {
                Some(uv) => [uv.x, uv.y],
                None => Mesh::NO_UVS[corner],
            });
            triangles.uvs[corner] = [
                f32x8::load_array(simd, by_lane!(lane => uvs[lane][0])),
                f32x8::load_array(simd, by_lane!(lane => uvs[lane][1])),
            ];
            corner += 1;
        }
    }
    if have_tangents != 0 {
        let mut tangents = [[[0.0; LANES]; 4]; 3];
        for lane in LaneMask(have_tangents) {
            for (columns, vertex) in tangents.iter_mut().zip(corners[lane]) {
                set_row(columns, lane, meshes[lane].tangents[vertex as usize].to_array());
            }
        }
        let mut corner = 0;
        while corner < 3 {
            let [x, y, z, sign] = tangents[corner];
            let along = load(simd, &[x, y, z]);
            triangles.tangents[corner] = Tangent { along, sign: f32x8::load_array(simd, sign) };
            corner += 1;
        }
    }
    triangles
}

/// The points of hits on meshes, in instances or not: most often on one triangle.
#[inline(always)]
pub(crate) fn points_on_meshes<S: Simd>(
    simd: S,
    meshes: &[&Mesh; LANES],
    hits: &[&Hit; LANES],
    placements: &[Option<StoredPlacement<'_>>; LANES],
    wants_uvs: bool,
) -> SurfacePoints<f32x8<S>> {
    let indices = by_lane!(lane => hits[lane].primitive);
    let is_one = by_lane!(lane => std::ptr::eq(meshes[lane], meshes[0]) && indices[lane] == indices[0]);
    let triangles = match bitmask(&is_one) == (1 << LANES) - 1 {
        true => meshes[0].triangle(indices[0] as usize).splat(simd),
        false => gather_triangles(simd, meshes, &indices, wants_uvs),
    };
    let u = f32x8::load_array(simd, by_lane!(lane => hits[lane].u));
    let v = f32x8::load_array(simd, by_lane!(lane => hits[lane].v));
    let at = triangles.points(u, v);
    let Some(first) = placements.iter().find_map(|placement| *placement) else { return at };
    let are_placed = bitmask(&by_lane!(lane => placements[lane].is_some()));
    let rows = by_lane!(lane => placements[lane].unwrap_or(first).placement());
    let placements = gather_placements(simd, &by_lane!(lane => &rows[lane]));
    at.placed(mask64x8::from_bitmask(simd, are_placed.into()), &placements)
}

/// The normal of a vertex as a row; zero where the mesh has none.
#[inline(always)]
fn normal_row<S: Simd>(simd: S, mesh: &Mesh, vertex: u32) -> f32x4<S> {
    match mesh.normals.get(vertex as usize) {
        Some(n) => f32x4::load_array(simd, [n.x, n.y, n.z, 0.0]),
        None => f32x4::splat(simd, 0.0),
    }
}

#[cfg(test)]
mod tests {
    use glam::{Vec2, Vec3, Vec4};
    use lookfrom_simd::{Kernel, Level, dispatch};

    use super::*;
    use crate::core::hash;
    use crate::core::lanes::{by_lane, scatter, scatter_f64};
    use crate::core::points::{Placement, placement};
    use crate::primitive::MaterialBinding;

    /// A number of any exponent from 2⁻²⁰ to 2²⁰.
    fn number(count: u64) -> f32 {
        let bits = hash::pair(count, 11);
        let mantissa = (bits >> 40) as f64 / 16_777_216.0 - 0.5;
        (mantissa * libm::exp2((bits % 41) as f64 - 20.0)) as f32
    }

    /// A triangle with some of what meshes may have.
    fn mesh(seed: u64) -> Mesh {
        let vector =
            |k: u64| Vec3::new(number(64 * seed + k), number(64 * seed + k + 1), number(64 * seed + k + 2));
        let three = |first: u64| [0, 3, 6].map(|k| vector(first + k));
        let uvs = three(9).map(|v| Vec2::new(v.x, v.y)).to_vec();
        let normals = three(18).map(Vec3::normalize_or_zero).to_vec();
        let tangents = three(27).map(|v| v.extend(if v.x > 0.0 { 1.0 } else { -1.0 })).to_vec();
        let has = |bit: u64| hash::pair(seed, 5) & 1 << bit != 0;
        Mesh {
            positions: three(0).map(|v| v.to_array()).to_vec(),
            triangles: vec![[0, 1, 2]],
            normals: if has(0) { normals } else { Vec::new() },
            uvs: if has(1) { uvs } else { Vec::new() },
            colors: Vec::new(),
            tangents: if has(2) { tangents } else { Vec::<Vec4>::new() },
            more_uvs: Vec::new(),
            opacities: Vec::new(),
            wants_derivatives: has(3),
            flip: has(4),
            is_lifted: has(5),
            later: Vec::new(),
            binding: MaterialBinding::NONE,
        }
    }

    /// The numbers of a point.
    type Numbers = ([[f64; 3]; 9], [f32; 2]);

    fn numbers(at: &SurfacePoints<f32>) -> Numbers {
        let SurfacePoints { points, ng, ns, uv, dpdu, dpdv, shading_dpdu, shading_dpdv, lift } = *at;
        let vectors = [points.position, points.error, ng, ns, dpdu, dpdv, shading_dpdu, shading_dpdv, lift];
        (vectors.map(<[f64; 3]>::from), uv)
    }

    struct Eight<'a> {
        meshes: &'a [Mesh; LANES],
        on: [[f32; LANES]; 2],
        placements: &'a [Placement<f32>; LANES],
    }

    impl Kernel for Eight<'_> {
        type Output = [Numbers; LANES];
        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> Self::Output {
            let triangles = gather_triangles(simd, &by_lane!(lane => &self.meshes[lane]), &[0; LANES], true);
            let [u, v] = self.on.map(|on| f32x8::load_array(simd, on));
            let placements = gather_placements(simd, &by_lane!(lane => &self.placements[lane]));
            // Every other lane is an instance.
            let at = triangles.points(u, v).placed(mask64x8::from_bitmask(simd, 0xaa), &placements);
            let vectors = [
                at.points.position,
                at.points.error,
                at.ng,
                at.ns,
                at.dpdu,
                at.dpdv,
                at.shading_dpdu,
                at.shading_dpdv,
                at.lift,
            ]
            .map(scatter_f64);
            let uv = scatter(Vector { x: at.uv[0], y: at.uv[1], z: at.uv[0] });
            std::array::from_fn(|lane| (vectors.map(|v| v[lane]), [uv[lane][0], uv[lane][1]]))
        }
    }

    #[test]
    fn eight_at_once_are_eight_one_by_one() {
        let mut levels = vec![Level::baseline(), Level::new()];
        #[cfg(target_arch = "x86_64")]
        levels.extend(Level::new().as_avx2().map(Level::Avx2));
        for round in 0..4000_u64 {
            let seed = |lane: usize| 8 * round + lane as u64;
            let meshes = std::array::from_fn(|lane| mesh(seed(lane)));
            let on: [[f32; LANES]; 2] = std::array::from_fn(|k| {
                std::array::from_fn(|lane| (hash::pair(seed(lane), k as u64) >> 41) as f32 / 16_777_216.0)
            });
            let placements = std::array::from_fn(|lane| {
                let row = |k: u64| [0, 1, 2].map(|j| f64::from(number(64 * seed(lane) + 40 + 3 * k + j)));
                let map = lookfrom_bvh::Affine { matrix: [row(0), row(1), row(2)], translation: row(3) };
                let inverse = map.inverse().map_or(map.matrix, |inverse| inverse.matrix);
                placement(&map, &inverse)
            });
            for &level in &levels {
                let eight = dispatch(level, Eight { meshes: &meshes, on, placements: &placements });
                for lane in 0..LANES {
                    let alone = meshes[lane].triangle(0).points(on[0][lane], on[1][lane]);
                    let alone = numbers(&alone.placed(lane % 2 == 1, &placements[lane]));
                    // The bits of NaN, of triangles without an area, do not matter.
                    let is_number = alone.0.iter().flatten().all(|x| !x.is_nan());
                    assert!(!is_number || eight[lane] == alone, "{:?}\n{alone:?}", eight[lane]);
                }
            }
        }
    }
}
