//! Derivations of importances: those of the children on the way to a light, with their operands.

use glam::Vec3;

use super::sight::{Seen, Sight};
use super::{Link, Tree};
use crate::light::derivation::{Derivation, vector};

/// The importance of a child by distances and angles.
const DIRECTED: &str = "importance = Φ cos θ' cos θᵢ' / max(d², r), within 10⁻³⁰ … 10³⁰, but 0 where cos θ' ≤ cos θ_e; \
    θ' = θ_w ⊖ θ_o ⊖ θ_b, θᵢ' = θ_i ⊖ θ_b, a ⊖ b = max(0, a − b); the lights below: Φ their power, c and r their sphere, \
    normals within θ_o of the axis a; d² = |p − c|², w = (p − c) / d, cos θ_w = a·w (if two-sided |a·w|), sin θ_b = r / d \
    (θ_b = π where d ≤ r), cos θ_i = |N·w|";

/// The importance of a child at whose centre the point is, or very far away.
const UNDIRECTED: &str = "importance = Φ / max(d², r), within 10⁻³⁰ … 10³⁰, since d² = |p − c|² is not within 10⁻³⁶ … 10³⁶; \
    the lights below: Φ their power, c and r their sphere";

impl Tree {
    /// For each node on the way to a light its two children, the chosen one first: their importances, and how these come
    /// about.
    pub(in crate::light) fn way(&self, p: Vec3, n: Vec3, light: u32) -> Vec<[(f32, Derivation); 2]> {
        let Some(mut way) = self.ways.get(light as usize).copied().flatten() else { return Vec::new() };
        let (mut pairs, mut node) = (Vec::new(), 0);
        while let Link::Second(second) = self.nodes[node].link {
            let mut children = [node + 1, second as usize];
            if way & 1 == 1 {
                children.reverse();
            }
            pairs.push(children.map(|child| {
                let sight = &self.nodes[child].sight;
                let seen = sight.seen(p.into(), n.into());
                (seen.importance, derivation(sight, &seen, n))
            }));
            node = children[0];
            way >>= 1;
        }
        pairs
    }
}

fn derivation(sight: &Sight, seen: &Seen, n: Vec3) -> Derivation {
    let one = |x: f32| vec![f64::from(x)];
    let angle = |(cos, sin): (f32, f32)| vec![f64::from(cos), f64::from(sin)];
    let mut numbers = vec![
        ("importance", one(seen.importance)),
        ("Φ", one(sight.power)),
        ("p − c", vector(seen.to_p)),
        ("d²", one(seen.length2)),
        ("r", one(sight.radius)),
    ];
    if !seen.is_usual {
        return Derivation::new(UNDIRECTED, numbers);
    }
    numbers.extend([
        ("a", vector(sight.axis)),
        ("two-sided", one(sight.two_sided)),
        ("N", vector(n)),
        ("cos, sin θ_w", angle(seen.to_axis)),
        ("cos, sin θ_o", angle((sight.cos_normals, sight.sin_normals))),
        ("cos, sin θ_b", angle(seen.of_box)),
        ("cos, sin θ_i", angle(seen.at_surface)),
        ("cos θ_e", one(sight.cos_emission)),
        ("cos θ'", one(seen.cos_least)),
        ("cos θᵢ'", one(seen.cos_incident)),
    ]);
    Derivation::new(DIRECTED, numbers)
}
