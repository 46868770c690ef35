// The settings of the picture: those that develop it above it, those that render it anew in the panel "View".

import { append, byId, h, replace } from "./html.js";
import { check, choices, field, number, select, slider } from "./fields.js";
import { MOST_PIXELS, fitted } from "./fit.js";
import { count, counted } from "./format.js";

/** @typedef {import("./app.js").App} App */
/** @typedef {import("./fields.js").Control} Control */
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
    /** @type {Control[]} */
    let groups = [];
    app.scene.on((scene) => {
        if (!scene) return;
        groups = [development(app, scene), rendering(app, scene)];
        replace(byId("development"), ...groups[0].element.childNodes);
        replace(byId("settings"), ...groups[1].element.childNodes);
    });
    // Controls stay: one that has the focus keeps it, and what is being typed into it.
    const show = () => groups.forEach((group) => group.show());
    app.view.on((_, moving) => void (moving || show()));
    // Time and turntable move the camera of the scene.
    app.frame.on(show);
}

/** @param {App} app @param {Scene} scene */
function development(app, scene) {
    const { get, set } = app.view;
    return together(h("div"),
        select(scene.layers.map(({ name, title }) => [name, title]), () => get().layer, (layer) => set({ layer }), "Layer"),
        scene.reference !== null &&
            select(COMPARISONS, () => get().compare ?? "", (compare) => set({ compare: /** @type {View["compare"]} */ (compare || null) }), "Comparison with the reference"),
        slider(
            "Exposure",
            { min: -10, max: 10, step: 0.1 },
            () => get().exposure ?? scene.exposure,
            (exposure) => set({ exposure }),
            (value) => `${value > 0 ? "+" : value < 0 ? "−" : ""}${Math.abs(value).toFixed(1)}`,
        ),
        select(scene.tonemaps.map((name) => [name, name]), () => get().tonemap ?? scene.tonemap, (tonemap) => set({ tonemap }), "Tone map"),
        check("Denoise", () => get().denoise ?? scene.denoise, (denoise) => set({ denoise })),
        check("Rays", app.raysOverPicture.get, app.raysOverPicture.set, "The selected sample's rays over the picture"),
    );
}

/** @param {App} app @param {Scene} scene */
function rendering(app, scene) {
    const { get, set } = app.view;
    return together(h("div"),
        group(
            "Light transport",
            field("Integrator", select(scene.integrators.map((name) => [name, name]), () => get().integrator ?? scene.integrator, (integrator) => set({ integrator }))),
            field("Depth", number(() => get().depth, { min: 0, max: MOST_DEPTH, step: 1, placeholder: String(scene.depth) }, (depth) => set({ depth })), "Bounces at most"),
            field("Samples", number(() => get().samples, { min: 1, max: MOST_SAMPLES, step: 1, placeholder: String(scene.samples) }, (samples) => set({ samples })), "Samples per pixel"),
            field("Min. contribution", number(() => get().min_contribution, { min: 0, max: 1, placeholder: String(scene.min_contribution) }, (min_contribution) => set({ min_contribution })), "Branches of Whitted's tree that carry less are not followed"),
            field("Size", sizes(app, scene)),
        ),
        group(
            "Scene",
            scene.variants.length > 0 && field("Variant", select([["", "the file's own"], .../** @type {[string, string][]} */ (scene.variants.map((name) => [name, name]))], () => get().variant ?? scene.variant ?? "", (variant) => set({ variant: variant || null }))),
            scene.animations.length > 0 &&
                field("Animation", select([["", "none"], .../** @type {[string, string][]} */ (scene.animations.map(({ name }, i) => [String(i), name || `animation ${i}`]))], () => String(get().animation ?? scene.animation ?? ""), (text) => set({ animation: text === "" ? null : Number(text), at: text === "" ? null : 0 }))),
            time(app, scene),
            scene.turntable && slider("Turntable", { min: 0, max: 360, step: 1 }, () => get().turn ?? scene.turn ?? 0, (turn) => set({ turn }), (turn) => `${turn}°`),
            slider("Surroundings", { min: -180, max: 180, step: 1 }, () => get().rotate_environment ?? scene.rotate_environment ?? 0, (rotate_environment) => set({ rotate_environment }), (turn) => `${turn}°`),
        ),
        camera(app, scene),
        group(
            "Contents",
            h("dl", { class: "facts" }, Object.entries(scene.counts ?? {}).flatMap(([name, n]) => [h("dt", {}, name), h("dd", {}, contents(n))])),
            scene.warnings.length > 0 && h("details", { class: "warnings" }, h("summary", {}, counted(scene.warnings.length, "warning")), h("ul", {}, scene.warnings.map((warning) => h("li", {}, warning)))),
        ),
    );
}

/** The time of an animation, as long as the chosen one, or of expressions. @param {App} app @param {Scene} scene @returns {Control} */
function time(app, scene) {
    const element = h("div");
    let last = /** @type {number | null} */ (null);
    /** @type {Control | null} */
    let shown = null;
    function show() {
        const chosen = app.view.get().animation ?? scene.animation;
        const animation = chosen === null ? null : scene.animations[chosen];
        // Expressions have no end: ten seconds of them.
        const seconds = animation ? animation.seconds : scene.duration === 0 ? 10 : scene.duration;
        if (seconds === last) return shown?.show();
        last = seconds;
        shown = seconds === null ? null : slider("Time", { min: 0, max: seconds, step: seconds / 200 }, () => app.view.get().at ?? scene.at ?? 0, (at) => app.view.set({ at }), (at) => `${at.toFixed(2)} s`);
        replace(element, shown?.element);
    }
    show();
    return { element, show };
}

/** The sizes, which the window and the view change. @param {App} app @param {Scene} scene @returns {Control} */
function sizes(app, scene) {
    const size = () => app.view.get().size ?? scene.size;
    const choice = select([], () => size().join("x"), (text) => app.view.set({ size: text === scene.size.join("x") ? null : /** @type {[number, number]} */ (text.split("x").map(Number)) }));
    let last = "";
    function show() {
        const options = sizesOf(scene, size());
        if (last !== JSON.stringify(options)) replace(choice.element, choices(options));
        last = JSON.stringify(options);
        choice.show();
    }
    show();
    return { element: choice.element, show };
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
function camera(app, scene) {
    const shown = () => app.camera() ?? scene.camera;
    const rounded = (/** @type {number} */ x) => Number(x.toPrecision(6));
    /** @param {Partial<import("./protocol.js").Camera>} change */
    const move = (change) => {
        const { lookfrom, lookat, up, fov } = shown();
        app.view.set({ camera: { lookfrom, lookat, up, fov, ...change } });
    };
    /** @param {"lookfrom" | "lookat" | "up"} name */
    const vector = (name) => together(h("div", { class: "field vector", role: "group", "aria-label": name }, h("span", { class: "label" }, name)),
        ...[0, 1, 2].map((i) => number(() => rounded(shown()[name][i]), { name: `${name} ${"xyz"[i]}` }, (value) =>
            move({ [name]: shown()[name].map((old, k) => (k === i ? value ?? 0 : old)) }))));
    return group("Camera", vector("lookfrom"), vector("lookat"), vector("up"),
        scene.camera.fov !== null && field("fov", number(() => rounded(shown().fov ?? 0), { min: 1, max: 179 }, (fov) => (fov === null ? app.view.set({ camera: null }) : move({ fov }))), "Vertical field of view, degrees"),
        h("button", { type: "button", onclick: () => app.view.set({ camera: null }) }, "The scene's own camera"));
}

/** @typedef {Control | Node | false} Part */

/** @param {string} title @param {...Part} parts */
const group = (title, ...parts) => together(h("section", { class: "group" }, h("h3", {}, title)), ...parts);

/** Controls and other elements within one, which show together. @param {HTMLElement} element @param {...Part} parts @returns {Control} */
function together(element, ...parts) {
    const controls = /** @type {Control[]} */ (parts.filter((part) => part && !(part instanceof Node)));
    append(element, parts.map((part) => (part && !(part instanceof Node) ? part.element : part)));
    return { element, show: () => controls.forEach((control) => control.show()) };
}
