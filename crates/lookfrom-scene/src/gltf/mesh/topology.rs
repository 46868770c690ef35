//! Topology types: the vertices of each point, line or triangle (specification, §3.7.2.1).

use super::Order;
use crate::gltf::json::Whole;

/// The topology type of a primitive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Topology {
    Points,
    Lines,
    LineLoop,
    LineStrip,
    Triangles,
    TriangleStrip,
    TriangleFan,
}

impl Topology {
    /// The topology of a primitive's `mode`.
    pub(super) fn of(mode: Whole) -> Option<Self> {
        Some(match mode.0 {
            0 => Self::Points,
            1 => Self::Lines,
            2 => Self::LineLoop,
            3 => Self::LineStrip,
            4 => Self::Triangles,
            5 => Self::TriangleStrip,
            6 => Self::TriangleFan,
            _ => return None,
        })
    }

    /// The topology once strips and fans are listed as separate triangles.
    pub(super) fn listed(self) -> Self {
        match self {
            Self::TriangleStrip | Self::TriangleFan => Self::Triangles,
            other => other,
        }
    }
}

/// All lines; incomplete ones are dropped.
pub(super) fn lines(topology: Topology, order: &Order<'_>) -> Vec<[u32; 2]> {
    let count = order.len();
    let line = |i: usize, j: usize| [order.vertex(i), order.vertex(j)];
    match topology {
        Topology::Lines => (0..count / 2).map(|i| line(2 * i, 2 * i + 1)).collect(),
        Topology::LineStrip => (1..count).map(|i| line(i - 1, i)).collect(),
        Topology::LineLoop if count > 1 => (0..count).map(|i| line(i, (i + 1) % count)).collect(),
        _ => Vec::new(),
    }
}

/// All triangles, with the winding order of the first; incomplete ones are dropped.
pub(super) fn triangles(topology: Topology, order: &Order<'_>) -> Vec<[u32; 3]> {
    let count = order.len();
    let triangle = |i: usize, j: usize, k: usize| [order.vertex(i), order.vertex(j), order.vertex(k)];
    let last = count.saturating_sub(2);
    match (topology, order.indices) {
        (Topology::Triangles, Some(indices)) => indices.as_chunks::<3>().0.to_vec(),
        (Topology::Triangles, None) => {
            (0..count / 3).map(|i| triangle(3 * i, 3 * i + 1, 3 * i + 2)).collect()
        }
        (Topology::TriangleStrip, _) => {
            (0..last).map(|i| triangle(i, i + 1 + i % 2, i + 2 - i % 2)).collect()
        }
        (Topology::TriangleFan, _) => (0..last).map(|i| triangle(i + 1, i + 2, 0)).collect(),
        _ => Vec::new(),
    }
}
