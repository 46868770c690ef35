// The numbers of an intersection test, in f32 beside f64.

import { display, frac, row, sqrt } from "./formula.js";
import { h } from "./html.js";
import { exact, fileName } from "./format.js";

/** @typedef {import("./protocol.js").Candidate} Candidate */
/** @typedef {import("./protocol.js").Twice} Twice */

/**
 * The kind of a test with its numbers by their names in the lecture notes: `t`, not `t = D3/D`.
 * @param {Candidate} candidate
 */
export function numbersOf({ test }) {
    const [kind, { numbers: rows, inputs }] = /** @type {[string, import("../types/inspection.js").TestNumbers][]} */ (Object.entries(test))[0];
    /** @type {Record<string, Twice>} */
    const byName = {};
    for (const [name, value] of rows) byName[name.split(" ")[0]] = value;
    return { kind, rows, byName, inputs };
}

const FORMULAS = /** @type {Record<string, () => Element[]>} */ ({
    Triangle: () => [display("a + t (b − a) = P_0 + β (P_1 − P_0) + γ (P_2 − P_0)")],
    Sphere: () => [display("A t² + 2 B t + C = 0,  t = ", frac(row("− B ±", sqrt("B² − A C")), "A"))],
});

/** @param {Candidate} candidate */
export function candidateTable(candidate) {
    const { kind, rows, inputs } = numbersOf(candidate);
    return h("div", { class: `candidate ${candidate.is_nearest ? "nearest" : ""}` },
        h("p", { class: "verdict" }, h("strong", { title: candidate.name }, fileName(candidate.name)), h("span", {}, candidate.verdict)),
        rows.length > 0 && FORMULAS[kind]?.(),
        inputRows(inputs),
        rows.length > 0 && h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": `numbers of ${candidate.name}` },
            h("table", { class: "twice" },
                h("thead", {}, h("tr", {}, h("td"), ["f32", "f64", "bits"].map((name) => h("th", { scope: "col" }, name)))),
                h("tbody", {}, rows.map(([name, value]) =>
                    h("tr", {}, h("th", { scope: "row" }, name), h("td", {}, exact(value.f32)), h("td", {}, exact(value.f64)), h("td", { title: "leading bits that agree, of 24" }, bits(value.bits))))))));
}

/** The inputs of a test: points, radii. @param {[string, number[]][]} inputs */
function inputRows(inputs) {
    if (inputs.length === 0) return null;
    return h("table", { class: "terms inputs" }, h("tbody", {}, inputs.map(([name, value]) =>
        h("tr", {}, h("th", { scope: "row" }, name), h("td", { class: "number" }, value.length === 1 ? exact(value[0]) : `(${value.map(exact).join(", ")})`)))));
}

/** @param {number} n */
function bits(n) {
    const meter = h("meter", { min: 0, max: 24, value: n, low: 12, "aria-label": `${n} of 24 bits` });
    return h("span", { class: "bits" }, meter, String(n));
}
