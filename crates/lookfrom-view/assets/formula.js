// Formulas, from the way they are written in a line: `k_d Σ (N·L_j) I_j`, `frac(a, b)`.
//
// Elements of HTML, not of MathML: that needs a font with a table for mathematics, which few systems have; without one its
// roots do not meet their bars and its subscripts stand apart.

import { h } from "./html.js";

/** @typedef {Node | string} Part */

const TOKENS = /\s+|[A-Za-zα-ωΑ-ΡΤ-Ωη₁₂]+'?|\d+(?:\.\d+)?(?:e[-−]?\d+)?|./gu;
const SUPERSCRIPTS = /** @type {Record<string, string>} */ ({ "²": "2", "⁵": "5", ᵀ: "T", ⁿ: "n" });

/** @param {string} token */
function atom(token) {
    // One letter is a variable, in italics; a word and a number stand upright.
    if (/^\p{L}/u.test(token)) return token.length > 1 && !/^[A-Za-z][0-9₁₂]?$/.test(token) ? h("span", {}, token) : h("i", {}, token);
    if (token === ",") return h("span", { class: "comma" }, token);
    return h("span", { class: /^[+−±=·×<>≤≥]$/.test(token) ? "operator" : null }, token);
}

/**
 * The elements of a line; `_` joins a subscript.
 * @param {string} text
 * @returns {Element[]}
 */
function atoms(text) {
    const tokens = [...text.matchAll(TOKENS)].map(([token]) => token).filter((token) => token.trim() !== "");
    /** @type {Element[]} */
    const elements = [];
    // An index and an exponent stay beside what they belong to.
    const join = (/** @type {Element} */ script) => elements.push(h("span", { class: "joined" }, elements.pop(), script));
    for (let i = 0; i < tokens.length; i++) {
        if (tokens[i] === "_" && elements.length > 0) join(h("sub", {}, atom(tokens[++i] ?? "")));
        else if (tokens[i] in SUPERSCRIPTS && elements.length > 0) join(h("sup", {}, atom(SUPERSCRIPTS[tokens[i]])));
        else elements.push(atom(tokens[i]));
    }
    return elements;
}

/** Parts side by side, as one. @param {Part[]} parts */
export const row = (...parts) => h("span", {}, ...parts.flatMap((part) => (typeof part === "string" ? atoms(part) : [part])));

/** @param {Part} above @param {Part} below */
export const frac = (above, below) => h("span", { class: "frac" }, row(above), row(below));

/** @param {Part} inside */
export const sqrt = (inside) => h("span", { class: "root-of" }, "√", h("span", {}, row(inside)));

/** @param {readonly (readonly string[])[]} rows */
export const matrix = (rows) =>
    h("span", { class: "matrix" }, ...rows.map((cells) => h("span", {}, ...cells.map((cell) => h("span", {}, cell)))));

/**
 * The line of which an element is the drawing: fractions, roots and exponents, which a screen reader would read as letters side by side, by
 * signs that it knows.
 * @param {Node} node
 * @returns {string}
 */
function line(node) {
    if (!(node instanceof Element)) return node.textContent ?? "";
    const parts = [...node.childNodes].map(line);
    const name = node.getAttribute("class");
    if (name === "frac") return parts.map(enclosed).join(" / ");
    if (name === "root-of") return `√${enclosed(parts.slice(1).join(" "))}`;
    if (name === "matrix") return `[ ${[...node.children].map((cells) => [...cells.children].map(line).join(", ")).join("; ")} ]`;
    if (name === "joined") return parts.join("");
    if (node.tagName === "SUB") return `_${parts[0]}`;
    if (node.tagName === "SUP") return Object.keys(SUPERSCRIPTS).find((sign) => SUPERSCRIPTS[sign] === parts[0]) ?? "";
    return parts.join(" ");
}

/** @param {string} text */
const enclosed = (text) => (text.includes(" ") ? `( ${text} )` : text);

/**
 * A formula of strings and parts.
 * @param {...Part} parts
 */
export const formula = (...parts) => named(h("span", { class: "math", role: "math" }, row(...parts)));

/** @template {Element} T @param {T} element @returns {T} */
function named(element) {
    element.setAttribute("aria-label", line(element));
    return element;
}

/** What is wider than its place scrolls, by keys too. */
const widths = new ResizeObserver((entries) => {
    for (const { target } of entries) {
        if (target.scrollWidth > target.clientWidth) target.setAttribute("tabindex", "0");
        else target.removeAttribute("tabindex");
    }
});

/**
 * A formula on a line of its own.
 * @param {...Part} parts
 */
export function display(...parts) {
    const element = named(h("div", { class: "math", role: "math" }, row(...parts)));
    widths.observe(element);
    return element;
}
