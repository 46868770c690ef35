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
    /** The size that fitted before the window changed: a view of this size follows. @type {string | null} */
    let before = null;
    let timer = 0;
    let isFirst = true;

    app.scene.on((scene) => {
        if (!scene) return;
        // Pixels of a link are those of the scene's own size where it says no other.
        if (isFirst && !scene.is_sized && location.hash === "") app.view.reset({ ...app.view.get(), size: fitted(scene.size) });
        isFirst = false;
        before = fitted(scene.size).join("x");
    });
    new ResizeObserver(() => {
        clearTimeout(timer);
        timer = window.setTimeout(() => {
            const scene = app.scene.get();
            // A selected pixel would become another one.
            if (!scene || app.pixel.get()) return;
            const [size, isFollowing] = [fitted(scene.size), app.view.get().size?.join("x") === before];
            before = size.join("x");
            if (isFollowing && app.view.get().size?.join("x") !== before) app.view.set({ size });
        }, 300);
    }).observe(byId("picture-overlay"));
}
