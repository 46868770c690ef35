// The view on its way to the other end: asked for once per frame of the screen, then accepted by what is shown of it, or refused.

import { possible } from "./possible.js";
import { returned } from "./state.js";

/** @typedef {import("./protocol.js").View} View */

/** @param {import("./app.js").App} app */
export function askForViews(app) {
    let frame = 0;
    let isMoving = false;
    /** Views that are neither accepted nor refused yet, by the numbers of their messages. @type {Map<number, View>} */
    const asked = new Map();
    /** The last view that this scene has been shown in. @type {View | null} */
    let accepted = null;

    function ask() {
        cancelAnimationFrame(frame);
        frame = 0;
        const scene = app.scene.get();
        if (!scene) return;
        const view = app.view.get();
        const id = app.socket.send("view", {
            ...view,
            moving: isMoving,
            exposure: view.exposure ?? scene.exposure,
            tonemap: view.tonemap ?? scene.tonemap,
            denoise: view.denoise ?? scene.denoise,
            compare: view.compare && { mode: view.compare },
        });
        asked.set(id, view);
    }
    app.view.on((_, moving) => {
        isMoving = moving;
        frame ||= requestAnimationFrame(ask);
    });
    app.scene.on((scene) => {
        if (!scene) return;
        asked.clear();
        accepted = null;
        app.refusal.set(null);
        const { absent } = possible(app.view.get(), scene);
        if (absent.length > 0) {
            app.toast(`This scene does not have: ${absent.join(", ")}`);
            app.view.revise((view) => possible(view, scene).view);
        }
        ask();
    });

    /** @param {number} id */
    function accept(id) {
        const view = asked.get(id);
        if (!view) return;
        accepted = view;
        // Of those before it, which it has replaced, nothing more is heard.
        for (const other of asked.keys()) if (other <= id) asked.delete(other);
        app.refusal.set(null);
    }
    app.socket.on("progress", ({ view }) => accept(view));
    app.socket.on("picture", ({ header }) => accept(header.view));

    app.socket.on("error", (/** @type {import("./protocol.js").Failure} */ { id, message }) => {
        const refused = id === null ? undefined : asked.get(id);
        if (id === null || !refused) return;
        asked.delete(id);
        const back = accepted && returned(refused, accepted);
        if (!back) return app.refusal.set(message);
        app.toast(message);
        // Later ones with the same fault will be refused, too.
        for (const [other, view] of asked) if (back(view) !== view) asked.delete(other);
        app.view.revise(back);
    });
}
