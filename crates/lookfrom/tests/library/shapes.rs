//! Each shape against its twin: triangles along the formula of its points, or a search along its curve.

use std::sync::Arc;

use crate::support::forms::{Random, forms, place, ray, scene_of, shape, shining, twin, world};
use glam::{DMat3, DMat4, DVec3, Vec3};
use lookfrom::shading::interaction::SurfaceInteraction;
use lookfrom::world::World;
use lookfrom_bvh::Ray;
use lookfrom_scene::material::Scalar;
use lookfrom_scene::scene::MeshId;
use lookfrom_scene::shape::{Geometry, Mesh, Patches, Profile, Sphere, Strand};

#[test]
fn rays_meet_what_they_meet_of_fine_triangles() {
    let mut random = Random(1);
    for form in forms() {
        for _ in 0..3 {
            let map = random.map(3.0);
            let (exact, triangles) =
                (world(shape(form.geometry.clone(), map), vec![]), twin(&form, map, 192));
            let (mut hits, mut different) = (0, 0);
            for _ in 0..4000 {
                let ray = ray(&mut random, &map);
                let (hit, other) = (exact.bvh().closest_hit(&ray), triangles.bvh().closest_hit(&ray));
                hits += u32::from(hit.is_hit());
                if !hit.is_hit() || !other.is_hit() {
                    different += u32::from(hit.is_hit() != other.is_hit());
                    continue;
                }
                let (surface, flat) = (exact.surface(&ray, &hit), triangles.surface(&ray, &other));
                let apart = (surface.uv - flat.uv).abs();
                let same_t = (hit.t - other.t).abs() < 0.01 * hit.t;
                // Where u begins again the triangles know only one end.
                let same_uv = apart.x.min((1.0 - apart.x).abs()) < 0.05 && apart.y < 0.02;
                let same_side = surface.front == flat.front && surface.ng.dot(flat.ng) > 0.98;
                different += u32::from(!(same_t && same_uv && same_side));
            }
            assert!(hits > 400, "{}: {hits} hits", form.name);
            assert!(different * 50 < hits, "{}: {different} of {hits} hits differ", form.name);
        }
    }
}

#[test]
fn points_are_where_the_formula_says_and_so_are_derivatives() {
    let mut random = Random(2);
    for form in forms() {
        for _ in 0..4 {
            let map = random.map(2.0);
            let exact = world(shape(form.geometry.clone(), map), vec![]);
            let size = map.transform_vector3(DVec3::X).length();
            for _ in 0..500 {
                let ray = ray(&mut random, &map);
                let hit = exact.bvh().closest_hit(&ray);
                if !hit.is_hit() {
                    continue;
                }
                let surface = exact.surface(&ray, &hit);
                let (u, v) = (f64::from(surface.uv.x), f64::from(surface.uv.y));
                let at = |u, v| map.transform_point3((form.at)(u, v));
                let position = DVec3::from_array(surface.point.position);
                let tolerance = 1e-5 * (size + position.length());
                assert!(position.distance(at(u, v)) < tolerance, "{}: {surface:?}", form.name);
                assert!(position.distance(place(&ray, &hit)) < tolerance, "{}", form.name);
                let h = 1e-5;
                let by_u = (at(u + h, v) - at(u - h, v)) / (2.0 * h);
                let by_v = (at(u, v + h) - at(u, v - h)) / (2.0 * h);
                let near =
                    |a: Vec3, b: DVec3| (a.as_dvec3() - b).length() < 1e-3 * (b.length() + 0.01 * size);
                assert!(near(surface.dpdu, by_u), "{}: {} {by_u}", form.name, surface.dpdu);
                assert!(near(surface.dpdv, by_v), "{}: {} {by_v}", form.name, surface.dpdv);
                // The outside is outside, however it is mirrored.
                let own = map.inverse().transpose().transform_vector3(cross_at(form.at, u, v)).normalize();
                assert!(surface.ng.dot(own) > 0.99, "{}: {} {own}", form.name, surface.ng);
            }
        }
    }
}

fn cross_at(at: fn(f64, f64) -> DVec3, u: f64, v: f64) -> DVec3 {
    let h = 1e-5;
    (at(u + h, v) - at(u - h, v)).cross(at(u, v + h) - at(u, v - h))
}

#[test]
fn a_reversed_shape_has_its_outside_inside() {
    let mut random = Random(3);
    let ball = Geometry::Sphere(Sphere { center: DVec3::ZERO, radius: 1.0 });
    let plate = Geometry::Disk { center: DVec3::ZERO, normal: DVec3::Y, radius: 1.0 };
    let others = forms().into_iter().map(|form| form.geometry);
    for geometry in others.chain([ball, plate]) {
        let map = random.map(1.0);
        let usual = shape(geometry, map);
        let mut reversed = usual.clone();
        reversed.reverse_orientation = true;
        let [usual, reversed] = [usual, reversed].map(|shape| world(shape, vec![]));
        for _ in 0..100 {
            let ray = ray(&mut random, &map);
            let (a, b) = (usual.bvh().closest_hit(&ray), reversed.bvh().closest_hit(&ray));
            assert_eq!(a, b);
            if a.is_hit() {
                let (a, b) = (usual.surface(&ray, &a), reversed.surface(&ray, &b));
                assert!(a.ng == -b.ng && a.ns == -b.ns && a.front != b.front && a.uv == b.uv);
            }
        }
    }
}

#[test]
fn rays_that_leave_a_hair_start_outside_of_it() {
    let mut random = Random(6);
    let strand = Strand { points: STRAND.map(Vec3::from_array), width: [0.02; 2], profile: Profile::Flat };
    for far in [0.0, 10.0] {
        let map = random.map(far);
        let exact = world(shape(Geometry::Curves(Arc::new([strand])), map), vec![]);
        let (mut left, mut again) = (0, 0);
        while left < 10_000 {
            let to = map.transform_point3(Vec3::from_array(STRAND[0]).as_dvec3() * random.between(-1.0, 1.0));
            let from = map.transform_point3(3.0 * random.direction());
            let ray = Ray::new(from.as_vec3().to_array(), (to - from).as_vec3().to_array());
            let hit = exact.bvh().closest_hit(&ray);
            if !hit.is_hit() {
                continue;
            }
            let surface = exact.surface(&ray, &hit);
            let (ray, _) = leaving(&mut random, &surface, 1.0);
            let next = exact.bvh().closest_hit(&ray);
            left += 1;
            let width = map.transform_vector3(DVec3::X).length() * 0.02;
            again += u32::from(f64::from(next.t) < 2.0 * width);
        }
        assert!(again * 200 < left, "{again} of {left} meet the hair that they left");
    }
}

/// Leaves a surface on a side, not too flat.
fn leaving(random: &mut Random, surface: &SurfaceInteraction, scale: f64) -> (Ray, f64) {
    loop {
        let direction = random.direction();
        if direction.dot(surface.ng).abs() > 0.05 {
            let direction = (direction * scale).as_vec3();
            return (Ray::new(surface.origin(direction), direction.to_array()), scale);
        }
    }
}

#[test]
fn rays_that_leave_do_not_meet_what_they_left() {
    let mut random = Random(4);
    for form in forms() {
        let mut left = 0;
        for far in [0.0, 1.0, 30.0, 1000.0, 2e4].into_iter().cycle().take(50) {
            let map = random.map(far);
            let exact = world(shape(form.geometry.clone(), map), vec![]);
            let size = map.transform_vector3(DVec3::X).length();
            for _ in 0..4000 {
                let ray = ray(&mut random, &map);
                let hit = exact.bvh().closest_hit(&ray);
                if !hit.is_hit() {
                    continue;
                }
                let surface = exact.surface(&ray, &hit);
                for _ in 0..2 {
                    left += 1;
                    let (ray, length) = leaving(&mut random, &surface, size);
                    let next = exact.bvh().closest_hit(&ray);
                    let way = f64::from(next.t) * length;
                    assert!(way > 1e-3 * size, "{} at {far}: again after {way} of {size}", form.name);
                    // It starts no farther away than f32 and the error of the point make necessary.
                    let start = DVec3::from_array(ray.origin.map(f64::from));
                    let position = DVec3::from_array(surface.point.position);
                    assert!(start.distance(position) < 1e-6 * (size + position.length()), "{}", form.name);
                }
            }
        }
        assert!(left > 100_000, "{}: {left}", form.name);
    }
}

#[test]
fn rays_that_leave_an_ellipsoid_never_meet_it_however_thin_it_is() {
    let mut random = Random(7);
    let ball = Geometry::Sphere(Sphere { center: DVec3::new(0.5, -1.0, 2.0), radius: 0.3 });
    let mut left = 0;
    for far in [0.0, 1.0, 100.0].into_iter().cycle().take(60) {
        let thin = [0; 3].map(|_| 2f64.powf(random.between(-10.0, 10.0)));
        let map = random.map(far) * DMat4::from_scale(DVec3::from_array(thin));
        let exact = world(shape(ball.clone(), map), vec![]);
        for _ in 0..2000 {
            let at = |d: DVec3| map.transform_point3(DVec3::new(0.5, -1.0, 2.0) + d).as_vec3();
            let (from, to) = (at(3.0 * random.direction()), at(0.29 * random.direction()));
            let ray = Ray::new(from.to_array(), (to - from).to_array());
            let hit = exact.bvh().closest_hit(&ray);
            if !hit.is_hit() {
                continue;
            }
            let surface = exact.surface(&ray, &hit);
            for _ in 0..2 {
                let direction = random.direction().as_vec3();
                if direction.as_dvec3().dot(surface.ng) > 0.0 {
                    let next =
                        exact.bvh().closest_hit(&Ray::new(surface.origin(direction), direction.to_array()));
                    assert!(!next.is_hit(), "far {far}, thin {thin:?}: {surface:?}");
                    left += 1;
                }
            }
        }
    }
    assert!(left > 50_000, "{left}");
}

#[test]
fn rays_that_leave_inward_from_near_a_pole_do_not_start_outside() {
    // Where the normal is along an axis, rounding to f32 moves an origin mostly sideways, and the surface bends away.
    let mut random = Random(9);
    // The pole is a little beyond a number that f32 has, so that the origin hardly moves along the normal.
    let center = DVec3::new(30_000.250_008, 23_331.1, -37_023.4);
    let map = DMat4::from_translation(center) * DMat4::from_scale(DVec3::new(0.25, 0.25, 0.3));
    let exact = world(shape(forms().swap_remove(0).geometry, map), vec![]);
    for _ in 0..20_000 {
        let mut near = || 4e-3 * (2.0 * random.unit() - 1.0);
        let from = (center + DVec3::new(0.0, near(), near())).as_vec3().to_array();
        let ray = Ray::new(from, [1.0, near() as f32, near() as f32]);
        let surface = exact.surface(&ray, &exact.bvh().closest_hit(&ray));
        let direction = Vec3::new(-1.0, 20.0 * near() as f32, 20.0 * near() as f32);
        let next = exact.bvh().closest_hit(&Ray::new(surface.origin(direction), direction.to_array()));
        assert!(next.t > 0.4, "again after {} from {surface:?}", next.t);
    }
}

#[test]
fn rays_that_leave_a_flat_patch_never_meet_it_however_flat_they_are() {
    // Exactly in a plane, but no parallelogram.
    let at = |x: f32, y: f32| Vec3::new(x, y, x + 2.0 * y);
    let positions = vec![at(-900.0, -700.0), at(800.0, -1000.0), at(-300.0, 1100.0), at(500.0, 600.0)];
    let patch = Patches { positions, patches: vec![[0, 1, 2, 3]], ..Patches::default() };
    let exact = world(shape(Geometry::Bilinear(Arc::new(patch)), DMat4::IDENTITY), vec![]);
    let mut random = Random(8);
    let mut left = 0;
    while left < 100_000 {
        let (x, y) = (random.between(-900.0, 900.0) as f32, random.between(-900.0, 900.0) as f32);
        let from = 2000.0 * random.direction().as_vec3();
        let ray = Ray::new(from.to_array(), (at(x, y) - from).to_array());
        let hit = exact.bvh().closest_hit(&ray);
        if !hit.is_hit() {
            continue;
        }
        let surface = exact.surface(&ray, &hit);
        let flat = random.direction().reject_from_normalized(surface.ng).normalize();
        let up = 2f64.powf(random.between(-22.0, 0.0));
        let direction = (flat + up * surface.ng).as_vec3();
        if direction.as_dvec3().dot(surface.ng) > 0.0 {
            let next = exact.bvh().closest_hit(&Ray::new(surface.origin(direction), direction.to_array()));
            assert!(!next.is_hit(), "{direction} from {surface:?}");
            left += 1;
        }
    }
}

#[test]
fn tangents_and_texture_coordinates_of_meshes_lead_the_derivatives() {
    let mut mesh = Mesh {
        positions: [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 4.0, 0.0]].map(Vec3::from_array).to_vec(),
        triangles: vec![[0, 1, 2]],
        uvs: [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(Into::into).to_vec(),
        ..Mesh::default()
    };
    let ray = Ray::new([0.5, 0.5, 3.0], [0.0, 0.0, -1.0]);
    let surface = |mesh: &Mesh| {
        let world = world(shape(Geometry::Mesh(MeshId(0)), DMat4::IDENTITY), vec![mesh.clone()]);
        world.surface(&ray, &world.bvh().closest_hit(&ray))
    };
    let plain = surface(&mesh);
    assert_eq!((plain.dpdu, plain.dpdv), (Vec3::X * 2.0, Vec3::Y * 4.0));
    assert_eq!((plain.shading_dpdu, plain.shading_dpdv), (plain.dpdu, plain.dpdv));

    mesh.normals = vec![Vec3::new(0.6, 0.0, 0.8); 3];
    let smooth = surface(&mesh);
    assert_eq!(smooth.dpdu, plain.dpdu);
    assert!(smooth.shading_dpdu.dot(smooth.ns).abs() < 1e-6 && smooth.shading_dpdu.x > 0.0);
    assert!(smooth.shading_dpdv.dot(smooth.ns).abs() < 1e-6 && smooth.shading_dpdv.y > 0.0);

    mesh.tangents = vec![Vec3::Y.extend(1.0); 3];
    let brushed = surface(&mesh);
    assert!(brushed.shading_dpdu.normalize().distance(Vec3::Y) < 1e-6);

    // Texture coordinates that say nothing: any basis of the plane.
    mesh = Mesh { uvs: vec![Default::default(); 3], normals: vec![], tangents: vec![], ..mesh };
    let lost = surface(&mesh);
    assert!(lost.dpdu.dot(lost.dpdv).abs() < 1e-6 && lost.dpdu.z == 0.0 && lost.dpdv.z == 0.0);
}

#[test]
fn alpha_comes_with_the_surface() {
    let mut half = shape(Geometry::Sphere(Sphere { center: DVec3::ZERO, radius: 1.0 }), DMat4::IDENTITY);
    half.alpha = Some(Scalar::Value(0.5));
    let world = world(half, vec![]);
    let ray = Ray::new([0.0, 0.0, 3.0], [0.0, 0.0, -1.0]);
    assert_eq!(
        world.surface(&ray, &world.bvh().closest_hit(&ray)).alpha,
        Some(lookfrom::shading::texture::FloatTexture::Constant(0.5))
    );
}

const STRAND: [[f32; 3]; 4] = [[-1.0, -0.5, 0.0], [-0.2, 0.9, 0.4], [0.3, -0.9, -0.3], [1.0, 0.5, 0.2]];

#[test]
fn curves_are_met_where_a_search_along_them_says() {
    let mut random = Random(5);
    let ribbon = Profile::Ribbon([Vec3::Z, Vec3::new(0.0, 0.6, 0.8)]);
    for profile in [Profile::Flat, Profile::Cylinder, Profile::PbrtCylinder, ribbon] {
        let strand = Strand { points: STRAND.map(Vec3::from_array), width: [0.2, 0.08], profile };
        let points = STRAND.map(|p| Vec3::from_array(p).as_dvec3());
        let at = |u: f64| {
            let v = 1.0 - u;
            v * v * v * points[0]
                + 3.0 * v * v * u * points[1]
                + 3.0 * v * u * u * points[2]
                + u * u * u * points[3]
        };
        let map = random.map(2.0);
        let exact = world(shape(Geometry::Curves(Arc::new([strand])), map), vec![]);
        let (mut hits, mut sure) = (0, 0);
        for _ in 0..1500 {
            // Aim near the curve.
            let to = at(random.unit()) + 0.15 * random.unit() * random.direction();
            let from = 3.0 * random.direction();
            let (to, from) = (map.transform_point3(to).as_vec3(), map.transform_point3(from).as_vec3());
            let ray = Ray::new(from.to_array(), (to - from).to_array());
            // The search happens in the curve's space, where its width is.
            let back = map.inverse();
            let origin = back.transform_point3(from.as_dvec3());
            let direction = back.transform_vector3((to - from).as_dvec3()).normalize();
            // The least distance, in half widths as they are seen.
            let turned = |u: f64| {
                let n = DVec3::new(0.0, 0.6, 0.8);
                let angle = 0.8f64.acos();
                let n = (((1.0 - u) * angle).sin() * DVec3::Z + (u * angle).sin() * n) / angle.sin();
                if profile == ribbon { n.dot(direction).abs() } else { 1.0 }
            };
            let seen = |u: f64| {
                let across = (at(u) - origin).reject_from_normalized(direction).length();
                across / (0.5 * (0.2 + u * (0.08 - 0.2)) * turned(u))
            };
            let (least, u) = (0..=4000)
                .map(|k| f64::from(k) / 4000.0)
                .map(|u| (seen(u), u))
                .fold((f64::INFINITY, 0.0), |a, b| if b.0 < a.0 { b } else { a });
            let hit = exact.bvh().closest_hit(&ray);
            hits += u32::from(hit.is_hit());
            if turned(u) < 0.5 {
                continue; // seen edge on, what is left of the width is not wider than the search is exact
            }
            // A hit is a point of the curve that the ray passes within half the width there, but for the steps of the search.
            if least > 1.001 {
                assert!(!hit.is_hit(), "{profile:?}: met at {least} half widths");
                sure += 1;
            }
            // The nearest point is searched on a chord, to which the piece of the curve is near: the place on the curve is off
            // along it, which makes the distance too large in second order only.
            if least < 0.98 && (0.01..0.99).contains(&u) {
                assert!(hit.is_hit(), "{profile:?}: missed at {least} half widths, u = {u}");
                sure += 1;
            }
            if hit.is_hit() {
                let surface = exact.surface(&ray, &hit);
                let u = f64::from(surface.uv.x);
                let off = 2.0 * (f64::from(surface.uv.y) - 0.5).abs();
                assert!((off - seen(u)).abs() < 1e-5, "{profile:?}: v says {off}, the curve {}", seen(u));
                // The depth is that of the curve's middle.
                let depth = (at(u) - origin).dot(direction);
                let length = back.transform_vector3((to - from).as_dvec3()).length();
                let away = (f64::from(hit.t) * length - depth).abs();
                assert!(away < 1e-6, "{profile:?}: the depth is {away} off");
                // Seen from behind its normal, as in pbrt; a round one turns it by up to a right angle, and is seen from before it
                // elsewhere: off the middle it points away from that. The map keeps no right angles.
                let facing = surface.ng.dot(surface.wo.as_dvec3());
                let across = back.transform_point3(DVec3::from_array(surface.point.position)) - at(u);
                let outward = DMat3::from_mat4(map).transpose() * surface.ng;
                let sideways = across.reject_from_normalized(direction).dot(outward);
                match profile {
                    Profile::Flat => assert!(facing < 0.0),
                    Profile::Cylinder => assert!(facing > -0.05 && (sideways > 0.0 || off < 0.3)),
                    Profile::PbrtCylinder => assert!(facing < 0.05),
                    Profile::Ribbon(_) => {}
                }
                let tangent = (at(u + 1e-5) - at(u - 1e-5)) / 2e-5;
                let tangent = map.transform_vector3(tangent);
                assert!((surface.dpdu.as_dvec3() - tangent).length() < 0.01 * tangent.length());
            }
        }
        assert!(hits > 300 && sure > 500, "{profile:?}: {hits} hits, {sure} sure");
    }
}

/// A band that is shaded as a cylinder has the normals of the half of it that the ray sees, and pbrt's those of the far half, seen from
/// inside.
#[test]
fn round_curves_have_the_normals_of_cylinders() {
    let points = [-1.5, -0.5, 0.5, 1.5].map(|y| Vec3::new(0.0, y, 0.0));
    let normal = |profile, x: f32| {
        let strand = Strand { points, width: [0.5; 2], profile };
        let world = world(shape(Geometry::Curves(Arc::new([strand])), DMat4::IDENTITY), vec![]);
        let ray = Ray::new([x, 0.1, 3.0], [0.0, 0.0, -1.0]);
        world.surface(&ray, &world.bvh().closest_hit(&ray)).ng
    };
    for x in [-0.24_f32, -0.1, 0.0, 0.05, 0.2] {
        let sin = f64::from(x) / 0.25;
        let round = DVec3::new(sin, 0.0, (1.0 - sin * sin).sqrt());
        let found = normal(Profile::Cylinder, x);
        assert!(found.distance(round) < 1e-5, "{x}: {found}, expected {round}");
        // Turned in proportion to the place across.
        let (sin, cos) = (0.5 * std::f64::consts::PI * sin).sin_cos();
        let hollow = DVec3::new(sin, 0.0, -cos);
        let found = normal(Profile::PbrtCylinder, x);
        assert!(found.distance(hollow) < 1e-5, "{x}: {found}, expected {hollow}");
    }
}

#[test]
fn straight_curves_are_exactly_as_wide_as_they_say() {
    // Control points that are evenly spaced on a line: nothing is approximated. A ray meets the curve where the foot of the
    // shortest way to its line is on the curve, and that way is at most half the width there.
    let mut random = Random(6);
    let [first, last] = [DVec3::new(-1.0, -0.5, 0.25), DVec3::new(1.25, 0.5, -0.25)];
    let points = [0.0, 1.0, 2.0, 3.0].map(|k| first.lerp(last, k / 3.0).as_vec3());
    let ribbon = Profile::Ribbon([Vec3::Z; 2]);
    for profile in [Profile::Flat, Profile::Cylinder, ribbon] {
        let strand = Strand { points, width: [0.25, 0.0625], profile };
        let world = world(shape(Geometry::Curves(Arc::new([strand])), DMat4::IDENTITY), vec![]);
        let (mut hits, mut misses) = (0, 0);
        for _ in 0..4000 {
            let near = first.lerp(last, random.unit()) + 0.25 * random.unit() * random.direction();
            let from = (3.0 * random.direction()).as_vec3();
            let ray = Ray::new(from.to_array(), (near.as_vec3() - from).to_array());
            let [origin, along] = [ray.origin, ray.direction].map(|v| Vec3::from_array(v).as_dvec3());
            let along = along.normalize();
            // Seen along the ray: the foot on the curve's line.
            let [start, line] = [first - origin, last - first].map(|v| v.reject_from_normalized(along));
            let u = -start.dot(line) / line.length_squared();
            let turned = if profile == ribbon { along.z.abs() } else { 1.0 };
            let half = 0.5 * (0.25 + u * (0.0625 - 0.25)) * turned;
            let distance = (start + u * line).length() / half;
            let is_clear = [u, 1.0 - u].iter().all(|end| end.abs() > 1e-4) && (distance - 1.0).abs() > 1e-4;
            if !is_clear {
                continue;
            }
            let expected = (0.0..1.0).contains(&u) && distance < 1.0;
            let hit = world.bvh().closest_hit(&ray);
            assert_eq!(hit.is_hit(), expected, "{profile:?}: {distance} half widths at u = {u}");
            *(if expected { &mut hits } else { &mut misses }) += 1;
        }
        assert!(hits > 500 && misses > 500, "{profile:?}: {hits} hits, {misses} misses");
    }
}

#[test]
fn poles_have_derivatives_and_nonsense_has_no_surface() {
    let pole = Ray::new([0.0, 0.0, 3.0], [0.0, 0.0, -1.0]);
    let whole = Geometry::PartialSphere { radius: 1.0, z: [-1.0, 1.0], phi_max: 360.0 };
    let stretched = DMat4::from_scale(DVec3::new(1.0, 2.0, 1.0));
    for map in [DMat4::IDENTITY, stretched] {
        let world = world(shape(whole.clone(), map), vec![]);
        let surface = world.surface(&pole, &world.bvh().closest_hit(&pole));
        assert!(surface.dpdu.cross(surface.dpdv).normalize().dot(surface.ns) > 0.999, "{surface:?}");
    }

    let strand = |width| Strand { points: [Vec3::ZERO; 4], width, profile: Profile::Cylinder };
    let collapsed =
        Patches { positions: vec![Vec3::ONE; 4], patches: vec![[0, 1, 2, 3]], ..Patches::default() };
    let nonsense = [
        Geometry::PartialSphere { radius: 0.0, z: [-1.0, 1.0], phi_max: 180.0 },
        Geometry::PartialSphere { radius: -1.0, z: [0.5, 0.5], phi_max: 0.0 },
        Geometry::PartialSphere { radius: f64::NAN, z: [f64::NAN; 2], phi_max: f64::NAN },
        Geometry::PartialDisk { height: 0.0, radius: 1.0, inner_radius: 1.0, phi_max: -1.0 },
        Geometry::PartialDisk { height: f64::INFINITY, radius: 1.0, inner_radius: 2.0, phi_max: 360.0 },
        Geometry::Cylinder { radius: 0.0, z: [0.0, 0.0], phi_max: 1e300 },
        Geometry::Cylinder { radius: f64::INFINITY, z: [f64::NEG_INFINITY, f64::NAN], phi_max: 360.0 },
        Geometry::Torus { radius: 0.0, tube: 1.0 },
        Geometry::Torus { radius: f64::NAN, tube: f64::INFINITY },
        Geometry::Bilinear(Arc::new(collapsed)),
        Geometry::Bilinear(Arc::new(Patches::default())),
        Geometry::Curves(Arc::new([strand([0.0, 0.0]), strand([f32::NAN, f32::INFINITY])])),
        Geometry::Curves(Arc::new([])),
    ];
    let mut random = Random(10);
    for geometry in nonsense {
        let text = format!("{geometry:?}");
        let scene = scene_of(shining(geometry, DMat4::IDENTITY, true, false), vec![]);
        let is_valid = scene.validate().is_ok();
        let compiled = World::compile(scene, &mut Vec::new());
        assert_eq!(compiled.is_ok(), is_valid, "{text}");
        let Ok(world) = compiled else { continue };
        for _ in 0..200 {
            let ray = ray(&mut random, &DMat4::IDENTITY);
            assert!(!world.bvh().closest_hit(&ray).is_hit(), "{text}");
        }
    }
}
