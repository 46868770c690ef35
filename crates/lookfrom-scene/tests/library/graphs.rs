//! Graphs that files describe (textures, mixed materials, includes, nodes): deep, wide, shared or circular, they are read or refused,
//! and mixed materials that are read are few where every use counts.

use std::collections::HashMap;
use std::fmt::Write as _;
use std::path::Path;

use lookfrom_scene::material::{Color, MaterialKind};
use lookfrom_scene::scene::MaterialId;
use lookfrom_scene::{ErrorKind, LoadContext, Memory, Result, Scene, load};
use proptest::prelude::*;

fn read(name: &str, text: &str) -> Result<Scene> {
    let files = Memory([(name.into(), text.as_bytes().to_vec())].into());
    load::scene(Path::new(name), &mut LoadContext::new(&files))
}

/// The longest chain that anything read may be in.
const DEEPEST: usize = 16;

/// The most materials that anything read may stand for.
const MOST: usize = 4096;

/// The length of the longest chain of textures that begins with each.
fn heights(scene: &Scene) -> Vec<usize> {
    fn height(scene: &Scene, index: usize, known: &mut HashMap<usize, usize>) -> usize {
        if let Some(&height) = known.get(&index) {
            return height;
        }
        let mut below = 0;
        for part in scene.textures[index].kind.parts() {
            if let Color::Texture(id) = part {
                below = below.max(height(scene, id.index(), known));
            }
        }
        known.insert(index, 1 + below);
        1 + below
    }
    let mut known = HashMap::new();
    (0..scene.textures.len()).map(|index| height(scene, index, &mut known)).collect()
}

fn limit(result: Result<Scene>) -> String {
    let error = result.expect_err("it is refused");
    assert_eq!(error.kind, ErrorKind::Limit, "{error}");
    error.to_string()
}

/// A texture of pbrt for each number, made by `parts`.
fn pbrt(count: usize, parts: impl Fn(usize) -> String) -> String {
    let mut text = "WorldBegin\nTexture \"t0\" \"spectrum\" \"checkerboard\"\n".to_owned();
    (1..=count).for_each(|k| writeln!(text, "Texture \"t{k}\" \"spectrum\" {}", parts(k - 1)).unwrap());
    text + &format!("Material \"diffuse\" \"texture reflectance\" \"t{count}\"\nShape \"sphere\"\n")
}

#[test]
fn chains_of_textures_of_pbrt_end() {
    let scaled = |k: usize| format!("\"scale\" \"texture tex\" \"t{k}\" \"float scale\" 0.5");
    assert!(read("a.pbrt", &pbrt(15, scaled)).is_ok());
    assert!(limit(read("a.pbrt", &pbrt(22_000, scaled))).contains("in a chain of more than 16 textures"));
    // Twice the one before; the one before and that before it; four times the one before.
    let doubled = |k: usize| format!("\"mix\" \"texture tex1\" \"t{k}\" \"texture tex2\" \"t{k}\"");
    assert!(limit(read("a.pbrt", &pbrt(60, doubled))).contains("in a chain of more than 16"));
    assert!(read("a.pbrt", &pbrt(15, doubled)).is_ok());
    let woven =
        |k: usize| format!("\"mix\" \"texture tex1\" \"t{k}\" \"texture tex2\" \"t{}\"", k.saturating_sub(1));
    assert!(read("a.pbrt", &pbrt(15, woven)).is_ok());
    let cornered = |k: usize| {
        let corners = ["v00", "v01", "v10", "v11"].map(|corner| format!("\"texture {corner}\" \"t{k}\" "));
        format!("\"bilerp\" {}", corners.concat())
    };
    assert!(read("a.pbrt", &pbrt(15, cornered)).is_ok());
}

#[test]
fn chains_of_textures_of_our_own_end() {
    let toml = |count: usize, part: fn(usize) -> String| {
        let mut text = "[textures]\nt0 = { type = \"checker\" }\n".to_owned();
        (1..=count).for_each(|k| writeln!(text, "t{k} = {}", part(k - 1)).unwrap());
        read("a.toml", &text)
    };
    let cornered = |k: usize| {
        format!("{{ type = \"bilinear\", corners = [{}] }}", vec![format!("\"t{k}\""); 4].join(", "))
    };
    assert!(toml(15, cornered).is_ok());
    assert!(limit(toml(16, cornered)).contains("in a chain of more than 16 textures"));
    let doubled = |k: usize| format!("{{ type = \"mix\", low = \"t{k}\", high = \"t{k}\" }}");
    assert!(toml(15, doubled).is_ok());
    let tripled =
        |k: usize| format!("{{ type = \"mix\", low = \"t{k}\", high = \"t{k}\", amount = \"t{k}\" }}");
    assert!(toml(15, tripled).is_ok());
}

#[test]
fn mixes_of_mixes_end() {
    let pbrt = |count: usize, parts: fn(usize) -> [usize; 2]| {
        let mut text = "WorldBegin\nMakeNamedMaterial \"m0\" \"string type\" \"diffuse\"\n".to_owned();
        for k in 1..=count {
            let [a, b] = parts(k - 1);
            let mix = "\"string type\" \"mix\" \"string materials\"";
            writeln!(text, "MakeNamedMaterial \"m{k}\" {mix} [ \"m{a}\" \"m{b}\" ]").unwrap();
        }
        read("a.pbrt", &text)
    };
    assert!(pbrt(8, |k| [k, 0]).is_ok());
    assert!(limit(pbrt(22_000, |k| [k, 0])).contains("in a chain of more than 16 materials"));
    assert!(limit(pbrt(14, |k| [k, k])).contains("materials, more than 4096"));
}

#[test]
fn many_includes_are_a_scene() {
    // A Menger sponge of four levels: twenty times twenty times …
    let mut files = Memory::default();
    for level in 0..4 {
        let text = format!("Include \"{}.pbrt\"\n", level + 1).repeat(20);
        let head = if level == 0 { "WorldBegin\n" } else { "" };
        files.0.insert(format!("{level}.pbrt").into(), (head.to_owned() + &text).into_bytes());
    }
    files.0.insert("4.pbrt".into(), b"Shape \"sphere\"\n".to_vec());
    let scene = load::scene(Path::new("0.pbrt"), &mut LoadContext::new(&files)).expect("a scene");
    assert_eq!(scene.shapes.len(), 160_000);
}

#[test]
fn nested_brackets_and_nodes_end() {
    let deep = 100_000;
    let said = |name: &str, text: String| read(name, &text).map(drop).expect_err("too deep").to_string();
    said("a.toml", format!("a = {}", "[".repeat(deep)));
    said("a.toml", format!("[camera]\nfov = \"= {}1{}\"\n", "(".repeat(deep), ")".repeat(deep)));
    said("a.toml", format!("[camera]\nfov = \"= {}1\"\n", "-".repeat(deep)));
    said("a.toml", format!("[camera]\nfov = \"= {}\"\n", "1 ? ".repeat(deep)));
    said("a.pbrt", format!("WorldBegin Shape \"sphere\" \"float radius\" {}", "[".repeat(deep)));
    said("a.gltf", format!("{}{}", "[".repeat(deep), "]".repeat(deep)));
    let nodes: Vec<String> = (1..deep).map(|k| format!("{{\"children\":[{k}]}}")).collect();
    let text = format!(
        "{{\"asset\":{{\"version\":\"2.0\"}},\"scenes\":[{{\"nodes\":[0]}}],\"nodes\":[{},{{}}]}}",
        nodes.join(",")
    );
    // A chain of nodes is read or refused.
    let _ = read("a.gltf", &text);
}

/// A kind of texture of three parts at most.
fn texture() -> impl Strategy<Value = (u8, [prop::sample::Index; 3])> {
    (0_u8..6, prop::array::uniform3(any::<prop::sample::Index>()))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn any_graph_of_textures(
        graph in prop::collection::vec(texture(), 1..80), reach in 1_usize..8, is_circular in any::<bool>(),
    ) {
        let (mut own, mut pbrt) = ("[textures]\n".to_owned(), "WorldBegin\n".to_owned());
        for (k, (kind, parts)) in graph.iter().enumerate() {
            // Of the textures just before it, or of any.
            let part = |slot: usize| match is_circular {
                true => parts[slot].index(graph.len()),
                false => k.saturating_sub(1 + parts[slot].index(reach)),
            };
            let [a, b, c] = [part(0), part(1), part(2)];
            let kind = if k == 0 && !is_circular { 5 } else { *kind };
            let toml = match kind {
                0 => format!("type = \"mix\", low = \"t{a}\", high = \"t{b}\", amount = \"t{c}\""),
                1 => format!("type = \"scale\", color = \"t{a}\", by = \"t{b}\""),
                2 => format!("type = \"checker\", even = \"t{a}\", odd = \"t{b}\""),
                3 => format!("type = \"bilinear\", corners = [\"t{a}\", \"t{b}\", \"t{c}\", \"t{a}\"]"),
                4 => format!("type = \"mix\", low = \"t{a}\", high = \"t{a}\""),
                _ => "type = \"dots\"".to_owned(),
            };
            writeln!(own, "t{k} = {{ {toml} }}").unwrap();
            let of_pbrt = match kind {
                0 | 1 => format!("\"mix\" \"texture tex1\" \"t{a}\" \"texture tex2\" \"t{b}\""),
                2 => format!("\"checkerboard\" \"texture tex1\" \"t{a}\" \"texture tex2\" \"t{b}\""),
                3 => format!("\"bilerp\" \"texture v00\" \"t{a}\" \"texture v01\" \"t{b}\" \"texture v11\" \"t{c}\""),
                4 => format!("\"directionmix\" \"texture tex1\" \"t{a}\" \"texture tex2\" \"t{a}\""),
                _ => "\"dots\"".to_owned(),
            };
            writeln!(pbrt, "Texture \"t{k}\" \"spectrum\" {of_pbrt}").unwrap();
        }
        for (name, text) in [("a.toml", &own), ("a.pbrt", &pbrt)] {
            if let Ok(scene) = read(name, text) {
                prop_assert!(heights(&scene).iter().all(|&height| height <= DEEPEST));
            }
        }
    }

    #[test]
    fn any_graph_of_mixes(graph in prop::collection::vec(prop::array::uniform2(any::<prop::sample::Index>()), 1..60)) {
        let mut own = "[materials]\n".to_owned();
        for (k, parts) in graph.iter().enumerate() {
            let [a, b] = parts.map(|part| part.index(graph.len()));
            let kind = if k % 3 == 0 { "type = \"diffuse\"".to_owned() } else { format!("type = \"mix\", materials = [\"m{a}\", \"m{b}\"]") };
            writeln!(own, "m{k} = {{ {kind} }}").unwrap();
        }
        if let Ok(scene) = read("a.toml", &own) {
            for index in 0..scene.materials.len() {
                let (mut open, mut uses) = (vec![index], 0);
                while let Some(index) = open.pop() {
                    uses += 1;
                    prop_assert!(uses <= MOST);
                    if let MaterialKind::Mix { materials, .. } = scene.materials[index].kind {
                        open.extend(materials.map(MaterialId::index));
                    }
                }
            }
        }
    }
}
