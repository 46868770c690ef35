// The types of inspections, made from docs/guide/inspect.schema.json by tests/types.rs; not to be edited.
//
// Numbers that are not finite are the strings "NaN", "Infinity" and "-Infinity": the types leave this out.

/** Absorption by a medium (Beer's law): `T = exp(−σ · scale · length)`. */
export interface Absorption {
    /** Length of the way; infinite where nothing is hit. */
    length: number;
    /** The material of the body whose medium it is; null in a medium that fills space. */
    material: string | null;
    /** A factor of it. */
    scale: number;
    /** σ: the absorption coefficient, per unit of length. */
    sigma: Factor;
    /** The throughput after it. */
    throughput: Factor;
    /** T: the part of the light that is left. */
    transmittance: Factor;
}

/** One addition to the sample. */
export interface Addition {
    /** The ray whose hit made it. */
    address: number;
    /** The reason: `sky`, `emission`, `medium` (its emission), `ambient`, `view`, `open sky`, or the light's name (`found` or `sampled` along a path). */
    term: string;
    /** The light that was added. */
    value: Amount;
}

/** An amount of light. */
export interface Amount {
    /** Per lane: the numbers that the renderer adds. */
    lanes: number[];
    /** Its colour as the camera's sensor measures it, linear Rec. 709; `max_component` limits only the whole sample. */
    rgb: Vector;
}

/** A surface that a shadow ray hit. */
export interface Blocker {
    /** Transmittance of the surface and of the medium before it. */
    passed: Factor;
    /** The point, in the world. */
    point: Vector;
    /** The shape's name. */
    shape: string;
    /** Its distance, in units of the ray from where it came last: from the surface, or from the blocker before. */
    t: number;
}

/** The continuation of a path: β becomes `β f cos / pdf`, divided by the survival probability of Russian roulette. */
export interface Bounce {
    /** Absolute cosine of the direction and the shading normal. */
    cos: number;
    /** Relative index of refraction, beyond the surface over before it, where light was refracted; else 1. */
    eta: number;
    /** The product of η² over all refractions so far, this one included: roulette multiplies the throughput by it. */
    eta_scale: number;
    /** The BSDF (for specular lobes the factor of the same delta function as in `pdf`). */
    f: Factor;
    /** The same in letters: `R`, `T` (specular), `D` diffuse, `G` glossy, `DT`, `GT` through the surface. */
    letters: "R" | "T" | "D" | "DT" | "G" | "GT";
    /** The sampled lobe, in words. */
    lobe: string;
    /** The factors of `f`, as those of a light sample. */
    microfacets: Microfacet[];
    /** β of the next ray: `throughput_after / survival`; null where there is none. */
    next_throughput: Factor | null;
    /** The density of the direction; for specular lobes a probability. */
    pdf: number;
    /** Whether `f` and `pdf` are estimates of which only the ratio is meaningful. */
    pdf_is_proportional: boolean;
    /** The survival probability of Russian roulette. */
    survival: number;
    /** Whether the path goes on. */
    survives: boolean;
    /** `β f cos / pdf`. */
    throughput_after: Factor;
    /** β before. */
    throughput_before: Factor;
    /** The direction, unit length. */
    wi: Vector;
}

/** One branch of the tree. */
export interface Branch {
    /** Address of the child. */
    address: number;
    /** The absolute cosine of the direction and the shading normal. */
    cos: number;
    /** The reason why it was not followed, if it was not. */
    cut: "share below min_contribution" | "the maximum depth is reached" | null;
    /** Its direction by the shading normal, unit length, whether it was followed or not. (The ray itself is reflected at the tangent plane where this points to the wrong side.) */
    direction: Vector;
    /** The index of refraction there over here, of Snell's law: `sin θ = η sin θ'`. */
    eta: number | null;
    /** Fresnel reflectance. */
    fresnel: number | null;
    /** `reflected` or `refracted`. */
    kind: "reflected" | "refracted";
    /** Whether there is total internal reflection. */
    total_reflection: boolean;
    /** The child's weight relative to its parent. */
    weight: Factor;
}

/** `P_world = T4 · R3 · S2 · T1 · P_k`, each factor and each product. A camera that moves has one more factor, `M`; its position and axes are those when the shutter opened. Matrices are rows of columns. */
export interface CameraSteps {
    /** `a`: the origin of the ray. */
    a: Vector;
    /** `b`: its intersection with the image plane; `P_world`, unless a lens moved `a` away. */
    b: Vector;
    /** `b − a`: its direction, not of unit length; `t = 1` is the image plane. Of a lens system of unit length. */
    direction: Vector;
    /** Whether a lens moved `a` away from `lookfrom`. */
    lens: boolean;
    /** The way of the ray through a lens system, if the camera has one. */
    lens_system: LensSystem | null;
    /** The camera's position. */
    lookfrom: Vector;
    /** For cameras that see all around, the way from the pixel to a direction in place of T1 and S2. */
    mapping: SphereMapping | null;
    /** The point of the image, `(x_k, y_k, 0, 1)`, `y_k` up. */
    p_k: Quadruple;
    /** `P_world`: the point of the image plane in the world. */
    p_world: Vector;
    /** How the camera projects: `perspective`, `orthographic`, all around, `lens system`, or `irradiance`. */
    projection: "perspective" | "orthographic" | "equirectangular" | "equirectangular, as pbrt's" | "octahedral" | "lens system" | "irradiance";
    /** Each matrix by name, its product with those before, and the point after it. */
    steps: MatrixStep[];
    /** To the viewer's left. */
    u: Vector;
    /** Up. */
    v: Vector;
    /** Forward. */
    w: Vector;
    /** `M_vw = T4 · R3`: from view space to the world. */
    world_from_view: Matrix;
}

/** A primitive that a ray was tested against. */
export interface Candidate {
    /** Whether it is the ray's closest hit. */
    is_nearest: boolean;
    /** The primitive and its shape. */
    name: string;
    /** The numbers of the test. */
    test: Test;
    /** The result of the test, with the reason for a miss. */
    verdict: string;
}

/** Whitted's coefficients at a point. */
export interface Coefficients {
    /** `k_a`. */
    ambient: Factor;
    /** `k_d`. */
    diffuse: Factor;
    /** Inside over outside. */
    ior: number;
    /** `k_r`. */
    mirror: Factor;
    /** `n`. */
    shininess: number;
    /** `k_s`. */
    specular: Factor;
    /** `k_t`. */
    transmission: Factor;
}

/** A collision of a ray with a medium that varies. */
export interface Collision {
    /** σ_a: the absorption coefficient there. */
    absorption: Factor;
    /** β σ_a L_e / m: the light that the medium adds. */
    emitted: Factor;
    /** Whether it is real: the ray is scattered. */
    is_real: boolean;
    /** m: the majorant, the density of collisions. */
    majorant: number;
    /** q: the probability that it is real, `Σ σ_t β / Σ β / m`. */
    probability: number;
    /** σ_s: the scattering coefficient there. */
    scattering: Factor;
    /** Its distance. */
    t: number;
    /** The throughput after it: `β σ_s / (m q)` where it is real, else `β (m − σ_t) / (m (1 − q))`. What has become weak may be ended by Russian roulette, or four times as strong. */
    throughput: Factor;
}

/** A contribution to a sample, as an expression. */
export interface Contribution {
    /** The ray whose hit made it. */
    address: number;
    /** Number of reflections, refractions and bounces before that hit. */
    depth: number;
    /** From the camera to the light: `camera → glass (R) → window`. Letters: `R` specular reflection, `T` specular transmission, `D` diffuse, `G` glossy (with `T`, through the surface), `V` a medium, `S` Whitted's highlight. */
    expression: string;
    /** The light that it comes from: its name, `sky`, `ambient`, or the shape that emits it. */
    light: string;
    /** Number of the sample in its pixel. */
    sample: number;
    /** Its part of the value that the film received for this sample. */
    value: Vector;
    /** Its factors, and the one that makes it large. */
    why: string;
}

/** How the origin of a ray follows from the point that it leaves: `a = point + lift + step · ng`, rounded to f32, relative to the render origin, away from the surface. */
export interface Departure {
    /** The lift, where the ray leaves to the outside of a smooth surface: to the side of its normal. */
    lift: Vector | null;
    /** Along the outward normal, beyond the error bound: `±Σ |ng| (error + 2⁻⁵¹ |point|)`, the point relative to the render origin. */
    step: number;
}

/** A formula, and its operands by name: each is a number, or one number for each lane or child. */
export interface Derivation {
    /** The formula. */
    formula: string;
    /** The operands. */
    numbers: [string, number[]][];
}

/** How a picture is developed from the film. */
export interface Development {
    /** Whether the picture is denoised, which `color8` is not. */
    denoise: boolean;
    /** In stops. */
    exposure: number;
    /** The tone map, as `--tonemap` names it. */
    tonemap: string;
}

/** A point where light leaves a medium below a surface. */
export interface Exit {
    /** q: the density of the point, per area, over all axes and lanes, without the choice among several points. */
    pdf: number;
    /** The point, in the world. */
    point: Vector;
    /** Q: the probability of its choice among the points where the line meets the material. */
    probability: number;
    /** S_p: the part of the light that has entered which leaves there, per area. */
    sp: Factor;
    /** The throughput there: `β S_p / (q Q)`. */
    throughput: Factor;
}

/** A factor of light, per lane: red, green and blue, or one for each of four wavelengths. */
export type Factor = number[];

/** A flight in a homogeneous medium that scatters. The distance is sampled with the extinction of one lane, chosen by the throughput. */
export interface Flight {
    /** P: the probability of each lane, β / Σ β. */
    choice: Factor;
    /** The density `q = Σ P σ_t T` of the distance, per unit of length, where it is scattered; else the probability `Q = Σ P T` of arriving. */
    density: number;
    /** The distance that was sampled, `−ln(1 − u) / σ_t`: the ray is scattered where it is less than `limit`. */
    distance: number;
    /** σ_t: the extinction coefficient, per unit of length. */
    extinction: Factor;
    /** The index of the lane that was chosen. */
    lane: number;
    /** The distance of what the ray hits or, where it hits nothing, of the end of a medium that fills space; infinite where that has none. */
    limit: number;
    /** The point where it is scattered, in the world; null where it arrives. */
    scattered_at: Vector | null;
    /** σ_s: the scattering coefficient. */
    scattering: Factor;
    /** The throughput after it: `β σ_s T / q`, or `β T / Q`. */
    throughput: Factor;
    /** T: `exp(−σ_t · length)` up to the point or the hit. */
    transmittance: Factor;
}

/** The part of a surface that the camera's narrowest pixel would see if the camera looked at it, in place of ray differentials: changes from one pixel to the next, which each texture multiplies by a width of its own. A level of a MIP map has texels of twice the largest change of a coordinate in texels, or with elliptical averages of the shorter axis (Pharr, Jakob & Humphreys 2023, §§ 10.1.3, 10.4.3). */
export interface Footprint {
    /** ∂p/∂x, in the world. */
    dpdx: Vector;
    /** ∂p/∂y, in the world. */
    dpdy: Vector;
    /** ∂(u, v)/∂x. */
    duv_dx: Pair;
    /** ∂(u, v)/∂y. */
    duv_dy: Pair;
}

/** A light that a path hit: `β L w` is added. */
export interface Found {
    /** The contribution to the sample. */
    added: Amount;
    /** How L comes about, of an area light. */
    emission: Derivation | null;
    /** Index of the light. */
    index: number;
    /** Its name. */
    light: string;
    /** q: the density of the direction in light sampling, the choice of the light included; 0 if light sampling cannot find it. (p is the ray's `pdf`.) */
    light_pdf: number;
    /** L: the radiance toward the ray's origin. */
    radiance: Amount;
    /** How `light_pdf` comes about: the probability of the light at the surface before, and the density of the direction, whose product it is; null where the direction was the only one possible, or light sampling cannot find the light. */
    sampling: FoundSampling | null;
    /** w: the MIS weight, `p² / (p² + q²)` where both techniques can find the light. */
    weight: number;
}

/** How light sampling finds the light that a path hit. */
export interface FoundSampling {
    /** How it comes about: its formula, and those of its operands. */
    choice: Derivation[];
    /** The density of the direction for this light. */
    density: number;
    /** How it and, of environments, the radiance come about, as far as there is a formula. */
    derivations: Derivation[];
    /** The probability of choosing the light at the surface before. */
    probability: number;
}

/** A file that was read. */
export interface InputFile {
    /** Its size. */
    bytes: number;
    path: string;
    /** Its SHA-256. */
    sha256: string;
}

/** A surface of a lens system, and the ray there. */
export interface LensSurface {
    /** Radius of the part that light passes. */
    aperture_radius: number;
    /** Radius of curvature, positive where the centre lies toward the film; null for planes and the aperture stop. */
    curvature_radius: number | null;
    /** The direction behind it, of unit length; null where there is none. */
    direction: Vector | null;
    /** Index of refraction on the scene's side over that on the film's side; null for the aperture stop. */
    index_ratio: number | null;
    /** Whether the ray passes. */
    passes: boolean;
    /** The point where the ray meets it; null if it does not. */
    point: Vector | null;
    /** z of its vertex. */
    vertex: number;
}

/** The way of a ray from the film through a lens system. Points and directions are in lens space: x to the viewer's right, y up, z along the axis to the scene, the film in z = 0, in units of the world. */
export interface LensSystem {
    /** The direction from there to the rear surface, of unit length. */
    direction: Vector;
    /** The working f-number: that of a thin lens which would light the middle of the film as much. */
    f_number: number;
    /** The point of the film. */
    film: Vector;
    /** Effective focal length. */
    focal_length: number;
    /** Distance of the plane of focus from the film. */
    focus_distance: number;
    /** The lens file. */
    name: string;
    /** Whether the ray passes all of them. */
    passes: boolean;
    /** Each surface, from the film to the front. */
    surfaces: LensSurface[];
    /** The factor of its light: cos⁴ of its angle to the axis at the film, times the area of the pupil's bounds, over the square of the rear surface's distance, times the exposure; 0 if it is blocked. */
    weight: number;
}

/** The way from a point of a triangle to the smooth surface that its vertex normals describe (Hanika 2021): `lift = Σ w_k max(0, −(p − P_k)·n_k) n_k`, with `p = Σ w_k P_k`. */
export interface Lift {
    /** P_k: the corners, relative to the render origin, or in the space of the object where there is one. */
    corners: ThreeVectors;
    /** In an instance the rows of the matrix that leads from the object to the world; the lift is multiplied by it. */
    from_object: ThreeVectors | null;
    /** The lift, in the world. */
    lift: Vector;
    /** n_k: their normals, unit length, in the same space. */
    normals: ThreeVectors;
    /** w_k: the weights of the corners at the point. */
    weights: Vector;
}

/** One light in Whitted's model. */
export interface Light {
    /** The contribution to the sample. */
    added: Amount;
    /** L: incident radiance (for a point light: intensity after fall-off). */
    arrives: Amount;
    /** How `arrives` and `pdf` come about, as far as there is a formula. */
    derivations: Derivation[];
    /** `k_d (N·L)`. */
    diffuse: Factor;
    /** H: halfway between the directions to the light and to the viewer, unit length. */
    h: Vector | null;
    /** Index of the light. */
    index: number;
    /** `I_j` of Whitted's formula: the unoccluded light. */
    intensity: Amount;
    /** Its name. */
    light: string;
    /** `N·H`. */
    n_dot_h: number | null;
    /** `N·L`; null when the light does not illuminate this point. */
    n_dot_l: number | null;
    /** The density, per steradian, of the direction; 1 where there is only one. `I_j = L / (π pdf)`. */
    pdf: number | null;
    /** The point on the light, in the world; null for a light infinitely far away. */
    point: Vector | null;
    /** The shadow ray; null where its contribution would be 0. */
    shadow: Shadow | null;
    /** `k_s (N·H)ⁿ`. */
    specular: Factor;
    /** Toward it, unit length; null when the light does not illuminate this point. */
    wi: Vector | null;
}

/** A light, by its index in reports. */
export interface LightPlace {
    /** The area of an area light, of one side. */
    area: number | null;
    /** The bounds of an area light: minimum and maximum in the world. */
    bounds: [Vector, Vector] | null;
    /** `point`, `spot`, `distant`, `projection`, `goniometric`, `area` or `environment`. */
    kind: "point" | "spot" | "distant" | "projection" | "goniometric" | "area" | "environment";
    /** Its name; of an area light, the name of its shape. */
    name: string;
    /** Its position in the world, if it has one; of an area light, the centre of its bounds. */
    position: Vector | null;
    /** Toward it, unit length, if it is infinitely far away in one direction. */
    toward: Vector | null;
}

/** The light that was sampled at a surface (next-event estimation): `β f cos L w / p` is added, if it is unoccluded. */
export interface LightSample {
    /** The contribution to the sample. */
    added: Amount;
    /** How it comes about: its formula, and those of its operands. */
    choice: Derivation[];
    /** Index of the light. */
    index: number;
    /** Its name. */
    light: string;
    /** The probability of choosing it among all lights. */
    probability: number;
    /** The sampled direction; null when the light does not illuminate this point. */
    sample: SampledDirection | null;
    /** The shadow ray; null where its contribution would be 0. */
    shadow: Shadow | null;
}

/** Rows of columns. */
export type Matrix = [Quadruple, Quadruple, Quadruple, Quadruple];

/** One factor of the camera's product. */
export interface MatrixStep {
    /** A description. */
    does: string;
    /** The factor. */
    matrix: Matrix;
    /** `T1`, `S2`, `R3` or `T4`; `M`, the way of a camera that moves since the shutter opened. */
    name: "T1" | "S2" | "R3" | "T4" | "M";
    /** The point so far. */
    point: Quadruple;
    /** The product of the factors so far. */
    product: Matrix;
}

/** The hit of a ray. */
export interface Met {
    /** Alpha here, where the surface is not opaque everywhere: the ray passes with the probability of the rest. */
    alpha: number | null;
    /** Its coefficients here, where the integrator evaluates them. */
    coefficients: Coefficients | null;
    /** The cosine of the angle between the shading normal and the direction to the viewer. */
    cos_viewer: number;
    /** Error bound of the point, per component, by which the next ray's origin is moved off the surface. */
    error: Vector;
    /** The footprint of a pixel on the surface, where textures of its material are averaged over it. */
    footprint: Footprint | null;
    /** Whether the outside was hit. */
    front: boolean;
    /** The instance, if it is in one. */
    instance: number | null;
    /** The way to the smooth surface that the triangle stands for, where rays start that leave to its outside. */
    lift: Lift | null;
    /** The material's name. */
    material: string;
    /** Shading normal on the side of the viewer. */
    n: Vector;
    /** Outward geometric normal. */
    ng: Vector;
    /** The point. */
    point: Vector;
    /** Index of the primitive. */
    primitive: number;
    /** The shape's name. */
    shape: string;
    /** The kernel's `t`, in units of the direction. */
    t: number;
    /** Texture coordinates. */
    uv: Pair;
    /** Toward the viewer, unit length. */
    wo: Vector;
}

/** A boundary with microfacets that scatters light between two directions. Its part of the BSDF is, for reflection, `weight · part · D G / (4 |cos_o cos_i|)`, for refraction `weight · part · D G |cos_om cos_im| / (|cos_o cos_i| (cos_im + cos_om / η)² η²)`, and where it is smooth `weight · part / (|cos_i| η²)`, the factor of a delta function; multiple scattering multiplies it by its gain. */
export interface Microfacet {
    /** α along u and v. */
    alpha: Pair;
    /** `conductor`, `dielectric`, `thin dielectric` or `coat`; of glTF's layers `specular`, `glass` or `clear coat`. */
    boundary: "conductor" | "dielectric" | "thin dielectric" | "coat" | "specular" | "glass" | "clear coat";
    /** The absolute cosine of the direction to the light, and the normal. */
    cos_i: number;
    /** The cosine of the direction to the light, and ω_m. */
    cos_im: number;
    /** The absolute cosine of the direction to the viewer, and the boundary's normal. */
    cos_o: number;
    /** The cosine of the direction to the viewer, and ω_m. */
    cos_om: number;
    /** D(ω_m): the density of facets with that normal; null where the boundary is smooth. */
    d: number | null;
    /** η: the index of refraction on the side of the light over that on the side of the viewer where light is refracted; else 1. */
    eta: number;
    /** F: the Fresnel reflectance of the facets. */
    fresnel: Factor;
    /** G: Smith's masking and shadowing; null where it is smooth. */
    g: number | null;
    /** ω_m: the normal of the facets, unit length; of a reflection the half vector. */
    half_vector: Vector;
    /** What light between the facets of a conductor adds; null where it is lost or there is none. */
    multiple_scattering: MultipleScattering | null;
    /** The share of light that the facets send this way: F where they reflect it, else 1 − F; tinted by the layers above and the body, if it passes them. */
    part: Factor;
    /** Whether the facets refract light; otherwise they reflect it (a thin sheet also to its other side). */
    refracts: boolean;
    /** The boundary's part of the BSDF: the product. */
    value: Factor;
    /** The weight of the boundary, below the layers above it. */
    weight: number;
}

/** Light that one facet of a conductor sends to another, over that of single scattering: `gain = 1 + F̄ Ē / (1 − F̄ (1 − Ē)) · (1 − E) / E`. */
export interface MultipleScattering {
    /** E(ω_o): the albedo of single scattering by facets that reflect all light. */
    albedo: number;
    /** All light over that of single scattering. */
    gain: Factor;
    /** Ē: its mean over all directions. */
    mean_albedo: number;
    /** F̄: the mean Fresnel reflectance. */
    mean_fresnel: Factor;
}

/** A null collision of a shadow ray with a medium that varies. */
export interface NullCollision {
    /** σ_t: the extinction coefficient there. */
    extinction: Factor;
    /** m: the majorant, the density of collisions. */
    majorant: number;
    /** Its distance. */
    t: number;
    /** The estimate of the transmittance after it, by `(m − σ_t) / m`, and by Russian roulette where it is weak. */
    transmittance: Factor;
}

export type Pair = [number, number];

/** Scattering by the phase function of a medium, which is its own density: β stays. */
export interface Phase {
    /** The cosine of the angle between the directions before and after it. */
    cos: number;
    /** The lobes whose mix it is. */
    lobes: PhaseLobe[];
    /** β of the next ray: β / survival; null where there is none. */
    next_throughput: Factor | null;
    /** The phase function in that direction, per steradian: its value and its density. */
    pdf: number;
    /** The survival probability of Russian roulette. */
    survival: number;
    /** Whether the path goes on. */
    survives: boolean;
    /** The sampled direction, unit length. */
    wi: Vector;
}

/** A lobe of a phase function. */
export interface PhaseLobe {
    /** α: 0 in that of Henyey and Greenstein. */
    alpha: number;
    /** g: its mean cosine; of Draine's lobe a parameter beside it. */
    g: number;
    /** Whether the direction was sampled by it. */
    is_sampled: boolean;
    /** Whose it is. */
    name: "Henyey-Greenstein" | "Draine";
    /** Its value in the sampled direction, per steradian. */
    value: number;
    /** Its share. */
    weight: number;
}

/** The samples of a pixel, and what the picture makes of them. */
export interface Pixel {
    /** Every sample: the brightest first, and before it those that are not finite. */
    all: SampleSummary[];
    /** The mean as in an 8-bit picture, without denoising and treatment of fireflies: exposure, tone map, sRGB. */
    color8: [number, number, number];
    /** The largest contributions of all samples, largest first. */
    contributions: Contribution[];
    /** Number of samples that are not finite, which the film leaves out. */
    dropped: number;
    /** Number of the first of them. */
    first_sample: number;
    /** The mean of the others, bit for bit that of a film with these samples: linear Rec. 709. */
    mean: Vector;
    /** Column and row from the top left. */
    pixel: [number, number];
    /** The number of samples. */
    samples: number;
    /** The standard error of the mean of independent samples (that of stratified ones is less): √(variance / samples). */
    standard_error: Vector | null;
    /** The unbiased estimate of the variance of one sample, per channel; null for fewer than two. */
    variance: Vector | null;
}

/** Subsurface scattering: the path has entered a medium in which light diffuses, and leaves it where a random line meets the same material. The next ray of the report is that line. */
export interface Probe {
    /** P: the probability of each lane, by its part of the light that leaves. */
    choice: Factor;
    /** Number of its intersections with the material. */
    count: number;
    /** One of these points, chosen by the light that leaves there; null where the path ends. */
    exit: Exit | null;
    /** The line; null where it would be outside of the sphere in which points are looked for. */
    segment: ProbeSegment | null;
    /** β of the path that has entered. */
    throughput_before: Factor;
}

/** A line that is searched for the point where light leaves. */
export interface ProbeSegment {
    /** The axis of the shading frame along which it is. */
    axis: "first tangent" | "second tangent" | "normal";
    /** Its direction, unit length. */
    direction: Vector;
    /** Its start, in the world. */
    from: Vector;
    /** The index of the lane whose profile sampled its distance. */
    lane: number;
    /** Its length. */
    length: number;
    /** Its distance from the point where the path has entered. */
    radius: number;
}

/** Density along a ray: at the middles of as many equal parts of its way as there are numbers. */
export interface Profile {
    /** The distance up to which. */
    end: number;
    /** σ_t, in the mean of the lanes. */
    extinction: number[];
    /** The majorants of the cells there. */
    majorant: number[];
    /** The distance from which on there is something of the medium. */
    start: number;
}

export type Quadruple = [number, number, number, number];

/** One ray. */
export interface Ray {
    /** Its origin. */
    a: Vector;
    /** What a medium absorbs on the way to the hit. */
    absorption: Absorption | null;
    /** The contribution of this ray's own hit to the sample. */
    added: Amount;
    /** 1 is the camera ray; in Whitted's tree the reflected child of n is 2n, the refracted one 2n + 1; along a path n is followed by n + 1. */
    address: number;
    /** The continuation of the path, even if Russian roulette ends it. */
    bounce: Bounce | null;
    /** The branches of the tree here, followed or not. */
    branches: Branch[];
    /** Every primitive that was tested, in the order of the tests. */
    candidates: Candidate[];
    /** How its origin follows from the point that it leaves; null for camera rays. */
    departure: Departure | null;
    /** Number of reflections, refractions and bounces before. */
    depth: number;
    /** Its direction, not necessarily of unit length. */
    direction: Vector;
    /** The reason why the path ends here, if it does. */
    ends: string | null;
    /** The product of η² over the refractions before, by which Russian roulette multiplies the throughput. */
    eta_scale: number;
    /** Free flight in a homogeneous medium that scatters: to the hit, or to a point before it. */
    flight: Flight | null;
    /** Lights that it hit, along a path. */
    found: Found[];
    /** `camera`; in a tree `reflected` or `refracted`; along a path `reflected`, `transmitted`, `scattered` (a random walk) or `straight on` (past a surface that it passes by alpha or as an interface). */
    kind: "camera" | "reflected" | "refracted" | "transmitted" | "scattered" | "straight on";
    /** The light that was sampled at the hit, along a path. */
    light_sample: LightSample | null;
    /** Each light, in Whitted's model. */
    lights: Light[];
    /** The light that the medium emits on the way, as far as the hit; it is added. */
    medium_emission: Amount | null;
    /** Its hit; null for a miss, and where a medium scatters it before. */
    met: Met | null;
    /** In RGB mode: the one colour that goes on, with the weight of all three, after dispersion at the hit. */
    only_color: "red" | "green" | "blue" | null;
    /** The shadow ray of ambient occlusion. */
    openness: Shadow | null;
    /** The same as it is traced: relative to the render origin (`render_origin`). */
    origin: Vector;
    /** Address of the ray that it comes from. */
    parent: number | null;
    /** The solid angle density of its direction, for MIS weights; null for camera rays, after specular bounces and in Whitted's tree. */
    pdf: number | null;
    /** The continuation of the path where a medium scatters it, even if Russian roulette ends it. */
    phase: Phase | null;
    /** The search for the point where the path leaves, where it has entered a medium below the surface. */
    probe: Probe | null;
    /** The BSDF at the hit, along a path. */
    scattering: Scattering | null;
    /** The contribution of this ray and of all rays that come from it. */
    subtree: Amount;
    /** β: the throughput, the factor of light along it in the sample. */
    throughput: Factor;
    /** The throughput at the hit, after absorption on the way and dispersion there, along a path. */
    throughput_there: Factor | null;
    /** Collisions in a medium that varies: to the hit, or to a point before it. */
    tracking: Tracking | null;
    /** The cost of finding its hit. */
    traversal: Traversal;
}

/** All steps in the computation of one sample. */
export interface Sample {
    /** Every addition to the sample, in the order in which they were made. */
    additions: Addition[];
    /** Whether the sum of the additions equals, bit for bit, the value that the film received. */
    adds_up: boolean;
    /** Alpha, before the filter's weight. */
    alpha: number;
    /** The steps from the pixel to the world. */
    camera: CameraSteps;
    /** The colour of this sample alone as in an 8-bit picture: exposure, tone map, sRGB. */
    color8: [number, number, number];
    /** The largest contributions, largest first. */
    contributions: Contribution[];
    /** How a picture is developed from the film. */
    development: Development;
    /** The value that the film received: `radiance · weight`, as the camera's sensor measures it. */
    film: Vector;
    /** The integrator, as `--integrator` names it. */
    integrator: "path" | "simple_path" | "random_walk" | "whitted" | "raycast" | "ambient_occlusion" | "normals" | "depth" | "uv" | "id";
    /** Column and row from the top left. */
    pixel: [number, number];
    /** The sum over all rays, added in the order of `additions`. */
    radiance: Amount;
    /** All rays, parents before children, by address. */
    rays: Ray[];
    /** The origin of render space in the world, where the camera's eye was when the scene was compiled: rays are traced in f32 relative to it. */
    render_origin: Vector;
    /** Number of the sample in its pixel. */
    sample: number;
    /** The rays and shadow rays as lines of a drawing, each ray before its shadow rays. */
    segments: Segment[];
    /** What the sensor does to it. */
    sensor: Sensor;
    /** The time while the shutter is open, from 0 to 1, of what moves; null where nothing does. */
    time: number | null;
    /** The wavelengths of the four lanes; null where light is red, green and blue. */
    wavelengths: Wavelengths | null;
    /** The filter's weight, times that of a ray through a lens system. */
    weight: number;
}

/** One sample of a pixel in short. */
export interface SampleSummary {
    /** Number of reflections, refractions and bounces before the hit that made the largest contribution; of a sample without light, of its longest way. */
    depth: number;
    /** The largest contribution as an expression (`contributions`). */
    expression: string;
    /** The value that the film received. */
    film: Vector;
    /** The light of the largest contribution; null for a sample without light. */
    light: string | null;
    /** Its luminance. */
    luminance: number;
    /** Number of the sample in its pixel. */
    sample: number;
}

/** A direction to a light that was sampled. */
export interface SampledDirection {
    /** L: the unoccluded incident radiance. */
    arrives: Amount;
    /** q: the density of the direction in BSDF sampling; null for a delta light, and where light is not weighted by MIS. */
    bsdf_pdf: number | null;
    /** How `arrives` and `light_pdf` come about, as far as there is a formula. */
    derivations: Derivation[];
    /** The BSDF times the cosine; black where it does not scatter this light. */
    f_cos: Factor;
    /** Whether the light has only one direction here (a point, a distant light): then p is a probability, not a density. */
    is_delta: boolean;
    /** The density of the direction for this light; 1 where there is only one. */
    light_pdf: number;
    /** The factors D, G and F of the boundaries of the BSDF that have microfacets. Diffuse lobes, sheen, and walks between layers are the rest of the BSDF. */
    microfacets: Microfacet[];
    /** p: the density with the choice of the light, `probability · light_pdf`. */
    pdf: number;
    /** The point on the light, in the world; null for a light infinitely far away. */
    point: Vector | null;
    /** w: the MIS weight, `p² / (p² + q²)` where both techniques can find the light. */
    weight: number;
    /** Toward the light, unit length. */
    wi: Vector;
}

/** A BSDF at a point. */
export interface Scattering {
    /** A description. */
    does: string;
    /** The kind of BSDF. */
    kind: string;
    /** Its lobes that light sampling can use, in letters: `D` diffuse, `G` glossy, `DG` both. */
    letters: "" | "D" | "G" | "DG";
    /** Its lobes, in words. */
    lobes: string;
    /** The outward shading normal, with normal and bump maps. */
    n: Vector;
    /** Its parameters by name: one number, one per axis, or one per lane. */
    numbers: [string, number[]][];
    /** The tangents along which the roughness has its two values, unit length; of a BSDF that is the same in all directions around n, any two. */
    tangents: [Vector, Vector];
}

/** A line segment of a drawing: a ray, or a part of a shadow ray. */
export interface Segment {
    /** Address of the ray; for a shadow ray, of the ray whose hit cast it. */
    address: number;
    /** Its start. */
    from: Vector;
    /** Whether it has no end. */
    is_endless: boolean;
    /** The kind of the ray; of a shadow ray `shadow` up to its light or to what blocks it, and `blocked` behind that. */
    kind: "camera" | "reflected" | "refracted" | "transmitted" | "scattered" | "straight on" | "shadow" | "blocked";
    /** The name at its end: of the shape, or of the light of a shadow ray. */
    name: string | null;
    /** Its description with its contribution. */
    title: string;
    /** Its end; without one, a point so far away that the ray is seen. */
    to: Vector;
    /** The width of its line in pixels, which grows with the throughput. */
    width: number;
}

/** What the camera's sensor does to the light of a sample. */
export interface Sensor {
    /** The camera whose responses are used; null for the standard observer. */
    camera: string | null;
    /** Multiplies all light. */
    imaging_ratio: number;
    /** The matrix, by rows, that a colour of RGB mode is multiplied by: the responses, the imaging ratio and the white balance together; null where it changes nothing, and in spectral mode. */
    matrix: [Vector, Vector, Vector] | null;
    /** The maximum of a sample's channels; infinite for no limit. */
    max_component: number;
    /** The factor by which this sample was scaled down to it; 1 for no change. */
    scaled_by: number;
    /** The colour temperature, in kelvin, of light that appears white. */
    white_balance: number | null;
}

/** A shadow ray. */
export interface Shadow {
    /** The surfaces that it hit, in order. */
    blockers: Blocker[];
    /** The collisions with media that vary, by which their transmittance is estimated: of all its parts, each from 1 on. */
    collisions: NullCollision[];
    /** How it follows from the point that is lit. */
    departure: Departure | null;
    /** Its origin. */
    from: Vector;
    /** Whether it has no end. */
    is_endless: boolean;
    /** Transmittance of the medium on the rest of the way to the light; null if it is blocked before. */
    rest: Factor | null;
    /** Its target (if it has no end: one length of its direction away). */
    to: Vector;
    /** The cost of finding them, of all its parts. */
    traversal: Traversal;
}

/** The way from a pixel to a direction, for cameras that see all around. */
export interface SphereMapping {
    /** The direction in view space: along u, v, w. */
    direction_in_view: Vector;
    /** A description. */
    does: string;
    /** The formula of the direction in view space. */
    formula: string;
    /** Its numbers by name. */
    numbers: [string, number][];
    /** `P_k` over the size of the picture, v up. */
    uv: Pair;
}

/** The test of a primitive, by its kind. */
export interface Test {
    Curve?: TestNumbers;
    Disk?: TestNumbers;
    Patch?: TestNumbers;
    Quadric?: TestNumbers;
    Sphere?: TestNumbers;
    Triangle?: TestNumbers;
}

/** The inputs of a test and the numbers that are computed from them. Lengths and points are relative to the render origin (`render_origin`), or in the space of an object where an input `a in the object` says so. */
export interface TestNumbers {
    /** The inputs by name, exactly: each is a vector or a number. `a` and `d` are the ray's, `a + t d`. */
    inputs: [string, number[]][];
    /** The numbers, each with its name in the lecture notes. */
    numbers: [string, Twice][];
}

export type ThreeVectors = [Vector, Vector, Vector];

/** The way of a ray through a medium that varies, by collisions whose density is a majorant of the extinction. */
export interface Tracking {
    /** Its collisions, in order: all are null, but for the last where the medium scatters it. */
    collisions: Collision[];
    /** The distance of what the ray hits or, where it hits nothing, of the end of a medium that fills space; infinite where that has none. */
    limit: number;
    /** The medium along the whole way, whether the ray goes on to there or not; null where it does not meet it. */
    profile: Profile | null;
    /** The point where it is scattered, in the world; null where it arrives. */
    scattered_at: Vector | null;
    /** The throughput at the end. */
    throughput: Factor;
}

/** The cost of a ray, traced alone. (In packets, rays share nodes.) */
export interface Traversal {
    /** Boxes of their children that were culled: the ray misses them, or has a hit before them. The others were entered. */
    culled: number;
    /** Nodes of the BVH that it visited, in instances, too. */
    nodes: number;
    /** Primitives that it was tested against. */
    tests: number;
}

/** One quantity, computed twice. */
export interface Twice {
    /** Number of leading bits that agree, of the 24 that f32 has. */
    bits: number;
    /** In f32. */
    f32: number;
    /** In f64. */
    f64: number;
}

/** A point, a direction, or linear red, green and blue (Rec. 709). */
export type Vector = [number, number, number];

/** The four wavelengths of a sample. */
export interface Wavelengths {
    /** Whether dispersion terminated all but the first. */
    dispersed: boolean;
    /** Wavelengths in nm. */
    lambda: Quadruple;
    /** Their densities, per nm; 0 for those that were terminated. */
    pdf: Quadruple;
}
