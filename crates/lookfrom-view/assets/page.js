// The page put together: what is in the link, the connection, and all parts.

import { attachActions } from "./actions.js";
import { createApp } from "./app.js";
import { askForViews } from "./asking.js";
import { attachDivider } from "./divider.js";
import { showEquations } from "./equations.js";
import { keepFitting } from "./fit.js";
import { byId } from "./html.js";
import { attachInspector } from "./inspector.js";
import { showLegend } from "./legend.js";
import { showLoupe } from "./loupe.js";
import { showNotes } from "./notes.js";
import { attachPaper } from "./paper.js";
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

    const picture = showPicture(app);
    showStatus(app);
    attachDivider();
    showSettings(app);
    if (fits) keepFitting(app);
    // Questions about pixels are about the view before them.
    askForViews(app);
    attachInspector(app);
    showLegend(app);
    showLoupe(app, picture);
    showPixel(app);
    showTree(app);
    showEquations(app);
    showSpace(app);
    attachPaper(picture);
    const notes = showNotes(app);
    attachActions(app);
    keepPermalink(app);
    attachTheme(() => app.frame.get() && window.dispatchEvent(new Event("resize")));

    const tabs = attachTabs(byId("tabs"), (panel) => (panel === "notes" ? notes.show() : notes.leave()));
    app.pixel.on((pixel) => {
        // A click on the picture asks why; a lesson that is open shows the new pixel itself.
        if (pixel && byId("notes").hidden) tabs.select("why");
    });
    tabs.select("view");

    app.socket.on("scene", (/** @type {import("./protocol.js").Scene} */ scene) => {
        app.scene.set(scene);
        if (link.pixel) app.pixel.set(link.pixel);
        link.pixel = null;
    });
    app.socket.open();
    return app;
}
