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

/// What a desk says, frames as their headers and what belongs to them.
fn said(desk: &Desk) -> Vec<(Value, Vec<u8>)> {
    let split = |message| match message {
        Outgoing::Text(text) => (serde_json::from_str(&text).expect("it is JSON"), Vec::new()),
        Outgoing::Binary(bytes) => {
            let length = u32::from_le_bytes(bytes[..4].try_into().expect("four bytes")) as usize;
            let header = serde_json::from_slice(&bytes[4..4 + length]).expect("it is JSON");
            (header, bytes[4 + length..].to_vec())
        }
    };
    std::iter::from_fn(|| desk.say()).map(split).collect()
}

/// The messages of a number of turns; ends when there is no more work.
fn turns(desk: &mut Desk, most: usize) -> Vec<(Value, Vec<u8>)> {
    let mut heard = Vec::new();
    for _ in 0..most {
        let has_more = desk.turn();
        heard.extend(said(desk));
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

/// What a hand-out holds.
fn held(html: &[u8]) -> Value {
    let html = std::str::from_utf8(html).expect("a text");
    let (_, rest) = html.split_once("id=\"handout\">").expect("its data");
    serde_json::from_str(rest.split("</script>").next().expect("their end")).expect("they are JSON")
}

#[test]
fn a_page_is_saved_with_the_view_and_its_pixel() {
    let mut desk = desk(Duration::from_millis(30), SCENE);
    let camera =
        json!({ "lookfrom": [5.0, 1.0, 0.0], "lookat": [0.0, 0.0, 0.0], "up": [0.0, 1.0, 0.0], "fov": 30.0 });
    desk.hear(
        &json!({ "type": "view", "id": 1, "camera": camera, "size": [64, 48], "exposure": 1.0, "samples": 9, "layer": "depth" })
            .to_string(),
    );
    let heard = turns(&mut desk, 1000);
    let hash =
        heard.iter().rev().find(|(message, _)| message["type"] == "progress").expect("an end").0["hash"]
            .clone();
    desk.hear(&json!({ "type": "inspect", "id": 2, "x": 30, "y": 20, "sample": 5 }).to_string());
    let inspection = turns(&mut desk, 10)[0].0["inspection"].clone();
    desk.hear(&json!({ "type": "handout", "id": 3, "pixel": [30, 20], "sample": 5 }).to_string());
    let (header, html) = turns(&mut desk, 10).remove(0);
    assert_eq!(header, json!({ "kind": "file", "id": 3, "name": "scene.html", "mime": "text/html" }));
    let held = held(&html);
    assert_eq!((&held["pixel"], &held["sample"]), (&json!([30, 20]), &json!(5)));
    assert_eq!(held["samples"].as_object().expect("samples").len(), 8, "the brightest, too");
    assert_eq!(held["samples"]["5"]["inspection"]["inspection"], inspection);
    assert_eq!(held["progress"]["hash"], hash);
    assert_eq!((&held["scene"]["size"], &held["scene"]["exposure"]), (&json!([64, 48]), &json!(1.0)));
    assert_eq!(held["scene"]["camera"]["lookfrom"], json!([5.0, 1.0, 0.0]));
    assert_eq!((&held["picture"]["layer"], &held["picture"]["done"]), (&json!("color"), &json!(true)));
    assert_eq!(held["source"], SCENE);

    desk.hear(&json!({ "type": "handout", "id": 4, "pixel": [64, 20] }).to_string());
    let error = &turns(&mut desk, 10)[0].0;
    assert_eq!((&error["type"], &error["id"]), (&json!("error"), &json!(4)));
    assert!(
        error["message"].as_str().expect("a text").contains("outside of the picture of 64 × 48"),
        "{error}"
    );
}

/// Where nothing can be saved beside the scene, the text of a view is the whole scene.
#[test]
fn words_are_the_whole_scene() {
    let mut desk = desk(Duration::from_millis(30), SCENE);
    desk.hear(
        &json!({ "type": "view", "id": 1, "size": [64, 48], "samples": 2, "depth": 3, "tonemap": "clamp" })
            .to_string(),
    );
    turns(&mut desk, 1000);
    desk.hear(&json!({ "type": "words", "id": 2 }).to_string());
    let words = turns(&mut desk, 10).remove(0).0;
    let text = words["toml"].as_str().expect("a text");
    assert!(!text.contains("import") && text.contains("[materials.red]"), "{text}");
    let picture = |text: &str, options: &Options| {
        let session = Session::from_bytes("scene.toml", text.into(), options);
        let session = session.unwrap_or_else(|error| panic!("{error}\n{text}"));
        session.render(&()).expect("a picture").picture.pixels.clone()
    };
    let options = Options {
        width: Some(64),
        height: Some(48),
        samples: Some(2),
        depth: Some(3),
        tonemap: Some(Tonemap::Clamp),
        ..Options::default()
    };
    assert_eq!(picture(text, &Options::default()), picture(SCENE, &options));
}

#[test]
fn the_vocabulary_is_that_of_the_reader() {
    let mut desk = desk(Duration::from_millis(30), SCENE);
    desk.hear(&json!({ "type": "vocabulary", "id": 1 }).to_string());
    let answer = turns(&mut desk, 1000).pop().expect("an answer").0;
    let told: Vec<(String, Vec<&str>)> = lookfrom_scene::toml::vocabulary();
    let told: Vec<Value> = told.iter().map(|(title, keys)| json!({ "title": title, "keys": keys })).collect();
    assert_eq!(answer["tables"], Value::from(told));
}

/// The hash of a picture that is rendered with a helper, and how many parts were lent. `pass` may change each film on its way.
fn with_helper(pass: impl Fn(usize, Vec<u8>) -> Vec<u8>) -> (Value, usize) {
    let scene = SCENE.replace("samples = 4", "samples = 40");
    let keeps_films =
        || Settings { options: Options { film: true, ..Options::default() }, ..settings("scene.toml") };
    let [mut desk, mut helper] = [(); 2].map(|()| Desk::new(Duration::ZERO));
    for desk in [&mut desk, &mut helper] {
        desk.open(keeps_films(), files(&[("scene.toml", scene.as_bytes())]));
        desk.hear(&view(1));
    }
    let mut parts = 0;
    for _ in 0..1000 {
        desk.turn();
        // Two are out at once, and come back in the other order.
        let lent = [desk.lend(Duration::ZERO), desk.lend(Duration::ZERO)];
        for part in lent.iter().rev().flatten() {
            let film = helper.render_part(part).expect("it has the scene");
            desk.take_part(part, &pass(parts, film));
            parts += 1;
        }
        let progress = said(&desk).into_iter().map(|(message, _)| message);
        if let Some(done) = progress.into_iter().find(|message| message["hash"].is_string()) {
            assert_eq!((&done["samples"], &done["of"]), (&json!(40), &json!(40)));
            assert!(!desk.turn() && desk.lend(Duration::ZERO).is_none(), "there is no more to do");
            return (done["hash"].clone(), parts);
        }
    }
    panic!("it never ends")
}

#[test]
fn a_picture_with_helpers_has_the_same_bits() {
    let alone = {
        let mut desk = desk(Duration::from_millis(30), &SCENE.replace("samples = 4", "samples = 40"));
        desk.hear(&view(1));
        let heard = turns(&mut desk, 1000);
        heard.iter().rev().find_map(|(message, _)| message["hash"].as_str().map(Value::from)).expect("an end")
    };
    let (helped, parts) = with_helper(|_, film| film);
    assert!(parts > 4, "{parts} parts");
    assert_eq!(helped, alone);
    // Whatever a helper does: none, a film that is damaged, one of other samples.
    let first = std::cell::RefCell::new(Vec::new());
    let (helped, _) = with_helper(|number, mut film| match number {
        1 => Vec::new(),
        3 => {
            let middle = film.len() / 2;
            film[middle] ^= 1;
            film
        }
        4 => first.borrow().clone(),
        _ => {
            first.replace(film.clone());
            film
        }
    });
    assert_eq!(helped, alone);
}

#[test]
fn a_part_of_an_earlier_view_is_not_added() {
    let scene = SCENE.replace("samples = 4", "samples = 40");
    let mut desk = Desk::new(Duration::ZERO);
    let options = Options { film: true, ..Options::default() };
    desk.open(Settings { options, ..settings("scene.toml") }, files(&[("scene.toml", scene.as_bytes())]));
    desk.hear(&view(1));
    let lent = (0..100).find_map(|_| {
        desk.turn();
        desk.lend(Duration::ZERO)
    });
    let part = lent.expect("a part");
    let film = desk.render_part(&part).expect("its own film");
    desk.hear(&json!({ "type": "view", "id": 2, "samples": 60, "tonemap": "clamp" }).to_string());
    desk.turn();
    said(&desk);
    desk.take_part(&part, &film);
    assert_eq!(said(&desk), [], "nothing has changed");
    assert!(desk.lend(Duration::from_secs(1000)).is_none(), "it is not worth the while");
}
