// The settings of the picture: those that develop it above it, those that render it anew in the panel "View".

import { byId, h, replace } from "./html.js";
import { field, number, select, slider } from "./fields.js";
import { MOST_PIXELS, fitted } from "./fit.js";
import { count, counted } from "./format.js";

/** @typedef {import("./app.js").App} App */
/** @typedef {import("./protocol.js").Scene} Scene */
/** @typedef {import("./protocol.js").View} View */

const COMPARISONS = /** @type {const} */ ([
    ["", "Picture"],
    ["wipe", "Wipe"],
    ["reference", "Reference"],
    ["difference", "Difference"],
    ["flip", "FLIP"],
    ["z", "z-score"],
]);

/** The limits of the server. */
const [MOST_DEPTH, MOST_SAMPLES] = [256, 2 ** 24];

/** @param {App} app */
export function showSettings(app) {
    const rebuild = () => {
        const scene = app.scene.get();
        if (!scene) return;
        // What is being typed into is not replaced.
        const active = document.activeElement;
        if (!(active instanceof HTMLElement && active.closest("#development") && active.matches("input"))) showDevelopment(app, scene);
        if (!(active instanceof HTMLElement && active.closest("#settings") && active.matches("input"))) showRendering(app, scene);
    };
    app.scene.on(rebuild);
    app.view.on((_, moving) => void (moving || rebuild()));
    // Time and turntable move the camera of the scene.
    let shown = "";
    app.frame.on(() => {
        const [scene, group, camera] = [app.scene.get(), document.getElementById("camera-group"), JSON.stringify(app.camera())];
        if (!scene || !group || camera === shown || group.contains(document.activeElement)) return;
        shown = camera;
        group.replaceWith(cameraGroup(app, scene));
    });
}

/** @param {App} app @param {Scene} scene */
function showDevelopment(app, scene) {
    const view = app.view.get();
    const focused = focusedName("development");
    const exposure = slider(
        "Exposure",
        { min: -10, max: 10, step: 0.1 },
        view.exposure ?? scene.exposure,
        (value) => app.view.set({ exposure: value }),
        (value) => `${value > 0 ? "+" : value < 0 ? "−" : ""}${Math.abs(value).toFixed(1)}`,
    );
    const denoise = h("input", { type: "checkbox", checked: view.denoise ?? scene.denoise });
    denoise.addEventListener("change", () => app.view.set({ denoise: denoise.checked }));
    const rays = h("input", { type: "checkbox", checked: app.raysOverPicture.get() });
    rays.addEventListener("change", () => app.raysOverPicture.set(rays.checked));
    replace(
        byId("development"),
        select(scene.layers.map(({ name, title }) => [name, title]), view.layer, (layer) => app.view.set({ layer }), "Layer"),
        scene.reference !== null &&
            select(COMPARISONS, view.compare ?? "", (compare) => app.view.set({ compare: /** @type {View["compare"]} */ (compare || null) }), "Comparison with the reference"),
        exposure.element,
        select(scene.tonemaps.map((name) => [name, name]), view.tonemap ?? scene.tonemap, (tonemap) => app.view.set({ tonemap }), "Tone map"),
        h("label", { class: "check" }, denoise, "Denoise"),
        h("label", { class: "check", title: "The selected sample's rays over the picture" }, rays, "Rays"),
    );
    refocus("development", focused);
}

/** The accessible name of the focused control, which survives rebuilding. @param {string} id */
function focusedName(id) {
    const active = document.activeElement;
    if (!(active instanceof HTMLElement) || !byId(id).contains(active)) return null;
    return [...byId(id).querySelectorAll("input, select, button")].indexOf(active);
}

/** @param {string} id @param {number | null} index */
function refocus(id, index) {
    if (index === null || index < 0) return;
    const control = byId(id).querySelectorAll("input, select, button")[index];
    if (control instanceof HTMLElement) control.focus();
}

/** @param {App} app @param {Scene} scene */
function showRendering(app, scene) {
    const view = app.view.get();
    const focused = focusedName("settings");
    /** @param {Partial<View>} change */
    const set = (change) => app.view.set(change);
    const sizes = sizesOf(scene, view.size ?? scene.size);
    const chosen = view.animation ?? scene.animation;
    const animation = chosen === null ? null : scene.animations[chosen];
    // Expressions have no end: ten seconds of them.
    const seconds = animation ? animation.seconds : scene.duration === 0 ? 10 : scene.duration;
    replace(
        byId("settings"),
        group(
            "Light transport",
            field("Integrator", select(scene.integrators.map((name) => [name, name]), view.integrator ?? scene.integrator, (integrator) => set({ integrator }))),
            field("Depth", number(view.depth, { min: 0, max: MOST_DEPTH, step: 1, placeholder: String(scene.depth) }, (depth) => set({ depth })), "Bounces at most"),
            field("Samples", number(view.samples, { min: 1, max: MOST_SAMPLES, step: 1, placeholder: String(scene.samples) }, (samples) => set({ samples })), "Samples per pixel"),
            field("Min. contribution", number(view.min_contribution, { min: 0, max: 1, placeholder: String(scene.min_contribution) }, (min_contribution) => set({ min_contribution })), "Branches of Whitted's tree with a smaller share are not followed"),
            field("Size", select(sizes, (view.size ?? scene.size).join("x"), (text) => set({ size: text === scene.size.join("x") ? null : /** @type {[number, number]} */ (text.split("x").map(Number)) }))),
        ),
        group(
            "Scene",
            scene.variants.length > 0 && field("Variant", select([["", "the file's own"], .../** @type {[string, string][]} */ (scene.variants.map((name) => [name, name]))], view.variant ?? scene.variant ?? "", (variant) => set({ variant: variant || null }))),
            scene.animations.length > 0 &&
                field("Animation", select([["", "none"], .../** @type {[string, string][]} */ (scene.animations.map(({ name }, i) => [String(i), name || `animation ${i}`]))], chosen === null ? "" : String(chosen), (text) => set({ animation: text === "" ? null : Number(text), at: text === "" ? null : 0 }))),
            seconds !== null && slider("Time", { min: 0, max: seconds, step: seconds / 200 }, view.at ?? scene.at ?? 0, (at) => set({ at }), (at) => `${at.toFixed(2)} s`).element,
            scene.turntable && slider("Turntable", { min: 0, max: 360, step: 1 }, view.turn ?? scene.turn ?? 0, (turn) => set({ turn }), (turn) => `${turn}°`).element,
            slider("Surroundings", { min: -180, max: 180, step: 1 }, view.rotate_environment ?? scene.rotate_environment ?? 0, (rotate_environment) => set({ rotate_environment }), (turn) => `${turn}°`).element,
        ),
        cameraGroup(app, scene),
        group(
            "Contents",
            h("dl", { class: "facts" }, Object.entries(scene.counts ?? {}).flatMap(([name, n]) => [h("dt", {}, name), h("dd", {}, contents(n))])),
            scene.warnings.length > 0 && h("details", { class: "warnings" }, h("summary", {}, counted(scene.warnings.length, "warning")), h("ul", {}, scene.warnings.map((warning) => h("li", {}, warning)))),
        ),
    );
    refocus("settings", focused);
}

/**
 * The sizes to choose from: the scene's, parts of it, twice it, that of the window, and the one that is chosen.
 * @param {Scene} scene
 * @param {readonly [number, number]} chosen
 * @returns {[value: string, title: string][]}
 */
function sizesOf(scene, chosen) {
    const [width, height] = scene.size;
    /** @type {(part: number) => [number, number]} */
    const scaled = (part) => [Math.max(1, Math.round(width * part)), Math.max(1, Math.round(height * part))];
    const named = /** @type {[[number, number], string][]} */ ([
        [scaled(1), ", the scene's"], [scaled(0.5), ""], [scaled(0.25), ""], [scaled(2), ", 2 ×"], [fitted(scene.size), ", fits the window"], [[...chosen], ""],
    ]);
    const sizes = new Map(named.filter(([[x, y]]) => x * y <= MOST_PIXELS).reverse().map(([size, name]) => [size.join("x"), size.join(" × ") + name]));
    return [...sizes].reverse();
}

/** A count, or counts by kind. @param {import("./protocol.js").Count} n @returns {string} */
function contents(n) {
    if (typeof n === "number") return count(n);
    if (Array.isArray(n)) return String(n.length);
    return Object.entries(n ?? {}).map(([kind, n]) => `${contents(n)} ${kind}`).join(", ") || "0";
}

/** @param {App} app @param {Scene} scene */
function cameraGroup(app, scene) {
    const camera = app.camera() ?? scene.camera;
    /** @param {"lookfrom" | "lookat" | "up"} name */
    const vector = (name) =>
        h("div", { class: "field vector", role: "group", "aria-label": name }, h("span", { class: "label" }, name),
            camera[name].map((x, i) => {
                const input = number(Number(x.toPrecision(6)), {}, (value) => {
                    const changed = /** @type {import("./protocol.js").Vector} */ (camera[name].map((old, k) => (k === i ? value ?? 0 : old)));
                    app.view.set({ camera: { lookfrom: camera.lookfrom, lookat: camera.lookat, up: camera.up, fov: camera.fov, [name]: changed } });
                });
                input.setAttribute("aria-label", `${name} ${"xyz"[i]}`);
                return input;
            }));
    const fov = camera.fov !== null && field("fov", number(Number(camera.fov.toPrecision(6)), { min: 1, max: 179 }, (value) =>
        app.view.set({ camera: value === null ? null : { lookfrom: camera.lookfrom, lookat: camera.lookat, up: camera.up, fov: value } })), "Vertical field of view, degrees");
    const element = group("Camera", vector("lookfrom"), vector("lookat"), vector("up"), fov, h("button", { type: "button", onclick: () => app.view.set({ camera: null }) }, "The scene's own camera"));
    element.id = "camera-group";
    return element;
}

/** @param {string} title @param {...(import("./html.js").Child | import("./html.js").Child[])} children */
const group = (title, ...children) => h("section", { class: "group" }, h("h3", {}, title), ...children);
