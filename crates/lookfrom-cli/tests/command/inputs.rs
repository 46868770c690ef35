//! What was read is never written over, whatever it is called and whoever writes.

use lookfrom_scene::image::encode_png;

use super::stage::{MODEL, SCENE, Stage};

/// `chair.obj`, whose texture has the name that its picture would have.
fn chair(stage: &Stage) -> Vec<u8> {
    stage.write("chair.obj", &format!("mtllib chair.mtl\nusemtl wood\n{MODEL}"));
    stage.write("chair.mtl", "newmtl wood\nmap_Kd chair.png\n");
    let picture = encode_png(1, 1, &[200, 100, 50]).unwrap();
    std::fs::write(stage.path("chair.png"), &picture).unwrap();
    picture
}

const SMALL: &str = "--size 8 --samples 1";

#[test]
fn a_texture_of_the_pictures_name_stays() {
    let stage = Stage::new("inputs");
    let texture = chair(&stage);
    let names = stage.names();
    let says = ["cannot write chair.png", "an input of chair.obj", "help: ", "-o other.png"];
    stage.run(&format!("render chair.obj {SMALL}")).fails(3, &says);
    stage.run(&format!("render chair.obj {SMALL} --write-every 1ms")).fails(3, &says);
    assert_eq!((stage.bytes("chair.png"), stage.names()), (texture.clone(), names));
    // What is not there would be read the next time.
    std::fs::remove_file(stage.path("chair.png")).unwrap();
    let run = stage.run(&format!("render chair.obj {SMALL}"));
    run.fails(3, &["cannot write chair.png", "an input of chair.obj"]);
    assert!(!stage.path("chair.png").exists());
    std::fs::write(stage.path("chair.png"), texture).unwrap();
    stage.done(&format!("render chair.obj {SMALL} -o other.png"));
}

#[test]
fn a_file_is_the_same_by_any_name() {
    let stage = Stage::new("inputs-names");
    let texture = chair(&stage);
    std::fs::create_dir(stage.path("sub")).unwrap();
    let mut names = vec![
        "./chair.png".to_owned(),
        "sub/../chair.png".to_owned(),
        stage.path("chair.png").display().to_string(),
    ];
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("../chair.png", stage.path("sub/link.png")).unwrap();
        std::os::unix::fs::symlink("sub", stage.path("folder")).unwrap();
        std::fs::hard_link(stage.path("chair.png"), stage.path("hard.png")).unwrap();
        names.extend(["sub/link.png", "folder/../chair.png", "hard.png"].map(str::to_owned));
    }
    for name in names {
        stage.run(&format!("render chair.obj {SMALL} -o {name}")).fails(3, &["an input of chair.obj"]);
    }
    // Another name for the scene that leads to the same texture.
    stage.run(&format!("render sub/../chair.obj {SMALL} -o chair.png")).fails(3, &["an input of"]);
    assert_eq!(stage.bytes("chair.png"), texture);
}

#[test]
#[cfg(unix)]
fn links_and_permissions_of_what_is_replaced_stay() {
    use std::os::unix::fs::PermissionsExt;
    let stage = Stage::new("inputs-links");
    stage.write("real.png", "old");
    let real = stage.path("real.png");
    std::fs::set_permissions(&real, std::fs::Permissions::from_mode(0o640)).unwrap();
    std::os::unix::fs::symlink("real.png", stage.path("link.png")).unwrap();
    stage.done(&format!("render scene.toml {SMALL} -o link.png"));
    assert!(stage.path("link.png").is_symlink() && stage.bytes("real.png").starts_with(b"\x89PNG"));
    assert_eq!(std::fs::metadata(&real).unwrap().permissions().mode() & 0o777, 0o640);
    // What is no file is not replaced.
    std::os::unix::fs::symlink("/dev/null", stage.path("null.png")).unwrap();
    stage.done(&format!("render scene.toml {SMALL} -o null.png"));
    assert!(!std::fs::metadata("/dev/null").unwrap().is_file());
}

#[test]
fn every_kind_of_input_stays() {
    let stage = Stage::new("inputs-kinds");
    let picture = encode_png(1, 1, &[9, 9, 9]).unwrap();
    std::fs::write(stage.path("t.png"), &picture).unwrap();
    let textured = format!(
        "{SCENE}\n[textures.t]\ntype = \"image\"\nfile = \"t.png\"\n[materials.m]\ndiffuse = \"t\"\n"
    );
    stage.write("part.toml", &textured);
    stage.write("whole.toml", "import = \"part.toml\"\n");
    stage.run("render whole.toml -o t.png").fails(3, &["an input of whole.toml"]);
    stage
        .run(&format!("render scene.toml {SMALL} --environment t.png -o t.png"))
        .fails(3, &["--environment"]);
    stage
        .run("inspect whole.toml 0 0 --svg part.toml")
        .fails(3, &["an input of whole.toml", "--svg other.toml"]);
    stage.run("inspect whole.toml 0 0 --svg whole.toml").fails(3, &["the scene itself"]);
    stage.run("inspect model.obj 0 0 --environment t.png --svg t.png").fails(3, &["--environment"]);
    let run = stage.run("compare t.png t.png --html t.png");
    assert!(run.code == Some(3) && run.stderr.contains("cannot write t.png"), "{}", run.stderr);
    stage.write("s.pbrt", "Include \"part.pbrt\"\nWorldBegin\nShape \"sphere\"\n");
    stage.write("part.pbrt", "LookAt 0 0 5  0 0 0  0 1 0\nCamera \"perspective\"\n");
    stage.run("inspect s.pbrt 0 0 --svg part.pbrt").fails(3, &["an input of s.pbrt"]);
    assert_eq!((stage.bytes("t.png"), stage.bytes("part.toml")), (picture, textured.into_bytes()));
}

#[test]
fn a_turntable_is_refused_before_its_first_picture() {
    let stage = Stage::new("inputs-turntable");
    let texture = chair(&stage);
    stage.write("chair.mtl", "newmtl wood\nmap_Kd chair-002.png\n");
    std::fs::rename(stage.path("chair.png"), stage.path("chair-002.png")).unwrap();
    stage.run(&format!("render chair.obj {SMALL} --turntable 4")).fails(3, &["cannot write chair-002.png"]);
    assert_eq!(stage.bytes("chair-002.png"), texture);
    assert!(!stage.path("chair-000.png").exists());
}

#[test]
fn a_batch_keeps_what_its_later_scenes_read() {
    let stage = Stage::new("inputs-batch");
    let texture = chair(&stage);
    stage.write("chair.mtl", "newmtl wood\nmap_Kd model.png\n");
    std::fs::rename(stage.path("chair.png"), stage.path("model.png")).unwrap();
    let run = stage.run(&format!("render model.obj chair.obj {SMALL}"));
    run.fails(3, &["cannot write model.png: it is an input of chair.obj"]);
    assert_eq!(stage.bytes("model.png"), texture);
    assert!(stage.path("chair.png").exists(), "the other scene is rendered");
    // Where nothing was before, the scene that would read the new picture is refused.
    std::fs::remove_file(stage.path("model.png")).unwrap();
    std::fs::remove_file(stage.path("chair.png")).unwrap();
    let run = stage.run(&format!("render model.obj chair.obj {SMALL}"));
    run.fails(3, &["chair.obj reads model.png", "two calls"]);
    assert!(stage.path("model.png").exists() && !stage.path("chair.png").exists());
}
