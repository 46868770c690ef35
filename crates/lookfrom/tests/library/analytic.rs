//! Pictures whose colours can be worked out on paper.

use crate::support::{Compiled, close, scene};

/// The colour of the middle of a tiny picture, seen from (0, 0, 5) toward the origin through the pixel's centre.
fn middle(samples: u32, rest: &str) -> [f32; 3] {
    let toml = format!(
        "[camera]\nlookfrom = [0, 0, 5]\nlookat = [0, 0, 0]\nfov = 40\n\
         [image]\nwidth = 33\nheight = 33\ncrop = [16, 16, 17, 17]\nfilter = {{ type = \"box\", radius = 1e-6 }}\n\
         [render]\nsamples = {samples}\nmin_contribution = 0\n{rest}"
    );
    Compiled::new(scene(&toml)).film().mean(16, 16)
}

/// A white surface in the plane z = 0 that faces the eye.
const WHITE: &str = "
    [materials.white]
    diffuse = 1
    [[quad]]
    corner = [-9, -9, 0]
    edge_u = [18, 0, 0]
    edge_v = [0, 18, 0]
    material = \"white\"
";

#[test]
fn a_white_surface_shows_the_intensity_of_the_light_that_it_faces() {
    let lit = |light: &str| middle(1, &format!("{WHITE}[[light]]\n{light}"));
    let rgb = "intensity = [0.5, 0.25, 1]";
    assert!(close(lit(&format!("type = \"point\"\nposition = [0, 0, 1]\n{rgb}")), [0.5, 0.25, 1.0], 1e-5));
    assert!(close(
        lit(&format!("type = \"point\"\nposition = [0, 0, 2]\n{rgb}")),
        [0.125, 0.0625, 0.25],
        1e-5
    ));
    let unfading = format!("type = \"point\"\nposition = [0, 0, 2]\nfalloff = \"none\"\n{rgb}");
    assert!(close(lit(&unfading), [0.5, 0.25, 1.0], 1e-5));
    // from 60° off the normal: half of it
    let slanted = format!("type = \"distant\"\ndirection = [0.8660254, 0, -0.5]\n{rgb}");
    assert!(close(lit(&slanted), [0.25, 0.125, 0.5], 1e-5));
    let spot =
        format!("type = \"spot\"\nposition = [0, 0, 1]\ndirection = [0, 0, -1]\ncone_angle = 20\n{rgb}");
    assert!(close(lit(&spot), [0.5, 0.25, 1.0], 1e-5));
    let beside =
        format!("type = \"spot\"\nposition = [2, 0, 1]\ndirection = [0, 0, -1]\ncone_angle = 20\n{rgb}");
    assert_eq!(lit(&beside), [0.0; 3]);
    // radiance L from all around leaves a white surface with L
    assert!(close(lit("type = \"environment\"\ncolor = 0.6"), [0.6; 3], 1e-5));
    assert!(close(lit("type = \"ambient\"\ncolor = 0.3"), [0.3; 3], 1e-6));
}

#[test]
fn area_lights_have_their_form_factors() {
    // A disk of radius R that faces the surface from the height h: L R² / (R² + h²). It stands beside the view and is
    // seen by the surface point under it only through symmetry, so the eye looks past its rim from above.
    let lit = |light: &str| middle(4096, &format!("{WHITE}[[light]]\n{light}"))[0];
    let expect = |value: f32, expected: f32| {
        assert!((value - expected).abs() < 0.01 * expected, "{value} is not {expected}");
    };
    // A sphere of radius R whose centre is h above: L R² / h², here seen slantwise: times cos θ.
    let (x, z, radius) = (3.0f32, 2.0f32, 0.8f32);
    let distance2 = x * x + z * z;
    let sphere = lit("type = \"sphere\"\ncenter = [3, 0, 2]\nradius = 0.8\nradiance = 4");
    expect(sphere, 4.0 * radius * radius / distance2 * (z / distance2.sqrt()));
    // Small plates of area A at the distance r that face the point: L A cos θ / (π r²).
    let plate = |area: f32| 100.0 * area / (std::f32::consts::PI * distance2) * (z / distance2.sqrt());
    let disk = "type = \"disk\"\ncenter = [3, 0, 2]\nnormal = [-3, 0, -2]\nradius = 0.05\nradiance = 100";
    expect(lit(disk), plate(std::f32::consts::PI * 0.0025));
    let rectangle = "type = \"rectangle\"\ncenter = [3, 0, 2]\ntarget = [0, 0, 0]\nwidth = 0.1\nheight = 0.05\nradiance = 100";
    expect(lit(rectangle), plate(0.005));
}

#[test]
fn a_mirror_shows_what_stands_where_the_image_says() {
    // A mirror in z = 0 shows the sphere at (0, 0, 9), behind the eye, where its image at (0, 0, −9) would be seen.
    let mirror = "
        [materials.mirror]
        diffuse = 0
        mirror = 0.9
        [materials.glow]
        diffuse = 0
        emission = [1, 0.5, 0.25]
        [[quad]]
        corner = [-9, -9, 0]
        edge_u = [18, 0, 0]
        edge_v = [0, 18, 0]
        material = \"mirror\"
        [[sphere]]
        material = \"glow\"
    ";
    let seen = |x: f32, y: f32| middle(1, &format!("{mirror}center = [{x}, {y}, 9]\nradius = 0.5"));
    assert!(close(seen(0.0, 0.0), [0.9, 0.45, 0.225], 1e-6));
    assert_eq!(seen(0.6, 0.0), [0.0; 3]);
    assert_eq!(seen(0.0, -0.6), [0.0; 3]);
    assert!(close(seen(0.4, 0.2), [0.9, 0.45, 0.225], 1e-6));
}

#[test]
fn a_pane_of_glass_moves_what_is_behind_it_by_snells_law() {
    // A pane of thickness 1 and index 1.5, turned by 45°, shifts the ray sideways by d sin(θ − θ') / cos θ'.
    let theta = std::f32::consts::FRAC_PI_4;
    let inside = (theta.sin() / 1.5).asin();
    let shift = (theta - inside).sin() / inside.cos();
    let pane = "
        [materials.glass]
        diffuse = 0
        transmission = 1
        ior = 1.5
        [materials.glow]
        diffuse = 0
        emission = 1
        [[box]]
        min = [-5, -5, -0.5]
        max = [5, 5, 0.5]
        material = \"glass\"
        rotate = [0, 45, 0]
        [[sphere]]
        material = \"glow\"
        radius = 0.05
    ";
    let seen = |x: f32| middle(1, &format!("{pane}center = [{x}, 0, -8]"))[0];
    // Turned by +45° about y, the pane's near face looks to (1, 0, 1)/√2. The ray along (0, 0, −1) is bent towards the
    // opposite of that normal, thus to −x, and leaves the pane at x = −shift. The sphere's rim is 0.05 from there.
    let exit = -shift;
    for (offset, expected) in [(0.0, 1.0), (0.0499, 1.0), (-0.0499, 1.0), (0.0501, 0.0), (-0.0501, 0.0)] {
        assert_eq!(seen(exit + offset), expected, "{offset} beside {exit}");
    }
    // Neither straight on nor to the other side.
    assert_eq!([seen(0.0), seen(shift)], [0.0; 2]);
}

#[test]
fn light_that_is_totally_reflected_inside_comes_out_elsewhere() {
    // The eye's ray enters a right-angled prism head on, is totally reflected by the face at 45° (critical angle 41.8°)
    // and leaves downward: it sees the glow below and nothing behind.
    let prism = "
        [materials.glass]
        diffuse = 0
        transmission = 1
        ior = 1.5
        [materials.glow]
        diffuse = 0
        emission = 1
        [[mesh]]
        material = \"glass\"
        positions = [[-1,-1,1],[1,-1,1],[1,1,1],[-1,1,1],[-1,-1,-1],[1,-1,-1]]
        triangles = [[0,1,2],[0,2,3],[4,1,0],[4,5,1],[3,2,5],[3,5,4],[0,3,4],[1,5,2]]
        [[sphere]]
        material = \"glow\"
        radius = 0.5
    ";
    let seen = |center: &str| middle(1, &format!("{prism}center = {center}"))[0];
    assert!((seen("[0, -4, 0]") - 1.0).abs() < 1e-6);
    assert_eq!(seen("[0, 0, -4]"), 0.0);
    assert_eq!(seen("[0, 4, 0]"), 0.0);
}

#[test]
fn glass_swallows_by_beers_law() {
    let slab = |thickness: f32| {
        format!(
            "[materials.glass]\ndiffuse = 0\ntransmission = 1\nior = 1.5\nabsorption = [0.5, 1, 0]\n\
             [[box]]\nmin = [-5, -5, {}]\nmax = [5, 5, 0]\nmaterial = \"glass\"\n\
             [[light]]\ntype = \"environment\"\ncolor = 1\n",
            -thickness
        )
    };
    for thickness in [0.5f32, 2.0] {
        let expected = [0.5f32, 1.0, 0.0].map(|sigma| (-sigma * thickness).exp());
        assert!(close(middle(1, &slab(thickness)), expected, 1e-5));
    }
}

#[test]
fn a_shadow_ends_where_its_edge_is() {
    // A point light at height 4 over a plate at height 2 whose edge is x = 0.5: the shadow on the ground ends at x = 1.
    let toml = |x: f32| {
        format!(
            "[camera]\nlookfrom = [{x}, 1, 0]\nlookat = [{x}, 0, 0]\nup = [0, 0, -1]\n\
             [image]\nwidth = 1\nheight = 1\nfilter = {{ type = \"box\", radius = 1e-6 }}\n[render]\nsamples = 1\n\
             [[quad]]\ncorner = [-9, 0, 9]\nedge_u = [18, 0, 0]\nedge_v = [0, 0, -18]\n\
             [[quad]]\ncorner = [-3, 2, 3]\nedge_u = [3.5, 0, 0]\nedge_v = [0, 0, -6]\n\
             [[light]]\ntype = \"point\"\nposition = [0, 4, 0]\nintensity = 9\n"
        )
    };
    let brightness = |x: f32| Compiled::new(scene(&toml(x))).film().mean(0, 0)[0];
    assert_eq!(brightness(0.999), 0.0);
    assert!(brightness(1.001) > 0.1);
}

#[test]
fn transparent_shadows_are_coloured() {
    let scene_with = |setting: &str| {
        format!(
            "{setting}\n{WHITE}\n[materials.pane]\ndiffuse = 0\ntransmission = [1, 0.5, 0.25]\nior = 1\n\
             [[quad]]\ncorner = [0.5, -1, 1]\nedge_u = [2, 0, 0]\nedge_v = [0, 2, 0]\nmaterial = \"pane\"\n\
             [[light]]\ntype = \"point\"\nposition = [3, 0, 2]\nintensity = 1\nfalloff = \"none\"\n"
        )
    };
    let cosine = 2.0 / 13.0f32.sqrt();
    let filtered = middle(1, &scene_with(""));
    assert!(close(filtered, [cosine, 0.5 * cosine, 0.25 * cosine], 1e-5), "{filtered:?}");
    assert_eq!(middle(1, &scene_with("transparent_shadows = false")), [0.0; 3]);
}
