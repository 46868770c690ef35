//! The materials of many parameters: glTF's, OpenPBR's and Disney's.

use super::Writer;
use super::color::plain_color;
use super::text::{Fields, Item};
use crate::error::Result;
use crate::material::{Anisotropy, Disney, OpenPbr, Principled, Scalar, Tangent};

impl Writer<'_> {
    pub(super) fn principled(&mut self, fields: &mut Fields, look: &Principled) -> Result<()> {
        let Principled {
            base_color,
            metallic,
            roughness,
            anisotropy,
            ior,
            dispersion,
            specular,
            specular_color,
            transmission,
            is_solid,
            absorption,
            diffuse_transmission,
            diffuse_transmission_color,
            clearcoat,
            clearcoat_roughness,
            clearcoat_normal,
            sheen_color,
            sheen_roughness,
            iridescence,
            iridescence_ior,
            iridescence_thickness,
        } = look;
        let usual = Principled::default();
        self.put_color(fields, "base_color", *base_color, 0.8)?;
        self.put_scalars(fields, &[("metallic", *metallic, 0.0), ("roughness", *roughness, 0.5)]);
        if let Some(Anisotropy { strength, rotation, texture }) = *anisotropy {
            fields.put("anisotropy", strength);
            put_angle(fields, rotation);
            if let Some(texture) = texture {
                fields.put("anisotropy_map", self.texture_name(texture));
            }
        }
        fields.put_unless("ior", *ior, usual.ior);
        fields.put_unless("dispersion", *dispersion, usual.dispersion);
        self.put_scalars(fields, &[("specular", *specular, 1.0)]);
        self.put_color(fields, "specular_color", *specular_color, 1.0)?;
        self.put_scalars(fields, &[("transmission", *transmission, 0.0)]);
        fields.put_unless("solid", *is_solid, usual.is_solid);
        if *absorption != [0.0; 3] {
            fields.put("absorption", plain_color(*absorption));
        }
        self.put_scalars(fields, &[("diffuse_transmission", *diffuse_transmission, 0.0)]);
        self.put_color(fields, "diffuse_transmission_color", *diffuse_transmission_color, 1.0)?;
        self.put_scalars(
            fields,
            &[("clearcoat", *clearcoat, 0.0), ("clearcoat_roughness", *clearcoat_roughness, 0.0)],
        );
        if let Some(map) = clearcoat_normal {
            fields.put("clearcoat_normal_map", self.normals(*map));
        }
        self.put_color(fields, "sheen_color", *sheen_color, 0.0)?;
        self.put_scalars(
            fields,
            &[("sheen_roughness", *sheen_roughness, 0.5), ("iridescence", *iridescence, 0.0)],
        );
        fields.put_unless("iridescence_ior", *iridescence_ior, usual.iridescence_ior);
        self.put_scalars(
            fields,
            &[("iridescence_thickness", *iridescence_thickness, Principled::FILM_THICKNESS)],
        );
        Ok(())
    }

    pub(super) fn open_pbr(&mut self, fields: &mut Fields, look: &OpenPbr) -> Result<()> {
        let OpenPbr {
            base_weight,
            base_color,
            base_diffuse_roughness,
            base_metalness,
            specular_weight,
            specular_color,
            specular_roughness,
            specular_roughness_anisotropy,
            specular_ior,
            transmission_weight,
            transmission_color,
            dispersion,
            subsurface_weight,
            subsurface_color,
            subsurface_scatter_anisotropy,
            coat_weight,
            coat_color,
            coat_roughness,
            coat_roughness_anisotropy,
            coat_ior,
            coat_darkening,
            fuzz_weight,
            fuzz_color,
            fuzz_roughness,
            thin_film_weight,
            thin_film_thickness,
            thin_film_ior,
            geometry_thin_walled,
            geometry_coat_normal,
            geometry_tangent,
            geometry_coat_tangent,
        } = look;
        let usual = OpenPbr::default();
        self.put_scalars(fields, &[("base_weight", *base_weight, 1.0)]);
        self.put_color(fields, "base_color", *base_color, 0.8)?;
        self.put_scalars(
            fields,
            &[
                ("base_diffuse_roughness", *base_diffuse_roughness, 0.0),
                ("base_metalness", *base_metalness, 0.0),
                ("specular_weight", *specular_weight, 1.0),
            ],
        );
        self.put_color(fields, "specular_color", *specular_color, 1.0)?;
        self.put_scalars(
            fields,
            &[
                ("specular_roughness", *specular_roughness, 0.3),
                ("specular_roughness_anisotropy", *specular_roughness_anisotropy, 0.0),
            ],
        );
        fields.put_unless("specular_ior", *specular_ior, usual.specular_ior);
        self.put_scalars(fields, &[("transmission_weight", *transmission_weight, 0.0)]);
        self.put_color(fields, "transmission_color", *transmission_color, 1.0)?;
        fields.put_unless("dispersion", *dispersion, usual.dispersion);
        self.put_scalars(fields, &[("subsurface_weight", *subsurface_weight, 0.0)]);
        self.put_color(fields, "subsurface_color", *subsurface_color, 0.8)?;
        if *subsurface_weight != Scalar::Value(0.0) && !geometry_thin_walled {
            // Scattering in depth is a material of its own here.
            fields.put("subsurface_radius", 0_u32);
        }
        fields.put_unless("subsurface_scatter_anisotropy", *subsurface_scatter_anisotropy, 0.0);
        self.put_scalars(fields, &[("coat_weight", *coat_weight, 0.0)]);
        self.put_color(fields, "coat_color", *coat_color, 1.0)?;
        self.put_scalars(
            fields,
            &[
                ("coat_roughness", *coat_roughness, 0.0),
                ("coat_roughness_anisotropy", *coat_roughness_anisotropy, 0.0),
            ],
        );
        fields.put_unless("coat_ior", *coat_ior, usual.coat_ior);
        self.put_scalars(
            fields,
            &[("coat_darkening", *coat_darkening, 1.0), ("fuzz_weight", *fuzz_weight, 0.0)],
        );
        self.put_color(fields, "fuzz_color", *fuzz_color, 1.0)?;
        self.put_scalars(
            fields,
            &[
                ("fuzz_roughness", *fuzz_roughness, 0.5),
                ("thin_film_weight", *thin_film_weight, 0.0),
                ("thin_film_thickness", *thin_film_thickness, 0.5),
            ],
        );
        fields.put_unless("thin_film_ior", *thin_film_ior, usual.thin_film_ior);
        fields.put_unless("geometry_thin_walled", *geometry_thin_walled, false);
        if let Some(map) = geometry_coat_normal {
            fields.put("geometry_coat_normal", self.normals(*map));
        }
        self.put_tangent(fields, "geometry_tangent", *geometry_tangent);
        self.put_tangent(fields, "geometry_coat_tangent", *geometry_coat_tangent);
        Ok(())
    }

    pub(super) fn disney(&mut self, fields: &mut Fields, look: &Disney) -> Result<()> {
        let Disney {
            base_color,
            roughness,
            anisotropic,
            metallic,
            spec_trans,
            eta,
            spec_tint,
            sheen,
            sheen_tint,
            flatness,
            clearcoat,
            clearcoat_gloss,
            diff_trans,
            is_thin,
        } = look;
        self.put_color(fields, "base_color", *base_color, 0.5)?;
        self.put_scalars(
            fields,
            &[
                ("roughness", *roughness, 0.5),
                ("anisotropic", *anisotropic, 0.0),
                ("metallic", *metallic, 0.0),
                ("spec_trans", *spec_trans, 0.0),
                ("ior", *eta, 1.5),
                ("spec_tint", *spec_tint, 0.0),
                ("sheen", *sheen, 0.0),
                ("sheen_tint", *sheen_tint, 0.0),
                ("flatness", *flatness, 0.0),
                ("clearcoat", *clearcoat, 0.0),
                ("clearcoat_gloss", *clearcoat_gloss, 0.0),
                ("diff_trans", *diff_trans, 0.0),
            ],
        );
        fields.put_unless("thin", *is_thin, false);
        Ok(())
    }

    fn put_tangent(&self, fields: &mut Fields, key: &str, tangent: Tangent) {
        match tangent {
            Tangent::U => {}
            Tangent::Value(direction) => fields.put(key, direction),
            Tangent::Texture(id) => fields.put(key, self.texture_name(id)),
        }
    }
}

/// An angle in degrees where that gives the same bits, else in radians.
fn put_angle(fields: &mut Fields, radians: f32) {
    let near = radians.to_degrees();
    let candidates = [near.round(), near, near.next_down(), near.next_up()];
    match candidates.into_iter().find(|degrees| degrees.to_radians().to_bits() == radians.to_bits()) {
        Some(degrees) => fields.put_unless("anisotropy_rotation", degrees, 0.0),
        None => fields.put("anisotropy_rotation", Fields::one("radians", Item::from(radians))),
    }
}
