//! Labels: what is seen at the middle of a pixel is where the camera looks, and what it is called.

use lookfrom::prelude::*;
use lookfrom::render::Label;

use crate::support::{SMALL, scene};

#[test]
fn labels_name_what_is_seen_and_where() {
    let scene = scene(&format!(
        r#"{SMALL}
        [camera]
        lookfrom = [1, 2, 10]
        lookat = [1, 2, 0]
        fov = 40
        [materials.red]
        type = "diffuse"
        reflectance = [0.8, 0.1, 0.1]
        [materials.veil]
        type = "diffuse"
        reflectance = 0.5
        [[sphere]]
        center = [1, 2, 0]
        radius = 1
        material = "red"
        [[quad]]
        corner = [-9, -9, 5]
        edge_u = [20, 0, 0]
        edge_v = [0, 20, 0]
        alpha = 0.25
        material = "veil"
        [[objects.post.box]]
        min = [-0.5, -0.5, -0.5]
        max = [0.5, 0.5, 0.5]
        material = "red"
        [[instance]]
        object = "post"
        translate = [3, 2, 0]
        "#
    ));
    let options = Options { width: Some(65), height: Some(65), ..Options::default() };
    let session = Session::of_scene(scene, &options).expect("a scene");
    let renderer = session.renderer();
    let (width, height) = (session.image().width, session.image().height);
    let labels = renderer.labels();
    assert_eq!(labels.len(), (width * height) as usize);
    let names = session.world().names();

    // The nearest point of the sphere, seen through the veil.
    let middle = labels[(height / 2 * width + width / 2) as usize];
    assert!((middle.point - DVec3::new(1.0, 2.0, 1.0)).length() < 0.05, "{middle:?}");
    assert!(middle.n.z > 0.95 && middle.instance == Label::NONE, "{middle:?}");
    assert_eq!(names.materials[middle.material as usize], "red");
    // The instance, to the right of it.
    let beside = labels.iter().find(|label| label.instance != Label::NONE).expect("an instance is seen");
    assert!((beside.point - DVec3::new(3.0, 2.0, 0.0)).abs().max_element() < 0.5 + 1e-5, "{beside:?}");
    assert!(beside.shape != middle.shape && beside.material == middle.material);
    // Nothing in the corners.
    assert!(labels[0].shape == Label::NONE && labels[0].point.is_nan(), "{:?}", labels[0]);
    // Nor outside of the picture.
    for pixel in [[width, 0], [0, height], [500, 500]] {
        assert_eq!(renderer.label(pixel).shape, Label::NONE, "{pixel:?}");
    }
    // Each point is seen in the middle of its pixel.
    let camera = renderer.view().camera();
    for (index, label) in labels.iter().enumerate().filter(|(_, label)| label.shape != Label::NONE) {
        let (x, y) = (index as u32 % width, index as u32 / width);
        let ray = camera.ray([f64::from(x) + 0.5, f64::from(height - 1 - y) + 0.5], [0.5; 2]);
        let to = (label.point - camera.lookfrom()).normalize();
        assert!(to.dot(ray.direction.normalize()) > 1.0 - 1e-10, "{label:?}");
    }
}
