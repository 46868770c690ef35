//! Parameters of version 3 by the names that version 4 has for them.

use crate::pbrt::Reader;
use crate::pbrt::params::{Parameter, ParameterType, Values};
use crate::pbrt::text::Place;
use crate::spectrum::{Curve, observer, space};

/// Names of parameters that version 4 has by another name, in directives.
const RENAMED: &[(&str, &str, &str)] = &[
    ("Film", "maxsampleluminance", "maxcomponentvalue"),
    ("PixelFilter", "xwidth", "xradius"),
    ("PixelFilter", "ywidth", "yradius"),
    ("Integrator", "lightsamplestrategy", "lightsampler"),
    ("LightSource", "mapname", "filename"),
    ("Shape", "nlevels", "levels"),
    ("Shape", "st", "uv"),
];

/// Names of parameters that change nothing in a picture, in directives.
const WITHOUT_EFFECT: &[(&str, &[&str])] = &[
    ("Camera", &["simpleweighting"]),
    ("Sampler", &["dimensions", "samplesperpixel"]),
    (
        "Integrator",
        &[
            "rrthreshold",
            "pixelbounds",
            "strategy",
            "imagewritefrequency",
            "numiterations",
            "visualizestrategies",
        ],
    ),
    ("LightSource", &["samples", "nsamples"]),
    ("AreaLightSource", &["samples", "nsamples"]),
    ("Shape", &["discarddegenerateUVs", "shadowalpha"]),
    ("Texture", &["aamode"]),
];

/// The parameters of a directive.
struct Translation<'a> {
    /// The place of the directive.
    place: &'a Place,
    kind: &'a mut String,
    own: &'a mut Vec<Parameter>,
}

impl Reader<'_, '_> {
    /// Translates what a directive of version 3 says.
    pub(in crate::pbrt) fn translate(
        &mut self,
        (directive, place): (&str, &Place),
        kind: &mut String,
        own: &mut Vec<Parameter>,
    ) {
        for parameter in own.iter_mut() {
            to_rgb(parameter);
            let renamed = RENAMED.iter().find(|entry| entry.0 == directive && entry.1 == parameter.name);
            if let Some((.., new)) = renamed {
                (*new).clone_into(&mut parameter.name);
            }
        }
        let without_effect = WITHOUT_EFFECT.iter().filter(|entry| entry.0 == directive);
        let without_effect: Vec<&str> = without_effect.flat_map(|entry| entry.1).copied().collect();
        own.retain(|parameter| !without_effect.contains(&&*parameter.name));
        let mut translation = Translation { place, kind, own };
        match directive {
            "Film" => translation.film(),
            "PixelFilter" => translation.filter(),
            "Sampler" => translation.sampler(),
            "Integrator" => self.old_integrator(&mut translation),
            "Camera" => translation.camera(),
            "LightSource" | "AreaLightSource" => self.old_light(&mut translation),
            "Shape" => translation.shape(),
            "Texture" => translation.texture(),
            _ => {}
        }
    }

    fn old_integrator(&mut self, of: &mut Translation<'_>) {
        if let "directlighting" | "whitted" = &**of.kind {
            self.leave_out(
                of.place,
                "light that comes by way of other surfaces is there as well: \"path\" is used",
            );
            "path".clone_into(of.kind);
        }
        for parameter in of.own.iter_mut().filter(|parameter| parameter.name == "lightsampler") {
            if let Values::Strings(words) = &mut parameter.values {
                words.iter_mut().filter(|word| **word == "spatial").for_each(|word| "bvh".clone_into(word));
            }
        }
    }

    fn old_light(&mut self, of: &mut Translation<'_>) {
        match &**of.kind {
            "area" => "diffuse".clone_into(of.kind),
            "exinfinite" => "infinite".clone_into(of.kind),
            "goniometric" => {
                if let Some(picture) = of.take("filename") {
                    self.leave_out(
                        &picture.place,
                        "the picture of a goniometric light is left out: it is a point light",
                    );
                    "point".clone_into(of.kind);
                }
            }
            _ => {}
        }
        of.light();
    }
}

impl Translation<'_> {
    fn film(&mut self) {
        if self.kind == "image" {
            "rgb".clone_into(self.kind);
        }
        if let Some(scale) = self.number("scale") {
            self.own.retain(|parameter| parameter.name != "scale");
            self.add(ParameterType::Float, "iso", Values::Numbers(vec![100.0 * scale]));
        }
    }

    fn filter(&mut self) {
        if self.kind != "gaussian" {
            return;
        }
        for parameter in self.own.iter_mut().filter(|parameter| parameter.name == "alpha") {
            "sigma".clone_into(&mut parameter.name);
            if let Values::Numbers(numbers) = &mut parameter.values {
                numbers.iter_mut().for_each(|alpha| *alpha = 1.0 / (2.0 * *alpha).sqrt());
            }
        }
        for radius in ["xradius", "yradius"] {
            if self.number(radius).is_none() {
                self.add(ParameterType::Float, radius, Values::Numbers(vec![2.0]));
            }
        }
    }

    fn sampler(&mut self) {
        match &**self.kind {
            "lowdiscrepancy" | "02sequence" | "maxmindist" | "bestcandidate" | "adaptive" => {
                "zsobol".clone_into(self.kind);
            }
            "random" => "independent".clone_into(self.kind),
            _ => {}
        }
    }

    fn camera(&mut self) {
        if self.kind == "environment" {
            "spherical".clone_into(self.kind);
            let values = Values::Strings(vec!["equirectangular".to_owned()]);
            self.add(ParameterType::String, "mapping", values);
        }
        if let Some(half) = self.number("halffov") {
            self.own.retain(|parameter| parameter.name != "halffov");
            self.add(ParameterType::Float, "fov", Values::Numbers(vec![2.0 * half]));
        }
    }

    /// A `scale` that is a colour multiplies the light.
    fn light(&mut self) {
        let mean = |rgb: [f32; 3]| Values::Numbers(vec![rgb.iter().sum::<f32>() / 3.0]);
        let scale = self.take_color("scale");
        if self.kind == "projection" {
            // Its picture has the colours.
            let light = [scale, self.take_color("I")].into_iter().flatten().reduce(times);
            light.into_iter().for_each(|light| self.add(ParameterType::Float, "scale", mean(light)));
            if self.number("fov").is_none() {
                self.add(ParameterType::Float, "fov", Values::Numbers(vec![45.0]));
            }
            return;
        }
        let Some(scale) = scale else { return };
        let name = match &**self.kind {
            "distant" | "infinite" | "diffuse" => "L",
            _ => "I",
        };
        match self.take_color(name) {
            Some(light) => self.add(ParameterType::Rgb, name, Values::Numbers(times(light, scale).to_vec())),
            // By the name of a spectrum.
            None if self.own.iter().any(|parameter| parameter.name == name) => {
                self.add(ParameterType::Float, "scale", mean(scale));
            }
            None => self.add(ParameterType::Rgb, name, Values::Numbers(scale.to_vec())),
        }
    }

    fn shape(&mut self) {
        for parameter in self.own.iter_mut().filter(|parameter| parameter.name == "uv") {
            if parameter.kind == ParameterType::Float {
                parameter.kind = ParameterType::Point2;
            }
        }
    }

    fn texture(&mut self) {
        if self.kind != "imagemap" {
            return;
        }
        let word = |word: &str| Values::Strings(vec![word.to_owned()]);
        if let Some(gamma) = self.take("gamma") {
            let encoding = match gamma.values {
                Values::Truths(truths) => match truths.first() {
                    Some(false) => "linear".to_owned(),
                    _ => "sRGB".to_owned(),
                },
                Values::Numbers(numbers) => match numbers.first() {
                    Some(1.0) | None => "linear".to_owned(),
                    Some(gamma) => format!("gamma {gamma}"),
                },
                _ => "sRGB".to_owned(),
            };
            self.add(ParameterType::String, "encoding", word(&encoding));
        }
        let is_trilinear = match self.take("trilinear").map(|parameter| parameter.values) {
            Some(Values::Truths(truths)) => truths.first() == Some(&true),
            _ => false,
        };
        self.add(ParameterType::String, "filter", word(if is_trilinear { "trilinear" } else { "ewa" }));
    }

    /// The single number of a parameter.
    fn number(&self, name: &str) -> Option<f32> {
        let parameter = self.own.iter().rev().find(|parameter| parameter.name == name)?;
        match parameter.numbers() {
            [number] => Some(*number),
            _ => None,
        }
    }

    fn add(&mut self, kind: ParameterType, name: &str, values: Values) {
        self.own.push(Parameter::new(kind, name, self.place.clone(), values));
    }

    /// Takes a colour out: of a spectrum in numbers its mean.
    fn take_color(&mut self, name: &str) -> Option<[f32; 3]> {
        let is_color = |parameter: &Parameter| {
            let kinds = [ParameterType::Rgb, ParameterType::Spectrum];
            parameter.name == name && kinds.contains(&parameter.kind) && !parameter.numbers().is_empty()
        };
        let index = self.own.iter().position(is_color)?;
        let color = self.own.remove(index);
        match (color.kind, color.numbers()) {
            (ParameterType::Rgb, &[red, green, blue]) => Some([red, green, blue]),
            (ParameterType::Rgb, _) => None,
            (_, pairs) => {
                let values = pairs.iter().skip(1).step_by(2);
                Some([values.clone().sum::<f32>() / values.count().max(1) as f32; 3])
            }
        }
    }

    /// Takes a parameter out.
    fn take(&mut self, name: &str) -> Option<Parameter> {
        let index = self.own.iter().position(|parameter| parameter.name == name)?;
        Some(self.own.remove(index))
    }
}

fn times(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    std::array::from_fn(|channel| a[channel] * b[channel])
}

/// Makes colours in XYZ, and blackbodies with a scale, colours in Rec. 709, as version 3 does.
fn to_rgb(parameter: &mut Parameter) {
    let xyz = match (parameter.kind, parameter.old_kind, parameter.numbers()) {
        (_, Some("xyz"), &[x, y, z]) => [x, y, z].map(f64::from),
        (ParameterType::Blackbody, _, &[kelvin, scale]) if kelvin > 0.0 => {
            observer::xyz(&Curve::Blackbody { kelvin }).map(|value| value * f64::from(scale))
        }
        _ => return,
    };
    let rgb = space::apply(&space::inverse(&space::XYZ_FROM_RGB), xyz);
    parameter.kind = ParameterType::Rgb;
    parameter.values = Values::Numbers(rgb.map(|value| value.max(0.0) as f32).to_vec());
}
