//! Materials.

use super::Writer;
use super::cannot;
use super::color::{Of, plain_color};
use super::picture::For;
use super::text::{Fields, Item};
use crate::error::Result;
use crate::material::{
    BackFace, BumpGuard, BumpMapping, Coat, Disney, Energy, Hair, Illuminant, Ior, Material, MaterialKind,
    Metal, Pigment, Plastic, Roughness, Scalar, Subsurface, SubsurfaceMedium, Tint, Whitted,
};
use crate::measured::Measured;
use crate::toml::material::BACK_FACES;
use crate::toml::physical::{ENERGIES, ESTIMATES, ILLUMINANTS, REFLECTANCE};
use crate::toml::word_of;

impl Writer<'_> {
    pub(super) fn material(&mut self, material: &Material) -> Result<Fields> {
        let Material { name: _, at: _, kind, bump_mapping, bump_guard, medium, back_face } = material;
        let mut fields = Fields::default();
        fields.put_unless("type", word(kind), "whitted");
        match kind {
            MaterialKind::Whitted(whitted) => self.whitted(&mut fields, whitted)?,
            MaterialKind::Diffuse { reflectance } => {
                self.put_color(&mut fields, "reflectance", *reflectance, REFLECTANCE)?;
            }
            MaterialKind::DiffuseTransmission { reflectance, transmittance, scale } => {
                let usual = MaterialKind::DIFFUSE_SHEET;
                self.put_color(&mut fields, "reflectance", *reflectance, usual)?;
                self.put_color(&mut fields, "transmittance", *transmittance, usual)?;
                fields.put_unless("scale", *scale, 1.0);
            }
            MaterialKind::Conductor { metal, roughness, energy, specular_reflectance } => {
                self.metal(&mut fields, metal)?;
                self.roughness(&mut fields, "roughness", roughness);
                put_energy(&mut fields, *energy);
                self.put_color(&mut fields, "specular_reflectance", *specular_reflectance, 1.0)?;
            }
            MaterialKind::Dielectric { eta, roughness, energy, tint } => {
                self.ior(&mut fields, *eta);
                self.roughness(&mut fields, "roughness", roughness);
                put_energy(&mut fields, *energy);
                self.tint(&mut fields, tint)?;
            }
            MaterialKind::ThinDielectric { eta, tint } => {
                self.ior(&mut fields, *eta);
                self.tint(&mut fields, tint)?;
            }
            MaterialKind::CoatedDiffuse { reflectance, coat } => {
                self.put_color(&mut fields, "reflectance", *reflectance, REFLECTANCE)?;
                self.coat(&mut fields, coat)?;
            }
            MaterialKind::CoatedConductor { metal, roughness, coat } => {
                self.metal(&mut fields, metal)?;
                self.roughness(&mut fields, "base_roughness", roughness);
                self.coat(&mut fields, coat)?;
            }
            MaterialKind::Subsurface(below) => self.subsurface(&mut fields, below)?,
            MaterialKind::Hair(hair) => self.hair(&mut fields, hair)?,
            MaterialKind::Measured(measured) => {
                let file = self.measured_file(measured)?;
                fields.put("file", file);
            }
            MaterialKind::Mix { materials, amount } => {
                let names = materials.map(|id| Item::from(self.materials.of(id.index())));
                fields.put("materials", names);
                self.put_scalar(&mut fields, "amount", *amount, MaterialKind::MIX_AMOUNT);
            }
            MaterialKind::Principled(look) => self.principled(&mut fields, look)?,
            MaterialKind::OpenPbr(look) => self.open_pbr(&mut fields, look)?,
            MaterialKind::Disney(look) => self.disney(&mut fields, look)?,
            MaterialKind::Plastic(plastic) => self.plastic(&mut fields, plastic)?,
            MaterialKind::Unlit { color } => self.put_color(&mut fields, "color", *color, 1.0)?,
            MaterialKind::ShadowCatcher { normal } => {
                fields.put("normal", normal.to_array().map(Item::exact));
            }
            MaterialKind::Interface => {}
        }
        match *bump_mapping {
            BumpMapping::None => {}
            BumpMapping::Bump(height) => fields.put("bump", self.scalar(height)),
            BumpMapping::NormalMap(image) => {
                let picture = self.picture(image, For::Normals)?;
                fields.put("normal_map", picture.file);
            }
            BumpMapping::NormalTexture(map) => {
                let mut table = Fields::one("texture", self.texture_name(map.texture));
                table.put_unless("scale", map.scale, 1.0);
                fields.put("normal_map", table);
            }
        }
        if let Some(BumpGuard { turns, shadows }) = *bump_guard {
            let mut table = Fields::one("turns", turns);
            table.put("shadows", shadows);
            fields.put("bump_guard", table);
        }
        if *back_face != BackFace::Own {
            fields.put("back_face", word_of(BACK_FACES, back_face));
        }
        if let Some(medium) = medium {
            fields.put("medium", self.media.of(medium.index()));
        }
        Ok(fields)
    }

    fn whitted(&mut self, fields: &mut Fields, whitted: &Whitted) -> Result<()> {
        let Whitted { ambient, diffuse, specular, shininess, mirror, transmission, ior, fresnel, absorption } =
            whitted;
        let usual = Whitted::default();
        if let Some(color) = ambient {
            let item = self.color(*color, Of::Color)?;
            fields.put("ambient", item);
        }
        self.put_color(fields, "diffuse", *diffuse, 0.8)?;
        self.put_color(fields, "specular", *specular, 0.0)?;
        fields.put_unless("shininess", *shininess, usual.shininess);
        self.put_color(fields, "mirror", *mirror, 0.0)?;
        self.put_color(fields, "transmission", *transmission, 0.0)?;
        fields.put_unless("ior", *ior, usual.ior);
        fields.put_unless("fresnel", *fresnel, usual.fresnel);
        if *absorption != [0.0; 3] {
            fields.put("absorption", plain_color(*absorption));
        }
        Ok(())
    }

    fn metal(&mut self, fields: &mut Fields, metal: &Metal) -> Result<()> {
        match *metal {
            Metal::Indices { eta, k, illuminant } => {
                match self.metal_symbol(eta, k) {
                    Some(symbol) => fields.put("metal", symbol),
                    None => {
                        let [eta, k] = [self.color(eta, Of::Optics)?, self.color(k, Of::Optics)?];
                        fields.put("eta", eta);
                        fields.put("k", k);
                    }
                }
                if illuminant != Illuminant::default() {
                    fields.put("illuminant", word_of(ILLUMINANTS, &illuminant));
                }
            }
            Metal::Reflectance(color) => {
                let item = self.color(color, Of::Color)?;
                fields.put("reflectance", item);
            }
        }
        Ok(())
    }

    fn ior(&mut self, fields: &mut Fields, eta: Ior) {
        match eta {
            Ior::Value(eta) => fields.put_unless("ior", eta, Ior::GLASS),
            Ior::Curve(id) => match self.glass(id) {
                Some(name) => fields.put("ior", name),
                None => {
                    let curve = self.curve(id, Of::Optics);
                    fields.put("ior", curve);
                }
            },
        }
    }

    fn coat(&mut self, fields: &mut Fields, coat: &Coat) -> Result<()> {
        let Coat { eta, roughness, thickness, albedo, g, max_depth, samples, estimate } = coat;
        let usual = Coat::default();
        self.roughness(fields, "roughness", roughness);
        self.ior(fields, *eta);
        self.put_scalar(fields, "thickness", *thickness, Coat::THICKNESS);
        self.put_color(fields, "coat_albedo", *albedo, 0.0)?;
        self.put_scalar(fields, "g", *g, 0.0);
        fields.put_unless("coat_depth", *max_depth, usual.max_depth);
        fields.put_unless("coat_samples", *samples, usual.samples);
        if *estimate != usual.estimate {
            fields.put("coat_estimate", word_of(ESTIMATES, estimate));
        }
        Ok(())
    }

    fn subsurface(&mut self, fields: &mut Fields, below: &Subsurface) -> Result<()> {
        let Subsurface { medium, scale, g, eta, roughness } = below;
        match *medium {
            SubsurfaceMedium::Coefficients { absorption, scattering } => {
                let [absorption, scattering] =
                    [self.color(absorption, Of::Optics)?, self.color(scattering, Of::Optics)?];
                fields.put("absorption", absorption);
                fields.put("scattering", scattering);
            }
            SubsurfaceMedium::Reflectance { reflectance, mean_free_path } => {
                let [reflectance, mean_free_path] =
                    [self.color(reflectance, Of::Color)?, self.color(mean_free_path, Of::Optics)?];
                fields.put("reflectance", reflectance);
                fields.put("mean_free_path", mean_free_path);
            }
        }
        fields.put_unless("scale", *scale, 1.0);
        fields.put_unless("g", *g, 0.0);
        fields.put_unless("ior", *eta, Subsurface::ETA);
        self.roughness(fields, "roughness", roughness);
        Ok(())
    }

    fn hair(&mut self, fields: &mut Fields, hair: &Hair) -> Result<()> {
        let Hair { pigment, eta, beta_m, beta_n, alpha } = hair;
        match *pigment {
            Pigment::Absorption(color) => {
                let item = self.color(color, Of::Optics)?;
                fields.put("absorption", item);
            }
            Pigment::Reflectance(color) => {
                let item = self.color(color, Of::Color)?;
                fields.put("reflectance", item);
            }
            Pigment::Melanin { eumelanin, pheomelanin } => {
                fields.put("eumelanin", self.scalar(eumelanin));
                self.put_scalar(fields, "pheomelanin", pheomelanin, 0.0);
            }
        }
        self.put_scalar(fields, "ior", *eta, Hair::ETA);
        self.put_scalar(fields, "roughness", *beta_m, Hair::ROUGHNESS);
        self.put_scalar(fields, "radial_roughness", *beta_n, Hair::ROUGHNESS);
        self.put_scalar(fields, "offset", *alpha, Hair::ALPHA);
        Ok(())
    }

    fn disney(&mut self, fields: &mut Fields, look: &Disney) -> Result<()> {
        let usual = Disney::default();
        self.put_color(fields, "base_color", look.base_color, 0.5)?;
        fields.put_unless("thin", look.is_thin, false);
        for ((name, scalar), (_, default)) in look.scalars().into_iter().zip(usual.scalars()) {
            if let Scalar::Value(default) = default {
                let key = if name == "eta" { "ior" } else { name };
                self.put_scalar(fields, key, scalar, default);
            }
        }
        Ok(())
    }

    fn tint(&mut self, fields: &mut Fields, tint: &Tint) -> Result<()> {
        self.put_color(fields, "specular_reflectance", tint.reflectance, 1.0)?;
        self.put_color(fields, "specular_transmittance", tint.transmittance, 1.0)
    }

    fn plastic(&mut self, fields: &mut Fields, plastic: &Plastic) -> Result<()> {
        let Plastic { reflectance, specular_reflectance, eta, alpha, microfacets, is_nonlinear } = plastic;
        self.put_color(fields, "reflectance", *reflectance, REFLECTANCE)?;
        self.put_color(fields, "specular_reflectance", *specular_reflectance, 1.0)?;
        fields.put_unless("ior", *eta, Plastic::ETA);
        let alphas = Roughness::of_alphas(Scalar::Value(*alpha), Scalar::Value(*alpha));
        self.roughness(fields, "roughness", &Roughness { microfacets: *microfacets, ..alphas });
        fields.put_unless("nonlinear", *is_nonlinear, true);
        Ok(())
    }

    /// The file that tables were read from, copied.
    fn measured_file(&mut self, measured: &Measured) -> Result<String> {
        if let Some(file) = self.measured.get(&measured.digest) {
            return Ok(file.clone());
        }
        let Some((path, bytes)) = self.sources.file_with(&measured.digest) else {
            return Err(cannot("a measured material: the file of its tables is not there any more"));
        };
        let ending = if path.to_lowercase().ends_with(".binary") { "binary" } else { "bsdf" };
        let file = self.file(&path, ending, bytes);
        self.measured.insert(measured.digest.clone(), file.clone());
        Ok(file)
    }

    /// Numbers that are not the defaults.
    pub(super) fn put_scalars(&self, fields: &mut Fields, scalars: &[(&str, Scalar, f32)]) {
        for (key, scalar, default) in scalars {
            self.put_scalar(fields, key, *scalar, *default);
        }
    }
}

/// The type of a material.
fn word(kind: &MaterialKind) -> &'static str {
    match kind {
        MaterialKind::Whitted(_) => "whitted",
        MaterialKind::Diffuse { .. } => "diffuse",
        MaterialKind::DiffuseTransmission { .. } => "diffuse_transmission",
        MaterialKind::Conductor { .. } => "conductor",
        MaterialKind::Dielectric { .. } => "dielectric",
        MaterialKind::ThinDielectric { .. } => "thin_dielectric",
        MaterialKind::CoatedDiffuse { .. } => "coated_diffuse",
        MaterialKind::CoatedConductor { .. } => "coated_conductor",
        MaterialKind::Subsurface(_) => "subsurface",
        MaterialKind::Hair(_) => "hair",
        MaterialKind::Measured(_) => "measured",
        MaterialKind::Mix { .. } => "mix",
        MaterialKind::Principled(_) => "principled",
        MaterialKind::OpenPbr(_) => "openpbr",
        MaterialKind::Disney(_) => "disney",
        MaterialKind::Plastic(_) => "plastic",
        MaterialKind::Unlit { .. } => "unlit",
        MaterialKind::ShadowCatcher { .. } => "shadow_catcher",
        MaterialKind::Interface => "interface",
    }
}

fn put_energy(fields: &mut Fields, energy: Energy) {
    if energy != Energy::default() {
        fields.put("energy", word_of(ENERGIES, &energy));
    }
}
