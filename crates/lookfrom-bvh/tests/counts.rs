//! How many nodes and triangles do rays visit? Counts do not depend on the machine's mood: a tree or a loop that became worse is
//! seen here, and not only by those who measure times.

#[path = "../src/testing.rs"]
mod testing;

use lookfrom_bvh::{Builder, Observer, Quality, Ray, Triangles};
use testing::Random;

#[derive(Default)]
struct Counts {
    nodes: u64,
    triangles: u64,
}

impl Observer for Counts {
    fn node(&mut self, _instance: u32, _node: u32) {
        self.nodes += 1;
    }

    fn candidate(&mut self, _instance: u32, _geometry: u32, _primitive: u32) {
        self.triangles += 1;
    }
}

type Mesh = (Vec<[f32; 3]>, Vec<[u32; 3]>);

/// A height field of waves over the unit square, 2 · side² triangles.
fn waves(side: u32) -> Mesh {
    let mut mesh = Mesh::default();
    for row in 0..=side {
        for column in 0..=side {
            let [x, y] = [column, row].map(|i| i as f32 / side as f32);
            mesh.0.push([x, y, 0.05 * ((20.0 * x).sin() + (31.0 * y).cos())]);
            if row < side && column < side {
                let corner = row * (side + 1) + column;
                mesh.1.push([corner, corner + 1, corner + side + 2]);
                mesh.1.push([corner, corner + side + 2, corner + side + 1]);
            }
        }
    }
    mesh
}

/// Triangles of very different sizes all over the unit cube.
fn soup(count: u32) -> Mesh {
    let mut random = Random::new(11);
    let mut mesh = Mesh::default();
    for number in 0..count {
        let center = random.near([0.5; 3], 0.5);
        let size = random.size(-3, -1);
        mesh.0.extend([0; 3].map(|_| random.near(center, size)));
        mesh.1.push([3 * number, 3 * number + 1, 3 * number + 2]);
    }
    mesh
}

/// Nodes and triangles that a ray visits, on average, for rays from one side of the unit cube to the other.
fn visits((positions, indices): &Mesh, quality: Quality) -> (f64, f64) {
    let mut builder = Builder::new();
    builder.quality(quality).triangles(Triangles { positions, indices });
    let bvh = builder.build().unwrap();
    let mut random = Random::new(5);
    let mut counts = Counts::default();
    let rays = 20_000;
    for _ in 0..rays {
        let [from, to] = [[0.5, 0.5, 1.5], [0.5, 0.5, -0.5]].map(|center| random.near(center, 0.5));
        let ray = Ray::new(from, [0, 1, 2].map(|axis| to[axis] - from[axis]));
        bvh.query().observer(&mut counts).closest_hit(&ray);
    }
    (counts.nodes as f64 / f64::from(rays), counts.triangles as f64 / f64::from(rays))
}

#[test]
fn rays_visit_no_more_than_they_did() {
    for (name, mesh, limits) in [
        ("waves", waves(100), [(4.655, 10.924), (4.652, 9.438)]),
        ("soup", soup(20_000), [(9.501, 50.645), (9.750, 44.379)]),
    ] {
        for (quality, limit) in [Quality::Balanced, Quality::Best].into_iter().zip(limits) {
            let (nodes, triangles) = visits(&mesh, quality);
            assert!(
                nodes <= 1.02 * limit.0 && triangles <= 1.02 * limit.1,
                "{name}, {quality:?}: {nodes:.3} nodes and {triangles:.3} triangles a ray; it was {limit:?}"
            );
        }
    }
}
