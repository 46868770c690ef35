//! Graphs that files describe, of textures, materials, media, objects and includes, made from the fuzzer's bytes as text of both
//! formats: they are read and compiled, or refused.
#![no_main]

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use lookfrom::view::View;
use lookfrom::world::World;
use lookfrom_scene::{LoadContext, Memory, load};

/// The most nodes of each kind. Chains may have 16, so that longer ones are made as well.
const MOST: usize = 40;

/// The most files; each includes two at most, so that all paths through them are few.
const MOST_FILES: usize = 7;

/// Numbers from bytes; 0 at their end.
struct Numbers<'a>(std::slice::Iter<'a, u8>);

impl Numbers<'_> {
    /// A number below `end`.
    fn below(&mut self, end: usize) -> usize {
        usize::from(self.0.next().copied().unwrap_or(0)) % end.max(1)
    }

    /// A node that another refers to: mostly one just before it, sometimes any, itself or a missing one.
    fn part(&mut self, own: usize, count: usize) -> usize {
        match self.below(8) {
            0 => self.below(count + 1),
            _ => own.saturating_sub(1 + self.below(3)),
        }
    }
}

/// A scene in both formats, file by file; the first file of each is the scene.
#[derive(Default)]
struct Texts {
    pbrt: Vec<String>,
    toml: Vec<String>,
}

impl Texts {
    fn new(numbers: &mut Numbers<'_>) -> Self {
        let mut texts = Self::default();
        let [textures, materials, objects] = [MOST, MOST / 2, 6].map(|most| 1 + numbers.below(most));
        let files = 1 + numbers.below(MOST_FILES);
        texts.add_files(numbers, files);
        // Parts are written in order, each into any file.
        (0..textures).for_each(|k| texts.add_texture(numbers, k, textures));
        (0..materials).for_each(|k| texts.add_material(numbers, k, materials, textures));
        (0..objects).for_each(|k| texts.add_object(numbers, k, objects, materials));
        texts
    }

    fn add_files(&mut self, numbers: &mut Numbers<'_>, files: usize) {
        for file in 0..files {
            let parts = [numbers.part(files - file, files), numbers.part(files - file, files)];
            let named = &parts[..numbers.below(3)];
            let imports: Vec<String> = named.iter().map(|part| format!("\"{part}.toml\"")).collect();
            self.toml.push(format!("import = [{}]\n", imports.join(", ")));
            let head = if file == 0 { "WorldBegin\n" } else { "" };
            let includes = named.iter().map(|part| format!("Include \"{part}.pbrt\"\n"));
            self.pbrt.push(head.to_owned() + &includes.collect::<String>());
        }
    }

    /// Adds a line of each format to a file.
    fn add(&mut self, numbers: &mut Numbers<'_>, pbrt: &str, toml: &str) {
        let file = numbers.below(self.pbrt.len());
        writeln!(self.pbrt[file], "{pbrt}").expect("text");
        writeln!(self.toml[file], "{toml}").expect("text");
    }

    fn add_texture(&mut self, numbers: &mut Numbers<'_>, k: usize, count: usize) {
        let [a, b, c] = [0; 3].map(|_| numbers.part(k, count));
        let kind = if k == 0 { 5 } else { numbers.below(6) };
        let toml = match kind {
            0 => format!("type = \"mix\", low = \"t{a}\", high = \"t{b}\", amount = \"t{c}\""),
            1 => format!("type = \"scale\", color = \"t{a}\", by = \"t{b}\""),
            2 => format!("type = \"checker\", even = \"t{a}\", odd = \"t{b}\""),
            3 => format!("type = \"bilinear\", corners = [\"t{a}\", \"t{b}\", \"t{c}\", \"t{a}\"]"),
            4 => format!("type = \"mix\", low = \"t{a}\", high = \"t{a}\""),
            _ => "type = \"dots\"".to_owned(),
        };
        let pbrt = match kind {
            0 => format!("\"mix\" \"texture tex1\" \"t{a}\" \"texture tex2\" \"t{b}\""),
            1 => format!("\"scale\" \"texture tex\" \"t{a}\" \"float scale\" 0.5"),
            2 => format!("\"checkerboard\" \"texture tex1\" \"t{a}\" \"texture tex2\" \"t{b}\""),
            3 => format!(
                "\"bilerp\" \"texture v00\" \"t{a}\" \"texture v01\" \"t{b}\" \"texture v11\" \"t{c}\""
            ),
            4 => format!("\"directionmix\" \"texture tex1\" \"t{a}\" \"texture tex2\" \"t{a}\""),
            _ => "\"dots\"".to_owned(),
        };
        self.add(
            numbers,
            &format!("Texture \"t{k}\" \"spectrum\" {pbrt}"),
            &format!("textures.t{k} = {{ {toml} }}"),
        );
    }

    fn add_material(&mut self, numbers: &mut Numbers<'_>, k: usize, count: usize, textures: usize) {
        let [a, b] = [0; 2].map(|_| numbers.part(k, count));
        let texture = numbers.below(textures + 1);
        let kind = if k == 0 { 2 } else { numbers.below(4) };
        let toml = match kind {
            0 | 1 => format!("type = \"mix\", materials = [\"m{a}\", \"m{b}\"]"),
            _ => format!("type = \"diffuse\", reflectance = \"t{texture}\""),
        };
        let pbrt = match kind {
            0 | 1 => format!("\"mix\" \"string materials\" [ \"m{a}\" \"m{b}\" ]"),
            _ => format!("\"diffuse\" \"texture reflectance\" \"t{texture}\""),
        };
        let (head, separated) = pbrt.split_once(' ').expect("two words");
        let pbrt = format!("MakeNamedMaterial \"m{k}\" \"string type\" {head} {separated}");
        self.add(numbers, &pbrt, &format!("materials.m{k} = {{ {toml} }}"));
    }

    /// An object with an instance of another, which no format has within objects, and media around it.
    fn add_object(&mut self, numbers: &mut Numbers<'_>, k: usize, count: usize, materials: usize) {
        let (other, material) = (numbers.part(k, count), numbers.below(materials + 1));
        let inner = match numbers.below(4) {
            0 => format!("ObjectInstance \"o{other}\""),
            1 => format!("ObjectBegin \"o{other}\"\nShape \"sphere\"\nObjectEnd"),
            2 => format!(
                "MakeNamedMedium \"x{k}\" \"string type\" \"homogeneous\"\nMediumInterface \"x{other}\" \"x{k}\""
            ),
            _ => String::new(),
        };
        let pbrt = format!(
            "ObjectBegin \"o{k}\"\nNamedMaterial \"m{material}\"\n{inner}\nShape \"sphere\"\nObjectEnd\nObjectInstance \"o{other}\""
        );
        let sphere = format!("{{ center = [0, 0, 0], radius = 1, material = \"m{material}\" }}");
        let toml = format!("objects.o{k}.sphere = [{sphere}]");
        self.add(numbers, &pbrt, &toml);
        // Instances are one list, at the top of a file.
        let file = numbers.below(self.toml.len());
        if !self.toml[file].contains("\ninstance") {
            writeln!(self.toml[file], "instance = [{{ object = \"o{other}\" }}, {{ object = \"o{k}\" }}]")
                .expect("text");
        }
    }
}

/// Reads and compiles the first of some files.
fn compile(files: Vec<String>, ending: &str) {
    let named = files.into_iter().enumerate();
    let files = named.map(|(number, text)| (PathBuf::from(format!("{number}.{ending}")), text.into_bytes()));
    let files = Memory(files.collect());
    let mut context = LoadContext::new(&files);
    context.limits = lookfrom_fuzz::limits();
    let Ok(scene) = load::scene(Path::new(&format!("0.{ending}")), &mut context) else { return };
    let _ = View::of_scene(&scene);
    let _ = World::compile(scene, &mut Vec::new());
}

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let Texts { pbrt, toml } = Texts::new(&mut Numbers(bytes.iter()));
    compile(pbrt, "pbrt");
    compile(toml, "toml");
});
