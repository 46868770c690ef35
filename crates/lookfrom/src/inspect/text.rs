//! The inspection as text: from the pixel to the world, then the tree of rays, indented, or the path, ray by ray.

mod path;
mod pixel;

use std::fmt::{self, Display, Formatter, Write as _};

use super::candidate::{Number, Test};
use super::{Amount, Candidate, Inspection, LightReport, MetReport, RayReport, ShadowReport};

/// Number of candidates that are shown besides the hit of a ray of the tree; the JSON has all.
const OTHERS_IN_TREE: usize = 5;

impl Display for Inspection {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let [x, y] = self.pixel;
        writeln!(f, "pixel {x} {y} (column, row from the top), sample {}", self.sample)?;
        writeln!(f)?;
        self.write_summary(f)?;
        writeln!(f)?;
        self.write_camera(f)?;
        writeln!(f)?;
        self.write_wavelengths(f)?;
        if self.is_path() {
            self.write_path(f)?;
        } else {
            writeln!(f, "The tree of rays")?;
            if let Some(root) = self.rays.first() {
                self.write_ray(f, root, 0)?;
            }
        }
        writeln!(f)?;
        self.write_sum(f)
    }
}

impl Inspection {
    fn write_camera(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let camera = &self.camera;
        writeln!(f, "From the pixel to the world: P_world = T4 · R3 · S2 · T1 · P_k")?;
        writeln!(f, "  P_k      = {}", vector(&camera.p_k))?;
        for step in &camera.steps {
            writeln!(f, "  {}: {}", step.name, step.does)?;
            let title =
                if step.name == "T1" { String::new() } else { format!("product up to {}", step.name) };
            for (row, (matrix, product)) in step.matrix.iter().zip(&step.product).enumerate() {
                let matrix = matrix.map(|x| format!("{:>11}", short(x))).join(" ");
                let product = product.map(|x| format!("{:>11}", short(x))).join(" ");
                match (title.is_empty(), row) {
                    (true, _) => writeln!(f, "    [{matrix} ]")?,
                    (false, 0) => writeln!(f, "    [{matrix} ]   [{product} ]  {title}")?,
                    (false, _) => writeln!(f, "    [{matrix} ]   [{product} ]")?,
                }
            }
            writeln!(f, "    point  = {}", vector(&step.point))?;
        }
        writeln!(f, "  lookfrom = {}", vector(&camera.lookfrom))?;
        writeln!(
            f,
            "  u (left) = {}   v (up) = {}   w (forward) = {}",
            vector(&camera.u),
            vector(&camera.v),
            vector(&camera.w)
        )?;
        let moved = if camera.lens { "   (a point of the lens)" } else { "" };
        writeln!(f, "  a        = {}{moved}", vector(&camera.a))?;
        let on_plane =
            if camera.lens { "where the ray from the lens crosses the image plane" } else { "P_world" };
        writeln!(f, "  b        = {}   ({on_plane})", vector(&camera.b))?;
        writeln!(
            f,
            "  b − a    = {}   p(t) = a + t (b − a); t = 1 is the image plane",
            vector(&camera.direction)
        )
    }

    fn write_ray(&self, f: &mut Formatter<'_>, ray: &RayReport, indent: usize) -> fmt::Result {
        let pad = "  ".repeat(indent + 1);
        writeln!(f, "{pad}{} ray {}: throughput {}", ray.kind, ray.address, lanes(&ray.throughput))?;
        writeln!(f, "{pad}  a = {}   direction = {}", vector(&ray.a), vector32(&ray.direction))?;
        write_candidates(f, ray, OTHERS_IN_TREE, &pad)?;
        match &ray.met {
            None => writeln!(f, "{pad}  meets nothing: the sky")?,
            Some(met) => write_met(f, met, &pad)?,
        }
        for light in &ray.lights {
            write_light(f, light, &pad)?;
        }
        for addition in self.additions.iter().filter(|addition| addition.address == ray.address) {
            writeln!(f, "{pad}  + {}   {}", amount(&addition.value), addition.term)?;
        }
        let straight_on =
            self.rays.iter().find(|child| child.parent == Some(ray.address) && child.kind == "straight on");
        if let Some(child) = straight_on {
            writeln!(f, "{pad}  the ray passes this surface (cut out by its alpha) and goes straight on")?;
            return self.write_ray(f, child, indent);
        }
        for branch in &ray.branches {
            let mut how = String::new();
            if let Some(fresnel) = branch.fresnel {
                write!(how, ", Fresnel reflectance {fresnel}")?;
            }
            if branch.total_reflection {
                how.push_str(", total internal reflection");
            }
            if let Some(cut) = branch.cut {
                write!(how, "; not followed: {cut}")?;
            }
            writeln!(f, "{pad}  {} branch, weight {}{how}", branch.kind, lanes(&branch.weight))?;
            if let Some(child) = self.rays.iter().find(|child| child.address == branch.address) {
                self.write_ray(f, child, indent + 2)?;
            }
        }
        if !ray.branches.is_empty() {
            writeln!(f, "{pad}  all below ray {}: {}", ray.address, amount(&ray.subtree))?;
        }
        Ok(())
    }

    /// Writes the wavelengths of the lanes, in spectral mode.
    fn write_wavelengths(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Some(wavelengths) = &self.wavelengths else { return Ok(()) };
        writeln!(f, "Light has four wavelengths; numbers in [brackets] are one for each, in this order")?;
        writeln!(f, "  λ   = {} nm", vector32(&wavelengths.lambda))?;
        writeln!(
            f,
            "  pdf = {} per nm: the density with which each was sampled; the sensor divides by it",
            vector32(&wavelengths.pdf)
        )?;
        if wavelengths.dispersed {
            writeln!(
                f,
                "  Dispersion: each wavelength is refracted differently, so the path follows only the first; the others no\n  \
                 longer count (pdf 0), and the first counts four times (its pdf is divided by four)."
            )?;
        }
        writeln!(f)
    }

    fn write_sum(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(f, "The sum, in the order in which the film's sample was added up")?;
        for addition in &self.additions {
            writeln!(f, "  {}   ray {} {}", amount(&addition.value), addition.address, addition.term)?;
        }
        writeln!(f, "  = {}   times the filter's weight {}", amount(&self.radiance), self.weight)?;
        let verdict = if self.adds_up { "the same, bit for bit" } else { "NOT the same: please report this" };
        let sensor = if self.wavelengths.is_some() { "measured by the camera's sensor, and " } else { "" };
        writeln!(f, "  = {}   {sensor}what the film received: {verdict}", lanes(&self.film))
    }
}

fn write_candidates(f: &mut Formatter<'_>, ray: &RayReport, others: usize, pad: &str) -> fmt::Result {
    let (shown, hidden) = chosen(&ray.candidates, others);
    for candidate in shown {
        writeln!(f, "{pad}  tested {}: {}", candidate.name, candidate.verdict)?;
        write_test(f, &candidate.test, pad)?;
    }
    if hidden > 0 {
        writeln!(f, "{pad}  … and {hidden} more candidates, all rejected or farther (--json shows them)")?;
    }
    Ok(())
}

/// The nearest hit and the first few others, and the number of those left out.
fn chosen(candidates: &[Candidate], others: usize) -> (Vec<&Candidate>, usize) {
    let mut shown: Vec<&Candidate> = candidates.iter().filter(|candidate| candidate.is_nearest).collect();
    shown.extend(candidates.iter().filter(|candidate| !candidate.is_nearest).take(others));
    let hidden = candidates.len() - shown.len();
    (shown, hidden)
}

fn write_test(f: &mut Formatter<'_>, test: &Test, pad: &str) -> fmt::Result {
    let numbers: &[(&str, Number)] = match test {
        Test::Triangle { numbers } | Test::Sphere { numbers } => numbers,
        Test::Other => return Ok(()),
    };
    writeln!(f, "{pad}    {:<14} {:>16} {:>24} {:>14}", "", "f32", "f64", "matching bits")?;
    for (name, Number { f32, f64, bits }) in numbers {
        writeln!(f, "{pad}    {name:<14} {:>16} {:>24} {bits:>14}", format!("{f32}"), format!("{f64}"))?;
    }
    Ok(())
}

fn write_met(f: &mut Formatter<'_>, met: &MetReport, pad: &str) -> fmt::Result {
    let side = if met.front { "outside" } else { "inside" };
    let instance = met.instance.map_or(String::new(), |instance| format!(" in instance {instance}"));
    writeln!(f, "{pad}  meets {} at t = {} from {side}{instance}", met.shape, met.t)?;
    writeln!(f, "{pad}    point = {}   known to ± {}", vector(&met.point), vector(&met.error))?;
    writeln!(f, "{pad}    ng = {}   n = {}   uv = {}", vector(&met.ng), vector32(&met.n), vector32(&met.uv))?;
    write!(f, "{pad}    material {}", met.material)?;
    if let Some(k) = &met.coefficients {
        write!(
            f,
            ": k_a {} k_d {} k_s {} n {}",
            lanes(&k.ambient),
            lanes(&k.diffuse),
            lanes(&k.specular),
            k.shininess
        )?;
        write!(f, " k_r {} k_t {} ior {}", lanes(&k.mirror), lanes(&k.transmission), k.ior)?;
    }
    writeln!(f)
}

fn write_light(f: &mut Formatter<'_>, light: &LightReport, pad: &str) -> fmt::Result {
    let Some(wi) = light.wi else {
        return writeln!(f, "{pad}  light {}: does not illuminate this point", light.light);
    };
    writeln!(f, "{pad}  light {}: L = {}   I_j = {}", light.light, vector32(&wi), amount(&light.intensity))?;
    let (diffuse, specular) = (lanes(&light.diffuse), lanes(&light.specular));
    writeln!(f, "{pad}    k_d (N·L) = {diffuse}   k_s (N·H)^n = {specular}")?;
    write_shadow(f, light.shadow.as_ref(), "reaches the light", pad)
}

/// Writes the result of a shadow ray; `end` describes one that is unoccluded.
fn write_shadow(f: &mut Formatter<'_>, shadow: Option<&ShadowReport>, end: &str, pad: &str) -> fmt::Result {
    let Some(shadow) = shadow else {
        return writeln!(f, "{pad}    no shadow ray: its contribution would be 0");
    };
    for blocker in &shadow.blockers {
        let (name, passed) = (&blocker.shape, &blocker.passed);
        match passed.iter().all(|lane| *lane == 0.0) {
            true => writeln!(f, "{pad}    shadow ray: blocked by {name}")?,
            false => writeln!(f, "{pad}    shadow ray: through {name}, transmittance {}", lanes(passed))?,
        }
    }
    if shadow.is_blocked() { Ok(()) } else { writeln!(f, "{pad}    shadow ray: {end}") }
}

fn vector(v: &[f64]) -> String {
    format!("({})", v.iter().map(|x| short(*x)).collect::<Vec<_>>().join(", "))
}

fn vector32(v: &[f32]) -> String {
    format!("({})", v.iter().map(|x| short(f64::from(*x))).collect::<Vec<_>>().join(", "))
}

/// Light with all digits, so that these numbers can be added up; in spectral mode followed by its colour.
fn amount(amount: &Amount) -> String {
    match amount.lanes == amount.rgb || amount.lanes.iter().all(|lane| *lane == 0.0) {
        true => lanes(&amount.lanes),
        false => {
            let rgb = amount.rgb.map(|x| short(f64::from(x))).join(" ");
            format!("{} (rgb {rgb})", lanes(&amount.lanes))
        }
    }
}

/// A colour with few digits.
fn digits(rgb: &[f32]) -> String {
    format!("[{}]", rgb.iter().map(|x| short(f64::from(*x))).collect::<Vec<_>>().join(" "))
}

/// A factor or a colour with all digits.
fn lanes(lanes: &[f32]) -> String {
    format!("[{}]", lanes.iter().map(|x| full(*x)).collect::<Vec<_>>().join(" "))
}

/// Enough digits to read the same number back.
fn full(x: f32) -> String {
    if x != 0.0 && x.abs() < 1e-5 { format!("{x:e}") } else { format!("{x}") }
}

/// Seven digits, without trailing zeros.
fn short(x: f64) -> String {
    // print −0 as 0
    let x = if x == 0.0 { 0.0 } else { x };
    if x != 0.0 && !(1e-4..1e7).contains(&x.abs()) {
        return format!("{x:.4e}");
    }
    let digits = 6usize.saturating_sub(x.abs().log10().max(0.0) as usize);
    let fixed = format!("{x:.digits$}");
    if fixed.contains('.') { fixed.trim_end_matches('0').trim_end_matches('.').to_owned() } else { fixed }
}
