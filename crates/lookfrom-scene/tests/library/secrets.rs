//! Files that scenes name, but that are no scenes: errors say where they are named, and quote nothing of them.

use std::path::Path;

use lookfrom_scene::excerpt::Excerpts;
use lookfrom_scene::{LoadContext, Memory, load};

#[test]
fn files_of_others_are_not_quoted() {
    for secret in [
        "root:x:0:0:root:/root:/bin/bash\n",
        "PASSWORD=secret\n",
        "[root]\n",
        "\"root\" \"x\"\n",
        "a:\n  root: 1\n",
    ] {
        let mtl = "mtllib passwd\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
        let spectrum = "WorldBegin Material \"diffuse\" \"spectrum reflectance\" \"passwd\"";
        for (name, text) in [
            ("a.pbrt", "Include \"passwd\""),
            ("a.pbrt", "WorldBegin Import \"passwd\""),
            ("a.pbrt", spectrum),
            ("a.pbrt", "WorldBegin Shape \"plymesh\" \"string filename\" \"passwd\""),
            ("a.toml", "import = \"passwd\"\n"),
            ("a.toml", "[[mesh]]\nfile = \"passwd\"\n"),
            ("a.toml", "[materials.a]\ndiffuse = { spectrum = \"passwd\" }\n"),
            ("a.toml", "[textures]\na = { type = \"image\", file = \"passwd\" }\n"),
            ("a.obj", mtl),
        ] {
            let files = Memory([(name.into(), text.into()), ("passwd".into(), secret.into())].into());
            let mut context = LoadContext::new(&files);
            let mut said = match load::scene(Path::new(name), &mut context) {
                Ok(_) => String::new(),
                Err(error) => {
                    let mut excerpts = Excerpts::new(&files);
                    let shown = error.first_few().0.filter_map(|error| excerpts.of(&error.at));
                    format!("{error}\n{}", shown.map(|excerpt| excerpt.text).collect::<String>())
                }
            };
            context.warnings.iter().for_each(|warning| said += &warning.to_string());
            assert!(said.contains("passwd"), "{text}: {said}");
            assert!(!said.contains("root") && !said.contains("PASS"), "{text}: {said}");
        }
    }
}
