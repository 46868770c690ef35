//! Every suggestion is valid where it is made.

use super::*;
use crate::toml::vocabulary::{choices, vocabulary};

/// Each suggestion is a key of its table, and each row applies to some table.
#[test]
fn what_is_suggested_is_there() {
    let tables = vocabulary();
    for (words, groups) in KEYS {
        for word in *words {
            assert_eq!(*word, plain(word));
            for (table, known) in &tables {
                for key in keys(word, known) {
                    assert!(known.contains(key), "{word} in {table} is not {key}");
                }
            }
        }
        for group in *groups {
            let is_there = |(_, known): &(String, Vec<&str>)| group.iter().all(|key| known.contains(key));
            assert!(tables.iter().any(is_there), "no table has {group:?}");
        }
    }
    for (words, ours, _) in CHOICES {
        for word in *words {
            assert_eq!(*word, plain(word));
            for (what, known) in choices() {
                let Some(hint) = choice(word, &known) else { continue };
                for quoted in hint.split('"').skip(1).step_by(2) {
                    assert!(known.contains(&quoted), "{word} of {what} is not {quoted}");
                }
            }
        }
        for word in *ours {
            assert!(choices().iter().any(|(_, known)| known.contains(word)), "nothing may be {word:?}");
        }
    }
}

#[test]
fn words_of_other_renderers_are_known() {
    let tables = vocabulary();
    let of = |title: &str| &tables.iter().find(|(table, _)| table == title).expect("a table").1;
    for (title, word, meant) in [
        ("[materials.NAME] coated_diffuse", "color", "reflectance"),
        ("[materials.NAME] diffuse", "albedo", "reflectance"),
        ("[materials.NAME] whitted", "Kd", "diffuse"),
        ("[materials.NAME] principled", "baseColor", "base_color"),
        ("[materials.NAME] unlit", "albedo", "color"),
        ("[materials.NAME] conductor", "color", "reflectance"),
        ("[materials.NAME] conductor", "alpha", "roughness"),
        ("[materials.NAME] conductor", "ior", "eta"),
        ("[materials.NAME] dielectric", "index", "ior"),
        ("[materials.NAME] dielectric", "eta", "ior"),
        ("[[light]] point", "kelvin", "intensity"),
        ("[[light]] sun_and_sky", "latitude", "place"),
        ("[[light]] sun_and_sky", "time", "hour"),
        ("[render]", "spp", "samples"),
        ("[render]", "pixelSamples", "samples"),
        ("[render]", "samples_per_pixel", "samples"),
        ("[render]", "max_depth", "depth"),
        ("[image]", "resolution", "width"),
        ("[image]", "xres", "width"),
        ("[camera]", "position", "lookfrom"),
        ("[camera]", "from", "lookfrom"),
        ("[camera]", "eye", "lookfrom"),
        ("[camera]", "origin", "lookfrom"),
        ("[camera]", "target", "lookat"),
        ("[camera]", "fovy", "fov"),
        ("[[sphere]]", "position", "center"),
        ("[[sphere]]", "color", "material"),
        ("[[cylinder]]", "position", "from"),
        ("[[box]]", "from", "min"),
        ("[[mesh]]", "position", "translate"),
        ("[[light]] point", "location", "position"),
        ("[[light]] distant", "position", "from"),
        ("[[light]] disk", "from", "center"),
        ("[[light]] spot", "look_at", "target"),
        ("[[light]] spot", "strength", "intensity"),
        ("[[light]] disk", "intensity", "radiance"),
        ("[[light]] distant", "power", "illuminance"),
        ("[[light]] point", "color", "intensity"),
        ("a scene", "cube", "box"),
    ] {
        assert_eq!(keys(word, of(title)).first(), Some(&meant), "{word} in {title}");
    }
    assert_eq!(keys("resolution", of("[image]")), ["width", "height"]);
    let of = |what: &str| choices().into_iter().find(|(title, _)| *title == what).expect("a choice").1;
    let said = |what, word| choice(word, &of(what)).unwrap_or_default();
    assert!(said("[[light]]", "area").starts_with("write \"rectangle\", \"disk\" or \"sphere\";"));
    assert!(said("[materials.NAME]", "emissive").contains("`emission`"));
    for (what, word, meant) in [
        ("[[light]]", "sun", "distant"),
        ("[[light]]", "directional", "distant"),
        ("[[light]]", "PointLight", "point"),
        ("[materials.NAME]", "lambert", "diffuse"),
        ("[materials.NAME]", "metal", "conductor"),
        ("[materials.NAME]", "paint", "coated_diffuse"),
        ("[materials.NAME]", "roughplastic", "plastic"),
        ("distribution", "GGX", "trowbridge_reitz"),
        ("[materials.NAME]", "mirror", "conductor"),
        ("[textures.NAME]", "checkerboard", "checker"),
        ("integrator", "path_tracer", "path"),
    ] {
        assert_eq!(said(what, word), format!("did you mean {meant:?}?"));
    }
}
