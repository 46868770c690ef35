// Formulas as MathML, from the way they are written in a line: `k_d Σ (N·L_j) I_j`, `frac(a, b)`.

import { append } from "./html.js";

const MATHML = "http://www.w3.org/1998/Math/MathML";

/** @typedef {Node | string} Part */

/**
 * @param {string} tag
 * @param {Record<string, string>} attributes
 * @param {...Part} children
 * @returns {Element}
 */
function m(tag, attributes, ...children) {
    const element = document.createElementNS(MATHML, tag);
    for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
    append(element, children);
    return element;
}

const TOKENS = /\s+|[A-Za-zα-ωΑ-ΡΤ-Ωη₁₂]+'?|\d+(?:\.\d+)?(?:e[-−]?\d+)?|./gu;
const SUPERSCRIPTS = /** @type {Record<string, string>} */ ({ "²": "2", "⁵": "5", ᵀ: "T", ⁿ: "n" });

/** @param {string} token */
function atom(token) {
    if (/^[\d]/.test(token)) return m("mn", {}, token);
    // One letter is a variable, in italics; a word stands upright.
    if (/^[\p{L}]/u.test(token)) return m("mi", token.length > 1 && !/^[A-Za-z][0-9₁₂]?$/.test(token) ? { mathvariant: "normal" } : {}, token);
    if (token === ",") return m("mo", { separator: "true", lspace: "0", rspace: "0.9em" }, token);
    return m("mo", /^[()[\]|]$/.test(token) ? { stretchy: "false" } : {}, token);
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
    for (let i = 0; i < tokens.length; i++) {
        if (tokens[i] === "_" && elements.length > 0) elements.push(m("msub", {}, /** @type {Element} */ (elements.pop()), atom(tokens[++i] ?? "")));
        else if (tokens[i] in SUPERSCRIPTS && elements.length > 0) elements.push(m("msup", {}, /** @type {Element} */ (elements.pop()), atom(SUPERSCRIPTS[tokens[i]])));
        else elements.push(atom(tokens[i]));
    }
    return elements;
}

/** Parts side by side, as one. @param {Part[]} parts */
export const row = (...parts) => m("mrow", {}, ...parts.flatMap((part) => (typeof part === "string" ? atoms(part) : [part])));

/** @param {Part} above @param {Part} below */
export const frac = (above, below) => m("mfrac", {}, row(above), row(below));

/** @param {Part} inside */
export const sqrt = (inside) => m("msqrt", {}, row(inside));

/** @param {readonly (readonly string[])[]} rows */
export const matrix = (rows) =>
    m("mtable", { class: "matrix" }, ...rows.map((cells) => m("mtr", {}, ...cells.map((cell) => m("mtd", {}, m("mn", {}, cell))))));

/**
 * A formula of strings and parts.
 * @param {...Part} parts
 */
export const formula = (...parts) => m("math", {}, row(...parts));

/**
 * A formula on a line of its own.
 * @param {...Part} parts
 */
export const display = (...parts) => m("math", { display: "block" }, row(...parts));
