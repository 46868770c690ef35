//! An arm of two joints, invalid weights, and reflections.

use glam::{DQuat, Vec4};

use super::*;

/// The upper arm extends from 0 to 1 along x, the forearm from 1 to 2, bound in these places; the forearm is rotated by
/// 90° about z.
fn arm() -> Skin {
    let elbow = DMat4::from_translation(DVec3::X);
    let turn = DMat4::from_quat(DQuat::from_rotation_z(std::f64::consts::FRAC_PI_2));
    Skin::of(vec![DMat4::IDENTITY, elbow * turn * elbow.inverse()])
}

fn vertices(positions: &[[f32; 3]]) -> Vertices {
    let count = positions.len();
    Vertices {
        positions: positions.iter().copied().map(Vec3::from_array).collect(),
        normals: vec![Vec3::Y; count],
        tangents: vec![Vec4::new(1.0, 0.0, 0.0, -1.0); count],
        ..Vertices::default()
    }
}

fn near(found: Vec3, expected: [f32; 3]) {
    assert!((found - Vec3::from_array(expected)).length() < 1e-6, "{found}, not {expected:?}");
}

#[test]
fn an_arm_bends() {
    let mut arm_of = vertices(&[[0.5, 0.0, 0.0], [2.0, 0.0, 0.25], [1.0, 0.5, 0.0]]);
    let all = |joint: u32| Influence { joints: [joint, 7, 0, 0], weights: [1.0, 0.0, 0.0, 0.0] };
    // The last vertex follows both joints equally, with weights in two sets that sum to 4.
    let first = vec![all(0), all(1), Influence { joints: [0, 0, 0, 0], weights: [1.0, 1.0, 0.0, 0.0] }];
    let none = Influence::default();
    let second = vec![none, none, Influence { joints: [1, 1, 9, 9], weights: [0.5, 1.5, 0.0, 0.0] }];
    arm().apply(&[first, second], &mut arm_of);
    near(arm_of.positions[0], [0.5, 0.0, 0.0]);
    near(arm_of.positions[1], [1.0, 1.0, 0.25]);
    // Halfway between its bind position and the forearm's: (1, ½) and (½, 0).
    near(arm_of.positions[2], [0.75, 0.25, 0.0]);
    near(arm_of.normals[1], [-1.0, 0.0, 0.0]);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    near(arm_of.normals[2], [-half, half, 0.0]);
    near(arm_of.tangents[1].truncate(), [0.0, 1.0, 0.0]);
    assert_eq!(arm_of.tangents[1].w, -1.0);
}

#[test]
fn vertices_without_weights_follow_their_first_joint() {
    let mut lost = vertices(&[[2.0, 0.0, 0.0]; 3]);
    let without = |joints: [u32; 4]| Influence { joints, weights: [0.0; 4] };
    // The last vertex names a joint that does not exist, and stays.
    arm().apply(&[vec![without([1, 0, 0, 0]), without([0; 4]), without([5; 4])]], &mut lost);
    near(lost.positions[0], [1.0, 1.0, 0.0]);
    near(lost.positions[1], [2.0, 0.0, 0.0]);
    near(lost.positions[2], [2.0, 0.0, 0.0]);
    for bad in [f32::NAN, f32::INFINITY, -1.0, -0.0] {
        assert_eq!(usable(bad), 0.0);
    }
}

#[test]
fn normals_stay_upright_under_any_scale() {
    // A slope of 45°, stretched along x, has a normal that is closer to the vertical.
    let skin = Skin::of(vec![DMat4::from_scale(DVec3::new(3.0, 1.0, 1.0))]);
    let mut slope = vertices(&[[0.0; 3]]);
    slope.normals[0] = Vec3::new(1.0, 1.0, 0.0).normalize();
    skin.apply(&[vec![Influence::default()]], &mut slope);
    near(slope.normals[0], [0.1f32.sqrt(), 0.9f32.sqrt(), 0.0]);
    // A flattened mesh has the normal of its plane.
    let flat = Skin::of(vec![DMat4::from_scale(DVec3::new(1.0, 0.0, 1.0))]);
    let mut slope = vertices(&[[0.0; 3]]);
    flat.apply(&[vec![Influence::default()]], &mut slope);
    near(slope.normals[0], [0.0, 1.0, 0.0]);
}

#[test]
fn what_all_joints_mirror_is_mirrored_as_a_whole() {
    let mirror = DMat4::from_scale(DVec3::new(1.0, -1.0, 1.0));
    let skin = Skin::of(vec![mirror; 2]);
    assert_eq!(skin.world_from_skinned.determinant(), -1.0);
    let mut vertex = vertices(&[[1.0, 2.0, 3.0]]);
    skin.apply(&[vec![Influence { joints: [0, 1, 0, 0], weights: [0.5, 0.5, 0.0, 0.0] }]], &mut vertex);
    let in_world = skin.world_from_skinned.transform_point3(vertex.positions[0].as_dvec3());
    near(in_world.as_vec3(), [1.0, -2.0, 3.0]);
    // With one matrix that is not a reflection, nothing is factored out.
    assert_eq!(Skin::of(vec![mirror, DMat4::IDENTITY]).world_from_skinned, DMat4::IDENTITY);
}
