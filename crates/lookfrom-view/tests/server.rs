//! The server, as a page and as an attacker meet it.

mod support;

use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::Duration;

use lookfrom::inspect;
use lookfrom::render::SampleId;
use lookfrom::session::{Format, Options, Session};
use lookfrom_scene::image::{Pixels, encode_png_to_show, read_exr, without_alpha};
use lookfrom_scene::{Budget, Disk, LoadContext, json};
use serde_json::{Value, json};
use support::{SCENE, Served, view, view_from};

/// What a session says of the same scene.
fn session(served: &Served) -> Session {
    Session::open(&served.scene, &Options::default()).expect("a scene")
}

/// The finished picture of a session, as the page gets it.
fn picture(session: &Session) -> Vec<u8> {
    let shown = session.render(&()).expect("a picture").shown();
    let rgb = without_alpha(&shown.rgba);
    encode_png_to_show([shown.width, shown.height], Pixels::Rgb8(&rgb)).expect("a PNG")
}

#[test]
fn nobody_without_the_token_gets_in() {
    let served = Served::new("token", SCENE);
    let host = format!("Host: {}\r\n", served.host());
    let upgrade = "Connection: upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n";
    for token in ["", "?token=", "?token=0", "?token=00000000000000000000000000000000", "?other=1"] {
        for (path, headers) in [("/", ""), ("/socket", upgrade)] {
            let status = served.status(&format!("{path}{token}"), &format!("{host}{headers}"));
            assert!(status.contains("403"), "{path}{token}: {status}");
        }
    }
    let longer = format!("/?token={}0", served.token());
    assert!(served.status(&longer, &host).contains("403"));
    assert!(served.status("/../Cargo.toml", &host).contains("404"), "nothing but assets");
    assert!(served.status("/%2e%2e/Cargo.toml", &host).contains("404"), "nothing but assets");
}

#[test]
fn other_hosts_and_origins_are_refused() {
    let served = Served::new("hosts", SCENE);
    let path = format!("/socket?token={}", served.token());
    let upgrade = "Connection: upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n";
    let own = served.host();
    let port = own.split(':').nth(1).expect("a port");
    let status = |host: &str, origin: Option<&str>| {
        let origin = origin.map_or(String::new(), |origin| format!("Origin: {origin}\r\n"));
        served.status(&path, &format!("Host: {host}\r\n{origin}{upgrade}"))
    };
    for host in [
        "evil.example",
        &format!("evil.example:{port}"),
        "10.0.0.1",
        "127.0.0.1.evil.example",
        "",
        "[::2]:80",
    ] {
        let status = status(host, None);
        assert!(status.contains("403") || status.contains("400"), "{host}: {status}");
    }
    for origin in ["http://evil.example", "null", &format!("https://{own}"), "http://127.0.0.1:1", ""] {
        assert!(status(own, Some(origin)).contains("403"), "{origin}");
    }
    // An attacker's page of a name that leads here.
    assert!(status("evil.example", Some("http://evil.example")).contains("403"));
    // With a tunnel, the port is another one.
    for host in [own, "localhost:8000", "[::1]:8000"] {
        let status = status(host, Some(&format!("http://{host}")));
        assert!(status.contains("101"), "{host}: {status}");
    }
}

#[test]
fn the_finished_picture_is_that_of_the_library() {
    let served = Served::new("picture", SCENE);
    let mut page = served.open();
    let scene = page.text("scene");
    assert_eq!((&scene["size"], &scene["samples"]), (&json!([64, 48]), &json!(4)));
    assert_eq!(scene["camera"]["lookfrom"], json!([0.0, 1.0, 5.0]));
    assert_eq!(scene["lights"], json!([{ "name": "point", "position": [3.0, 4.0, 5.0] }]));
    page.say(&view(7));
    let first = page.frame("picture");
    assert_eq!(first.header["view"], 7);
    let last = if first.header["done"] == true { first } else { page.finished(7) };
    assert_eq!((&last.header["width"], &last.header["samples"]), (&json!(64), &json!(4)));
    assert!(last.payload == picture(&session(&served)), "the same picture");
}

#[test]
fn a_moving_camera_gives_coarse_pictures_and_a_still_one_the_whole() {
    let served = Served::new("moving", SCENE);
    let mut page = served.open();
    page.say(&view_from(1, [5.0, 0.0, 0.0], true));
    let coarse = page.frame("picture");
    assert_eq!((&coarse.header["view"], &coarse.header["done"]), (&json!(1), &json!(false)));
    assert!(coarse.header["scale"].as_u64() > Some(1), "{}", coarse.header);
    page.say(&view_from(2, [5.0, 0.0, 0.0], false));
    let whole = page.finished(2);
    assert_eq!(whole.header["scale"], 1);
    let mut session = session(&served);
    let mut camera = session.camera().clone();
    camera.view = lookfrom_scene::camera::View::Look {
        lookfrom: [5.0, 0.0, 0.0].into(),
        lookat: [0.0; 3].into(),
        up: [0.0, 1.0, 0.0].into(),
    };
    session.set_camera(camera).expect("a camera");
    assert!(whole.payload == picture(&session), "the same picture");
}

#[test]
fn the_latest_view_wins() {
    let served = Served::new("latest", &SCENE.replace("samples = 4", "samples = 100000"));
    let mut page = served.open();
    let count = 200;
    for id in 1..=count {
        page.say(&view_from(id, [5.0, id as f64 / 100.0, 0.0], false));
    }
    let mut seen = Vec::new();
    while seen.last() != Some(&count) {
        seen.push(page.frame("picture").header["view"].as_u64().expect("a number"));
    }
    assert!(seen.is_sorted(), "none comes back: {seen:?}");
    assert!(seen.len() < count as usize, "most are never rendered: {}", seen.len());
}

#[test]
fn an_inspection_is_that_of_the_library() {
    let served = Served::new("inspect", SCENE);
    let mut page = served.open();
    page.say(&view(1));
    page.finished(1);
    page.say(&json!({ "type": "inspect", "id": 5, "x": 32, "y": 20, "sample": 3 }));
    let answer = page.text("inspection");
    let session = session(&served);
    let inspection = inspect::inspect(session.renderer(), SampleId { pixel: [32, 20], sample: 3 });
    assert_eq!(answer["id"], 5);
    assert_eq!(answer["text"], inspection.to_string());
    let expected: Value = serde_json::from_str(&json::line(&inspection)).expect("it is JSON");
    assert_eq!(answer["inspection"], expected);
    page.say(&json!({ "type": "pixel", "id": 8, "x": 32, "y": 20 }));
    let answer = page.text("pixel");
    let report = inspect::inspect_pixel(session.renderer(), [32, 20], 0..4).expect("a pixel");
    let expected: Value = serde_json::from_str(&json::line(&report)).expect("it is JSON");
    assert_eq!((&answer["id"], &answer["report"]), (&json!(8), &expected));
    page.say(&json!({ "type": "value", "id": 6, "x": 32, "y": 20 }));
    let value = page.text("value");
    let film = session.render(&()).expect("a picture").rendered.film;
    let expected: Value = serde_json::from_str(&json::line(&film.mean(32, 20))).expect("it is JSON");
    assert_eq!((&value["rgb"], &value["samples"]), (&expected, &json!(4)));
}

#[test]
fn an_edit_shows_and_a_broken_one_keeps_the_last_picture() {
    let served = Served::new("edit", SCENE);
    let mut page = served.open();
    page.say(&view_from(1, [5.0, 0.0, 0.0], false));
    assert_eq!(page.text("scene")["generation"], 1);
    let before = page.finished(1).payload;
    served.write(&SCENE.replace("radius = 1", "radius = \"one\""));
    let error = page.text("error");
    assert_eq!(error["id"], Value::Null);
    assert!(error["message"].as_str().is_some_and(|text| text.contains("scene.toml:15:")), "{error}");
    assert!(
        error["excerpt"].as_str().is_some_and(|text| text.contains("\"one\"") && text.contains('^')),
        "{error}"
    );
    // The last good scene goes on.
    page.say(&view_from(2, [5.0, 0.0, 0.0], false));
    assert!(page.finished(2).payload == before);
    served.write(&SCENE.replace("radius = 1", "radius = 1.5"));
    assert_eq!(page.text("scene")["generation"], 2);
    let after = page.finished(2).payload;
    assert!(after != before, "the view stays, the sphere has grown");
}

#[test]
fn a_closed_window_ends_its_render() {
    let served = Served::new("closed", &SCENE.replace("samples = 4", "samples = 16000000"));
    let mut page = served.open();
    page.say(&view(1));
    page.frame("picture");
    served.wait_for_windows(1);
    drop(page);
    served.wait_for_windows(0);
}

#[test]
fn hostile_messages_are_answered_and_the_server_lives() {
    let served = Served::new("hostile", SCENE);
    let mut page = served.open();
    page.text("scene");
    let camera = |lookfrom: &str, up: &str| {
        format!(r#"{{"type":"view","id":1,"camera":{{"lookfrom":{lookfrom},"lookat":[0,0,0],"up":{up}}}}}"#)
    };
    let mut texts = vec![
        "x".repeat(100_000),
        String::new(),
        "{".to_owned(),
        "[".repeat(50_000),
        "null".to_owned(),
        r#"{"type":"nothing","id":1}"#.to_owned(),
        r#"{"type":"view","id":1,"size":[1000000000,1000000000]}"#.to_owned(),
        r#"{"type":"view","id":1,"size":[0,5]}"#.to_owned(),
        r#"{"type":"view","id":1,"exposure":NaN}"#.to_owned(),
        r#"{"type":"view","id":1,"exposure":1e300}"#.to_owned(),
        r#"{"type":"view","id":1,"integrator":"magic"}"#.to_owned(),
        r#"{"type":"view","id":1,"depth":4000000000}"#.to_owned(),
        r#"{"type":"view","id":1,"samples":0}"#.to_owned(),
        r#"{"type":"view","id":1,"layer":"secrets"}"#.to_owned(),
        r#"{"type":"view","id":1,"compare":{"mode":"flip"}}"#.to_owned(),
        r#"{"type":"value","id":1,"x":4000000000,"y":0}"#.to_owned(),
        r#"{"type":"pixel","id":1,"x":64,"y":0}"#.to_owned(),
        r#"{"type":"inspect","id":1,"x":64,"y":0,"sample":0}"#.to_owned(),
        r#"{"type":"space","id":1,"camera":{"lookfrom":[0,0,0],"lookat":[0,0,0],"up":[0,1,0]},"size":[10,10]}"#.to_owned(),
        r#"{"type":"space","id":1,"camera":{"lookfrom":[0,0,5],"lookat":[0,0,0],"up":[0,1,0]},"size":[1000000000,10]}"#.to_owned(),
        camera("[0,0,0]", "[0,1,0]"),
        camera("[1e400,0,0]", "[0,1,0]"),
        camera("[0,5,0]", "[0,1,0]"),
        camera("[0,5,0]", "[0,0,0]"),
    ];
    texts
        .extend(["fov", "lookat"].map(|key| format!(r#"{{"type":"view","id":1,"camera":{{"{key}":"x"}}}}"#)));
    for text in texts {
        page.say_text(text.clone());
        let error = page.text("error");
        let message = error["message"].as_str().unwrap_or_default();
        assert!(
            !message.is_empty() && !message.contains("internal error"),
            "{}: {error}",
            &text[..text.len().min(200)]
        );
    }
    page.say(&view(2));
    page.finished(2);
    // Far too long a message closes the window, and only it.
    page.say_text("x".repeat(4 << 20));
    while page.hear().is_some() {}
    let mut other = served.open();
    other.say(&view(3));
    other.finished(3);
}

#[test]
fn two_windows_have_views_of_their_own() {
    let served = Served::new("two", SCENE);
    let (mut one, mut other) = (served.open(), served.open());
    one.say(&view_from(1, [5.0, 0.0, 0.0], false));
    other.say(&view_from(1, [0.0, 0.0, 5.0], false));
    let [one, other] = [&mut one, &mut other].map(|page| page.finished(1).payload);
    assert!(one != other);
}

#[test]
fn another_development_renders_nothing_anew() {
    let served = Served::new("develop", SCENE);
    let mut page = served.open();
    page.say(&view(1));
    let plain = page.finished(1);
    let mut wish = view(2);
    wish["exposure"] = json!(2.0);
    page.say(&wish);
    let brighter = page.finished(2);
    assert!(plain.payload != brighter.payload);
    assert_eq!(plain.header["seconds"], brighter.header["seconds"], "the same film");
    let layers = [
        "albedo",
        "normal",
        "shadingNormal",
        "position",
        "depth",
        "uv",
        "error",
        "samples",
        "bounces",
        "nodes",
        "tests",
    ];
    for (id, layer) in (3..).zip(layers) {
        let mut wish = view(id);
        wish["layer"] = json!(layer);
        page.say(&wish);
        let picture = page.finished(id);
        assert_eq!(picture.header["layer"], layer);
        assert_eq!(picture.header["seconds"], plain.header["seconds"]);
    }
}

#[test]
fn the_scene_from_an_observer_has_depths_and_a_matrix() {
    let served = Served::new("space", SCENE);
    let mut page = served.open();
    page.text("scene");
    let camera = json!({ "lookfrom": [0, 0, 4], "lookat": [0, 0, 0], "up": [0, 1, 0], "fov": 60 });
    page.say(&json!({ "type": "space", "id": 9, "camera": camera, "size": [33, 33] }));
    let frame = page.frame("space");
    let numbers: Vec<f64> =
        serde_json::from_value(frame.header["screen_from_world"].clone()).expect("numbers");
    let [png, depths] = [0, 1].map(|n| frame.header["sizes"][n].as_u64().expect("a size") as usize);
    assert_eq!((depths, frame.payload.len()), (33 * 33 * 4, png + depths));
    let depth = |x: usize, y: usize| {
        let at = png + 4 * (33 * y + x);
        f32::from_le_bytes(frame.payload[at..at + 4].try_into().expect("four bytes"))
    };
    // The front of the sphere, in the middle of the picture.
    let row = |r: usize| numbers[4 * r + 2] * 1.0 + numbers[4 * r + 3];
    assert!((row(0) / row(3) - 16.5).abs() < 1e-9 && (row(1) / row(3) - 16.5).abs() < 1e-9);
    assert!((row(3) - 3.0).abs() < 1e-9 && (depth(16, 16) - 3.0).abs() < 1e-2, "{}", depth(16, 16));
    assert_eq!(depth(0, 0), f32::INFINITY);
}

#[test]
fn a_balloon_is_the_scattering_at_its_vertex() {
    let matte = SCENE.replace("radius = 1", "radius = 1\nmaterial = \"matte\"");
    let matte = format!("{matte}\n[materials.matte]\ntype = \"diffuse\"\nreflectance = 0.5\n");
    for (name, text) in [("lobe-path", matte.as_str()), ("lobe-whitted", SCENE)] {
        let served = Served::new(name, text);
        let mut page = served.open();
        page.say(&view(1));
        page.finished(1);
        page.say(&json!({ "type": "lobe", "id": 4, "x": 32, "y": 24, "sample": 0, "address": 1 }));
        let lobe = page.text("lobe");
        let number = |value: &Value| value.as_f64().expect("a number");
        let [n, m] = [&lobe["theta"], &lobe["phi"]].map(|count| count.as_u64().expect("a count") as usize);
        let (values, directions) = (&lobe["values"], &lobe["directions"]);
        assert_eq!(
            (values.as_array().map(Vec::len), directions.as_array().map(Vec::len)),
            (Some(n * m), Some(n * m))
        );
        let vector = |value: &Value| [0, 1, 2].map(|axis| number(&value[axis]));
        let dot = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let (normal, point) = (vector(&lobe["normal"]), vector(&lobe["point"]));
        assert!((dot(point, point) - 1.0).abs() < 1e-3 && (dot(normal, point) - 1.0).abs() < 1e-3, "{lobe}");
        if name == "lobe-path" {
            for index in (0..n * m).step_by(97) {
                let expected = 0.5 / std::f64::consts::PI * dot(normal, vector(&directions[index])).max(0.0);
                assert!((number(&values[index]) - expected).abs() < 1e-4, "{index}");
            }
            assert!(dot(vector(&lobe["chosen"]), normal) > 0.0);
        }
        page.say(&json!({ "type": "lobe", "id": 5, "x": 32, "y": 24, "sample": 0, "address": 99 }));
        assert_eq!(page.text("error")["id"], 5);
    }
}

#[test]
fn words_render_the_same_view() {
    let served = Served::new("words", SCENE);
    let mut page = served.open();
    page.say(&view_from(1, [5.0, 0.5, 0.0], false));
    page.finished(1);
    page.say(&json!({ "type": "words", "id": 2 }));
    let words = page.text("words");
    let command = words["command"].as_str().expect("a text");
    assert!(command.contains("--lookfrom=5,0.5,0 ") && command.contains("--width=64"), "{command}");
    let session = beside(&served, words["toml"].as_str().expect("a text"));
    assert_eq!(session.camera().view.lookfrom().to_array(), [5.0, 0.5, 0.0]);
    assert_eq!((session.image().width, session.settings().samples), (64, 4));
}

/// The scene of a text that is saved in the scene's folder.
fn beside(served: &Served, text: &str) -> Session {
    let copy = served.scene.with_file_name("copy.toml");
    std::fs::write(&copy, text).expect("a temporary file");
    Session::open(&copy, &Options::default()).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// Cameras, filters and settings of every kind: the text is a scene, and its picture has the same bits.
#[test]
fn words_are_a_scene_with_the_same_picture() {
    let own = "[camera]\nlookfrom = [0, 1, 5]\nlookat = [0, 0, 0]\n";
    for (number, camera) in [
        "projection = \"orthographic\"\nheight = 3",
        "projection = \"equirectangular\"",
        "projection = \"octahedral\"",
        "fov = 30\naperture = 0.3\nfocus_distance = 2\ndistance = 2.5",
        "window = { x = [0, 1.5], y = [-0.5, 0.5] }",
        "up = [0, 1e20, 0]",
    ]
    .iter()
    .enumerate()
    {
        let scene = SCENE
            .replace(own, &format!("{own}{camera}\n"))
            .replace("height = 48\n", "height = 48\nfilter = { type = \"gaussian\", radius = 2 }\n")
            .replace(
                "samples = 4\n",
                "samples = 2\nseed = 3\nsampler = \"independent\"\ntransparent_shadows = false\n",
            );
        let served = Served::new(&format!("words-{number}"), &scene);
        let mut page = served.open();
        page.say(&view(1));
        page.finished(1);
        page.say(&json!({ "type": "words", "id": 2 }));
        let words = page.text("words");
        let copy = beside(&served, words["toml"].as_str().expect("a text"));
        let expected = session(&served).render(&()).expect("a picture");
        assert_eq!(copy.render(&()).expect("a picture").picture.pixels, expected.picture.pixels, "{words}");
    }
}

/// Keys that few scenes have, of the picture and of a camera that moves while the shutter is open.
#[test]
fn words_have_every_key_of_the_picture() {
    let moving = "lookfrom = { keyframes = [[0, [0, 1, 5]], [1, [4, 1, 5]]] }";
    let scene = SCENE.replace("lookfrom = [0, 1, 5]", &format!("{moving}\nshutter = 0.5")).replace(
        "height = 48\n",
        "height = 48\ncrop = [8, 8, 56, 40]\nmax_component = 0.3\nwhite_balance = 4000\n",
    );
    let served = Served::new("words-keys", &scene);
    let mut page = served.open();
    page.say(&view(1));
    page.finished(1);
    page.say(&json!({ "type": "words", "id": 2 }));
    let words = page.text("words");
    assert!(words["command"].as_str().expect("a text").contains("--crop=8,8,56,40"), "{words}");
    let copy = beside(&served, words["toml"].as_str().expect("a text"));
    let own = session(&served);
    let pictures =
        [&copy, &own].map(|session| session.render(&()).expect("a picture").picture.pixels.clone());
    assert!(own.camera().motion.is_some());
    let differ = pictures[0].iter().zip(&pictures[1]).filter(|(a, b)| a != b).count();
    assert_eq!(differ, 0, "{words}\n{:?}\n{:?}", own.camera(), copy.camera());
}

/// A view of a model without lights, in a variant and at a time: tables cannot say these, comments do.
#[test]
fn words_tell_what_no_table_says() {
    let served = Served::new("words-model", SCENE);
    let model = served.scene.with_file_name("triangle.obj");
    std::fs::write(&model, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").expect("a temporary file");
    let served = Served::of(&model);
    let mut page = served.open();
    let mut asked = view(1);
    (asked["variant"], asked["at"]) = (json!("red\npaint"), json!(0.5));
    page.say(&asked);
    page.finished(1);
    page.say(&json!({ "type": "words", "id": 2 }));
    let words = page.text("words");
    let comments: Vec<&str> = words["toml"]
        .as_str()
        .expect("a text")
        .lines()
        .filter(|line| line.starts_with('#'))
        .skip(1)
        .collect();
    assert_eq!(
        comments,
        [
            "# No table says the variant: red paint.",
            "# No table says the time: 0.5 s.",
            "# The lights of the studio are to be added: `lookfrom convert` writes them.",
        ]
    );
}

/// The camera of a picture and where its points are: mirrored, as pbrt's are, in a window beside the axis, and turned.
#[test]
fn pictures_have_their_cameras() {
    let pbrt = "LookAt 0 1 -5  0 1 0  0 1 0\nCamera \"perspective\" \"float fov\" 40 \"float screenwindow\" [0 1.2 0 0.9]\nFilm \"rgb\" \
                \"integer xresolution\" 64 \"integer yresolution\" 48\nWorldBegin\nLightSource \"distant\"\nShape \"sphere\"\n";
    let served = Served::new("cameras", SCENE);
    let scene = served.scene.with_extension("pbrt");
    std::fs::write(&scene, pbrt).expect("a temporary file");
    let session = Session::open(&scene, &Options::default()).expect("a scene");
    let served = Served::of(&scene);
    let mut page = served.open();
    page.say(&view(1));
    let header = page.frame("picture").header;
    assert_eq!(header["camera"]["is_mirrored"], true);
    let matrix: Vec<f64> = serde_json::from_value(header["screen_from_world"].clone()).expect("a matrix");
    let camera = session.renderer().view().camera();
    let ray = camera.ray([20.5, 30.5], [0.5; 2]);
    let p = camera.lookfrom() + ray.a_from_eye + 3.0 * ray.direction;
    let row = |i: usize| matrix[i] * p.x + matrix[i + 1] * p.y + matrix[i + 2] * p.z + matrix[i + 3];
    let [x, y] = [row(0), row(4)].map(|value| value / row(12));
    assert!((x - 20.5).abs() < 1e-9 && (y - (48.0 - 30.5)).abs() < 1e-9, "{x} {y}");
    // From elsewhere it is mirrored, too.
    page.say(&view_from(2, [1.0, 1.0, -5.0], false));
    let header = page.finished(2).header;
    assert_eq!(
        (&header["camera"]["is_mirrored"], &header["camera"]["lookfrom"][0]),
        (&json!(true), &json!(1.0))
    );
}

#[test]
fn saved_files_are_those_of_the_library() {
    let served = Served::new("save", SCENE);
    let mut page = served.open();
    page.say(&view(1));
    page.finished(1);
    let expected = session(&served).render(&()).expect("a picture");
    for (id, format, known) in [(2, "png", Format::Png), (3, "exr", Format::Exr)] {
        page.say(&json!({ "type": "save", "id": id, "format": format }));
        let file = page.frame("file");
        assert_eq!(
            (&file.header["id"], &file.header["name"]),
            (&json!(id), &json!(format!("scene.{format}")))
        );
        if known == Format::Png {
            assert!(file.payload == expected.encode(known).expect("a PNG"));
        } else {
            let path = served.scene.with_file_name("saved.exr");
            std::fs::write(&path, &file.payload).expect("a temporary file");
            let file = read_exr(&path, &mut LoadContext::new(&Disk)).expect("an EXR");
            let red: Vec<f32> = expected.picture.pixels.iter().map(|pixel| pixel[0]).collect();
            assert!(
                file.channel("R").is_some_and(|channel| channel == red) && file.channel("depth").is_some()
            );
        }
    }
}

#[test]
fn a_picture_is_compared_with_its_reference() {
    let served = Served::with_reference("reference", SCENE, |scene| {
        let session = Session::open(scene, &Options::default()).expect("a scene");
        let picture = session.render(&()).expect("a picture").encode(Format::Exr).expect("an EXR");
        let path = scene.with_file_name("reference.exr");
        std::fs::write(&path, picture).expect("a temporary file");
        Some(path)
    });
    let mut page = served.open();
    assert!(page.text("scene")["reference"].as_str().is_some_and(|name| name.ends_with("reference.exr")));
    let mut compared = |id: u64, mode: &str, exposure: f64| {
        let mut wish = view(id);
        (wish["compare"], wish["exposure"]) = (json!({ "mode": mode }), json!(exposure));
        page.say(&wish);
        page.finished(id)
    };
    let wipe = compared(1, "wipe", 0.0);
    let sizes: Vec<usize> = serde_json::from_value(wipe.header["sizes"].clone()).expect("sizes");
    let (picture, reference) = wipe.payload.split_at(sizes[0]);
    assert!(sizes.len() == 2 && picture == reference, "the same light");
    assert!(compared(2, "reference", 0.0).payload == picture);
    // Nothing stays nothing at any exposure.
    let black = compared(3, "difference", 0.0).payload;
    assert!(black == compared(4, "difference", 20.0).payload && black == compared(5, "flip", 0.0).payload);
    assert!(black != compared(6, "z", 0.0).payload, "no difference is white there");
    page.say(&json!({ "type": "value", "id": 7, "x": 32, "y": 20 }));
    let value = page.text("value");
    assert_eq!(value["rgb"], value["reference"]);
    let mut wish = view(8);
    (wish["compare"], wish["size"]) = (json!({ "mode": "wipe" }), json!([32, 24]));
    page.say(&wish);
    let error = page.text("error");
    assert!(error["message"].as_str().is_some_and(|text| text.contains("64 × 48")), "{error}");
}

#[test]
fn a_scene_that_is_not_there_yet_is_shown_when_it_is_saved() {
    let served = Served::with("unsaved", None, Options::default(), |_| None, Duration::from_secs(60));
    let mut page = served.open();
    let error = page.text("error");
    assert!(error["message"].as_str().unwrap().contains("as soon as it is saved"), "{error}");
    served.write(SCENE);
    assert_eq!(page.text("scene")["type"], "scene");
}

#[test]
fn windows_take_their_memory_from_the_budget() {
    let options = || Options { budget: Budget::new(4 << 20), ..Options::default() };
    let served = Served::with("memory", Some(SCENE), options(), |_| None, Duration::from_secs(60));
    let mut page = served.open();
    page.text("scene");
    // A film of 64 × 48 pixels has room, one of 640 × 480 has not.
    page.say(&json!({"type": "view", "id": 1, "size": [640, 480]}));
    let error = page.text("error");
    assert!(error["message"].as_str().unwrap().contains("memory"), "{error}");
    page.say(&view(2));
    page.finished(2);
}

#[test]
fn no_more_windows_than_the_limit_are_opened_at_once() {
    let served = Served::new("limit", SCENE);
    let key = "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: \
               dGhlIHNhbXBsZSBub25jZQ==\r\n";
    let request =
        format!("GET /socket?token={} HTTP/1.1\r\nHost: {}\r\n{key}\r\n", served.token(), served.host());
    let mut streams: Vec<TcpStream> =
        (0..40).map(|_| TcpStream::connect(served.host()).expect("it listens")).collect();
    for stream in &mut streams {
        stream.write_all(request.as_bytes()).expect("it reads");
    }
    let mut opened = 0;
    for stream in &mut streams {
        let mut answer = String::new();
        while !answer.contains("\"type\":\"scene\"") && !answer.contains("16 windows are open: close one") {
            let mut bytes = [0; 4096];
            let count = stream.read(&mut bytes).expect("it answers");
            assert!(count > 0, "it says why it ends: {answer}");
            answer += &String::from_utf8_lossy(&bytes[..count]);
        }
        assert!(answer.contains("101"), "{answer}");
        opened += usize::from(answer.contains("\"type\":\"scene\""));
    }
    assert_eq!(opened, 16);
}

#[test]
fn silent_clients_are_dropped_and_resting_pages_are_not() {
    let patience = Duration::from_millis(600);
    let served = Served::with("silent", Some(SCENE), Options::default(), |_| None, patience);
    let mut page = served.open();
    page.text("scene");
    let resting = std::thread::spawn(move || {
        page.rest(4 * patience);
        page
    });
    // One that sends nothing, one that stops in the middle of a request.
    for sent in ["", "GET / HTTP/1.1\r\nHost: "] {
        let mut stream = TcpStream::connect(served.host()).expect("it listens");
        stream.write_all(sent.as_bytes()).expect("it reads");
        stream.set_read_timeout(Some(Duration::from_secs(60))).expect("a timeout");
        // Its end, not our own timeout.
        assert_eq!(stream.read(&mut [0; 512]).expect("it is closed"), 0, "{sent:?}");
    }
    // One whose program does not even answer pings: the socket is there, and nobody reads it.
    let silent = served.open();
    served.wait_for_windows(1);
    drop(silent);
    let mut page = resting.join().expect("it does not panic");
    page.say(&view(1));
    page.finished(1);
}

/// pbrt's cameras may be mirrored or sheared: their matrix is told.
#[test]
fn a_sheared_camera_is_told_as_toml() {
    let pbrt = "Scale 1 2 1\nLookAt 0 1 -5  0 1 0  0 1 0\nCamera \"perspective\" \"float fov\" 40\nWorldBegin\nLightSource \
                \"distant\"\nTranslate 0 1 0\nShape \"sphere\"\n";
    let served = Served::new("sheared", SCENE);
    let scene = served.scene.with_extension("pbrt");
    std::fs::write(&scene, pbrt).expect("a temporary file");
    let session = Session::open(&scene, &Options::default()).expect("a scene");
    assert!(session.camera().look(session.info().bounds.center()).is_none(), "its matrix is one of ours");
    let served = Served::of(&scene);
    let mut page = served.open();
    page.say(&view(1));
    page.frame("picture");
    page.say(&json!({"type": "words", "id": 2}));
    let words = page.text("words");
    let toml = words["toml"].as_str().unwrap();
    for key in ["matrix = [", "fov = "] {
        assert!(toml.contains(key), "{key}: {toml}");
    }
    // It is read as a scene.
    let text = format!("{toml}\n[[sphere]]\ncenter = [0, 1, 0]\nradius = 1\n");
    let copy = Session::from_bytes("words.toml", text.into_bytes(), &Options::default()).expect("a scene");
    assert_eq!(copy.camera().view, session.camera().view);
}

#[test]
fn no_other_page_shows_it_in_a_frame() {
    let served = Served::new("framed", SCENE);
    let mut stream = TcpStream::connect(served.host()).expect("it listens");
    let request = format!("GET / HTTP/1.1\r\nHost: {}\r\nConnection: close\r\n\r\n", served.host());
    stream.write_all(request.as_bytes()).expect("it reads");
    let mut answer = String::new();
    stream.read_to_string(&mut answer).expect("it answers");
    assert!(answer.contains("frame-ancestors 'none'\r\n"), "{answer}");
}
