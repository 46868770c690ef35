//! Media of Mitsuba, and their grids.

use std::path::PathBuf;

use glam::{DMat4, DVec3};
use lookfrom_scene::material::Color;
use lookfrom_scene::medium::{Density, Extinction, Medium};
use lookfrom_scene::{ErrorKind, Result};

use super::{files, read_of, scene};

#[test]
fn media_are_absorption_and_scattering() {
    let read = scene(
        r#"<medium type="homogeneous" id="fog"><rgb name="sigma_t" value="1 2 4"/><float name="albedo" value="0.75"/>
            <float name="scale" value="3"/><phase type="hg"><float name="g" value="0.5"/></phase></medium>
        <shape type="sphere"><bsdf type="null"/><ref name="interior" id="fog"/></shape>
        <shape type="cube"><bsdf type="null"/><ref name="interior" id="fog"/></shape>"#,
    );
    let [fog] = &read.media[..] else { panic!("{:?}", read.media) };
    assert_eq!(
        fog.extinction,
        Extinction::Sum { sum: Color::Value([1.0, 2.0, 4.0]), albedo: Color::gray(0.75) }
    );
    assert_eq!((fog.g, fog.scale), (0.5, 3.0));
    let sides = read.shapes[1].sides.expect("sides");
    assert!(sides.inside.is_some() && sides.outside.is_none());
}

/// A `.vol` file.
fn volume(size: [i32; 3], channels: i32, values: &[f32]) -> Vec<u8> {
    let mut bytes = b"VOL\x03".to_vec();
    bytes.extend([1, size[0], size[1], size[2], channels].into_iter().flat_map(i32::to_le_bytes));
    bytes.extend([0.0_f32, 0.0, 0.0, 2.0, 3.0, 4.0].into_iter().flat_map(f32::to_le_bytes));
    bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    bytes
}

/// The medium of these elements, with a volume `v.vol`.
fn heterogeneous(elements: &str, bytes: Vec<u8>) -> Result<Medium> {
    let text = format!(
        "<scene version=\"3.0.0\">\n<medium type=\"heterogeneous\" id=\"m\">{elements}</medium>\
         <shape type=\"cube\"><bsdf type=\"null\"/><ref name=\"interior\" id=\"m\"/></shape>\n</scene>"
    );
    let mut memory = files(&[("s/a.xml", &text)]);
    memory.0.insert(PathBuf::from("s/v.vol"), bytes);
    read_of(&memory, &[]).0.map(|scene| scene.media[0].clone())
}

#[test]
fn volumes_are_grids_whose_outermost_cells_go_on() {
    let grid = "<volume name=\"sigma_t\" type=\"gridvolume\"><string name=\"filename\" value=\"v.vol\"/>\
                <boolean name=\"use_grid_bbox\" value=\"true\"/></volume><rgb name=\"albedo\" value=\"0.5 0.25 0\"/>";
    let medium = heterogeneous(grid, volume([2, 1, 1], 1, &[1.0, 3.0])).expect("a medium");
    assert_eq!(
        medium.extinction,
        Extinction::Sum { sum: Color::gray(1.0), albedo: Color::Value([0.5, 0.25, 0.0]) }
    );
    let variation = medium.variation.expect("a grid");
    assert_eq!(variation.world_from_medium, DMat4::from_scale(DVec3::new(2.0, 3.0, 4.0)));
    assert_eq!(
        variation.bounds.map(|[low, high]| (low.to_array(), high.to_array())),
        Some(([0.0; 3], [1.0; 3]))
    );
    let Density::Grid(placed) = variation.density else { panic!("{:?}", variation.density) };
    assert_eq!(placed.grid.size(), [4, 3, 3]);
    assert_eq!([0, 1, 2, 3].map(|x| placed.grid.value([x, 2, 0])), [1.0, 1.0, 3.0, 3.0]);
    assert_eq!(placed.bounds.map(|corner| corner.to_array()), [[-0.5, -1.0, -1.0], [1.5, 2.0, 2.0]]);

    // Colours by place.
    let colored = "<float name=\"sigma_t\" value=\"2\"/><volume name=\"albedo\" type=\"gridvolume\">\
                   <string name=\"filename\" value=\"v.vol\"/></volume>";
    let medium =
        heterogeneous(colored, volume([1, 1, 2], 3, &[0.5, 0.25, 0.0, 1.0, 1.0, 1.0])).expect("a medium");
    let Some(Density::Colors { absorption: Some(absorption), scattering: Some(scattering), .. }) =
        medium.variation.map(|variation| variation.density)
    else {
        panic!("colours")
    };
    assert_eq!(
        [absorption.grid.value([1, 1, 1]), scattering.grid.value([1, 1, 1])],
        [[1.0, 1.5, 2.0], [1.0, 0.5, 0.0]]
    );
    assert_eq!([absorption.grid.value([1, 1, 2]), scattering.grid.value([1, 1, 2])], [[0.0; 3], [2.0; 3]]);

    for (bytes, kind) in [
        (volume([2, 1, 1], 1, &[1.0]), ErrorKind::Syntax),
        (volume([2, 1, 1], 1, &[1.0, -1.0]), ErrorKind::Invalid),
        (volume([2, 1, 1], 1, &[1.0, f32::NAN]), ErrorKind::Invalid),
        (volume([i32::MAX; 3], 3, &[1.0]), ErrorKind::Invalid),
        (volume([-1, 1, 1], 1, &[]), ErrorKind::Invalid),
        (volume([1, 1, 1], 2, &[1.0, 1.0]), ErrorKind::Invalid),
        (b"VOL\x02".repeat(20), ErrorKind::Unsupported),
        (b"VOL".to_vec(), ErrorKind::Syntax),
    ] {
        assert_eq!(heterogeneous(grid, bytes).expect_err("a fault").kind, kind);
    }
}
