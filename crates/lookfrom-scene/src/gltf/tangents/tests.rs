//! Squares with unchanged, rotated and mirrored texture coordinates.

use super::*;

/// A square in the plane z = 0 that faces +z, with texture coordinates as a function of its corners.
fn square(uv: impl Fn(f32, f32) -> [f32; 2]) -> (Vertices, Vec<[u32; 3]>) {
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let vertices = Vertices {
        positions: corners.map(|[x, y]| Vec3::new(x, y, 0.0)).to_vec(),
        normals: vec![Vec3::Z; 4],
        uvs: vec![corners.map(|[x, y]| Vec2::from_array(uv(x, y))).to_vec()],
        ..Vertices::default()
    };
    (vertices, vec![[0, 1, 2], [0, 2, 3]])
}

/// The direction in which v grows, from normal and tangent.
fn bitangent(vertices: &Vertices, vertex: usize) -> Vec3 {
    let tangent = vertices.tangents[vertex];
    vertices.normals[vertex].cross(tangent.truncate()) * tangent.w
}

#[test]
fn tangents_lie_along_u_and_their_w_says_where_v_grows() {
    type Mapping = fn(f32, f32) -> [f32; 2];
    let cases: [(Mapping, Vec3, Vec3); 4] = [
        (|x, y| [x, y], Vec3::X, Vec3::Y),
        (|x, y| [y, -x], Vec3::Y, Vec3::NEG_X),
        (|x, y| [-x, y], Vec3::NEG_X, Vec3::Y),
        (|x, y| [x, 1.0 - y], Vec3::X, Vec3::NEG_Y),
    ];
    for (uv, along_u, along_v) in cases {
        let (mut vertices, mut triangles) = square(uv);
        complete(&mut vertices, &mut triangles, 0);
        assert_eq!((vertices.positions.len(), vertices.tangents.len()), (4, 4));
        for vertex in 0..4 {
            assert!((vertices.tangents[vertex].truncate() - along_u).length() < 1e-6);
            assert!((bitangent(&vertices, vertex) - along_v).length() < 1e-6);
        }
    }
}

#[test]
fn the_seam_of_a_mirrored_picture_is_split() {
    // Two squares with a common edge; u grows toward it from both sides.
    let x = [0.0, 1.0, 2.0];
    let places: Vec<[f32; 2]> = [0.0, 1.0].into_iter().flat_map(|y| x.map(|x| [x, y])).collect();
    let mut vertices = Vertices {
        positions: places.iter().map(|&[x, y]| Vec3::new(x, y, 0.0)).collect(),
        normals: vec![Vec3::Z; 6],
        uvs: vec![places.iter().map(|&[x, y]| Vec2::new(1.0 - (x - 1.0).abs(), y)).collect()],
        colors: (0..6u8).map(|i| [f32::from(i); 3]).collect(),
        ..Vertices::default()
    };
    let mut triangles = vec![[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]];
    complete(&mut vertices, &mut triangles, 0);
    // The two vertices of the edge occur twice, with all their attributes.
    assert_eq!((vertices.positions.len(), vertices.colors.len(), vertices.uvs[0].len()), (8, 8, 8));
    for (triangle, side) in triangles.iter().zip([1.0, 1.0, -1.0, -1.0]) {
        for corner in triangle.map(|vertex| vertex as usize) {
            assert!((vertices.tangents[corner] - Vec4::new(side, 0.0, 0.0, side)).length() < 1e-6);
            assert!((bitangent(&vertices, corner) - Vec3::Y).length() < 1e-6);
            let [x, y, _] = vertices.positions[corner].to_array();
            assert_eq!(vertices.colors[corner][0], 3.0 * y + x);
        }
    }
}

#[test]
fn files_that_have_tangents_or_no_coordinates_are_left_alone() {
    let (mut vertices, mut triangles) = square(|x, y| [x, y]);
    complete(&mut vertices, &mut triangles, 3);
    assert!(vertices.tangents.is_empty());
    vertices.tangents = vec![Vec4::new(0.0, 1.0, 0.0, 1.0); 4];
    complete(&mut vertices, &mut triangles, 0);
    assert_eq!(vertices.tangents[0].y, 1.0);
}

#[test]
fn odd_surfaces_are_survived() {
    let odd = [0.0, 1.0, -1.0, 1e-38, 1e38, -3e38, f32::MIN_POSITIVE, 0.5];
    // A formula that goes through all pairs.
    let number = |i: usize| odd[(i * 5 + i / 8 * 3 + i / 64) % 8];
    for shift in 0..400 {
        let count = 3 + shift % 9;
        let at = |i: usize| number(i * (shift % 7 + 1) + shift);
        let mut vertices = Vertices {
            positions: (0..count).map(|i| Vec3::new(at(i), at(i + 1), at(i + 3))).collect(),
            normals: (0..count).map(|i| Vec3::new(at(i + 2), at(i + 5), at(2 * i))).collect(),
            uvs: vec![(0..count).map(|i| Vec2::new(at(i + 4), at(3 * i))).collect()],
            ..Vertices::default()
        };
        let vertex = |i: usize| ((i * 7 + shift * 3) % count) as u32;
        let mut triangles: Vec<[u32; 3]> =
            (0..12).map(|i| [vertex(i), vertex(i * i + 1), vertex(2 * i + 2)]).collect();
        complete(&mut vertices, &mut triangles, 0);
        assert_eq!(vertices.tangents.len(), vertices.positions.len());
        assert!(vertices.tangents.iter().all(|tangent| tangent.is_finite()));
    }
}
