//! Layers beside the picture in an EXR.

use lookfrom_scene::{Disk, LoadContext, image};

use super::stage::Stage;

fn names(stage: &Stage, file: &str) -> Vec<String> {
    let found = image::read_exr(&stage.path(file), &mut LoadContext::new(&Disk)).unwrap();
    found.channels.into_iter().map(|(name, _)| name).collect()
}

#[test]
fn layers_have_the_names_of_pbrts() {
    let stage = Stage::new("layers");
    stage.done("render scene.toml -q -o plain.exr");
    assert_eq!(names(&stage, "plain.exr"), ["B", "G", "R"]);
    let told = stage.done("render scene.toml -o plain.png --layers geometry").stderr;
    assert!(told.contains("PNG pictures have no layers"), "{told}");
    stage.done("render scene.toml -q -o layers.exr --layers geometry");
    let found = names(&stage, "layers.exr");
    for name in ["R", "Albedo.G", "N.X", "Ns.Z", "P.Y", "Variance.B", "u", "v", "depth"] {
        assert!(found.iter().any(|of_file| of_file == name), "{name} is not in {found:?}");
    }
    // The picture is the same, and its variance is that of soft edges: nothing in most places.
    let read = |file: &str| image::read_exr(&stage.path(file), &mut LoadContext::new(&Disk)).unwrap();
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
fn layers_that_measure_keep_32_bits() {
    let stage = Stage::new("half-layers");
    let layers = "--layers geometry --cryptomatte object --light-path glow=C<L.>";
    stage.done(&format!("render scene.toml -q -o whole.exr {layers}"));
    stage.done(&format!("render scene.toml -q -o half.exr --bits 16 {layers}"));
    let read = |file: &str| image::read_exr(&stage.path(file), &mut LoadContext::new(&Disk)).unwrap();
    let [whole, half] = ["whole.exr", "half.exr"].map(read);
    assert_eq!(names(&stage, "whole.exr"), names(&stage, "half.exr"));
    for (name, exact) in &whole.channels {
        let found = half.channel(name).unwrap();
        let layer = name.split('.').next().unwrap();
        let is_rounded = ["R", "G", "B", "Albedo", "N", "Ns", "glow"].contains(&layer);
        // Halves have 11 bits.
        let is_near = |(a, b): (&f32, &f32)| (a - b).abs() <= a.abs() / 2048.0 + 1e-7;
        let keeps = if is_rounded { exact.iter().zip(found).all(is_near) } else { exact == found };
        assert!(keeps, "{name}");
    }
    assert_ne!(whole.channel("Ns.X"), half.channel("Ns.X"));
    let [large, small] =
        ["whole.exr", "half.exr"].map(|file| std::fs::metadata(stage.path(file)).unwrap().len());
    assert!(small < large, "{small} of {large} bytes");
}

#[test]
fn a_spectral_film_has_a_layer_for_each_bucket() {
    let stage = Stage::new("spectral-film");
    let said = |options: &str| {
        let run = stage.run(&format!("render scene.toml -q -o no.exr {options}"));
        assert_ne!(run.code, Some(0), "{options}");
        run.stderr
    };
    let message = said("--spectral-buckets 3");
    assert!(message.contains("rendered in RGB") && message.contains("--color spectral"), "{message}");
    for typed in ["--spectral-buckets 1000000000", "--spectral-buckets 2.5", "--wavelengths 700,400"] {
        let message = said(&format!("--color spectral {typed}"));
        assert!(message.contains("expected"), "{message}");
    }
    let message = said("--color spectral --wavelengths NaN,NaN");
    assert!(message.contains("two wavelengths from 360 to 830 nm"), "{message}");

    let spectral = "--integrator path --color spectral --spectral-buckets 3 --wavelengths 400,700";
    stage.done(&format!("render scene.toml -q -o whole.exr --film --samples 4 {spectral}"));
    let buckets = ["S0.450,000nm", "S0.550,000nm", "S0.650,000nm"];
    let found = names(&stage, "whole.exr");
    assert!(buckets.iter().all(|name| found.iter().any(|of_file| of_file == name)), "{found:?}");
    let info = &stage.json("info whole.exr --json")[0];
    assert_eq!(info["header"]["spectralLayoutVersion"], "1.0");
    // Parts are merged to the same film, and a picture without buckets is the same.
    for part in ["1/2", "2/2"] {
        let file = part.replace('/', "-");
        stage
            .done(&format!("render scene.toml -q -o {file}.exr --film --part {part} --samples 4 {spectral}"));
    }
    stage.done("merge 2-2.exr 1-2.exr -o merged.exr");
    assert!(stage.bytes("merged.exr") == stage.bytes("whole.exr"));
    stage.done(&format!("render scene.toml -q -o a.png --samples 4 {spectral}"));
    stage.done("develop merged.exr -o b.png");
    for pictures in ["a.png b.png", "merged.exr whole.exr"] {
        let compared = &stage.json(&format!("compare {pictures} --json"))[0];
        assert_eq!(compared["rmse"], 0.0, "{compared}");
    }
}

/// Unit vectors of a layer, pixel by pixel; those of pixels in which nothing is are left out.
fn normals(stage: &Stage, file: &str, layer: &str) -> Vec<[f32; 3]> {
    let found = image::read_exr(&stage.path(file), &mut LoadContext::new(&Disk)).unwrap();
    let [x, y, z] = ["X", "Y", "Z"].map(|axis| found.channel(&format!("{layer}.{axis}")).unwrap());
    let all = x.iter().zip(y).zip(z).map(|((&x, &y), &z)| [x, y, z]);
    let normals: Vec<[f32; 3]> = all.filter(|normal| *normal != [0.0; 3]).collect();
    for [x, y, z] in &normals {
        assert!((x * x + y * y + z * z - 1.0).abs() < 1e-4, "{layer}: {x} {y} {z}");
    }
    normals
}

#[test]
fn normals_look_to_the_viewer_and_have_bumps() {
    let stage = Stage::new("normals");
    // Seen from behind, bent by heights that rise along u, which is to the left then: as far as 45°.
    let scene = |material: &str| {
        format!(
            "[camera]\nlookfrom = [0, 0, -3]\nlookat = [0, 0, 0]\n\n[image]\nwidth = 12\nheight = 8\n\n\
             [render]\nsamples = 4\nintegrator = \"path\"\n\n\
             [materials.m]\ntype = \"diffuse\"\n{material}\n\n\
             [textures.slope]\ntype = \"image\"\nfile = \"slope.pfm\"\nwrap = \"clamp\"\n\n\
             [[quad]]\ncorner = [-0.5, -0.5, 0]\nedge_u = [1, 0, 0]\nedge_v = [0, 1, 0]\nmaterial = \"m\"\n"
        )
    };
    let slope: Vec<u8> =
        b"Pf\n2 1\n-1.0\n".iter().copied().chain([0.0_f32, 0.5].map(f32::to_le_bytes).concat()).collect();
    std::fs::write(stage.path("slope.pfm"), slope).unwrap();
    stage.write("plain.toml", &scene(""));
    stage.write("bump.toml", &scene("bump = \"slope\""));
    for name in ["plain", "bump"] {
        stage.done(&format!("render {name}.toml -q -o {name}.exr --layers geometry"));
        let geometric = normals(&stage, &format!("{name}.exr"), "N");
        assert!(!geometric.is_empty() && geometric.iter().all(|n| *n == [0.0, 0.0, -1.0]), "{geometric:?}");
    }
    let smooth = normals(&stage, "plain.exr", "Ns");
    assert!(smooth.iter().all(|n| *n == [0.0, 0.0, -1.0]), "{smooth:?}");
    let bent = normals(&stage, "bump.exr", "Ns");
    assert!(bent.iter().any(|[x, _, z]| x.abs() > 0.5 && *z < -0.5), "{bent:?}");
    // At the outline of a sphere samples see other normals, and their mean is as long.
    stage.done("render scene.toml -q -o sphere.exr --layers geometry");
    for layer in ["N", "Ns"] {
        assert!(normals(&stage, "sphere.exr", layer).iter().all(|[_, _, z]| *z < 0.0), "{layer}");
    }
}

#[test]
fn what_light_is_and_how_lights_are_chosen_is_in_the_header() {
    let stage = Stage::new("color");
    stage.done("render scene.toml -q -o p.exr --color rgb --light-sampler power");
    let found = image::read_exr(&stage.path("p.exr"), &mut LoadContext::new(&Disk)).unwrap().attributes;
    for (name, text) in [("color", "rgb"), ("light_sampler", "power"), ("regularize", "false")] {
        assert!(found.contains(&(name.to_owned(), text.to_owned())), "{name}: {found:?}");
    }
}

#[test]
fn cryptomattes_have_the_layout_that_compositors_read() {
    let stage = Stage::new("cryptomatte");
    let told = stage.done("render scene.toml -o plain.png --cryptomatte object").stderr;
    assert!(told.contains("PNG pictures have no layers"), "{told}");
    let told = stage.run("render scene.toml -o no.exr --cryptomatte asset");
    assert!(told.code == Some(2) && told.stderr.contains("object, material"), "{}", told.stderr);

    // In the picture, and in the file of a film, but not in pictures that are developed from its sums.
    let mattes = "--cryptomatte object,material,object --samples 4";
    stage.done(&format!("render scene.toml -q -o matte.exr {mattes}"));
    stage.done(&format!("render scene.toml -q -o film.exr --film {mattes}"));
    stage.done("develop film.exr -o developed.exr");
    let read = |file: &str| image::read_exr(&stage.path(file), &mut LoadContext::new(&Disk)).unwrap();
    let of_mattes = |file: &str| -> Vec<String> {
        let found = read(file);
        let attributes = found.attributes.into_iter().filter(|(name, _)| name.starts_with("cryptomatte/"));
        let channels = found.channels.into_iter().filter(|(name, _)| name.starts_with("Crypto"));
        attributes.map(|(_, text)| text).chain(channels.map(|(name, _)| name)).collect()
    };
    let found = of_mattes("matte.exr");
    assert_eq!(found.len(), 2 * (4 + 12), "{found:?}");
    for expected in
        ["CryptoObject", "CryptoMaterial", "MurmurHash3_32", "CryptoObject00.R", "CryptoMaterial02.A"]
    {
        assert!(found.iter().any(|text| text == expected), "{expected} is not in {found:?}");
    }
    assert_eq!(of_mattes("film.exr"), found);
    assert_eq!(of_mattes("developed.exr"), [""; 0]);

    // What a farm merges has none, and its later parts trace none.
    let told = stage.done("farm slurm scene.toml --parts 2 --cryptomatte object -o job").stderr;
    assert!(told.contains("what is merged has no Cryptomattes"), "{told}");
    stage.done(&format!("render scene.toml -q -o part.exr --film --part 2/2 {mattes}"));
    assert_eq!(of_mattes("part.exr"), [""; 0]);

    // A film that goes on has the mattes of all of its samples.
    stage.done("render scene.toml -q -o half.exr --film --cryptomatte object --samples 2");
    stage.done("resume half.exr -q --samples 4");
    let channel = |file: &str| read(file).channel("CryptoObject00.G").unwrap().to_vec();
    assert_eq!(channel("half.exr"), channel("film.exr"));
}
