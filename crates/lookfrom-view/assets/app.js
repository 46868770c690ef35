// What the parts of the page share: the connection, the scene, the view, and what is selected.

import { byId } from "./html.js";
import { signal } from "./signal.js";
import { Unanswered } from "./socket.js";
import { viewState } from "./state.js";

/** @typedef {ReturnType<typeof createApp>} App */

/** @param {import("./socket.js").Socket} socket */
export function createApp(socket) {
    const app = {
        socket,
        view: viewState(),
        scene: signal(/** @type {import("./protocol.js").Scene | null} */ (null)),
        frame: signal(/** @type {import("./protocol.js").PictureHeader | null} */ (null)),
        /** Why the view is not shown, where there is none to go back to. */
        refusal: signal(/** @type {string | null} */ (null)),
        isConnected: signal(false),
        /** The selected pixel. */
        pixel: signal(/** @type {[number, number] | null} */ (null)),
        report: signal(/** @type {import("./protocol.js").PixelReport | null} */ (null)),
        /** The selected sample of the pixel. */
        sample: signal(/** @type {number | null} */ (null)),
        inspection: signal(/** @type {import("./protocol.js").Inspection | null} */ (null)),
        /** The address of the selected ray. */
        ray: signal(/** @type {number | null} */ (null)),
        /** What the link says of the scene; empty where the other end knows it. */
        source: signal(""),
        /** Whether the rays are drawn over the picture. */
        raysOverPicture: signal(true),

        /** Says a sentence to screen readers. @param {string} sentence */
        announce(sentence) {
            byId("announcements").textContent = sentence;
        },
        /** Shows a short message for some seconds. @param {string} sentence */
        toast(sentence) {
            const element = byId("toast");
            element.textContent = sentence;
            element.classList.add("shown");
            clearTimeout(toastTimer);
            // Slow readers read ten letters in a second.
            toastTimer = window.setTimeout(() => element.classList.remove("shown"), Math.max(4000, 100 * sentence.length));
        },
        /** Shows an error, unless a later question concerns the user more, or the loss of the connection, which the status tells. @param {unknown} error */
        complain(error) {
            if (error instanceof Error && !(error instanceof Unanswered)) app.toast(error.message);
        },
        /** The camera in use: the view's; or that of the last picture, which time and turntable move; or the scene's. @returns {import("./protocol.js").Camera | null} */
        camera() {
            const own = app.scene.get()?.camera;
            const shown = app.frame.get()?.camera;
            const camera = app.view.get().camera;
            return camera ? { ...camera, is_mirrored: own?.is_mirrored } : shown ?? own ?? null;
        },
        /** The size of the finished picture; coarse ones are smaller. @returns {[number, number]} */
        size() {
            return app.view.get().size ?? app.scene.get()?.size ?? [1, 1];
        },
        /** The ray that is selected. @returns {import("./protocol.js").Ray | null} */
        selectedRay() {
            return app.inspection.get()?.rays.find((ray) => ray.address === app.ray.get()) ?? null;
        },
    };
    let toastTimer = 0;
    socket.on("open", () => app.isConnected.set(true));
    socket.on("close", () => app.isConnected.set(false));
    return app;
}
