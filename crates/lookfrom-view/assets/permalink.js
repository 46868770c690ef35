// The view, the pixel, the sample and the ray in the fragment of the page's address, so that a link shows the same.

import { SCENES_OWN } from "./state.js";

/** @typedef {import("./protocol.js").View} View */

const NUMBERS = ["min_contribution", "turn", "rotate_environment", "at", "exposure"];
const COUNTS = ["depth", "samples", "animation"];
const WORDS = ["integrator", "variant", "tonemap", "layer", "compare"];

/**
 * @param {View} view
 * @param {[number, number] | null} pixel
 * @param {number | null} sample
 * @param {number | null} ray
 */
export function fragment(view, pixel, sample, ray) {
    const parameters = new URLSearchParams();
    for (const [key, value] of Object.entries(view)) {
        if (value === SCENES_OWN[/** @type {keyof View} */ (key)] || value === null) continue;
        if (key === "camera" && view.camera) {
            const { lookfrom, lookat, up, fov } = view.camera;
            parameters.set("camera", [lookfrom, lookat, up].map((v) => v.map(rounded).join(",")).join("/") + (fov === null ? "" : `/${fov}`));
        } else if (key === "size") parameters.set("size", view.size?.join("x") ?? "");
        else parameters.set(key, String(value));
    }
    if (pixel) parameters.set("pixel", pixel.join(","));
    if (pixel && sample !== null) parameters.set("sample", String(sample));
    if (pixel && sample !== null && ray !== null) parameters.set("ray", String(ray));
    // Links stay readable.
    return parameters.toString().replaceAll("%2C", ",").replaceAll("%2F", "/");
}

/** Thirteen digits place the eye to a micrometre on a continent. @param {number} x */
const rounded = (x) => Number(x.toPrecision(13));

/** @param {number} x */
const isCount = (x) => Number.isInteger(x) && x >= 0;

/** @param {string} text @param {string} separator @param {number} length @param {(x: number) => boolean} [isPossible] */
function numbers(text, separator, length, isPossible = Number.isFinite) {
    const found = text.split(separator).map(Number);
    return found.length === length && found.every(isPossible) ? found : null;
}

/**
 * What a fragment says; parts that are not understood are left out.
 * @param {string} text
 */
export function parse(text) {
    const parameters = new URLSearchParams(text.replace(/^#/, ""));
    /** @type {(key: string) => number | null} */
    const index = (key) => (/^\d+$/.test(parameters.get(key) ?? "") ? Number(parameters.get(key)) : null);
    /** @type {Record<string, unknown>} */
    const view = { ...SCENES_OWN };
    for (const key of NUMBERS) {
        const value = parameters.get(key);
        if (value !== null && Number.isFinite(Number(value))) view[key] = Number(value);
    }
    for (const key of COUNTS) view[key] = index(key);
    for (const key of WORDS) if (parameters.has(key)) view[key] = parameters.get(key);
    if (parameters.has("denoise")) view.denoise = parameters.get("denoise") === "true";
    view.size = numbers(parameters.get("size") ?? "", "x", 2, isCount);
    const [lookfrom, lookat, up, fov] = (parameters.get("camera") ?? "").split("/");
    const vectors = [lookfrom, lookat, up].map((v) => numbers(v ?? "", ",", 3));
    if (vectors.every((v) => v !== null)) {
        view.camera = { lookfrom: vectors[0], lookat: vectors[1], up: vectors[2], fov: fov ? Number(fov) : null };
    }
    const pixel = /** @type {[number, number] | null} */ (numbers(parameters.get("pixel") ?? "", ",", 2, isCount));
    return { view: /** @type {View} */ (/** @type {unknown} */ (view)), pixel, sample: index("sample"), ray: index("ray") };
}

/**
 * Keeps the page's address up to date, and follows it when the user changes it.
 * @param {import("./app.js").App} app
 */
export function keepPermalink(app) {
    let timer = 0;
    const write = () => {
        clearTimeout(timer);
        // Browsers limit how often the address may change.
        timer = window.setTimeout(() => {
            const parts = [app.source.get(), fragment(app.view.get(), app.pixel.get(), app.sample.get(), app.ray.get())];
            const text = parts.filter((part) => part !== "").join("&");
            history.replaceState(null, "", text ? `#${text}` : location.pathname + location.search);
        }, 150);
    };
    app.view.on((_, moving) => void (moving || write()));
    for (const signal of [app.source, app.pixel, app.sample, app.ray]) signal.on(write);
    window.addEventListener("hashchange", () => {
        const { view, pixel, sample, ray } = parse(location.hash);
        app.view.set(view);
        app.pixel.set(pixel);
        if (sample !== null) app.sample.set(sample);
        if (ray !== null) app.ray.set(ray);
    });
}
