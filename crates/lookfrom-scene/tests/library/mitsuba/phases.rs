//! Phase functions of media.

use lookfrom_scene::medium::DraineLobe;

use super::*;

/// The mean cosine and the second lobe of a medium with this phase.
fn phase(phase: &str) -> Result<(f32, Option<DraineLobe>)> {
    let text = format!(
        "<scene version=\"3.0.0\"><medium type=\"homogeneous\" id=\"fog\">{phase}</medium>\
         <shape type=\"sphere\"><bsdf type=\"null\"/><ref name=\"interior\" id=\"fog\"/></shape></scene>"
    );
    read_of(&files(&[("s/a.xml", &text)]), &[]).0.map(|scene| (scene.media[0].g, scene.media[0].draine))
}

#[test]
fn phases_are_lobes() {
    let draine = |g, alpha, share| Some(DraineLobe { g, alpha, share });
    let (rayleigh, hg) =
        ("<phase type=\"rayleigh\"/>", "<phase type=\"hg\"><float name=\"g\" value=\"-0.5\"/></phase>");
    let blend = |a: &str, b: &str| {
        phase(&format!("<phase type=\"blendphase\"><float name=\"weight\" value=\"0.25\"/>{a}{b}</phase>"))
    };
    assert_eq!(phase(rayleigh).unwrap(), (0.0, draine(0.0, 1.0, 1.0)));
    assert_eq!(phase(hg).unwrap(), (-0.5, None));
    assert_eq!(blend(rayleigh, hg).unwrap(), (-0.5, draine(0.0, 1.0, 0.75)));
    assert_eq!(blend(hg, "<phase type=\"isotropic\"/>").unwrap(), (0.0, draine(-0.5, 0.0, 0.75)));
    assert_eq!(blend(hg, hg).unwrap(), (-0.5, None));
    let third = "<phase type=\"blendphase\"><phase type=\"isotropic\"/><phase type=\"rayleigh\"/></phase>";
    assert_eq!(blend(hg, third).unwrap_err().kind, ErrorKind::Unsupported);
    assert_eq!(blend(hg, "").unwrap_err().kind, ErrorKind::Invalid);
}
