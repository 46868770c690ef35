//! A page without a server: one window on the thread of its caller, scenes in memory.

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use lookfrom::session::{Format, Options, Session};
use lookfrom_scene::settings::Tonemap;
use lookfrom_scene::{LoadContext, Memory, image};
use lookfrom_view::{Desk, Outgoing, Settings};
use serde_json::{Value, json};

const SCENE: &str = r#"
[camera]
lookfrom = [0, 1, 5]
lookat = [0, 0, 0]

[image]
width = 96
height = 72

[render]
samples = 4

[[sphere]]
center = [0, 0, 0]
radius = 1
material = "red"

[materials.red]
diffuse = [0.8, 0.1, 0.1]

[[light]]
type = "point"
position = [3, 4, 5]
intensity = [20, 20, 20]
"#;

fn files(files: &[(&str, &[u8])]) -> Arc<Memory> {
    let files = files.iter().map(|(path, bytes)| (Path::new(path).to_owned(), bytes.to_vec()));
    Arc::new(Memory(files.collect()))
}

fn settings(scene: &str) -> Settings {
    Settings {
        scene: scene.into(),
        options: Options::default(),
        environment: None,
        reference: None,
        typed: Vec::new(),
    }
}

/// A desk with this scene.
fn desk(slice: Duration, text: &str) -> Desk {
    let mut desk = Desk::new(slice);
    desk.open(settings("scene.toml"), files(&[("scene.toml", text.as_bytes())]));
    desk
}

/// The messages of a number of turns, frames as their headers; ends when there is no more work.
fn turns(desk: &mut Desk, most: usize) -> Vec<(Value, Vec<u8>)> {
    let mut heard = Vec::new();
    for _ in 0..most {
        let has_more = desk.turn();
        while let Some(message) = desk.say() {
            heard.push(match message {
                Outgoing::Text(text) => (serde_json::from_str(&text).expect("it is JSON"), Vec::new()),
                Outgoing::Binary(bytes) => {
                    let length = u32::from_le_bytes(bytes[..4].try_into().expect("four bytes")) as usize;
                    let header = serde_json::from_slice(&bytes[4..4 + length]).expect("it is JSON");
                    (header, bytes[4 + length..].to_vec())
                }
            });
        }
        if !has_more {
            return heard;
        }
    }
    panic!("{most} turns are not enough")
}

fn view(id: u64) -> String {
    json!({ "type": "view", "id": id, "tonemap": "clamp" }).to_string()
}

#[test]
fn turns_make_the_picture_of_the_command() {
    let mut desk = desk(Duration::from_millis(30), SCENE);
    let told = turns(&mut desk, 1);
    assert_eq!(told[0].0["type"], "scene");
    assert_eq!(told[0].0["size"], json!([96, 72]));
    desk.hear(&view(7));
    let heard = turns(&mut desk, 1000);
    let (header, png) = heard.last().expect("a picture");
    assert_eq!(
        (&header["kind"], &header["done"], &header["view"]),
        (&json!("picture"), &json!(true), &json!(7))
    );
    let options = Options { tonemap: Some(Tonemap::Clamp), ..Options::default() };
    let session = Session::from_bytes("scene.toml", SCENE.into(), &options).expect("a scene");
    let mut expected = std::io::Cursor::new(Vec::new());
    session.render(&()).expect("a picture").write(Format::Png, &mut expected).expect("an encoder");
    let texels = |bytes: &[u8]| {
        let files = files(&[("a.png", bytes)]);
        let image = image::read(Path::new("a.png"), &mut LoadContext::new(&*files)).expect("a picture");
        (0..96 * 72).map(|index| image.texel(index)).collect::<Vec<_>>()
    };
    assert_eq!(texels(png), texels(&expected.into_inner()));
}

#[test]
fn a_slice_that_is_too_short_for_anything_still_ends() {
    let mut desk = desk(Duration::ZERO, SCENE);
    desk.hear(&view(1));
    // Nine tiles, in five passes at most, and what is coarse.
    let heard = turns(&mut desk, 60);
    assert_eq!(heard.last().expect("a picture").0["done"], true);
}

#[test]
fn messages_are_answered_between_turns() {
    let mut desk = desk(Duration::ZERO, &SCENE.replace("samples = 4", "samples = 100000"));
    desk.hear(&view(1));
    for _ in 0..40 {
        assert!(desk.turn(), "there are many samples");
    }
    desk.hear(&json!({ "type": "inspect", "id": 2, "x": 48, "y": 36, "sample": 0 }).to_string());
    desk.hear(&json!({ "type": "value", "id": 3, "x": 200, "y": 36 }).to_string());
    assert!(desk.turn());
    let mut texts = Vec::new();
    while let Some(message) = desk.say() {
        if let Outgoing::Text(text) = message {
            texts.push(serde_json::from_str::<Value>(&text).expect("it is JSON"));
        }
    }
    let of = |id: u64| texts.iter().find(|text| text["id"] == id).expect("an answer");
    assert_eq!(of(2)["type"], "inspection");
    assert_eq!(of(3)["type"], "error");
}

#[test]
fn a_broken_scene_is_told_with_its_line_and_the_last_good_one_stays() {
    let mut desk = desk(Duration::from_millis(30), SCENE);
    desk.hear(&view(1));
    turns(&mut desk, 1000);
    let broken = SCENE.replace("radius = 1", "radius = one");
    desk.open(settings("scene.toml"), files(&[("scene.toml", broken.as_bytes())]));
    let heard = turns(&mut desk, 10);
    let (error, _) = &heard[0];
    assert_eq!((&error["type"], &error["id"]), (&json!("error"), &Value::Null));
    let line = 1 + SCENE.lines().position(|line| line == "radius = 1").expect("it is there");
    assert_eq!(error["place"]["file"], "scene.toml");
    assert_eq!(error["place"]["line"], line);
    assert!(error["excerpt"].as_str().expect("a line").starts_with("radius = one\n"), "{error}");
    desk.hear(&json!({ "type": "value", "id": 3, "x": 48, "y": 36 }).to_string());
    assert_eq!(turns(&mut desk, 10)[0].0["type"], "value");

    // Mended, it is shown in the same view without a request.
    desk.open(settings("scene.toml"), files(&[("scene.toml", SCENE.as_bytes())]));
    let heard = turns(&mut desk, 1000);
    assert_eq!((&heard[0].0["type"], &heard[0].0["generation"]), (&json!("scene"), &json!(3)));
    assert_eq!(heard.last().expect("a picture").0["view"], 1);
}

#[test]
fn files_of_a_scene_come_from_memory() {
    let text = SCENE.replace("[0.8, 0.1, 0.1]", "{ type = \"image\", file = \"textures/red.png\" }");
    let mut desk = Desk::new(Duration::from_millis(30));
    desk.open(settings("a/scene.toml"), files(&[("a/scene.toml", text.as_bytes())]));
    let error = &turns(&mut desk, 10)[0].0;
    assert!(error["message"].as_str().expect("a text").contains("no such file"), "{error}");
    let red = image::encode_png(1, 1, &[255, 0, 0]).expect("an encoder");
    desk.open(
        settings("a/scene.toml"),
        files(&[("a/scene.toml", text.as_bytes()), ("a/textures/red.png", &red)]),
    );
    assert_eq!(turns(&mut desk, 10)[0].0["type"], "scene");

    // The scene is read again from there in another variation.
    let moving = text.replace("radius = 1", "radius = { keyframes = [[0, 1], [2, 0.5]] }");
    desk.open(
        settings("a/scene.toml"),
        files(&[("a/scene.toml", moving.as_bytes()), ("a/textures/red.png", &red)]),
    );
    desk.hear(&json!({ "type": "view", "id": 5, "at": 1.0 }).to_string());
    let heard = turns(&mut desk, 1000);
    assert!(heard.iter().all(|(message, _)| message["type"] != "error"), "{heard:?}");
    assert_eq!(heard.last().expect("a picture").0["done"], true);
}
