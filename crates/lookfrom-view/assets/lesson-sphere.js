// A ray and a sphere that is dragged: above both in their plane, below the parabola over the same t, whose roots are the two points.

import { candidateTable, numbersOf } from "./candidates.js";
import { draggable } from "./drag.js";
import { select } from "./fields.js";
import { short } from "./format.js";
import { display, frac, row, sqrt } from "./formula.js";
import { h, replace, svg } from "./html.js";

/** The ray's place, the zero of the parabola, and the highest point at which it is drawn; the origin of the ray. */
const [RAY, ZERO, TOP, ORIGIN] = [92, 268, 190, 50];
/** What R² and the largest R are high. */
const [SQUARE, RADIUS] = [30, 52];

/**
 * The ray and the centre in their plane.
 * @typedef {object} Plane
 * @property {number} A The square of the direction's length.
 * @property {number} along How far along the ray the centre is, as a length.
 * @property {number} beside How far from the ray.
 * @property {number} R
 */

/** An example, for a ray that was tested against no sphere. @type {Plane} */
const EXAMPLE = { A: 1, along: 4, beside: 0.4, R: 1 };

/** @param {import("./app.js").App} app */
export function sphereLesson(app) {
    const element = h("div");
    /** @type {string | null} */
    let chosen = null;
    /** @type {unknown} */
    let last = null;
    return { element, show };

    function show() {
        const tests = (app.selectedRay()?.candidates ?? []).filter((candidate) => numbersOf(candidate).kind === "Sphere");
        const candidate = tests.find(({ name }) => name === chosen) ?? tests.find(({ is_nearest }) => is_nearest) ?? tests[0];
        // What has been dragged stays while the ray does.
        if (element.hasChildNodes() && last === candidate) return;
        last = candidate;
        replace(element,
            h("p", {}, "A point of the ray is on the sphere where the distance to its centre is R. Squared, that is a parabola in t; its roots are where the ray enters and leaves. Drag the sphere off the ray, or behind its origin: the arrow keys do it, too."),
            tests.length > 1 && h("div", { class: "field" }, select(tests.slice(0, 60).map(({ name, verdict }) => [name, `${name}: ${verdict}`]), () => candidate.name, (name) => {
                chosen = name;
                show();
            }, "Tested sphere").element),
            display("A t² + 2 B t + C = 0,  t = ", frac(row("− B ±", sqrt("B² − A C")), "A")),
            section(candidate ? planeOf(candidate) : EXAMPLE),
            candidate ? [h("p", { class: "hint" }, "As the program has tested it:"), candidateTable(candidate)] : h("p", { class: "hint" }, "The selected ray was tested against no sphere; the picture above is an example."));
    }
}

/** @param {import("./protocol.js").Candidate} candidate @returns {Plane} */
function planeOf(candidate) {
    const { byName, inputs } = numbersOf(candidate);
    const [A, B, C] = ["A", "B", "C"].map((name) => Number(byName[name].f64));
    const R = Number(inputs.find(([name]) => name === "R")?.[1][0] ?? 1);
    const along = -B / Math.sqrt(A);
    return { A, along, beside: Math.sqrt(Math.max(0, C + R * R - along * along)), R };
}

/** @param {Plane} start */
function section({ A, along, beside, R }) {
    const scale = Math.min(RADIUS / R, 300 / (Math.abs(along) + 1.2 * R));
    const figure = svg("svg", { viewBox: "0 0 400 310", class: "figure", role: "slider", tabindex: "0", "aria-label": "The centre of the sphere", "aria-valuenow": 0 });
    // The slider says the same.
    const words = h("p", { class: "number centred" });
    const x = (/** @type {number} */ t) => ORIGIN + t * Math.sqrt(A) * scale;
    draggable(figure, {
        to: (_x, _y, right, down) => move(along + right / scale, beside - down / scale),
        by: (right, up) => move(along + (4 * right) / scale, beside + (4 * up) / scale),
    });

    /** @param {number} newAlong @param {number} newBeside */
    function move(newAlong, newBeside) {
        along = Math.max(-ORIGIN / scale, Math.min((400 - ORIGIN) / scale, newAlong));
        beside = Math.max(-RAY / scale, Math.min(RAY / scale, newBeside));
        draw();
    }

    function draw() {
        const [B, C] = [-along * Math.sqrt(A), along * along + beside * beside - R * R];
        const discriminant = B * B - A * C;
        const roots = discriminant >= 0 ? [-1, 1].map((sign) => (-B + sign * Math.sqrt(discriminant)) / A) : [];
        const first = roots.find((t) => t > 0);
        const f = (/** @type {number} */ t) => A * t * t + 2 * B * t + C;
        const y = (/** @type {number} */ t) => ZERO - (f(t) / (R * R)) * SQUARE;
        const times = Array.from({ length: 201 }, (_, i) => (2 * i - ORIGIN) / (Math.sqrt(A) * scale));
        const curve = times.filter((t) => y(t) >= TOP).map((t) => `${x(t).toFixed(1)},${y(t).toFixed(1)}`);
        const [cx, cy] = [x(along / Math.sqrt(A)), RAY - beside * scale];
        replace(figure,
            svg("circle", { cx, cy, r: Math.max(2, R * scale), class: "ball" }), svg("circle", { cx, cy, r: 5, class: "handle" }),
            svg("line", { x1: ORIGIN, x2: 392, y1: RAY, y2: RAY, class: "ray-line" }), svg("circle", { cx: ORIGIN, cy: RAY, r: 3, class: "origin" }), svg("text", { x: ORIGIN + 4, y: RAY + 16 }, "a"),
            svg("line", { x1: 0, x2: 400, y1: ZERO, y2: ZERO, class: "axis" }), svg("text", { x: 392, y: ZERO - 5, class: "end" }, "t"),
            svg("line", { x1: ORIGIN, x2: ORIGIN, y1: TOP, y2: 306, class: "grid" }), svg("text", { x: ORIGIN - 5, y: 304, class: "end" }, "t = 0"),
            svg("polyline", { points: curve.join(" "), class: "curve" }),
            roots.flatMap((t, i) => [
                svg("line", { x1: x(t), x2: x(t), y1: RAY, y2: ZERO, class: "stairs" }),
                [RAY, ZERO].map((cy) => svg("circle", { cx: x(t), cy, r: 4.5, class: t === first ? "hit" : "root" })),
                svg("text", { x: x(t) + (i === 0 ? -7 : 7), y: ZERO + 16, class: i === 0 ? "end" : "" }, short(t, 5))].flat()));
        words.textContent = `B² − A C = ${short(discriminant, 4)}: ${verdict(roots, first)}`;
        figure.setAttribute("aria-valuenow", along.toFixed(3));
        figure.setAttribute("aria-valuetext", `${short(along, 3)} along the ray, ${short(beside, 3)} beside it. ${words.textContent}`);
    }
    draw();
    return h("div", {}, figure, words);
}

/** @param {number[]} roots @param {number | undefined} first */
function verdict(roots, first) {
    if (roots.length === 0) return "no real root, the ray misses";
    if (first === undefined) return "both roots are behind the origin, the ray misses";
    return first === roots[0] ? `two roots, the nearer one counts: t = ${short(first, 6)}` : `the origin is in the sphere, the far root counts: t = ${short(first, 6)}`;
}
