//! Layers beside the picture in an EXR.

use lookfrom_scene::{Disk, Sources, image};

use super::stage::Stage;

fn names(stage: &Stage, file: &str) -> Vec<String> {
    let found = image::read_exr(&stage.path(file), &mut Sources::new(&Disk)).unwrap();
    found.channels.into_iter().map(|(name, _)| name).collect()
}

#[test]
fn layers_have_the_names_of_pbrts() {
    let stage = Stage::new("layers");
    stage.done("render scene.toml -q -o plain.exr");
    assert_eq!(names(&stage, "plain.exr"), ["B", "G", "R"]);
    stage.done("render scene.toml -q -o layers.exr --layers geometry");
    let found = names(&stage, "layers.exr");
    for name in ["R", "Albedo.G", "N.X", "Ns.Z", "P.Y", "Variance.B", "u", "v", "depth"] {
        assert!(found.iter().any(|of_file| of_file == name), "{name} is not in {found:?}");
    }
    // The picture is the same, and its variance is that of soft edges: nothing in most places.
    let read = |file: &str| image::read_exr(&stage.path(file), &mut Sources::new(&Disk)).unwrap();
    let (plain, layers) = (read("plain.exr"), read("layers.exr"));
    // What the variances are of is said: here of X, Y and Z.
    let says =
        |of: &image::Channels| of.attributes.iter().find(|(name, _)| name == "variance.from_rgb").cloned();
    assert_eq!(says(&plain), None);
    assert!(says(&layers).expect("an attribute").1.starts_with("0.4123908 0.3575843 "));
    assert_eq!(plain.channel("G"), layers.channel("G"));
    let variances = layers.channel("Variance.G").unwrap();
    assert!(
        variances.iter().all(|&variance| variance >= 0.0) && variances.iter().any(|&variance| variance > 0.0)
    );
}

#[test]
fn what_light_is_and_how_lights_are_chosen_is_in_the_header() {
    let stage = Stage::new("color");
    stage.done("render scene.toml -q -o p.exr --color rgb --light-sampler power");
    let found = image::read_exr(&stage.path("p.exr"), &mut Sources::new(&Disk)).unwrap().attributes;
    for (name, text) in [("color", "rgb"), ("light_sampler", "power"), ("regularize", "false")] {
        assert!(found.contains(&(name.to_owned(), text.to_owned())), "{name}: {found:?}");
    }
}
