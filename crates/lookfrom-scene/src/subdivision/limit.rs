//! The limit of a refined cage: positions, and normals.

use std::f64::consts::TAU;

use glam::DVec3;

use super::{Adjacency, Around, Cage, Edge, VertexRule, around_edges};

/// Positions on the limit surface, and normals there: not of unit length where a vertex has no face.
pub(super) struct Limit {
    pub(super) positions: Vec<DVec3>,
    pub(super) normals: Vec<DVec3>,
}

impl Limit {
    /// The limit surface of a cage that was refined at least once, so that all its faces are quadrilaterals.
    pub(super) fn of(cage: &Cage) -> Self {
        let adjacency = Adjacency::of(cage);
        let mut around = vec![Around::default(); cage.positions.len()];
        // The corners across faces take the place of their centres.
        for face in cage.faces() {
            for corner in face.clone() {
                let across = cage.at(face.start + (corner - face.start + 2) % 4);
                let around = &mut around[cage.corners[corner] as usize];
                around.faces += 1;
                around.centers += across;
            }
        }
        around_edges(&mut around, &cage.positions, &adjacency);
        let limit = |(at, around): (&DVec3, &Around)| {
            let n = f64::from(around.faces);
            match around.kind() {
                VertexRule::Fixed => *at,
                VertexRule::Crease => (*at * 4.0 + around.on_creases) / 6.0,
                VertexRule::Smooth => {
                    let ends = around.ends / f64::from(around.edges);
                    (*at * n + ends * 4.0 + around.centers / n) / (n + 5.0)
                }
            }
        };
        let positions: Vec<DVec3> = cage.positions.iter().zip(&around).map(limit).collect();
        let normals = normals(cage, &adjacency, &around, &positions);
        Self { positions, normals }
    }
}

/// The normals of smooth vertices from the masks of their tangents, those of all others as means of the faces around.
fn normals(cage: &Cage, adjacency: &Adjacency, around: &[Around], positions: &[DVec3]) -> Vec<DVec3> {
    let mut facets = vec![DVec3::ZERO; cage.positions.len()];
    let mut first = vec![None; cage.positions.len()];
    for face in cage.faces() {
        for corner in face.clone() {
            let at =
                |step: usize| positions[cage.corners[face.start + (corner - face.start + step) % 4] as usize];
            let (side, other) = (at(1) - at(0), at(3) - at(0));
            let vertex = cage.corners[corner] as usize;
            facets[vertex] += side.cross(other).normalize_or_zero() * side.angle_between(other).max(0.0);
            first[vertex].get_or_insert(corner);
        }
    }
    let normal = |vertex: usize| {
        let mean = facets[vertex].normalize_or_zero();
        let smooth = match (around[vertex].kind(), first[vertex]) {
            (VertexRule::Smooth, Some(corner)) => tangents(cage, adjacency, corner, around[vertex].faces),
            _ => None,
        };
        let normal = smooth.and_then(|[a, b]| a.cross(b).try_normalize());
        // A cage that folds may have tangents without a plane.
        normal.filter(|normal| normal.dot(mean) > 0.5).unwrap_or(mean)
    };
    (0..cage.positions.len()).map(normal).collect()
}

/// Two tangents at the limit of a smooth vertex, which a corner belongs to: Halstead et al. 1993, appendix A. `None` where the
/// faces around it are not of one orientation.
fn tangents(cage: &Cage, adjacency: &Adjacency, first: usize, faces: u32) -> Option<[DVec3; 2]> {
    let n = f64::from(faces);
    let of_turn = |turn: f64| libm::cos(TAU * turn / n);
    let c = of_turn(1.0);
    let of_ends = 1.0 + c + libm::cos(TAU / (2.0 * n)) * (2.0 * (9.0 + c)).sqrt();
    let mut sums = [DVec3::ZERO; 2];
    let mut corner = first;
    for k in 0..faces {
        let start = corner / 4 * 4;
        let at = |step: usize| start + (corner - start + step) % 4;
        let (end, across, before) = (cage.at(at(1)), cage.at(at(2)), at(3));
        let k = f64::from(k);
        for (sum, shift) in sums.iter_mut().zip([0.0, -1.0]) {
            let (here, next) = (of_turn(k + shift), of_turn(k + shift + 1.0));
            *sum += end * (of_ends * here) + across * (here + next);
        }
        // The next face, across the edge that leads to this vertex.
        let Edge { corners, .. } = &adjacency.edges[adjacency.edge_of[before] as usize];
        let next = if corners[0] as usize == before { corners[1] } else { corners[0] } as usize;
        if cage.corners[next] != cage.corners[corner] {
            return None;
        }
        corner = next;
    }
    (corner == first).then_some(sums)
}
