#![no_main]

use std::path::{Path, PathBuf};

use lookfrom_scene::files::Memory;
use lookfrom_scene::{Budget, LoadContext, mitsuba};

/// A scene of one file of meshes, volumes or curves: the first byte tells which.
fn scene(kind: u8) -> String {
    let file = "<string name=\"filename\" value=\"a.data\"/>";
    let shape = match kind % 5 {
        0 => format!("<shape type=\"serialized\">{file}<integer name=\"shape_index\" value=\"1\"/></shape>"),
        1 => format!(
            "<medium type=\"heterogeneous\" id=\"m\"><volume name=\"sigma_t\" type=\"gridvolume\">{file}</volume>\
             <rgb name=\"albedo\" value=\"0.5 0.25 0\"/></medium>\
             <shape type=\"cube\"><bsdf type=\"null\"/><ref name=\"interior\" id=\"m\"/></shape>"
        ),
        2 => format!("<shape type=\"bsplinecurve\">{file}</shape>"),
        3 => format!("<shape type=\"linearcurve\">{file}</shape>"),
        _ => format!("<shape type=\"sdfgrid\">{file}</shape>"),
    };
    format!("<scene version=\"3.0.0\">{shape}</scene>")
}

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let Some((kind, data)) = bytes.split_first() else { return };
    let files = [("a.xml", scene(*kind).into_bytes()), ("a.data", data.to_vec())];
    let files = Memory(files.map(|(name, bytes)| (PathBuf::from(name), bytes)).into());
    let mut context = LoadContext::within(&Budget::new(1 << 26), &files);
    context.limits = lookfrom_fuzz::limits();
    let _ = mitsuba::read(Path::new("a.xml"), &mut context);
});
