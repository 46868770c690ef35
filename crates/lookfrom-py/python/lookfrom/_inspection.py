"""What an inspection tells: one class for each object of docs/guide/inspect.schema.json.

Made from it by tools/inspection.py.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Sample:
    """All steps in the computation of one sample.

    pixel: Column and row from the top left.
    sample: Number of the sample in its pixel.
    integrator: The integrator, as `--integrator` names it.
    color8: The colour of this sample alone as in an 8-bit picture: exposure, tone map, sRGB.
    contributions: The largest contributions, largest first.
    time: The time while the shutter is open, from 0 to 1, of what moves; null where nothing does.
    wavelengths: The wavelengths of the four lanes; null where light is red, green and blue.
    camera: The steps from the pixel to the world.
    render_origin: The origin of render space in the world, where the camera's eye was when the scene was
        compiled: rays are traced in f32 relative to it.
    rays: All rays, parents before children, by address.
    segments: The rays and shadow rays as lines of a drawing, each ray before its shadow rays.
    radiance: The sum over all rays, added in the order of `additions`.
    additions: Every addition to the sample, in the order in which they were made.
    weight: The filter's weight, times that of a ray through a lens system.
    sensor: What the sensor does to it.
    development: How a picture is developed from the film.
    alpha: Alpha, before the filter's weight.
    film: The value that the film received: `radiance · weight`, as the camera's sensor measures it.
    adds_up: Whether the sum of the additions equals, bit for bit, the value that the film received.
    """

    pixel: tuple[int, int]
    sample: int
    integrator: str
    color8: tuple[int, int, int]
    contributions: list[Contribution]
    time: float | None
    wavelengths: Wavelengths | None
    camera: CameraSteps
    render_origin: tuple[float, float, float]
    rays: list[Ray]
    segments: list[Segment]
    radiance: Amount
    additions: list[Addition]
    weight: float
    sensor: Sensor
    development: Development
    alpha: float
    film: tuple[float, float, float]
    adds_up: bool


@dataclass(frozen=True)
class Pixel:
    """The samples of a pixel, and what the picture makes of them.

    pixel: Column and row from the top left.
    samples: The number of samples.
    first_sample: Number of the first of them.
    dropped: Number of samples that are not finite, which the film leaves out.
    mean: The mean of the others, bit for bit that of a film with these samples: linear Rec. 709.
    variance: The unbiased estimate of the variance of one sample, per channel; null for fewer than two.
    standard_error: The standard error of the mean of independent samples (that of stratified ones is less):
        √(variance / samples).
    color8: The mean as in an 8-bit picture, without denoising and treatment of fireflies: exposure, tone map,
        sRGB.
    contributions: The largest contributions of all samples, largest first.
    all: Every sample: the brightest first, and before it those that are not finite.
    """

    pixel: tuple[int, int]
    samples: int
    first_sample: int
    dropped: int
    mean: tuple[float, float, float]
    variance: tuple[float, float, float] | None
    standard_error: tuple[float, float, float] | None
    color8: tuple[int, int, int]
    contributions: list[Contribution]
    all: list[SampleSummary]


@dataclass(frozen=True)
class InputFile:
    """A file that was read.

    bytes: Its size.
    sha256: Its SHA-256.
    """

    path: str
    bytes: int
    sha256: str


@dataclass(frozen=True)
class Absorption:
    """Absorption by a medium (Beer's law): `T = exp(−σ · scale · length)`.

    material: The material of the body whose medium it is; null in a medium that fills space.
    sigma: σ: the absorption coefficient, per unit of length.
    scale: A factor of it.
    length: Length of the way; infinite where nothing is hit.
    transmittance: T: the part of the light that is left.
    throughput: The throughput after it.
    """

    material: str | None
    sigma: tuple[float, ...]
    scale: float
    length: float
    transmittance: tuple[float, ...]
    throughput: tuple[float, ...]


@dataclass(frozen=True)
class Addition:
    """One addition to the sample.

    address: The ray whose hit made it.
    term: The reason: `sky`, `emission`, `medium` (its emission), `ambient`, `view`, `open sky`, or the
        light's name (`found` or `sampled` along a path).
    value: The light that was added.
    """

    address: int
    term: str
    value: Amount


@dataclass(frozen=True)
class Amount:
    """An amount of light.

    lanes: Per lane: the numbers that the renderer adds.
    rgb: Its colour as the camera's sensor measures it, linear Rec. 709; `max_component` limits only the whole
        sample.
    """

    lanes: tuple[float, ...]
    rgb: tuple[float, float, float]


@dataclass(frozen=True)
class Blocker:
    """A surface that a shadow ray hit.

    shape: The shape's name.
    t: Its distance, in units of the ray from where it came last: from the surface, or from the blocker
        before.
    point: The point, in the world.
    passed: Transmittance of the surface and of the medium before it.
    """

    shape: str
    t: float
    point: tuple[float, float, float]
    passed: tuple[float, ...]


@dataclass(frozen=True)
class Bounce:
    """The continuation of a path: β becomes `β f cos / pdf`, divided by the survival probability of Russian
    roulette.

    lobe: The sampled lobe, in words.
    letters: The same in letters: `R`, `T` (specular), `D` diffuse, `G` glossy, `DT`, `GT` through the
        surface.
    wi: The direction, unit length.
    f: The BSDF (for specular lobes the factor of the same delta function as in `pdf`).
    microfacets: The factors of `f`, as those of a light sample.
    cos: Absolute cosine of the direction and the shading normal.
    pdf: The density of the direction; for specular lobes a probability.
    pdf_is_proportional: Whether `f` and `pdf` are estimates of which only the ratio is meaningful.
    eta: Relative index of refraction, beyond the surface over before it, where light was refracted; else 1.
    eta_scale: The product of η² over all refractions so far, this one included: roulette multiplies the
        throughput by it.
    throughput_before: β before.
    throughput_after: `β f cos / pdf`.
    survival: The survival probability of Russian roulette.
    survives: Whether the path goes on.
    next_throughput: β of the next ray: `throughput_after / survival`; null where there is none.
    """

    lobe: str
    letters: str
    wi: tuple[float, float, float]
    f: tuple[float, ...]
    microfacets: list[Microfacet]
    cos: float
    pdf: float
    pdf_is_proportional: bool
    eta: float
    eta_scale: float
    throughput_before: tuple[float, ...]
    throughput_after: tuple[float, ...]
    survival: float
    survives: bool
    next_throughput: tuple[float, ...] | None


@dataclass(frozen=True)
class Branch:
    """One branch of the tree.

    address: Address of the child.
    kind: `reflected` or `refracted`.
    direction: Its direction by the shading normal, unit length, whether it was followed or not. (The ray
        itself is reflected at the tangent plane where this points to the wrong side.)
    cos: The absolute cosine of the direction and the shading normal.
    eta: The index of refraction there over here, of Snell's law: `sin θ = η sin θ'`.
    weight: The child's weight relative to its parent.
    fresnel: Fresnel reflectance.
    total_reflection: Whether there is total internal reflection.
    cut: The reason why it was not followed, if it was not.
    """

    address: int
    kind: str
    direction: tuple[float, float, float]
    cos: float
    eta: float | None
    weight: tuple[float, ...]
    fresnel: float | None
    total_reflection: bool
    cut: str


@dataclass(frozen=True)
class CameraSteps:
    """`P_world = T4 · R3 · S2 · T1 · P_k`, each factor and each product. A camera that moves has one more
    factor, `M`; its position and axes are those when the shutter opened. Matrices are rows of columns.

    projection: How the camera projects: `perspective`, `orthographic`, all around, `lens system`, or
        `irradiance`.
    lookfrom: The camera's position.
    u: To the viewer's left.
    v: Up.
    w: Forward.
    p_k: The point of the image, `(x_k, y_k, 0, 1)`, `y_k` up.
    steps: Each matrix by name, its product with those before, and the point after it.
    world_from_view: `M_vw = T4 · R3`: from view space to the world.
    p_world: `P_world`: the point of the image plane in the world.
    a: `a`: the origin of the ray.
    b: `b`: its intersection with the image plane; `P_world`, unless a lens moved `a` away.
    direction: `b − a`: its direction, not of unit length; `t = 1` is the image plane. Of a lens system of
        unit length.
    lens: Whether a lens moved `a` away from `lookfrom`.
    mapping: For cameras that see all around, the way from the pixel to a direction in place of T1 and S2.
    lens_system: The way of the ray through a lens system, if the camera has one.
    """

    projection: str
    lookfrom: tuple[float, float, float]
    u: tuple[float, float, float]
    v: tuple[float, float, float]
    w: tuple[float, float, float]
    p_k: tuple[float, float, float, float]
    steps: list[MatrixStep]
    world_from_view: tuple[tuple[float, float, float, float], tuple[float, float, float, float], tuple[float, float, float, float], tuple[float, float, float, float]]
    p_world: tuple[float, float, float]
    a: tuple[float, float, float]
    b: tuple[float, float, float]
    direction: tuple[float, float, float]
    lens: bool
    mapping: SphereMapping | None
    lens_system: LensSystem | None


@dataclass(frozen=True)
class Candidate:
    """A primitive that a ray was tested against.

    name: The primitive and its shape.
    verdict: The result of the test, with the reason for a miss.
    is_nearest: Whether it is the ray's closest hit.
    test: The numbers of the test.
    """

    name: str
    verdict: str
    is_nearest: bool
    test: dict[str, TestNumbers]


@dataclass(frozen=True)
class Coefficients:
    """Whitted's coefficients at a point.

    ambient: `k_a`.
    diffuse: `k_d`.
    specular: `k_s`.
    shininess: `n`.
    mirror: `k_r`.
    transmission: `k_t`.
    ior: Inside over outside.
    """

    ambient: tuple[float, ...]
    diffuse: tuple[float, ...]
    specular: tuple[float, ...]
    shininess: float
    mirror: tuple[float, ...]
    transmission: tuple[float, ...]
    ior: float


@dataclass(frozen=True)
class Collision:
    """A collision of a ray with a medium that varies.

    t: Its distance.
    majorant: m: the majorant, the density of collisions.
    absorption: σ_a: the absorption coefficient there.
    scattering: σ_s: the scattering coefficient there.
    emitted: β σ_a L_e / m: the light that the medium adds.
    probability: q: the probability that it is real, `Σ σ_t β / Σ β / m`.
    is_real: Whether it is real: the ray is scattered.
    throughput: The throughput after it: `β σ_s / (m q)` where it is real, else `β (m − σ_t) / (m (1 − q))`.
        What has become weak may be ended by Russian roulette, or four times as strong.
    """

    t: float
    majorant: float
    absorption: tuple[float, ...]
    scattering: tuple[float, ...]
    emitted: tuple[float, ...]
    probability: float
    is_real: bool
    throughput: tuple[float, ...]


@dataclass(frozen=True)
class Contribution:
    """A contribution to a sample, as an expression.

    sample: Number of the sample in its pixel.
    value: Its part of the value that the film received for this sample.
    address: The ray whose hit made it.
    depth: Number of reflections, refractions and bounces before that hit.
    light: The light that it comes from: its name, `sky`, `ambient`, or the shape that emits it.
    expression: From the camera to the light: `camera → glass (R) → window`. Letters: `R` specular reflection,
        `T` specular transmission, `D` diffuse, `G` glossy (with `T`, through the surface), `V` a medium, `S`
        Whitted's highlight.
    why: Its factors, and the one that makes it large.
    """

    sample: int
    value: tuple[float, float, float]
    address: int
    depth: int
    light: str
    expression: str
    why: str


@dataclass(frozen=True)
class Development:
    """How a picture is developed from the film.

    exposure: In stops.
    tonemap: The tone map, as `--tonemap` names it.
    denoise: Whether the picture is denoised, which `color8` is not.
    """

    exposure: float
    tonemap: str
    denoise: bool


@dataclass(frozen=True)
class Departure:
    """How the origin of a ray follows from the point that it leaves: `a = point + lift + step · ng`, rounded
    to f32, relative to the render origin, away from the surface.

    lift: The lift, where the ray leaves to the outside of a smooth surface: to the side of its normal.
    step: Along the outward normal, beyond the error bound: `±Σ |ng| (error + 2⁻⁵¹ |point|)`, the point
        relative to the render origin.
    """

    lift: tuple[float, float, float] | None
    step: float


@dataclass(frozen=True)
class Derivation:
    """A formula, and its operands by name: each is a number, or one number for each lane or child.

    formula: The formula.
    numbers: The operands.
    """

    formula: str
    numbers: list[tuple[str, tuple[float, ...]]]


@dataclass(frozen=True)
class Exit:
    """A point where light leaves a medium below a surface.

    point: The point, in the world.
    sp: S_p: the part of the light that has entered which leaves there, per area.
    pdf: q: the density of the point, per area, over all axes and lanes, without the choice among several
        points.
    probability: Q: the probability of its choice among the points where the line meets the material.
    throughput: The throughput there: `β S_p / (q Q)`.
    """

    point: tuple[float, float, float]
    sp: tuple[float, ...]
    pdf: float
    probability: float
    throughput: tuple[float, ...]


@dataclass(frozen=True)
class Flight:
    """A flight in a homogeneous medium that scatters. The distance is sampled with the extinction of one
    lane, chosen by the throughput.

    extinction: σ_t: the extinction coefficient, per unit of length.
    scattering: σ_s: the scattering coefficient.
    choice: P: the probability of each lane, β / Σ β.
    lane: The index of the lane that was chosen.
    limit: The distance of what the ray hits or, where it hits nothing, of the end of a medium that fills
        space; infinite where that has none.
    distance: The distance that was sampled, `−ln(1 − u) / σ_t`: the ray is scattered where it is less than
        `limit`.
    scattered_at: The point where it is scattered, in the world; null where it arrives.
    transmittance: T: `exp(−σ_t · length)` up to the point or the hit.
    density: The density `q = Σ P σ_t T` of the distance, per unit of length, where it is scattered; else the
        probability `Q = Σ P T` of arriving.
    throughput: The throughput after it: `β σ_s T / q`, or `β T / Q`.
    """

    extinction: tuple[float, ...]
    scattering: tuple[float, ...]
    choice: tuple[float, ...]
    lane: int
    limit: float
    distance: float
    scattered_at: tuple[float, float, float] | None
    transmittance: tuple[float, ...]
    density: float
    throughput: tuple[float, ...]


@dataclass(frozen=True)
class Footprint:
    """The part of a surface that the camera's narrowest pixel would see if the camera looked at it, in place
    of ray differentials: changes from one pixel to the next, which each texture multiplies by a width of its
    own. A level of a MIP map has texels of twice the largest change of a coordinate in texels, or with
    elliptical averages of the shorter axis (Pharr, Jakob & Humphreys 2023, §§ 10.1.3, 10.4.3).

    dpdx: ∂p/∂x, in the world.
    dpdy: ∂p/∂y, in the world.
    duv_dx: ∂(u, v)/∂x.
    duv_dy: ∂(u, v)/∂y.
    """

    dpdx: tuple[float, float, float]
    dpdy: tuple[float, float, float]
    duv_dx: tuple[float, float]
    duv_dy: tuple[float, float]


@dataclass(frozen=True)
class Found:
    """A light that a path hit: `β L w` is added.

    index: Index of the light.
    light: Its name.
    radiance: L: the radiance toward the ray's origin.
    emission: How L comes about, of an area light.
    light_pdf: q: the density of the direction in light sampling, the choice of the light included; 0 if light
        sampling cannot find it. (p is the ray's `pdf`.)
    sampling: How `light_pdf` comes about: the probability of the light at the surface before, and the density
        of the direction, whose product it is; null where the direction was the only one possible, or light
        sampling cannot find the light.
    weight: w: the MIS weight, `p² / (p² + q²)` where both techniques can find the light.
    added: The contribution to the sample.
    """

    index: int
    light: str
    radiance: Amount
    emission: Derivation | None
    light_pdf: float
    sampling: FoundSampling | None
    weight: float
    added: Amount


@dataclass(frozen=True)
class FoundSampling:
    """How light sampling finds the light that a path hit.

    probability: The probability of choosing the light at the surface before.
    choice: How it comes about: its formula, and those of its operands.
    density: The density of the direction for this light.
    derivations: How it and, of environments, the radiance come about, as far as there is a formula.
    """

    probability: float
    choice: list[Derivation]
    density: float
    derivations: list[Derivation]


@dataclass(frozen=True)
class LensSurface:
    """A surface of a lens system, and the ray there.

    vertex: z of its vertex.
    curvature_radius: Radius of curvature, positive where the centre lies toward the film; null for planes and
        the aperture stop.
    aperture_radius: Radius of the part that light passes.
    index_ratio: Index of refraction on the scene's side over that on the film's side; null for the aperture
        stop.
    point: The point where the ray meets it; null if it does not.
    direction: The direction behind it, of unit length; null where there is none.
    passes: Whether the ray passes.
    """

    vertex: float
    curvature_radius: float | None
    aperture_radius: float
    index_ratio: float | None
    point: tuple[float, float, float] | None
    direction: tuple[float, float, float] | None
    passes: bool


@dataclass(frozen=True)
class LensSystem:
    """The way of a ray from the film through a lens system. Points and directions are in lens space: x to the
    viewer's right, y up, z along the axis to the scene, the film in z = 0, in units of the world.

    name: The lens file.
    focal_length: Effective focal length.
    f_number: The working f-number: that of a thin lens which would light the middle of the film as much.
    focus_distance: Distance of the plane of focus from the film.
    film: The point of the film.
    direction: The direction from there to the rear surface, of unit length.
    surfaces: Each surface, from the film to the front.
    passes: Whether the ray passes all of them.
    weight: The factor of its light: cos⁴ of its angle to the axis at the film, times the area of the pupil's
        bounds, over the square of the rear surface's distance, times the exposure; 0 if it is blocked.
    """

    name: str
    focal_length: float
    f_number: float
    focus_distance: float
    film: tuple[float, float, float]
    direction: tuple[float, float, float]
    surfaces: list[LensSurface]
    passes: bool
    weight: float


@dataclass(frozen=True)
class Lift:
    """The way from a point of a triangle to the smooth surface that its vertex normals describe (Hanika
    2021): `lift = Σ w_k max(0, −(p − P_k)·n_k) n_k`, with `p = Σ w_k P_k`.

    corners: P_k: the corners, relative to the render origin, or in the space of the object where there is
        one.
    normals: n_k: their normals, unit length, in the same space.
    weights: w_k: the weights of the corners at the point.
    from_object: In an instance the rows of the matrix that leads from the object to the world; the lift is
        multiplied by it.
    lift: The lift, in the world.
    """

    corners: tuple[tuple[float, float, float], tuple[float, float, float], tuple[float, float, float]]
    normals: tuple[tuple[float, float, float], tuple[float, float, float], tuple[float, float, float]]
    weights: tuple[float, float, float]
    from_object: tuple[tuple[float, float, float], tuple[float, float, float], tuple[float, float, float]] | None
    lift: tuple[float, float, float]


@dataclass(frozen=True)
class Light:
    """One light in Whitted's model.

    index: Index of the light.
    light: Its name.
    wi: Toward it, unit length; null when the light does not illuminate this point.
    n_dot_l: `N·L`; null when the light does not illuminate this point.
    h: H: halfway between the directions to the light and to the viewer, unit length.
    n_dot_h: `N·H`.
    arrives: L: incident radiance (for a point light: intensity after fall-off).
    pdf: The density, per steradian, of the direction; 1 where there is only one. `I_j = L / (π pdf)`.
    point: The point on the light, in the world; null for a light infinitely far away.
    derivations: How `arrives` and `pdf` come about, as far as there is a formula.
    intensity: `I_j` of Whitted's formula: the unoccluded light.
    diffuse: `k_d (N·L)`.
    specular: `k_s (N·H)ⁿ`.
    shadow: The shadow ray; null where its contribution would be 0.
    added: The contribution to the sample.
    """

    index: int
    light: str
    wi: tuple[float, float, float] | None
    n_dot_l: float | None
    h: tuple[float, float, float] | None
    n_dot_h: float | None
    arrives: Amount
    pdf: float | None
    point: tuple[float, float, float] | None
    derivations: list[Derivation]
    intensity: Amount
    diffuse: tuple[float, ...]
    specular: tuple[float, ...]
    shadow: Shadow | None
    added: Amount


@dataclass(frozen=True)
class LightPlace:
    """A light, by its index in reports.

    name: Its name; of an area light, the name of its shape.
    kind: `point`, `spot`, `distant`, `projection`, `goniometric`, `area` or `environment`.
    position: Its position in the world, if it has one; of an area light, the centre of its bounds.
    bounds: The bounds of an area light: minimum and maximum in the world.
    area: The area of an area light, of one side.
    toward: Toward it, unit length, if it is infinitely far away in one direction.
    """

    name: str
    kind: str
    position: tuple[float, float, float] | None
    bounds: tuple[tuple[float, float, float], tuple[float, float, float]] | None
    area: float | None
    toward: tuple[float, float, float] | None


@dataclass(frozen=True)
class LightSample:
    """The light that was sampled at a surface (next-event estimation): `β f cos L w / p` is added, if it is
    unoccluded.

    index: Index of the light.
    light: Its name.
    probability: The probability of choosing it among all lights.
    choice: How it comes about: its formula, and those of its operands.
    sample: The sampled direction; null when the light does not illuminate this point.
    shadow: The shadow ray; null where its contribution would be 0.
    added: The contribution to the sample.
    """

    index: int
    light: str
    probability: float
    choice: list[Derivation]
    sample: SampledDirection | None
    shadow: Shadow | None
    added: Amount


@dataclass(frozen=True)
class MatrixStep:
    """One factor of the camera's product.

    name: `T1`, `S2`, `R3` or `T4`; `M`, the way of a camera that moves since the shutter opened.
    does: A description.
    matrix: The factor.
    product: The product of the factors so far.
    point: The point so far.
    """

    name: str
    does: str
    matrix: tuple[tuple[float, float, float, float], tuple[float, float, float, float], tuple[float, float, float, float], tuple[float, float, float, float]]
    product: tuple[tuple[float, float, float, float], tuple[float, float, float, float], tuple[float, float, float, float], tuple[float, float, float, float]]
    point: tuple[float, float, float, float]


@dataclass(frozen=True)
class Met:
    """The hit of a ray.

    shape: The shape's name.
    primitive: Index of the primitive.
    instance: The instance, if it is in one.
    t: The kernel's `t`, in units of the direction.
    point: The point.
    error: Error bound of the point, per component, by which the next ray's origin is moved off the surface.
    lift: The way to the smooth surface that the triangle stands for, where rays start that leave to its
        outside.
    ng: Outward geometric normal.
    n: Shading normal on the side of the viewer.
    uv: Texture coordinates.
    footprint: The footprint of a pixel on the surface, where textures of its material are averaged over it.
    wo: Toward the viewer, unit length.
    cos_viewer: The cosine of the angle between the shading normal and the direction to the viewer.
    front: Whether the outside was hit.
    alpha: Alpha here, where the surface is not opaque everywhere: the ray passes with the probability of the
        rest.
    material: The material's name.
    coefficients: Its coefficients here, where the integrator evaluates them.
    """

    shape: str
    primitive: int
    instance: int | None
    t: float
    point: tuple[float, float, float]
    error: tuple[float, float, float]
    lift: Lift | None
    ng: tuple[float, float, float]
    n: tuple[float, float, float]
    uv: tuple[float, float]
    footprint: Footprint | None
    wo: tuple[float, float, float]
    cos_viewer: float
    front: bool
    alpha: float | None
    material: str
    coefficients: Coefficients | None


@dataclass(frozen=True)
class Microfacet:
    """A boundary with microfacets that scatters light between two directions. Its part of the BSDF is, for
    reflection, `weight · part · D G / (4 |cos_o cos_i|)`, for refraction `weight · part · D G |cos_om cos_im|
    / (|cos_o cos_i| (cos_im + cos_om / η)² η²)`, and where it is smooth `weight · part / (|cos_i| η²)`, the
    factor of a delta function; multiple scattering multiplies it by its gain.

    boundary: `conductor`, `dielectric`, `thin dielectric` or `coat`; of glTF's layers `specular`, `glass` or
        `clear coat`.
    refracts: Whether the facets refract light; otherwise they reflect it (a thin sheet also to its other
        side).
    alpha: α along u and v.
    half_vector: ω_m: the normal of the facets, unit length; of a reflection the half vector.
    cos_o: The absolute cosine of the direction to the viewer, and the boundary's normal.
    cos_i: The absolute cosine of the direction to the light, and the normal.
    cos_om: The cosine of the direction to the viewer, and ω_m.
    cos_im: The cosine of the direction to the light, and ω_m.
    d: D(ω_m): the density of facets with that normal; null where the boundary is smooth.
    g: G: Smith's masking and shadowing; null where it is smooth.
    fresnel: F: the Fresnel reflectance of the facets.
    part: The share of light that the facets send this way: F where they reflect it, else 1 − F; tinted by the
        layers above and the body, if it passes them.
    eta: η: the index of refraction on the side of the light over that on the side of the viewer where light
        is refracted; else 1.
    weight: The weight of the boundary, below the layers above it.
    multiple_scattering: What light between the facets of a conductor adds; null where it is lost or there is
        none.
    value: The boundary's part of the BSDF: the product.
    """

    boundary: str
    refracts: bool
    alpha: tuple[float, float]
    half_vector: tuple[float, float, float]
    cos_o: float
    cos_i: float
    cos_om: float
    cos_im: float
    d: float | None
    g: float | None
    fresnel: tuple[float, ...]
    part: tuple[float, ...]
    eta: float
    weight: float
    multiple_scattering: MultipleScattering | None
    value: tuple[float, ...]


@dataclass(frozen=True)
class MultipleScattering:
    """Light that one facet of a conductor sends to another, over that of single scattering: `gain = 1 + F̄ Ē
    / (1 − F̄ (1 − Ē)) · (1 − E) / E`.

    albedo: E(ω_o): the albedo of single scattering by facets that reflect all light.
    mean_albedo: Ē: its mean over all directions.
    mean_fresnel: F̄: the mean Fresnel reflectance.
    gain: All light over that of single scattering.
    """

    albedo: float
    mean_albedo: float
    mean_fresnel: tuple[float, ...]
    gain: tuple[float, ...]


@dataclass(frozen=True)
class NullCollision:
    """A null collision of a shadow ray with a medium that varies.

    t: Its distance.
    majorant: m: the majorant, the density of collisions.
    extinction: σ_t: the extinction coefficient there.
    transmittance: The estimate of the transmittance after it, by `(m − σ_t) / m`, and by Russian roulette
        where it is weak.
    """

    t: float
    majorant: float
    extinction: tuple[float, ...]
    transmittance: tuple[float, ...]


@dataclass(frozen=True)
class Phase:
    """Scattering by the phase function of a medium, which is its own density: β stays.

    wi: The sampled direction, unit length.
    cos: The cosine of the angle between the directions before and after it.
    pdf: The phase function in that direction, per steradian: its value and its density.
    lobes: The lobes whose mix it is.
    survival: The survival probability of Russian roulette.
    survives: Whether the path goes on.
    next_throughput: β of the next ray: β / survival; null where there is none.
    """

    wi: tuple[float, float, float]
    cos: float
    pdf: float
    lobes: list[PhaseLobe]
    survival: float
    survives: bool
    next_throughput: tuple[float, ...] | None


@dataclass(frozen=True)
class PhaseLobe:
    """A lobe of a phase function.

    name: Whose it is.
    weight: Its share.
    g: g: its mean cosine; of Draine's lobe a parameter beside it.
    alpha: α: 0 in that of Henyey and Greenstein.
    value: Its value in the sampled direction, per steradian.
    is_sampled: Whether the direction was sampled by it.
    """

    name: str
    weight: float
    g: float
    alpha: float
    value: float
    is_sampled: bool


@dataclass(frozen=True)
class Probe:
    """Subsurface scattering: the path has entered a medium in which light diffuses, and leaves it where a
    random line meets the same material. The next ray of the report is that line.

    throughput_before: β of the path that has entered.
    choice: P: the probability of each lane, by its part of the light that leaves.
    segment: The line; null where it would be outside of the sphere in which points are looked for.
    count: Number of its intersections with the material.
    exit: One of these points, chosen by the light that leaves there; null where the path ends.
    """

    throughput_before: tuple[float, ...]
    choice: tuple[float, ...]
    segment: ProbeSegment | None
    count: int
    exit: Exit | None


@dataclass(frozen=True)
class ProbeSegment:
    """A line that is searched for the point where light leaves.

    axis: The axis of the shading frame along which it is.
    lane: The index of the lane whose profile sampled its distance.
    radius: Its distance from the point where the path has entered.
    from_: Its start, in the world.
    direction: Its direction, unit length.
    length: Its length.
    """

    axis: str
    lane: int
    radius: float
    from_: tuple[float, float, float]
    direction: tuple[float, float, float]
    length: float


@dataclass(frozen=True)
class Profile:
    """Density along a ray: at the middles of as many equal parts of its way as there are numbers.

    start: The distance from which on there is something of the medium.
    end: The distance up to which.
    extinction: σ_t, in the mean of the lanes.
    majorant: The majorants of the cells there.
    """

    start: float
    end: float
    extinction: tuple[float, ...]
    majorant: tuple[float, ...]


@dataclass(frozen=True)
class Ray:
    """One ray.

    address: 1 is the camera ray; in Whitted's tree the reflected child of n is 2n, the refracted one 2n + 1;
        along a path n is followed by n + 1.
    parent: Address of the ray that it comes from.
    kind: `camera`; in a tree `reflected` or `refracted`; along a path `reflected`, `transmitted`, `scattered`
        (a random walk) or `straight on` (past a surface that it passes by alpha or as an interface).
    depth: Number of reflections, refractions and bounces before.
    a: Its origin.
    origin: The same as it is traced: relative to the render origin (`render_origin`).
    direction: Its direction, not necessarily of unit length.
    departure: How its origin follows from the point that it leaves; null for camera rays.
    throughput: β: the throughput, the factor of light along it in the sample.
    pdf: The solid angle density of its direction, for MIS weights; null for camera rays, after specular
        bounces and in Whitted's tree.
    traversal: The cost of finding its hit.
    candidates: Every primitive that was tested, in the order of the tests.
    met: Its hit; null for a miss, and where a medium scatters it before.
    absorption: What a medium absorbs on the way to the hit.
    flight: Free flight in a homogeneous medium that scatters: to the hit, or to a point before it.
    tracking: Collisions in a medium that varies: to the hit, or to a point before it.
    medium_emission: The light that the medium emits on the way, as far as the hit; it is added.
    phase: The continuation of the path where a medium scatters it, even if Russian roulette ends it.
    eta_scale: The product of η² over the refractions before, by which Russian roulette multiplies the
        throughput.
    throughput_there: The throughput at the hit, after absorption on the way and dispersion there, along a
        path.
    only_color: In RGB mode: the one colour that goes on, with the weight of all three, after dispersion at
        the hit.
    found: Lights that it hit, along a path.
    scattering: The BSDF at the hit, along a path.
    lights: Each light, in Whitted's model.
    light_sample: The light that was sampled at the hit, along a path.
    openness: The shadow ray of ambient occlusion.
    bounce: The continuation of the path, even if Russian roulette ends it.
    probe: The search for the point where the path leaves, where it has entered a medium below the surface.
    branches: The branches of the tree here, followed or not.
    ends: The reason why the path ends here, if it does.
    added: The contribution of this ray's own hit to the sample.
    subtree: The contribution of this ray and of all rays that come from it.
    """

    address: int
    parent: int | None
    kind: str
    depth: int
    a: tuple[float, float, float]
    origin: tuple[float, float, float]
    direction: tuple[float, float, float]
    departure: Departure | None
    throughput: tuple[float, ...]
    pdf: float | None
    traversal: Traversal
    candidates: list[Candidate]
    met: Met | None
    absorption: Absorption | None
    flight: Flight | None
    tracking: Tracking | None
    medium_emission: Amount | None
    phase: Phase | None
    eta_scale: float
    throughput_there: tuple[float, ...] | None
    only_color: str
    found: list[Found]
    scattering: Scattering | None
    lights: list[Light]
    light_sample: LightSample | None
    openness: Shadow | None
    bounce: Bounce | None
    probe: Probe | None
    branches: list[Branch]
    ends: str | None
    added: Amount
    subtree: Amount


@dataclass(frozen=True)
class SampleSummary:
    """One sample of a pixel in short.

    sample: Number of the sample in its pixel.
    film: The value that the film received.
    luminance: Its luminance.
    depth: Number of reflections, refractions and bounces before the hit that made the largest contribution;
        of a sample without light, of its longest way.
    light: The light of the largest contribution; null for a sample without light.
    expression: The largest contribution as an expression (`contributions`).
    """

    sample: int
    film: tuple[float, float, float]
    luminance: float
    depth: int
    light: str | None
    expression: str


@dataclass(frozen=True)
class SampledDirection:
    """A direction to a light that was sampled.

    wi: Toward the light, unit length.
    light_pdf: The density of the direction for this light; 1 where there is only one.
    pdf: p: the density with the choice of the light, `probability · light_pdf`.
    point: The point on the light, in the world; null for a light infinitely far away.
    derivations: How `arrives` and `light_pdf` come about, as far as there is a formula.
    is_delta: Whether the light has only one direction here (a point, a distant light): then p is a
        probability, not a density.
    arrives: L: the unoccluded incident radiance.
    f_cos: The BSDF times the cosine; black where it does not scatter this light.
    microfacets: The factors D, G and F of the boundaries of the BSDF that have microfacets. Diffuse lobes,
        sheen, and walks between layers are the rest of the BSDF.
    bsdf_pdf: q: the density of the direction in BSDF sampling; null for a delta light, and where light is not
        weighted by MIS.
    weight: w: the MIS weight, `p² / (p² + q²)` where both techniques can find the light.
    """

    wi: tuple[float, float, float]
    light_pdf: float
    pdf: float
    point: tuple[float, float, float] | None
    derivations: list[Derivation]
    is_delta: bool
    arrives: Amount
    f_cos: tuple[float, ...]
    microfacets: list[Microfacet]
    bsdf_pdf: float | None
    weight: float


@dataclass(frozen=True)
class Scattering:
    """A BSDF at a point.

    kind: The kind of BSDF.
    does: A description.
    numbers: Its parameters by name: one number, one per axis, or one per lane.
    lobes: Its lobes, in words.
    letters: Its lobes that light sampling can use, in letters: `D` diffuse, `G` glossy, `DG` both.
    n: The outward shading normal, with normal and bump maps.
    tangents: The tangents along which the roughness has its two values, unit length; of a BSDF that is the
        same in all directions around n, any two.
    """

    kind: str
    does: str
    numbers: list[tuple[str, tuple[float, ...]]]
    lobes: str
    letters: str
    n: tuple[float, float, float]
    tangents: tuple[tuple[float, float, float], tuple[float, float, float]]


@dataclass(frozen=True)
class Sensor:
    """What the camera's sensor does to the light of a sample.

    camera: The camera whose responses are used; null for the standard observer.
    imaging_ratio: Multiplies all light.
    white_balance: The colour temperature, in kelvin, of light that appears white.
    matrix: The matrix, by rows, that a colour of RGB mode is multiplied by: the responses, the imaging ratio
        and the white balance together; null where it changes nothing, and in spectral mode.
    max_component: The maximum of a sample's channels; infinite for no limit.
    scaled_by: The factor by which this sample was scaled down to it; 1 for no change.
    """

    camera: str | None
    imaging_ratio: float
    white_balance: float | None
    matrix: tuple[tuple[float, float, float], tuple[float, float, float], tuple[float, float, float]] | None
    max_component: float
    scaled_by: float


@dataclass(frozen=True)
class Segment:
    """A line segment of a drawing: a ray, or a part of a shadow ray.

    address: Address of the ray; for a shadow ray, of the ray whose hit cast it.
    kind: The kind of the ray; of a shadow ray `shadow` up to its light or to what blocks it, and `blocked`
        behind that.
    from_: Its start.
    to: Its end; without one, a point so far away that the ray is seen.
    is_endless: Whether it has no end.
    width: The width of its line in pixels, which grows with the throughput.
    name: The name at its end: of the shape, or of the light of a shadow ray.
    title: Its description with its contribution.
    """

    address: int
    kind: str
    from_: tuple[float, float, float]
    to: tuple[float, float, float]
    is_endless: bool
    width: float
    name: str | None
    title: str


@dataclass(frozen=True)
class Shadow:
    """A shadow ray.

    from_: Its origin.
    departure: How it follows from the point that is lit.
    to: Its target (if it has no end: one length of its direction away).
    is_endless: Whether it has no end.
    blockers: The surfaces that it hit, in order.
    traversal: The cost of finding them, of all its parts.
    collisions: The collisions with media that vary, by which their transmittance is estimated: of all its
        parts, each from 1 on.
    rest: Transmittance of the medium on the rest of the way to the light; null if it is blocked before.
    """

    from_: tuple[float, float, float]
    departure: Departure | None
    to: tuple[float, float, float]
    is_endless: bool
    blockers: list[Blocker]
    traversal: Traversal
    collisions: list[NullCollision]
    rest: tuple[float, ...] | None


@dataclass(frozen=True)
class SphereMapping:
    """The way from a pixel to a direction, for cameras that see all around.

    does: A description.
    uv: `P_k` over the size of the picture, v up.
    formula: The formula of the direction in view space.
    numbers: Its numbers by name.
    direction_in_view: The direction in view space: along u, v, w.
    """

    does: str
    uv: tuple[float, float]
    formula: str
    numbers: list[tuple[str, float]]
    direction_in_view: tuple[float, float, float]


@dataclass(frozen=True)
class TestNumbers:
    """The inputs of a test and the numbers that are computed from them. Lengths and points are relative to
    the render origin (`render_origin`), or in the space of an object where an input `a in the object` says
    so.

    inputs: The inputs by name, exactly: each is a vector or a number. `a` and `d` are the ray's, `a + t d`.
    numbers: The numbers, each with its name in the lecture notes.
    """

    inputs: list[tuple[str, tuple[float, ...]]]
    numbers: list[tuple[str, Twice]]


@dataclass(frozen=True)
class Tracking:
    """The way of a ray through a medium that varies, by collisions whose density is a majorant of the
    extinction.

    limit: The distance of what the ray hits or, where it hits nothing, of the end of a medium that fills
        space; infinite where that has none.
    collisions: Its collisions, in order: all are null, but for the last where the medium scatters it.
    profile: The medium along the whole way, whether the ray goes on to there or not; null where it does not
        meet it.
    scattered_at: The point where it is scattered, in the world; null where it arrives.
    throughput: The throughput at the end.
    """

    limit: float
    collisions: list[Collision]
    profile: Profile | None
    scattered_at: tuple[float, float, float] | None
    throughput: tuple[float, ...]


@dataclass(frozen=True)
class Traversal:
    """The cost of a ray, traced alone. (In packets, rays share nodes.)

    nodes: Nodes of the BVH that it visited, in instances, too.
    culled: Boxes of their children that were culled: the ray misses them, or has a hit before them. The
        others were entered.
    tests: Primitives that it was tested against.
    """

    nodes: int
    culled: int
    tests: int


@dataclass(frozen=True)
class Twice:
    """One quantity, computed twice.

    f32: In f32.
    f64: In f64.
    bits: Number of leading bits that agree, of the 24 that f32 has.
    """

    f32: float
    f64: float
    bits: int


@dataclass(frozen=True)
class Wavelengths:
    """The four wavelengths of a sample.

    lambda_: Wavelengths in nm.
    pdf: Their densities, per nm; 0 for those that were terminated.
    dispersed: Whether dispersion terminated all but the first.
    """

    lambda_: tuple[float, float, float, float]
    pdf: tuple[float, float, float, float]
    dispersed: bool
