//! How many nodes and triangles do rays visit? Counts do not depend on the machine's mood: a tree or a loop that became worse is
//! seen here, and not only by those who measure times.

use crate::testing::Random;
use lookfrom_bvh::{Builder, Observer, Quality, Ray, RayF64, Triangles};

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

/// Boxes and the nodes whose children they are.
#[derive(Default)]
struct Boxes {
    nodes: u64,
    tested: u64,
    entered: u64,
}

impl Observer for Boxes {
    fn node(&mut self, _instance: u32, _node: u32) {
        self.nodes += 1;
    }

    fn boxes(&mut self, _instance: u32, tested: u32, entered: u32) {
        assert!((1..=8).contains(&tested) && entered <= tested, "{entered} of {tested}");
        self.tested += u64::from(tested);
        self.entered += u64::from(entered);
    }
}

#[test]
fn boxes_are_counted_alike_in_both_precisions() {
    let (positions, indices) = soup(2000);
    let mut builder = Builder::new();
    builder.triangles(Triangles { positions: &positions, indices: &indices });
    let bvh = builder.build().unwrap();
    let mut random = Random::new(6);
    let [mut all, mut in_f64, mut nearest] = [(); 3].map(|()| Boxes::default());
    for _ in 0..500 {
        let ray = Ray::new(random.near([0.5, 0.5, 1.5], 0.5), [0.1, 0.2, -1.0]);
        bvh.query().observer(&mut all).all_hits(&ray, &mut Vec::new());
        bvh.query().observer(&mut in_f64).all_hits(&RayF64::from(ray), &mut Vec::new());
        bvh.query().observer(&mut nearest).closest_hit(&ray);
    }
    // Margins for rounding differ, so that a box may be entered in one precision alone.
    let is_near = |a: u64, b: u64| a.abs_diff(b) <= a / 500;
    assert!(is_near(all.tested, in_f64.tested) && is_near(all.entered, in_f64.entered));
    // What is behind a hit is culled, and so are the boxes in it.
    assert!(nearest.tested < all.tested && nearest.entered < all.entered);
    assert!(all.entered < all.tested && all.tested <= 8 * all.nodes);

    let mut past = Boxes::default();
    bvh.query().observer(&mut past).closest_hit(&Ray::new([0.0, 0.0, 9.0], [1.0, 0.0, 0.0]));
    assert!((past.nodes, past.entered) == (1, 0) && past.tested > 1, "every box of the root is culled");
}
