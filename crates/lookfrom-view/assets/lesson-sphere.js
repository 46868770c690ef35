// A ray and a sphere: the parabola with its roots, and what f32 loses where the sphere is small or far.

import { display, frac, row, sqrt } from "./formula.js";
import { h, replace, svg } from "./html.js";
import { candidateTable, numbersOf } from "./candidates.js";
import { select } from "./fields.js";
import { short } from "./format.js";

/** @typedef {{A: number, B: number, C: number}} Quadratic */

/** @param {import("./app.js").App} app */
export function sphereLesson(app) {
    const element = h("div");
    /** @type {string | null} */
    let chosen = null;
    return { element, show };

    function show() {
        const tests = (app.selectedRay()?.candidates ?? []).filter((candidate) => numbersOf(candidate).kind === "Sphere");
        const candidate = tests.find(({ name }) => name === chosen) ?? tests.find(({ is_nearest }) => is_nearest) ?? tests[0];
        const { byName } = candidate ? numbersOf(candidate) : { byName: null };
        const quadratic = byName ? { A: Number(byName.A.f64), B: Number(byName.B.f64), C: Number(byName.C.f64) } : { A: 1, B: -4, C: 15 };
        replace(element,
            h("p", {}, "A point of the ray is on the sphere where the distance to its centre is R. Squared, that is a parabola in t; its roots are where the ray enters and leaves."),
            tests.length > 1 && h("div", { class: "field" }, select(tests.slice(0, 60).map(({ name, verdict }) => [name, `${name}: ${verdict}`]), candidate.name, (name) => {
                chosen = name;
                show();
            }, "Tested sphere")),
            display("A t² + 2 B t + C = 0,  t = ", frac(row("− B ±", sqrt("B² − A C")), "A")),
            parabola(quadratic),
            candidate ? candidateTable(candidate) : h("p", { class: "hint" }, "The selected ray was tested against no sphere; the picture above is an example."));
    }
}

/** @param {Quadratic} quadratic */
function parabola({ A, B, C }) {
    const discriminant = B * B - A * C;
    const vertex = -B / A;
    const half = discriminant > 0 ? Math.sqrt(discriminant) / A : Math.sqrt(-discriminant) / A || 1;
    const roots = discriminant >= 0 ? [vertex - half, vertex + half] : [];
    const [low, high] = [Math.min(0, vertex - 2.2 * half), Math.max(vertex + 2.2 * half, 0.2 * half)];
    const f = (/** @type {number} */ t) => A * t * t + 2 * B * t + C;
    const [bottom, top] = [Math.min(0, f(vertex)) - 0.2 * A * half * half, f(vertex + 2.2 * half)];
    const x = (/** @type {number} */ t) => 10 + ((t - low) / (high - low)) * 380;
    const y = (/** @type {number} */ value) => 150 - ((value - bottom) / (top - bottom)) * 140;
    const line = Array.from({ length: 121 }, (_, i) => low + ((high - low) * i) / 120).filter((t) => f(t) <= top * 1.01).map((t) => `${x(t).toFixed(1)},${y(f(t)).toFixed(1)}`);
    return h("div", {},
        svg("svg", { viewBox: "0 0 400 160", class: "figure", role: "img", "aria-label": roots.length ? `Parabola with the roots ${roots.map((t) => short(t)).join(" and ")}` : "Parabola without a root" },
            svg("line", { x1: 0, x2: 400, y1: y(0), y2: y(0), class: "axis" }), svg("text", { x: 392, y: y(0) - 5, class: "end" }, "t"),
            svg("line", { x1: x(0), x2: x(0), y1: 0, y2: 160, class: "grid" }), svg("text", { x: x(0) + 4, y: 156 }, "t = 0: the origin"),
            svg("polyline", { points: line.join(" "), class: "curve" }),
            roots.map((t, i) => [svg("circle", { cx: x(t), cy: y(0), r: 5, class: t > 0 && (i === 0 || roots[0] <= 0) ? "handle" : "root" }),
                svg("text", { x: x(t) + (i === 0 ? -7 : 7), y: y(0) + 16, class: i === 0 ? "end" : "" }, short(t, 5))]).flat()),
        h("p", { class: "number centred" }, roots.length ? `two roots; the nearest in front is ${short(roots.find((t) => t > 0) ?? NaN, 6)}` : "no real root: the ray misses"));
}
