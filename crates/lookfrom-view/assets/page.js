// The page put together: what is in the link, the connection, and all parts.

import { attachActions } from "./actions.js";
import { createApp } from "./app.js";
import { attachDivider } from "./divider.js";
import { showEquations } from "./equations.js";
import { keepFitting } from "./fit.js";
import { byId } from "./html.js";
import { attachInspector } from "./inspector.js";
import { showLegend } from "./legend.js";
import { showLoupe } from "./loupe.js";
import { showNotes } from "./notes.js";
import { keepPermalink, parse } from "./permalink.js";
import { showPicture } from "./picture.js";
import { showPixel } from "./pixel.js";
import { showSettings } from "./settings.js";
import { showSpace } from "./space.js";
import { showStatus } from "./status.js";
import { attachTabs } from "./tabs.js";
import { attachTheme } from "./theme.js";
import { showTree } from "./tree.js";

/**
 * Shows the page over a connection, which it opens.
 * @param {import("./socket.js").Socket} socket
 * @param {{fits?: boolean}} [options] Whether the picture has the size of the window, where nobody says another.
 */
export function showPage(socket, { fits = false } = {}) {
    const app = createApp(socket);
    const link = parse(location.hash);
    app.view.reset(link.view);
    app.sample.set(link.sample);
    app.ray.set(link.ray);

    /** Asks for the whole view; while the hand moves, once per frame of the screen. */
    let scheduled = false;
    let isMoving = false;
    function sendView() {
        scheduled = false;
        const scene = app.scene.get();
        if (!scene) return;
        const view = app.view.get();
        app.socket.send("view", {
            ...view,
            moving: isMoving,
            exposure: view.exposure ?? scene.exposure,
            tonemap: view.tonemap ?? scene.tonemap,
            denoise: view.denoise ?? scene.denoise,
            compare: view.compare && { mode: view.compare },
        });
    }
    app.view.on((_, moving) => {
        isMoving = moving;
        if (!scheduled) requestAnimationFrame(sendView);
        scheduled = true;
    });

    attachInspector(app);
    const picture = showPicture(app);
    showStatus(app);
    attachDivider();
    showSettings(app);
    if (fits) keepFitting(app);
    showLegend(app);
    showLoupe(app, picture);
    showPixel(app);
    showTree(app);
    showEquations(app);
    showSpace(app);
    const notes = showNotes(app);
    attachActions(app);
    keepPermalink(app);
    attachTheme(() => app.frame.get() && window.dispatchEvent(new Event("resize")));

    const tabs = attachTabs(byId("tabs"), (panel) => void (panel === "notes" && notes.show()));
    app.pixel.on((pixel) => {
        // A click on the picture asks why; a lesson that is open shows the new pixel itself.
        if (pixel && byId("notes").hidden) tabs.select("why");
    });
    tabs.select("view");

    app.socket.on("scene", (/** @type {import("./protocol.js").Scene} */ scene) => {
        const name = scene.name.split(/[/\\]/).at(-1) ?? scene.name;
        byId("scene-name").textContent = name;
        byId("scene-name").title = scene.name;
        document.title = `${name} · lookfrom`;
        app.announce(`${name} is loaded`);
        app.scene.set(scene);
        sendView();
        if (link.pixel) app.pixel.set(link.pixel);
        link.pixel = null;
    });
    app.socket.open();
    return app;
}
