// The size of a picture that has a pixel for each of the screen: chosen at the start unless a link or the command line says one, and kept
// when the window changes.

import { byId } from "./html.js";

/** The most pixels of a view, as the server has it. */
export const MOST_PIXELS = 3840 * 2160;

/**
 * The largest size of this shape in the picture's place.
 * @param {readonly [number, number]} shape
 * @returns {[number, number]}
 */
export function fitted([width, height]) {
    const stage = byId("picture-overlay").getBoundingClientRect();
    const ratio = window.devicePixelRatio || 1;
    const scale = Math.min((stage.width * ratio) / width, (stage.height * ratio) / height, Math.sqrt(MOST_PIXELS / (width * height)));
    return [Math.max(1, Math.floor(width * scale)), Math.max(1, Math.floor(height * scale))];
}

/** @param {import("./app.js").App} app */
export function keepFitting(app) {
    /** The size that fitted last: views of this size follow. @type {string | null} */
    let before = null;
    /** Width over height of the scene. */
    let shape = 0;
    let timer = 0;

    /** Gives views the size that fits now. That is no step to undo, and no step leads back from it. @param {import("./protocol.js").Scene} scene @param {boolean} isForAll */
    function fit(scene, isForAll) {
        const [size, last] = [fitted(scene.size), before];
        before = size.join("x");
        if (isForAll || before !== last) app.view.revise((view) => (isForAll || view.size?.join("x") === last ? { ...view, size } : view));
    }

    app.scene.on((scene) => {
        if (!scene || scene.size[0] / scene.size[1] === shape) return;
        const isFirst = shape === 0;
        shape = scene.size[0] / scene.size[1];
        // Pixels of a link are those of the scene's own size where it says no other.
        fit(scene, isFirst && !scene.is_sized && location.hash === "");
    });
    new ResizeObserver(() => {
        clearTimeout(timer);
        timer = window.setTimeout(() => {
            const scene = app.scene.get();
            // A selected pixel would become another one.
            if (scene && !app.pixel.get()) fit(scene, false);
        }, 300);
    }).observe(byId("picture-overlay"));
}
