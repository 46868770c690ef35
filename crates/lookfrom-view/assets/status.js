// How far the picture is, whether the other end is there, and errors of the scene over the last good picture.

import { byId, h, replace } from "./html.js";
import { count, duration } from "./format.js";

/** @param {import("./app.js").App} app */
export function showStatus(app) {
    const progress = /** @type {HTMLProgressElement} */ (byId("progress"));
    const text = byId("progress-text");
    const failure = byId("failure");
    let announced = -1;
    let isPaused = false;

    app.socket.on("progress", (/** @type {import("./protocol.js").Progress} */ { samples, of, seconds, rays_per_second, done, hash }) => {
        progress.max = of;
        progress.value = samples;
        document.body.classList.toggle("is-done", done);
        const rate = rays_per_second > 0 ? ` · ${count(rays_per_second)} rays/s` : "";
        text.textContent = `${samples} / ${of} samples · ${duration(seconds)}${rate}${hash ? ` · ${hash}` : ""}`;
        text.title = hash ? `${hash} is the hash of this picture: that of lookfrom render --json is the same` : "";
        text.dataset.hash = hash ?? "";
        // Screen readers hear of each quarter only.
        const quarter = done ? 4 : Math.floor((4 * samples) / Math.max(of, 1));
        if (quarter !== announced && (done || quarter > 0)) app.announce(done ? "The picture is finished" : `${samples} of ${of} samples`);
        announced = quarter;
    });

    const pause = byId("pause");
    pause.addEventListener("click", () => {
        isPaused = !isPaused;
        app.socket.send("pause", { paused: isPaused });
        pause.setAttribute("aria-pressed", String(isPaused));
        pause.setAttribute("aria-label", isPaused ? "Continue rendering" : "Pause rendering");
    });

    app.socket.on("error", (/** @type {import("./protocol.js").Failure} */ { id, message, excerpt }) => {
        if (id !== null) return app.toast(message);
        replace(
            failure,
            h("h2", {}, "The scene cannot be shown"),
            h("p", {}, message),
            excerpt && h("pre", { tabindex: "0" }, excerpt),
            h("p", { class: "faint" }, document.body.classList.contains("has-picture") ? `Behind is the last good picture. ${app.socket.whenBroken}` : app.socket.whenBroken),
        );
        failure.hidden = false;
    });
    app.scene.on(() => (failure.hidden = true));

    app.socket.on("open", () => {
        document.body.classList.remove("is-offline");
        [isPaused, announced] = [false, -1];
        pause.setAttribute("aria-pressed", "false");
    });
    app.socket.on("close", () => {
        document.body.classList.add("is-offline");
        text.textContent = app.socket.whenLost;
        app.announce("The connection is lost");
    });
}
