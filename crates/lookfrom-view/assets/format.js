// Numbers, vectors and colours as text, and colours as swatches.

import { h } from "./html.js";

/**
 * A number of at most `digits` digits, for reading. `exact` is for comparing.
 * @param {number | string | null | undefined} number JSON has infinities and NaN as strings.
 * @param {number} [digits]
 */
export function short(number, digits = 5) {
    if (number === null || number === undefined) return "–";
    const x = Number(number);
    if (!Number.isFinite(x)) return Number.isNaN(x) ? "NaN" : x > 0 ? "∞" : "−∞";
    if (x === 0) return "0";
    const size = Math.abs(x);
    const text = size >= 1e6 || size < 1e-4 ? x.toExponential(digits - 2) : String(Number(x.toPrecision(digits)));
    return text.replace("-", "−").replace(/e\+?([-−]?)(\d+)$/, (_, sign, power) => `e${sign && "−"}${power}`);
}

/**
 * A number with all of its digits, as in the JSON of `lookfrom inspect`.
 * @param {number | string | null | undefined} x
 */
export const exact = (x) => (x === null || x === undefined ? "–" : String(x));

/** The fewest digits that name an f32. @param {number} x */
export function single(x) {
    for (let digits = 6; digits < 10; digits++) {
        const value = Number(x.toPrecision(digits));
        if (Math.fround(value) === Math.fround(x)) return String(value);
    }
    return String(x);
}

/**
 * @param {readonly number[] | null | undefined} v
 * @param {number} [digits]
 */
export const point = (v, digits = 5) => (v ? `(${v.map((x) => short(x, digits)).join(", ")})` : "–");

/**
 * @param {readonly number[] | number | null | undefined} v
 * @param {number} [digits]
 */
export const lanes = (v, digits = 4) =>
    v === null || v === undefined ? "–" : typeof v === "number" ? short(v, digits) : `[${v.map((x) => short(x, digits)).join(" ")}]`;

/** @param {readonly number[]} rgb linear, Rec. 709 */
export const luminance = (rgb) => (rgb.length === 3 ? 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2] : mean(rgb));

/** @param {readonly number[]} v */
const mean = (v) => v.reduce((sum, x) => sum + x, 0) / Math.max(v.length, 1);

/** @param {number} x linear */
const encoded = (x) => Math.round(255 * (x <= 0.0031308 ? 12.92 * Math.max(x, 0) : 1.055 * Math.min(x, 1) ** (1 / 2.4) - 0.055));

/** @param {readonly number[]} rgb linear */
export const css = (rgb) => `rgb(${rgb.slice(0, 3).map(encoded).join(" ")})`;

/**
 * A small square of a linear colour; those brighter than white keep their hue.
 * @param {readonly number[]} rgb
 */
export function swatch(rgb) {
    const element = h("span", { class: "swatch", "aria-hidden": "true" });
    element.style.backgroundColor = css(rgb.map((x) => x / Math.max(1, ...rgb)));
    return element;
}

/** A name without the folders of the files in it. @param {string} name */
export const fileName = (name) => name.replace(/[^\s(]*[/\\](?=[^\s/\\])/g, "");

/** @param {number} seconds */
export const duration = (seconds) =>
    seconds < 1 ? `${Math.round(seconds * 1000)} ms` : seconds < 60 ? `${seconds.toFixed(1)} s` : `${Math.floor(seconds / 60)} min ${Math.round(seconds % 60)} s`;

/** @param {number} n */
export const count = (n) =>
    n >= 1e9 ? `${(n / 1e9).toFixed(1)} G` : n >= 1e6 ? `${(n / 1e6).toFixed(1)} M` : n >= 1e4 ? `${(n / 1e3).toFixed(0)} k` : String(Math.round(n));

/** A number of things: "1 node", "2 nodes", "2 boxes". @param {number} n @param {string} noun */
export const counted = (n, noun) => `${n} ${n === 1 ? noun : noun.endsWith("x") ? `${noun}es` : `${noun}s`}`;
