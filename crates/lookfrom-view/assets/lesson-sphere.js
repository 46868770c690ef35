// A ray and a sphere: the parabola with its roots, and what f32 loses where the sphere is small or far.

import { display, frac, row, sqrt } from "./formula.js";
import { h, replace, svg } from "./html.js";
import { candidateTable, numbersOf } from "./candidates.js";
import { select, slider } from "./fields.js";
import { exact, short, single } from "./format.js";

/** @typedef {{A: number, B: number, C: number}} Quadratic */

/** @param {import("./app.js").App} app */
export function sphereLesson(app) {
    const element = h("div");
    /** @type {string | null} */
    let chosen = null;
    const far = farSphere();
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
            candidate ? candidateTable(candidate) : h("p", { class: "hint" }, "The selected ray was tested against no sphere; the picture above is an example."),
            h("h4", {}, "The numerical trap"),
            h("p", {}, "Move a sphere of radius 1 away, and watch f32 lose the digits of B² − A C, which subtracts two numbers that grow alike. Δ, from the distance between centre and line, does not."),
            far);
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

/** f32 beside f64 for a sphere that moves away. */
function farSphere() {
    const body = h("tbody");
    const control = slider("Distance", { min: 0, max: 7, step: 0.1 }, 3, show, (power) => short(10 ** power, 3));
    /** @param {number} power */
    function show(power) {
        const f = Math.fround;
        // The ray passes the centre at 0.6: the true Δ is 1 − 0.36.
        const [d, offset] = [f(10 ** power + 1), f(0.6)];
        const exactOffset = offset * offset;
        const [b32, c32] = [f(-d), f(f(f(d * d) + f(offset * offset)) - 1)];
        const [b64, c64] = [-d, d * d + exactOffset - 1];
        const rows = /** @type {[string, number, number][]} */ ([
            ["B²", f(b32 * b32), b64 * b64],
            ["A C", c32, c64],
            ["B² − A C", f(f(b32 * b32) - c32), b64 * b64 - c64],
            ["Δ (stable)", f(1 - f(offset * offset)), 1 - exactOffset],
            ["t, textbook", f(f(-b32) - f(Math.sqrt(f(f(b32 * b32) - c32)))), -b64 - Math.sqrt(b64 * b64 - c64)],
            ["t = C/q", f(c32 / f(-b32 + f(Math.sqrt(f(1 - f(offset * offset)))))), c64 / (-b64 + Math.sqrt(1 - exactOffset))],
        ]);
        replace(body, rows.map(([name, f32, f64]) => h("tr", { class: Math.abs(f32 - f64) > 0.01 * Math.abs(f64) || Number.isNaN(f32) ? "lost" : "" }, h("th", { scope: "row" }, name), h("td", {}, single(f32)), h("td", {}, exact(f64)))));
    }
    show(3);
    return h("div", {}, control.element, h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "f32 beside f64" }, h("table", { class: "twice" }, h("thead", {}, h("tr", {}, ["", "f32", "f64"].map((name) => h("th", { scope: "col" }, name)))), body)));
}
