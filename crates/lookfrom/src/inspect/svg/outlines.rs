//! The shapes of a scene as outlines.

use std::f64::consts::TAU;

use glam::{DMat4, DVec3, DVec4, Vec3};

use crate::primitive::{Primitives, Quadric, QuadricKind, Quadrics, Torus};
use crate::world::World;

/// Maximum number of outlines of all shapes.
const MOST: usize = 3000;

/// Bounds of the number of outlines of one list of primitives. Of more, some are drawn, at regular steps.
const OF_LIST: [usize; 2] = [12, 600];

/// Corners of a circle's polygon.
const CIRCLE: usize = 48;

/// An outline in the world.
pub(super) enum Outline {
    /// A convex polygon, which is filled.
    Polygon(Vec<DVec3>),
    /// A line.
    Line(Vec<DVec3>),
}

/// The outlines of a world's shapes for a viewer: an eye, or a direction as a point infinitely far away.
pub(super) fn outlines(world: &World, viewer: DVec4) -> Vec<Outline> {
    let world_from_render = DMat4::from_translation(world.origin);
    let of_world = world.primitives.iter().map(|primitives| (primitives, world_from_render));
    let every = world.instances.len().div_ceil(MOST).max(1);
    let of_instances = (0..world.instances.len()).step_by(every).flat_map(|id| {
        let placed = world.instance(id as u32, 0.0);
        let world_from_object = world_from_render * placed.render_from_object();
        let object = &world.objects[placed.instance.object as usize];
        object.iter().map(move |primitives| (primitives, world_from_object))
    });
    let lists: Vec<(&Primitives, DMat4)> = of_world.chain(of_instances).collect();
    let most = (MOST / lists.len().max(1)).clamp(OF_LIST[0], OF_LIST[1]);
    let mut outlines = Vec::new();
    for (primitives, to_world) in &lists {
        add(primitives, to_world, most, viewer, &mut outlines);
    }
    outlines
}

/// Adds the outlines of primitives, at most about `most`.
fn add(primitives: &Primitives, to_world: &DMat4, most: usize, viewer: DVec4, outlines: &mut Vec<Outline>) {
    let count = match primitives {
        Primitives::Mesh(mesh) => mesh.triangles.len(),
        Primitives::Spheres(spheres) => spheres.spheres.len(),
        Primitives::Disks(disks) => disks.disks.len(),
        Primitives::Quadrics(quadrics) => quadrics.quadrics.len(),
        Primitives::Patches(patches) => patches.patches.len(),
        Primitives::Curves(curves) => curves.count(),
    };
    let every = count.div_ceil(most).max(1);
    for index in (0..count).step_by(every) {
        if outlines.len() >= MOST {
            return;
        }
        let place = |point: DVec3| to_world.transform_point3(point);
        let polygon = |corners: Vec<DVec3>| Outline::Polygon(corners.into_iter().map(place).collect());
        let line = |points: Vec<DVec3>| Outline::Line(points.into_iter().map(place).collect());
        match primitives {
            Primitives::Mesh(mesh) => {
                let corners = mesh.corners(index).map(|corner| Vec3::from_array(corner).as_dvec3());
                outlines.push(polygon(corners.into()));
            }
            Primitives::Spheres(spheres) => {
                let sphere = spheres.spheres[index];
                let center = Vec3::from_array(sphere.center).as_dvec3();
                // An affine map keeps tangents: the silhouette is found in the sphere's own space.
                let seen_from = to_world.inverse() * viewer;
                outlines.extend(silhouette(center, f64::from(sphere.radius), seen_from).map(polygon));
            }
            Primitives::Disks(disks) => {
                let disk = &disks.disks[index];
                let corners = circle(TAU).map(|[x, y]| disk.center + x * disk.axis_u + y * disk.axis_v);
                outlines.push(polygon(corners.collect()));
            }
            Primitives::Quadrics(quadrics) => {
                outlines.extend(quadric(quadrics, index).into_iter().map(line));
            }
            Primitives::Patches(patches) => {
                let [p00, p10, p01, p11] = patches.corners(index);
                outlines.push(line(vec![p00, p10, p11, p01, p00]));
            }
            Primitives::Curves(curves) => outlines.push(line(curves.ends(index).into())),
        }
    }
}

/// Points of the unit circle, through an angle.
fn circle(angle: f64) -> impl Iterator<Item = [f64; 2]> {
    (0..=CIRCLE).map(move |step| {
        let (sin, cos) = libm::sincos(angle * step as f64 / CIRCLE as f64);
        [cos, sin]
    })
}

/// The circle in which the tangents of a viewer touch a sphere; `None` from inside.
fn silhouette(center: DVec3, radius: f64, viewer: DVec4) -> Option<Vec<DVec3>> {
    let way = viewer.truncate() - viewer.w * center;
    let distance = way.length();
    // From a distance, the circle is nearer to the viewer than the centre, and smaller.
    let near = if viewer.w == 0.0 { 0.0 } else { radius / distance };
    if !(near < 1.0) {
        return None;
    }
    let toward = way / distance;
    let (x, y) = toward.any_orthonormal_pair();
    let across = radius * (1.0 - near * near).sqrt();
    let middle = center + near * radius * toward;
    Some(circle(TAU).map(|[cos, sin]| middle + across * (cos * x + sin * y)).collect())
}

/// Circles at the ends of a quadric, and lines along it, as far as a solid leaves them.
fn quadric(quadrics: &Quadrics, index: usize) -> Vec<Vec<DVec3>> {
    let quadric = &quadrics.quadrics[index];
    let lines = lines_of(quadric);
    let is_left = |a: &DVec3, b: &DVec3| quadrics.keeps(index, a.midpoint(*b));
    let pieces = lines.iter().flat_map(|line| line.chunk_by(is_left)).filter(|piece| piece.len() > 1);
    pieces.map(|piece| piece.iter().map(|point| quadric.point_in_render(*point)).collect()).collect()
}

/// Circles at the ends of a quadric, and lines along it, in its object space.
fn lines_of(quadric: &Quadric) -> Vec<Vec<DVec3>> {
    let turn = |radius: f64, z: f64| -> Vec<DVec3> {
        circle(quadric.phi_max).map(|[x, y]| DVec3::new(radius * x, radius * y, z)).collect()
    };
    let (heights, radius_at): (Vec<f64>, Box<dyn Fn(f64) -> f64>) = match quadric.kind {
        QuadricKind::Disk { height, radius, inner_radius } => {
            return vec![turn(radius, height), turn(inner_radius, height)];
        }
        QuadricKind::Cylinder { radius, z } => (z.to_vec(), Box::new(move |_| radius)),
        QuadricKind::Rectangle { size: [x, y] } => {
            let corners = [[0.0, 0.0], [x, 0.0], [x, y], [0.0, y], [0.0, 0.0]];
            let side = |ends: &[[f64; 2]]| -> Vec<DVec3> {
                let [from, to] = [ends[0], ends[1]].map(|[x, y]| DVec3::new(x, y, 0.0));
                (0..=CIRCLE).map(|step| from.lerp(to, step as f64 / CIRCLE as f64)).collect()
            };
            return corners.windows(2).map(side).collect();
        }
        QuadricKind::Torus(torus) => return rings(torus),
        QuadricKind::Sphere { radius, z: [low, high] } => (
            (0..=8).map(|step| low + (high - low) * f64::from(step) / 8.0).collect(),
            Box::new(move |z| (radius * radius - z * z).max(0.0).sqrt()),
        ),
    };
    let mut lines: Vec<Vec<DVec3>> = heights.iter().map(|&z| turn(radius_at(z), z)).collect();
    for quarter in 0..4 {
        let (sin, cos) = libm::sincos(quadric.phi_max * f64::from(quarter) / 4.0);
        let at = |&z: &f64| {
            let radius = radius_at(z);
            DVec3::new(radius * cos, radius * sin, z)
        };
        lines.push(heights.iter().map(at).collect());
    }
    lines
}

/// Circles around the axis of a torus, and around its tube, in its object space.
fn rings(Torus { radius, tube }: Torus) -> Vec<Vec<DVec3>> {
    let place = |[cos, sin]: [f64; 2], [x, z]: [f64; 2]| {
        let ring = radius + tube * x;
        DVec3::new(ring * cos, ring * sin, tube * z)
    };
    let around_axis = circle(TAU)
        .step_by(CIRCLE / 4)
        .skip(1)
        .map(|tube| circle(TAU).map(|axis| place(axis, tube)).collect());
    let around_tube = circle(TAU)
        .step_by(CIRCLE / 8)
        .skip(1)
        .map(|axis| circle(TAU).map(|tube| place(axis, tube)).collect());
    around_axis.chain(around_tube).collect()
}
