// A ray and a triangle: α, β, γ as the areas that the point leaves, for a point that is dragged.

import { draggable } from "./drag.js";
import { display, frac } from "./formula.js";
import { h, replace, svg } from "./html.js";
import { candidateTable, numbersOf } from "./candidates.js";
import { select } from "./fields.js";
import { short } from "./format.js";

/** The corners P0, P1, P2 as drawn: areas have the same ratios in every triangle. */
const CORNERS = /** @type {const} */ ([[60, 200], [340, 200], [200, 30]]);

/** @param {import("./app.js").App} app */
export function triangleLesson(app) {
    const element = h("div");
    /** @type {string | null} */
    let chosen = null;
    return { element, show };

    function show() {
        const tests = (app.selectedRay()?.candidates ?? []).filter((candidate) => numbersOf(candidate).kind === "Triangle");
        const candidate = tests.find(({ name }) => name === chosen) ?? tests.find(({ is_nearest }) => is_nearest) ?? tests[0];
        const numbers = candidate ? numbersOf(candidate).byName : {};
        const start = /** @type {[number, number]} */ (candidate ? [Number(numbers["β"].f64), Number(numbers["γ"].f64)] : [0.25, 0.3]);
        const figure = areas(start);
        replace(element,
            h("p", {}, "Three equations, three unknowns; Cramer's rule gives β, γ and t. A hit has ", h("b", {}, "β ≥ 0, γ ≥ 0, β + γ ≤ 1"), ": then α, β, γ are the shares of the three areas."),
            tests.length > 1 && h("div", { class: "field" }, select(tests.slice(0, 60).map(({ name, verdict }) => [name, `${name}: ${verdict}`]), () => candidate.name, (name) => {
                chosen = name;
                show();
            }, "Tested triangle").element),
            figure,
            display("β = ", frac("D_1", "D"), ",  γ = ", frac("D_2", "D"), ",  t = ", frac("D_3", "D"), ",  α = 1 − β − γ"),
            candidate ? candidateTable(candidate) : h("p", { class: "hint" }, "The selected ray was tested against no triangle; the picture above is an example."));
    }
}

/** @param {[number, number]} start β and γ */
function areas(start) {
    let [beta, gamma] = start;
    const [p0, p1, p2] = CORNERS;
    const parts = ["alpha", "beta", "gamma"].map((name) => svg("polygon", { class: `area ${name}` }));
    const dot = svg("circle", { r: 6, class: "handle" });
    // The slider says the same.
    const words = h("p", { class: "number centred" });
    const picture = svg("svg", { viewBox: "0 0 400 240", class: "figure", role: "slider", tabindex: "0", "aria-label": "The point in the triangle", "aria-valuenow": 0 },
        parts, svg("polygon", { points: CORNERS.map(String).join(" "), class: "outline" }), dot,
        svg("text", { x: p0[0] - 24, y: p0[1] + 14 }, "P₀"), svg("text", { x: p1[0] + 8, y: p1[1] + 14 }, "P₁"), svg("text", { x: p2[0] - 6, y: p2[1] - 10 }, "P₂"));

    function show() {
        // A miss far outside is drawn at the edge of the figure.
        const alpha = 1 - beta - gamma;
        const x = Math.max(8, Math.min(392, alpha * p0[0] + beta * p1[0] + gamma * p2[0]));
        const y = Math.max(8, Math.min(232, alpha * p0[1] + beta * p1[1] + gamma * p2[1]));
        const inside = beta >= 0 && gamma >= 0 && beta + gamma <= 1;
        [[p1, p2], [p0, p2], [p0, p1]].forEach(([a, b], i) => parts[i].setAttribute("points", `${x},${y} ${a} ${b}`));
        dot.setAttribute("cx", String(x));
        dot.setAttribute("cy", String(y));
        picture.classList.toggle("miss", !inside);
        picture.setAttribute("aria-valuenow", beta.toFixed(3));
        const verdict = inside ? "hit" : beta < 0 ? "miss: β < 0" : gamma < 0 ? "miss: γ < 0" : "miss: β + γ > 1";
        replace(words, h("span", { class: "alpha" }, `α ${short(alpha, 4)}`), " + ", h("span", { class: "beta" }, `β ${short(beta, 4)}`), " + ", h("span", { class: "gamma" }, `γ ${short(gamma, 4)}`), ` = 1 · ${verdict}`);
        picture.setAttribute("aria-valuetext", words.textContent ?? "");
    }
    draggable(picture, {
        to(x, y) {
            gamma = (y - p0[1]) / (p2[1] - p0[1]);
            beta = (x - p0[0] - gamma * (p2[0] - p0[0])) / (p1[0] - p0[0]);
            show();
        },
        by(right, up) {
            [beta, gamma] = [beta + 0.02 * right - 0.01 * up, gamma + 0.02 * up];
            show();
        },
    });
    show();
    return h("div", {}, picture, words);
}
