//! What pictures are called.

use super::stage::{SCENE, Stage};

#[test]
fn scenes_of_one_name_are_told_apart() {
    let stage = Stage::new("naming");
    for folder in ["oak", "steel"] {
        std::fs::create_dir(stage.path(folder)).unwrap();
        stage.write(&format!("{folder}/chair.toml"), SCENE);
    }
    let render =
        |output: &str| format!("render oak/chair.toml steel/chair.toml -q --samples 1 --width 8 {output}");
    stage.run(&render("-o out/")).fails(
        2,
        &["oak/chair.toml and steel/chair.toml", "both be out/chair.png", "{parent}", "{dir}", "{n}"],
    );
    assert!(!stage.path("out").exists(), "nothing is made where nothing is rendered");
    stage.done(&render("-o new/out/{parent}.png"));
    stage.done(&render("-o {dir}/pictures/{name}.png"));
    stage.done(&render("-o {n}-{name}.png"));
    for name in [
        "new/out/oak.png",
        "new/out/steel.png",
        "oak/pictures/chair.png",
        "steel/pictures/chair.png",
        "1-chair.png",
        "2-chair.png",
    ] {
        assert!(stage.path(name).exists(), "{name}");
    }
    stage.done(&render("-o {{n}}-{n}.png"));
    assert!(stage.path("{n}-2.png").exists());
    // Two names of one picture.
    stage
        .run("render oak/chair.toml ./oak/chair.toml -q --width 8 -o {dir}/p.png")
        .fails(2, &["would both be ./oak/p.png"]);
}

#[test]
fn a_name_is_no_way_out_of_the_folder() {
    let stage = Stage::new("naming-points");
    for name in ["..toml", "...toml"] {
        stage.write(name, SCENE);
        stage.done(&format!("render {name} -o out/{{name}}/a.png"));
        assert!(stage.path("out/picture/a.png").exists() && !stage.path("a.png").exists());
        std::fs::remove_dir_all(stage.path("out")).unwrap();
    }
}

#[test]
fn unknown_words_name_the_known_ones() {
    let stage = Stage::new("naming-words");
    let known = "{name}, {dir}, {parent}, {n}";
    stage.run("render scene.toml -o {nam}.png").fails(2, &["no {nam}", "did you mean {name}?", known]);
    stage.run("render scene.toml -o {frame}.png").fails(2, &["no {frame}", known]);
    stage.run("render scene.toml -o a{.png").fails(2, &["a single {", known, "{{ and }}"]);
    assert_eq!(stage.names(), ["model.obj", "scene.toml"]);
}

#[test]
fn missing_folders_are_made() {
    let stage = Stage::new("naming-folders");
    stage.done("render scene.toml -q --width 8 -o one/two/p.png");
    stage.done("render scene.toml -q --width 8 -o three/");
    stage.done("inspect scene.toml 0 0 --svg four/rays.svg");
    stage.done("compare three/scene.png three/scene.png --html five/report.html");
    for name in ["one/two/p.png", "three/scene.png", "four/rays.svg", "five/report.html"] {
        assert!(stage.path(name).exists(), "{name}");
    }
    // Only for a picture.
    stage.run("render nowhere.toml -o six/p.png").fails(1, &[]);
    assert!(!stage.path("six").exists());
}
