// The page of a hand-out: a picture and a pixel, with the answers that it holds and no program behind it.

import { handoutTransport } from "./handout-transport.js";
import { byId, h } from "./html.js";
import { showPage } from "./page.js";
import { connect } from "./socket.js";
import { SCENES_OWN } from "./state.js";

/** @type {import("./handout-transport.js").Kept} */
const kept = JSON.parse(byId("handout").textContent ?? "");
document.body.classList.add("is-handout");
const app = showPage(connect(handoutTransport(kept)));

const own = JSON.stringify(SCENES_OWN);
app.view.on((view) => void (JSON.stringify(view) !== own && app.view.reset({ ...SCENES_OWN })));
app.view.reset({ ...SCENES_OWN });

app.pixel.on((pixel) => {
    if (!pixel || pixel.join() === kept.pixel.join()) return;
    app.toast(`This hand-out holds pixel ${kept.pixel.join(", ")} only`);
    app.pixel.set(kept.pixel);
});
app.report.on((report) => void (report && app.sample.get() === null && app.sample.set(kept.sample)));
app.scene.on((scene) => void (scene && app.pixel.set(kept.pixel)));

byId("tab-view").textContent = "Scene";
byId("tab-view").hidden = kept.source === null;
byId("view").append(h("pre", { class: "source", tabindex: "0", "aria-label": "The scene's file" }, kept.source ?? ""));
