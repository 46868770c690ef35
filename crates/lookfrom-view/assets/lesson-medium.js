// Light through fog: Beer and Lambert's law from many thin slices, and the same number from random flights, in the mean.

import { draggable } from "./drag.js";
import { display, formula, frac } from "./formula.js";
import { h, replace, svg } from "./html.js";
import { slider } from "./fields.js";
import { lanes, short } from "./format.js";

/** The plot: x of the way's beginning, its width, the longest way in it, y of T = 0, the height of T = 1. */
const [LEFT, WIDTH, LONGEST, BOTTOM, HEIGHT] = [24, 360, 10, 130, 118];
/** Where flights are drawn, and how many at most. */
const [TOP_OF_FLIGHTS, DRAWN] = [150, 24];
/** The part of light that the exercise asks for, and how near counts. */
const [WANTED, NEAR] = [0.5, 0.01];

/** @param {number} along */
const x = (along) => LEFT + (WIDTH * along) / LONGEST;
/** @param {number} part */
const y = (part) => BOTTOM - HEIGHT * part;

/** @param {import("./app.js").App} app */
export function mediumLesson(app) {
    let [sigma, length, slices, count, seed] = [0.4, 3, 6, 64, 1];
    const figure = svg("svg", { viewBox: "0 0 400 300", class: "figure", role: "slider", tabindex: "0", "aria-label": "Length of the way through the medium", "aria-valuemin": 0, "aria-valuemax": LONGEST });
    const [law, flights, verdict] = [h("p", { class: "number centred" }), h("p", { class: "number centred" }), h("p", { class: "verdict", role: "status", id: "medium-verdict" })];
    const ofSigma = slider("σ", { min: 0, max: 2, step: 0.01 }, () => sigma, (value) => ((sigma = value), draw()), (value) => value.toFixed(2));
    const ofSlices = slider("slices", { min: 1, max: 60, step: 1 }, () => slices, (value) => ((slices = value), draw()));
    const ofCount = slider("paths", { min: 0, max: 14, step: 1 }, () => Math.log2(count), (value) => ((count = 2 ** value), draw()), (value) => String(2 ** value));
    const again = h("button", { type: "button", onclick: () => (seed++, draw()) }, "Other random numbers");
    const here = h("div");
    const element = h("div", {},
        h("p", {}, "A slice of fog of thickness dt takes the part ", formula("σ dt"), " of the light that enters it, and each slice what is left by those before. Drag the end of the way, or use the arrow keys."),
        display("dL = − σ L dt,  T = ", frac("L(l)", "L(0)"), " = lim ( 1 − ", frac("σ l", "n"), ")ⁿ = exp(− σ l)"),
        figure, law, ofSigma.element, ofSlices.element,
        h("h4", {}, "Why random steps give it in the mean"),
        h("p", {}, "A path is not weakened: it flies on unchanged or is stopped. In each slice it is stopped with the probability ", formula("σ dt"), "; then the probability to fly farther than t is the same product, ", formula("exp(− σ t)"), ". One random number u finds such a distance, and the part of the paths that arrive is T in the mean:"),
        display("1 − u = exp(− σ t),  t = − ", frac("ln(1 − u)", "σ"), ",  P(t > l) = exp(− σ l)"),
        ofCount.element, flights, again,
        h("h4", {}, "Exercise"),
        h("p", {}, "Make the way so long that half of the light arrives, for whatever σ. How long is it, as a formula?"),
        verdict, here);

    draggable(figure, { to: (x) => to(((x - LEFT) / WIDTH) * LONGEST), by: (right, up) => to(length + 0.05 * (right + up)) });

    /** @param {number} next */
    function to(next) {
        length = Math.max(0.05, Math.min(LONGEST, next));
        draw();
    }

    function draw() {
        const transmittance = Math.exp(-sigma * length);
        const left = (/** @type {number} */ k) => Math.max(0, 1 - (sigma * length) / slices) ** k;
        const distances = flightsOf(sigma, count, seed);
        const arrived = distances.filter((distance) => distance > length).length;
        const curve = Array.from({ length: 101 }, (_, i) => `${x((LONGEST * i) / 100)},${y(Math.exp((-sigma * LONGEST * i) / 100)).toFixed(1)}`);
        const stairs = Array.from({ length: slices }, (_, k) => [`${x((length * k) / slices).toFixed(1)},${y(left(k + 1)).toFixed(1)}`, `${x((length * (k + 1)) / slices).toFixed(1)},${y(left(k + 1)).toFixed(1)}`]).flat();
        const drawn = distances.slice(0, DRAWN);
        const line = (/** @type {number} */ i) => TOP_OF_FLIGHTS + (140 * (i + 0.5)) / Math.max(drawn.length, 1);
        replace(figure,
            svg("rect", { x: x(0), y: 6, width: x(length) - x(0), height: 288, class: "glass" }),
            svg("line", { x1: x(0), x2: x(LONGEST), y1: BOTTOM, y2: BOTTOM, class: "axis" }),
            svg("polyline", { points: `${x(0)},${y(1)} ${stairs.join(" ")}`, class: "stairs" }),
            svg("polyline", { points: curve.join(" "), class: "curve" }),
            svg("text", { x: LEFT - 5, y: y(1) + 4, class: "end" }, "1"), svg("text", { x: LEFT - 5, y: BOTTOM + 4, class: "end" }, "0"),
            svg("text", { x: x(LONGEST), y: BOTTOM + 13, class: "end" }, String(LONGEST)), svg("text", { x: x(LONGEST), y: y(1) + 4, class: "end" }, "T"),
            drawn.map((distance, i) => [
                svg("line", { x1: x(0), x2: x(Math.min(distance, length)), y1: line(i), y2: line(i), class: distance > length ? "flight arrives" : "flight" }),
                distance <= length && svg("circle", { cx: x(distance), cy: line(i), r: 2.6, class: "collision" }),
            ]).flat(),
            svg("line", { x1: x(length), x2: x(length), y1: 6, y2: 294, class: "incident" }),
            svg("circle", { cx: x(length), cy: y(transmittance), r: 6, class: "handle" }));
        law.textContent = `σ l = ${short(sigma * length, 4)} · T = ${short(transmittance, 4)} · ${slices} ${slices === 1 ? "slice" : "slices"} ${short(left(slices), 4)}`;
        flights.textContent = `${arrived} of ${count} paths arrive: ${short(arrived / count, 4)} · T = ${short(transmittance, 4)} ± ${short(Math.sqrt((transmittance * (1 - transmittance)) / count), 2)}`;
        figure.setAttribute("aria-valuenow", length.toFixed(2));
        figure.setAttribute("aria-valuetext", law.textContent);
        const isRight = Math.abs(transmittance - WANTED) < NEAR;
        verdict.classList.toggle("good", isRight);
        replace(verdict, isRight
            ? [`Half of it arrives: l = ${short(length, 3)}, and `, formula("l = ln 2 / σ"), ` = ${short(Math.LN2 / sigma, 3)}. Twice as far, a quarter does.`]
            : `T = ${short(transmittance, 3)}: the way is too ${transmittance > WANTED ? "short" : "long"}.`);
    }

    function show() {
        const ray = app.selectedRay();
        const { flight, tracking } = ray ?? {};
        replace(here, h("p", { class: "hint" },
            flight ? `The selected ray flies ${flight.scattered_at ? `${short(flight.distance)}, and is scattered there` : `the whole way, ${short(flight.limit)}`}: σ_t = ${lanes(flight.extinction)}, T = ${lanes(flight.transmittance)}.`
                : tracking ? `The selected ray collides ${tracking.collisions.length} times with a medium that varies; its equations have each.`
                : "Where the selected ray flies in a medium, its own numbers stand here."));
        draw();
    }
    return { element, show };
}

/**
 * Distances of random flights, in an order that a seed decides.
 * @param {number} sigma
 * @param {number} count
 * @param {number} seed
 */
function flightsOf(sigma, count, seed) {
    // A linear congruential generator modulo 2³² (Numerical Recipes): good enough to be looked at.
    let state = (seed * 2654435761) >>> 0;
    return Array.from({ length: count }, () => {
        state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
        return sigma === 0 ? Infinity : -Math.log1p(-state / 2 ** 32) / sigma;
    });
}
