// The numerical trap of the quadratic: what f32 loses where the sphere is small or far, and what the rationalised numerator keeps.

import { slider } from "./fields.js";
import { display, frac, row, sqrt } from "./formula.js";
import { exact, short, single } from "./format.js";
import { h, replace } from "./html.js";

export function trapLesson() {
    const element = h("div", {},
        h("p", {}, "Drag a sphere of radius 1 away, and watch f32 lose the digits of B² − A C, which subtracts two numbers that grow alike. Δ, from the distance between centre and line, does not."),
        farSphere(),
        h("p", {}, "The textbook's numerator loses digits, too, where it subtracts B from a root that is nearly B. Rationalised, it adds:"),
        display("q = − ( B + sign(B) ", sqrt("Δ"), " ),  t_1 = ", frac("q", "A"), ",  t_2 = ", frac(row("C"), "q")));
    return { element, show() {} };
}

/** f32 beside f64 for a sphere that moves away. */
function farSphere() {
    const body = h("tbody");
    let power = 3;
    const control = slider("Distance", { min: 0, max: 7, step: 0.1 }, () => power, (value) => ((power = value), show()), () => short(10 ** power, 3));
    function show() {
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
    show();
    return h("div", {}, control.element, h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "f32 beside f64" }, h("table", { class: "twice" }, h("thead", {}, h("tr", {}, h("td"), ["f32", "f64"].map((name) => h("th", { scope: "col" }, name)))), body)));
}
