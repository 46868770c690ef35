// How far the picture is, whether the other end is there, and errors of the scene over the last good picture.

import { byId, h, replace } from "./html.js";
import { count, duration } from "./format.js";
import { SCENES_OWN } from "./state.js";

/** @param {import("./app.js").App} app */
export function showStatus(app) {
    const progress = /** @type {HTMLProgressElement} */ (byId("progress"));
    const text = byId("progress-text");
    const failure = byId("failure");
    let announced = -1;
    let isPaused = false;
    /** Why the files as they are cannot be shown. @type {import("./protocol.js").Failure | null} */
    let broken = null;

    app.socket.on("progress", (/** @type {import("./protocol.js").Progress} */ { samples, of, seconds, rays_per_second, done, hash }) => {
        progress.max = of;
        progress.value = samples;
        document.body.classList.toggle("is-done", done);
        const rate = rays_per_second > 0 ? ` · ${count(rays_per_second)} rays/s` : "";
        text.textContent = `${samples} / ${of} samples · ${duration(seconds)}${rate}${hash ? ` · ${hash}` : ""}`;
        // A scene whose camera was moved is not built around it, as that of a command is.
        const isOwn = !app.view.get().camera;
        text.title = hash ? `${hash} is the hash of this picture${isOwn ? ": that of lookfrom render --json is the same" : ""}` : "";
        text.dataset.hash = hash ?? "";
        // Screen readers hear of each quarter only.
        const quarter = done ? 4 : Math.floor((4 * samples) / Math.max(of, 1));
        if (quarter !== announced && (done || quarter > 0)) app.announce(done ? "The picture is finished" : `${samples} of ${of} samples`);
        announced = quarter;
    });

    const pause = byId("pause");
    /** @param {boolean} next */
    function showPause(next) {
        isPaused = next;
        pause.setAttribute("aria-pressed", String(isPaused));
        pause.setAttribute("aria-label", isPaused ? "Continue rendering" : "Pause rendering");
    }
    pause.addEventListener("click", () => {
        showPause(!isPaused);
        app.socket.send("pause", { paused: isPaused });
    });

    /** What is wrong with the files, or else with the first view of the scene. */
    function showFailure() {
        const refusal = app.refusal.get();
        const behind = document.body.classList.contains("has-picture") ? "Behind is the last good picture. " : "";
        failure.hidden = broken === null && refusal === null;
        if (broken) {
            replace(
                failure,
                h("h2", {}, "The scene cannot be shown"),
                h("p", {}, broken.message),
                broken.excerpt && h("pre", { tabindex: "0" }, broken.excerpt),
                h("p", { class: "faint" }, behind + app.socket.whenBroken),
            );
        } else if (refusal !== null) {
            replace(
                failure,
                h("h2", {}, "This view cannot be shown"),
                h("p", {}, refusal),
                behind && h("p", { class: "faint" }, behind),
                h("button", { type: "button", onclick: () => app.view.set(SCENES_OWN) }, "The scene's own view"),
            );
        }
    }
    app.socket.on("error", (/** @type {import("./protocol.js").Failure} */ failure) => {
        if (failure.id !== null) return;
        broken = failure;
        showFailure();
        if (!app.scene.get()) showName("no scene");
    });
    app.scene.on((scene) => {
        broken = null;
        showFailure();
        if (!scene) return;
        const name = scene.name.split(/[/\\]/).at(-1) ?? scene.name;
        showName(name, scene.name);
        app.announce(`${name} is loaded`);
    });
    app.refusal.on(showFailure);

    app.socket.on("open", () => {
        document.body.classList.remove("is-offline");
        announced = -1;
        showPause(false);
        if (!app.scene.get()) showName("reading the scene …");
    });
    app.socket.on("close", () => {
        document.body.classList.add("is-offline");
        if (!app.scene.get()) showName("connecting …");
        // Each attempt to come back ends here: that it has failed once more is no news.
        if (text.textContent === app.socket.whenLost) return;
        text.textContent = app.socket.whenLost;
        app.announce(app.socket.whenLost);
    });
}

/** The name of the scene, or what stands for it, in the header and for the tab. @param {string} name @param {string} [path] */
function showName(name, path = "") {
    const element = byId("scene-name");
    [element.textContent, element.title] = [name, path];
    document.title = `${name} · lookfrom`;
}
