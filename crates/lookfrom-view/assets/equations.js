// The equations of the selected ray, in the order in which the renderer computes them, with their numbers.

import { display, formula, frac } from "./formula.js";
import { byId, h, replace } from "./html.js";
import { counted, exact, fileName, lanes, point, short, swatch } from "./format.js";
import { candidateTable } from "./candidates.js";
import { densityPlot } from "./density.js";
import { ends } from "./tree.js";

/** @typedef {import("./protocol.js").Ray} Ray */
/** @typedef {import("./html.js").Child} Child */
/** @typedef {[symbol: string, meaning: string, value: string | Node | (string | Node)[]]} Row */

/** @param {import("./app.js").App} app */
export function showEquations(app) {
    const element = byId("equations");
    /** What the reader has closed stays closed from ray to ray. @type {Set<string>} */
    const closed = new Set();
    const show = () => {
        const ray = app.selectedRay();
        if (!ray) return replace(element);
        const sections = [theRay(ray), theTests(ray), theAbsorption(ray), theFlight(ray), theCollisions(ray), theHit(ray), ...theLights(ray), theLightSample(ray), ...theFound(ray), theBranches(ray), theBounce(ray), thePhase(ray), theSum(ray)];
        replace(element, sections.filter((section) => section !== null).map((section) => {
            const { title, content } = /** @type {Section} */ (section);
            const details = h("details", { open: !closed.has(title) }, h("summary", {}, title), ...content);
            details.addEventListener("toggle", () => (details.open ? closed.delete(title) : closed.add(title)));
            return details;
        }));
    };
    app.inspection.on(show);
    app.ray.on(show);
}

/** @param {Row[]} rows */
export const terms = (rows) =>
    h("table", { class: "terms" }, h("tbody", {}, rows.map(([symbol, meaning, value]) =>
        h("tr", {}, symbol ? h("th", { scope: "row" }, formula(symbol)) : h("td"), h("td", { class: "number" }, value), h("td", { class: "meaning" }, meaning)))));

/** @typedef {{title: string, content: (Child | Child[])[]}} Section */

/** @param {string} title @param {...(Child | Child[])} content @returns {Section} */
const section = (title, ...content) => ({ title, content });

/** @param {Ray} ray */
function theRay(ray) {
    return section(`Ray ${ray.address}: ${ray.kind}`,
        display("p(t) = a + t (b − a)"),
        terms([
            ["a", ray.kind === "camera" ? "the eye (or a point of the lens)" : "its origin", point(ray.a, 7)],
            ["b − a", "its direction", point(ray.direction, 7)],
            ["β", "throughput: light along it is multiplied by this", lanes(ray.throughput, 6)],
            ...(ray.pdf === null ? [] : [/** @type {Row} */ (["p", "density of its direction, per steradian", short(ray.pdf, 6)])]),
        ]));
}

/** @param {Ray} ray */
function theTests(ray) {
    const cost = ray.traversal && h("p", { class: "hint" }, `${counted(ray.traversal.nodes, "node")} of the BVH visited, ${counted(ray.traversal.culled, "box")} culled, ${counted(ray.traversal.tests, "primitive")} tested.`);
    if (ray.candidates.length === 0) return section("Tested primitives", cost ?? h("p", { class: "hint" }, "None: the tree of boxes excludes everything."));
    const sorted = [...ray.candidates].sort((a, b) => Number(b.is_nearest) - Number(a.is_nearest));
    const others = sorted.slice(1);
    return section("Tested primitives",
        cost,
        candidateTable(sorted[0]),
        others.length > 0 && h("details", { class: "inner" }, h("summary", {}, `${others.length} more: rejected or farther`), others.slice(0, 40).map(candidateTable)));
}

/** Beer's law, on the way through a medium. @param {Ray} ray */
function theAbsorption(ray) {
    const { absorption } = ray;
    if (!absorption) return null;
    return section(`Absorption${absorption.material ? ` in ${absorption.material}` : ""}`,
        display("T = exp(− σ s l)"),
        terms([
            ["σ", "absorption coefficient, per unit of length", lanes(absorption.sigma)],
            ["s", "a factor of it", exact(absorption.scale)],
            ["l", "length of the way", exact(absorption.length)],
            ["T", "what is left", lanes(absorption.transmittance)],
            ["β T", "throughput after it", lanes(absorption.throughput)],
        ]));
}

/** @param {Ray} ray */
function theFlight(ray) {
    const { flight } = ray;
    if (!flight) return null;
    const { scattered_at: place } = flight;
    return section("A flight in a medium",
        display("β′ = ", place ? frac("β σ_s T", "q") : frac("β T", "Q")),
        densityPlot(ray),
        terms([
            ["σ_t", "extinction coefficient, per unit of length", lanes(flight.extinction)],
            ["σ_s", "scattering coefficient", lanes(flight.scattering)],
            ["P", `probability of each lane by its share of β; the distance is sampled by lane ${flight.lane}`, lanes(flight.choice)],
            ["l", "the distance that was sampled", exact(flight.distance)],
            ["d", "the distance of what is hit", exact(flight.limit)],
            ["T", "exp(− σ_t l), or of d where that is less", lanes(flight.transmittance)],
            place ? ["q", "density of the distance: Σ P σ_t T", exact(flight.density)] : ["Q", "probability of arriving: Σ P T", exact(flight.density)],
            ["β′", "throughput there", lanes(flight.throughput)],
            ...(place ? [/** @type {Row} */ (["p", "the point where the medium scatters it", point(place, 9)])] : []),
        ]));
}

/** @param {Ray} ray */
function theCollisions(ray) {
    const { tracking } = ray;
    if (!tracking) return null;
    const { collisions, limit, scattered_at: place } = tracking;
    return section("Collisions in a medium that varies",
        display("β′ = ", frac("β (m − σ_t)", "m (1 − q)"), " null, ", frac("β σ_s", "m q"), " real"),
        densityPlot(ray),
        terms([
            ["d", "the distance of what is hit", exact(limit)],
            ...collisions.flatMap(({ t, majorant, absorption, scattering, emitted, probability, is_real, throughput }) => [
                /** @type {Row} */ (["t", `a ${is_real ? "real" : "null"} collision`, exact(t)]),
                /** @type {Row} */ (["m", "majorant: the density of collisions", exact(majorant)]),
                /** @type {Row} */ (["σ_a", "absorption coefficient there", lanes(absorption)]),
                /** @type {Row} */ (["σ_s", "scattering coefficient there", lanes(scattering)]),
                /** @type {Row} */ (["q", "probability that it is real: Σ P σ_t / m", exact(probability)]),
                ...(emitted.some((lane) => lane !== 0) ? [/** @type {Row} */ (["β σ_a L / m", "light that the medium adds", lanes(emitted)])] : []),
                /** @type {Row} */ (["β′", "throughput after it", lanes(throughput)]),
            ]),
            ...(place ? [/** @type {Row} */ (["p", "the point where the medium scatters it", point(place, 9)])] : []),
        ]));
}

/** @param {Ray} ray */
function thePhase({ phase, ends: reason }) {
    if (!phase) return null;
    return section("Goes on by the phase function",
        terms([
            ["ω", "the sampled direction", point(phase.wi)],
            ["cos θ", "of the angle to the direction before", exact(phase.cos)],
            ["p", "phase function, which is its own density: β stays", exact(phase.pdf)],
            ...(phase.lobes.length < 2 ? [] : phase.lobes.map(({ name, weight, g, alpha, value, is_sampled }) =>
                /** @type {Row} */ (["", `share × value of the lobe of ${name}${is_sampled ? ", which has sampled it" : ""}; g = ${short(g)}, α = ${short(alpha)}`, `${short(weight, 6)} × ${exact(value)}`]))),
            ...(phase.survival < 1 ? [
                /** @type {Row} */ (["P", "probability that Russian roulette lets it go on", exact(phase.survival)]),
                /** @type {Row} */ (["β / P", "throughput of the next ray", lanes(phase.next_throughput)]),
            ] : []),
        ]),
        reason && h("p", {}, `${reason[0].toUpperCase()}${reason.slice(1)}.`));
}

/** @param {Ray} ray */
function theHit(ray) {
    const { met, flight, tracking } = ray;
    if (flight?.scattered_at || tracking?.scattered_at) return section("Hit", h("p", {}, "None: a medium scatters it before."));
    if (!met) return section("Hit", h("p", {}, "It leaves the scene."));
    const k = met.coefficients;
    return section(`Hit: ${fileName(met.shape)}`,
        terms([
            ["t", "where along the ray; 1 is the image plane for a camera ray", exact(met.t)],
            ["p", "the point", point(met.point, 9)],
            ["±", "bound of the distance to the surface, by component", point(met.error, 2)],
            ["n_g", `geometric normal; the ray comes from ${met.front ? "outside" : "inside"}`, point(met.ng)],
            ["n", "shading normal", point(met.n)],
            ["u v", "surface parameters", point(met.uv)],
            ...(met.footprint ? [
                /** @type {Row} */ (["∂p/∂x", "from one pixel to the next: textures are averaged over that", point(met.footprint.dpdx)]),
                /** @type {Row} */ (["∂p/∂y", "", point(met.footprint.dpdy)]),
                /** @type {Row} */ (["∂uv/∂x", "", point(met.footprint.duv_dx)]), /** @type {Row} */ (["∂uv/∂y", "", point(met.footprint.duv_dy)]),
            ] : []),
            ...(k ? [
                /** @type {Row} */ (["k_a", "ambient", lanes(k.ambient)]), /** @type {Row} */ (["k_d", "diffuse", lanes(k.diffuse)]),
                /** @type {Row} */ (["k_s", `specular, with the exponent n = ${short(k.shininess)}`, lanes(k.specular)]),
                /** @type {Row} */ (["k_r", "mirrored", lanes(k.mirror)]), /** @type {Row} */ (["k_t", `transmitted, η = ${short(k.ior)}`, lanes(k.transmission)]),
            ] : []),
        ]),
        h("p", { class: "meaning" }, `Material ${met.material}`, ray.scattering && `: ${ray.scattering.kind}; ${ray.scattering.does}`),
        ray.scattering && terms(ray.scattering.numbers.map((/** @type {[string, number[]]} */ [name, value]) => ["", name, lanes(value)])));
}

/** Whitted's sum over the lights. @param {Ray} ray */
function theLights(ray) {
    const lit = ray.lights.filter(({ wi }) => wi);
    if (lit.length === 0) return [];
    return [section("Lights",
        display("I = k_a I_a + Σ_j ( k_d (N·L_j) + k_s (N·H_j)ⁿ ) I_j + k_r S + k_t T"),
        lit.flatMap(({ light, wi, n_dot_l, h: half, n_dot_h, intensity, diffuse, specular, shadow, added }) => [
            h("h4", {}, fileName(light)),
            terms([
                ["L_j", "direction to the light", point(wi)],
                ...(typeof n_dot_l === "number" ? [/** @type {Row} */ (["N·L_j", "cosine of the angle to the normal", exact(n_dot_l)])] : []),
                ...(half ? [/** @type {Row} */ (["H_j", `halfway between the light and the viewer; N·H = ${short(n_dot_h)}`, point(half)])] : []),
                ["I_j", "its intensity here, were nothing between", lanes(intensity.rgb)],
                ["k_d (N·L_j)", "diffuse", lanes(diffuse)],
                ["k_s (N·H_j)ⁿ", "highlight", lanes(specular)],
                ["", "shadow ray", shadowWords(shadow)],
                ["+", "added to the pixel", amount(added)],
            ]),
        ]))];
}

/** @param {import("./protocol.js").Shadow | null} shadow */
function shadowWords(shadow) {
    if (!shadow) return "none: it would carry nothing";
    if (shadow.blockers.length === 0) return "reaches the light";
    return shadow.blockers.map(({ shape, passed, t }) => {
        const at = t === undefined ? "" : ` at t = ${short(t)}`;
        return Math.max(...passed) > 0 ? `through ${fileName(shape)}${at} × ${lanes(passed)}` : `blocked by ${fileName(shape)}${at}`;
    }).join(", ");
}

/** D, G and F of the boundaries with microfacets. @param {import("./protocol.js").Microfacet[] | undefined} microfacets @returns {Row[]} */
const microfacetRows = (microfacets) => (microfacets ?? []).flatMap(({ boundary, refracts, alpha, half_vector, d, g, fresnel, value }) => {
    const does = `${boundary} ${refracts ? "refracts" : "reflects"}`;
    return /** @type {Row[]} */ ([
        ...(d === null || g === null ? [] : [
            ["ω_m", `normal of the microfacets; the ${does}, α = ${alpha.map((x) => short(x)).join(", ")}`, point(half_vector)],
            ["D", "density of microfacets with this normal", exact(d)],
            ["G", "the part that is neither masked nor shadowed", exact(g)],
        ]),
        ["F", `Fresnel reflectance${d === null ? ` where the smooth ${does}` : ""}`, lanes(fresnel)],
        ["f", `${boundary}'s part of the BSDF`, lanes(value)],
    ]);
});

/** Next-event estimation. @param {Ray} ray */
function theLightSample(ray) {
    const sampled = ray.light_sample;
    if (!sampled) return null;
    const { sample, light, probability, shadow, added } = sampled;
    if (!sample) return section(`Sampled light: ${fileName(light)}`, h("p", {}, "It does not illuminate this point."));
    return section(`Sampled light: ${fileName(light)}`,
        display("β f cos θ L", frac("w", "p")),
        terms([
            ["β", "throughput", lanes(ray.throughput_there ?? ray.throughput)],
            ["f cos θ", "BSDF times cosine", lanes(sample.f_cos)],
            ...microfacetRows(sample.microfacets),
            ["L", "radiance, were nothing between", lanes(sample.arrives.lanes)],
            ["p", `density: ${short(probability)} (choice of this light) × ${short(sample.light_pdf)}`, exact(sample.pdf)],
            ["q", "density of the direction in BSDF sampling", exact(sample.bsdf_pdf)],
            ["w", "weight p² / (p² + q²), the power heuristic", exact(sample.weight)],
            ["", "shadow ray", shadowWords(shadow)],
            ["+", "added to the pixel", amount(added)],
        ]));
}

/** Light that the ray itself hits. @param {Ray} ray */
function theFound(ray) {
    return ray.found.map(({ light, radiance, light_pdf, weight, added }) => section(`Light that it hits: ${fileName(light)}`,
        display("β L w"),
        terms([
            ["β", "throughput", lanes(ray.throughput_there ?? ray.throughput)],
            ["L", "radiance toward the origin", lanes(radiance.lanes)],
            ["p", "density of the direction in BSDF sampling", exact(ray.pdf)],
            ["q", "density in light sampling; 0 where that cannot find it", exact(light_pdf)],
            ["w", "weight p² / (p² + q²)", exact(weight)],
            ["+", "added to the pixel", amount(added)],
        ])));
}

/** @param {Ray} ray */
function theBranches(ray) {
    if (ray.branches.length === 0) return null;
    return section("Branches",
        display("F max(k_r, k_t) S + (1 − F) k_t T"),
        terms(ray.branches.map(({ kind, direction, cos, eta, weight, fresnel, total_reflection, cut }) => [
            kind === "reflected" ? "S" : "T",
            `${kind}${direction ? ` to ${point(direction, 4)}, cos θ = ${short(cos)}` : ""}${eta ? `, η = ${short(eta)}` : ""}${fresnel === null || fresnel === undefined ? "" : `, Fresnel's F = ${short(fresnel)}`}${total_reflection ? ", total internal reflection" : ""}${cut ? `; not followed: ${cut}` : ""}`,
            lanes(weight),
        ])));
}

/** @param {Ray} ray */
function theBounce(ray) {
    const { bounce, ends: reason } = ray;
    if (!bounce) return reason && !ray.phase ? section("The path ends", h("p", {}, `${reason[0].toUpperCase()}${reason.slice(1)}.`)) : null;
    return section(`Goes on by ${bounce.lobe}`,
        display("β′ = ", frac("β f cos θ", "p")),
        terms([
            ["ω", "the sampled direction", point(bounce.wi)],
            ["f", "BSDF", lanes(bounce.f)],
            ...microfacetRows(bounce.microfacets),
            ["cos θ", "of the angle to the shading normal", exact(bounce.cos)],
            ["p", bounce.pdf_is_proportional ? "density; only its ratio to f means something" : "density of the direction", exact(bounce.pdf)],
            ["β", "before", lanes(bounce.throughput_before)],
            ["β′", "after", lanes(bounce.throughput_after)],
            ...(bounce.survival < 1 ? [
                /** @type {Row} */ (["P", "probability that Russian roulette lets it go on", exact(bounce.survival)]),
                /** @type {Row} */ (["β′ / P", "throughput of the next ray: what goes on stands for what ended", lanes(bounce.next_throughput)]),
            ] : []),
        ]),
        reason && h("p", {}, `${reason[0].toUpperCase()}${reason.slice(1)}.`));
}

/** @param {Ray} ray */
function theSum(ray) {
    return section("Sum", terms([["", `ray ${ray.address} ${ends(ray)}`, amount(ray.added)], ["", "with all rays after it", amount(ray.subtree)]]));
}

/** @param {import("./protocol.js").Amount} value */
const amount = (value) => [swatch(value.rgb), ` ${lanes(value.rgb, 6)}`];
