//! Lights of each form: what is sampled has the density that it says, and a ray that finds the same point agrees.

use std::f64::consts::PI;
use std::sync::Arc;

use crate::support::forms::{Random, forms, ray, shape, shining, world};
use crate::support::{Compiled, scene};
use glam::{DMat4, DVec3, Vec3};
use lookfrom::light::{AreaLight, Light};
use lookfrom::world::World;
use lookfrom_bvh::Ray;
use lookfrom_scene::scene::MeshId;
use lookfrom_scene::shape::{Geometry, Mesh, Patches, Shape, Sphere};

/// How many samples, and how many uniform directions.
const COUNT: usize = 40_000;

/// What is compared: a sum for each of the eight octants of directions.
type Octants = [f64; 8];

fn octant(d: Vec3) -> usize {
    d.to_array().iter().fold(0, |index, x| 2 * index + usize::from(*x > 0.0))
}

fn light(world: &World) -> &AreaLight {
    match &world.lights()[0] {
        Light::Area(light) => light,
        other => panic!("{other:?} is no area light"),
    }
}

/// All forms that shine: one of each kind, and meshes of few and many triangles.
fn lights() -> Vec<(&'static str, Geometry, Vec<Mesh>)> {
    let mut lights: Vec<_> = forms().into_iter().map(|form| (form.name, form.geometry, vec![])).collect();
    // Last, since all lights share one sequence of random numbers.
    let torus = lights.pop().expect("forms");
    lights.push(("sphere", Geometry::Sphere(Sphere { center: DVec3::X * 0.25, radius: 0.75 }), vec![]));
    let normal = DVec3::new(0.3, 1.0, 0.2);
    lights.push(("disk", Geometry::Disk { center: DVec3::ZERO, normal, radius: 1.0 }, vec![]));
    let (corner, edge_u, edge_v) = (DVec3::new(-1.0, -1.0, 0.0), DVec3::X * 2.0, DVec3::Y * 2.0);
    lights.push(("quad", Geometry::Quad { corner, edge_u, edge_v }, vec![]));
    let fine = forms().into_iter().nth(1).map(|form| form.triangles(24)).into_iter().collect();
    lights.push(("mesh", Geometry::Mesh(MeshId(0)), fine));
    let triangle = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.2], [0.0, 1.0, 0.6]];
    let saddle = [[-0.9, -0.8, -0.4], [0.8, -0.9, -1.0], [-0.7, 0.8, -1.0], [0.9, 0.9, -0.5]];
    let patches = Patches {
        positions: triangle.iter().chain(&saddle).copied().map(Vec3::from_array).collect(),
        patches: vec![[0, 1, 2, 2], [3, 4, 5, 6]],
        ..Patches::default()
    };
    lights.push(("patches, one with two corners in one", Geometry::Bilinear(Arc::new(patches)), vec![]));
    lights.push(torus);
    lights
}

/// Sums over sampled points that are not hidden, each over its octant: of 1, and of the solid angle that each stands for.
fn by_samples(world: &World, from: Vec3, random: &mut Random, what: &str) -> [Octants; 2] {
    let light = light(world);
    let mut sums = [[0.0; 8]; 2];
    let mut compared = 0;
    for _ in 0..COUNT {
        let Some(sample) = light.sample_point(from.as_dvec3(), random.square()) else { continue };
        let to = DVec3::from_array(sample.point.position) - from.as_dvec3();
        assert!((to.normalize() - sample.wi.as_dvec3()).length() < 1e-5, "{what}: wi leads to the point");
        let ray = Ray::new(from.to_array(), sample.wi.to_array());
        let hit = world.bvh().closest_hit(&ray);
        let visible = (f64::from(hit.t) / to.length() - 1.0).abs() < 1e-4;
        if !visible {
            continue;
        }
        sums[0][octant(sample.wi)] += 1.0;
        sums[1][octant(sample.wi)] += 1.0 / f64::from(sample.pdf);

        // The ray that found it says the same about it.
        let surface = world.surface(&ray, &hit);
        if surface.ng.dot(sample.wi.as_dvec3()).abs() > 0.05 {
            let found = light.pdf(from.as_dvec3(), &surface, sample.wi);
            assert!((found / sample.pdf - 1.0).abs() < 0.02, "{what}: {found} instead of {}", sample.pdf);
            assert!(surface.ng.dot(sample.normal) > 0.99, "{what}: {} {}", surface.ng, sample.normal);
            let apart = (surface.uv - sample.uv).abs();
            assert!(apart.x.min((1.0 - apart.x).abs()) < 0.01 && apart.y < 0.01, "{what}: {apart}");
            compared += 1;
        }
    }
    assert!(compared > COUNT / 10, "{what}: {compared} compared");
    sums
}

/// The same sums over uniform directions: of the density, and of the solid angle of each.
fn by_directions(world: &World, from: Vec3, random: &mut Random) -> [[(f64, f64); 8]; 2] {
    let mut sums = [[(0.0, 0.0); 8]; 2];
    for _ in 0..10 * COUNT {
        let direction = random.direction().as_vec3();
        let ray = Ray::new(from.to_array(), direction.to_array());
        let hit = world.bvh().closest_hit(&ray);
        if hit.is_hit() {
            let pdf = light(world).pdf(from.as_dvec3(), &world.surface(&ray, &hit), direction);
            for (sum, value) in sums.iter_mut().zip([f64::from(pdf), 1.0]) {
                let weight = value * 4.0 * PI / 10.0;
                let sum = &mut sum[octant(direction)];
                *sum = (sum.0 + weight, sum.1 + weight * weight);
            }
        }
    }
    sums
}

fn agree(what: &str, shape: Shape, meshes: Vec<Mesh>, from: Vec3, random: &mut Random) {
    let world = world(shape, meshes);
    let samples = by_samples(&world, from, random, what);
    let directions = by_directions(&world, from, random);
    for octant in 0..8 {
        for (sums, directions) in samples.iter().zip(directions) {
            let (sum, (other, square)) = (sums[octant], directions[octant]);
            // Five standard deviations of what directions say, and of a count with its mean weight.
            let count = samples[0][octant].max(1.0);
            let tolerance = 5.0 * square.sqrt() + 5.0 * count.sqrt() * sum.max(1.0) / count + 0.004 * sum;
            assert!(
                (sum - other).abs() < tolerance,
                "{what}, octant {octant}: {sum} and {other} ± {tolerance}"
            );
        }
    }
}

#[test]
fn densities_of_samples_and_of_directions_agree() {
    let mut random = Random(11);
    for (what, geometry, meshes) in lights() {
        for far in [0.0, 3.0] {
            let map = random.map(far);
            // From outside, not too far away, at a place that f32 can name.
            let from = map.transform_point3(random.between(1.6, 2.5) * random.direction()).as_vec3();
            agree(what, shining(geometry.clone(), map, true, false), meshes.clone(), from, &mut random);
        }
    }
}

#[test]
fn inside_of_spheres_and_close_to_plates() {
    let mut random = Random(12);
    for (what, geometry, meshes) in lights() {
        if !["whole sphere", "sphere", "quad"].contains(&what) {
            continue;
        }
        let map = random.map(0.0);
        let from = map.transform_point3(DVec3::new(0.3, 0.2, 0.15)).as_vec3();
        agree(what, shining(geometry, map, true, false), meshes, from, &mut random);
    }
}

#[test]
fn a_sphere_that_shines_inward_is_seen_from_its_own_wall() {
    // The mean of radiance 1 over the hemisphere above any point of the wall, by the light's samples.
    let mut random = Random(13);
    let geometry = Geometry::Sphere(Sphere { center: DVec3::new(1.0, 2.0, 3.0), radius: 2.0 });
    let world = world(shining(geometry, DMat4::IDENTITY, false, true), vec![]);
    let inside = Ray::new([1.0, 2.0, 3.0], [0.3, 0.4, 0.5]);
    let wall = world.surface(&inside, &world.bvh().closest_hit(&inside));
    assert!(wall.front, "the outside is inside");
    let from = DVec3::from_array(wall.point.position);
    let mut sum = 0.0;
    for _ in 0..100_000 {
        if let Some(sample) = light(&world).sample_point(from, random.square()) {
            let cos = sample.wi.as_dvec3().dot(wall.ng).max(0.0);
            assert!(sample.normal.dot(sample.wi.as_dvec3()) < 0.0, "its inner side shines");
            sum += cos / PI / f64::from(sample.pdf);
        }
    }
    assert!((sum / 100_000.0 - 1.0).abs() < 0.02, "{}", sum / 100_000.0);
}

#[test]
fn areas_and_extents() {
    let mut random = Random(14);
    for (what, geometry, meshes) in lights() {
        let map = random.map(1.0);
        let lit = world(shining(geometry.clone(), map, false, false), meshes);
        let light = light(&lit);
        let extent = light.emitter_bounds();
        let size = (extent.max - extent.min).length();
        let mut points = 0;
        for _ in 0..20_000 {
            let from = map.transform_point3(3.0 * random.direction());
            let Some(sample) = light.sample_point(from, random.square()) else { continue };
            let p = DVec3::from_array(sample.point.position);
            let inside = p.cmpge(extent.min - 1e-6 * size).all() && p.cmple(extent.max + 1e-6 * size).all();
            assert!(inside, "{what}: {p} is not in {extent:?}");
            let cos = sample.normal.dot(extent.axis.as_dvec3());
            assert!(cos > f64::from(extent.cos_normals) - 1e-5, "{what}: {cos} {extent:?}");
            points += 1;
        }
        assert!(points > 10_000, "{what}");
        let twin = forms().into_iter().find(|form| form.name == what);
        if let Some(form) = twin {
            let mesh = form.triangles(128);
            let corner = |vertex: u32| map.transform_point3(mesh.positions[vertex as usize].as_dvec3());
            let by_triangles: f64 = mesh
                .triangles
                .iter()
                .map(|t| t.map(corner))
                .map(|[a, b, c]| 0.5 * (b - a).cross(c - a).length())
                .sum();
            let ratio = light.area() / by_triangles;
            assert!((ratio - 1.0).abs() < 0.002, "{what}: {ratio}");
        }
    }
}

#[test]
fn what_shines_is_linked_to_its_light() {
    let mut random = Random(15);
    for (what, geometry, meshes) in lights() {
        let map = random.map(1.0);
        let lit = world(shining(geometry.clone(), map, false, false), meshes.clone());
        let dark = world(shape(geometry, map), meshes);
        let mut met = 0;
        for _ in 0..200 {
            let ray = ray(&mut random, &map);
            let hit = lit.bvh().closest_hit(&ray);
            assert_eq!(hit, dark.bvh().closest_hit(&ray));
            if hit.is_hit() {
                met += 1;
                assert_eq!(lit.surface(&ray, &hit).light, Some(0), "{what}");
                assert_eq!(dark.surface(&ray, &hit).light, None, "{what}");
            }
        }
        assert!(met > 5, "{what}");
    }
}

/// Light whose colour depends on the place, as sampled and as found by paths: of cubes in the world, far from its origin.
#[test]
fn textures_of_places_shine_where_they_are_seen() {
    let cubes = "{ type = \"checker\", even = 8, odd = 0, space = \"world\", size = 0.5 }";
    for form in [
        "[[sphere]]\ncenter = [100.3, 1.4, 0]\nradius = 1",
        "[[disk]]\ncenter = [100.3, 1.1, 0]\nnormal = [0.1, -1, 0]\nradius = 1",
        "[[quad]]\ncorner = [99.3, 1.1, -1]\nedge_u = [2, 0, 0]\nedge_v = [0, 0.1, 2]",
    ] {
        let mean = |integrator: &str| {
            let text = format!(
                "[image]\nwidth = 8\nheight = 8\n[render]\nintegrator = \"{integrator}\"\nsamples = 512\ndepth = 1\n\
                 [camera]\nlookfrom = [100.3, 0.3, 4]\nlookat = [100.3, 0, 0]\nfov = 30\n[materials.m]\ntype = \"diffuse\"\n\
                 [[plane]]\nmaterial = \"m\"\n{form}\nmaterial = \"m\"\nemission = {cubes}\ntwo_sided = true\n"
            );
            let pixels = Compiled::new(scene(&text)).film().picture().pixels;
            pixels.iter().map(|pixel| f64::from(pixel[1])).sum::<f64>() / pixels.len() as f64
        };
        let (sampled, found) = (mean("path"), mean("random_walk"));
        assert!((sampled / found - 1.0).abs() < 0.06, "{form}: {sampled} {found}");
    }
}
