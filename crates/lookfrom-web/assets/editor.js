// The text of the scene beside its picture, read again as one types, with what is wrong under its line.

import { byId, h, replace } from "../../lookfrom-view/assets/html.js";
import { LINE, attachSuggestions } from "./suggestions.js";

/** @typedef {import("../../lookfrom-view/assets/app.js").App} App */
/** @typedef {import("../../lookfrom-view/assets/protocol.js").Failure} Failure */

const PAUSE = 250;
const TEXTS = /\.(toml|pbrt|gltf|obj|mtl)$/i;
/** Longer texts are not for typing. */
const LONGEST = 1 << 20;

/** Adds the tab and its panel, before the page attaches its tabs. */
export function addEditorTab() {
    byId("tabs").prepend(h("button", { type: "button", role: "tab", id: "tab-scene", "aria-controls": "scene" }, "Scene"));
    byId("why").before(h("div", { id: "scene", role: "tabpanel", "aria-labelledby": "tab-scene", tabindex: "-1", hidden: true }));
}

/**
 * @param {App} app
 * @param {(path: string, text: string) => void} changed Called a moment after the text has changed.
 */
export function attachEditor(app, changed) {
    const area = h("textarea", { "aria-label": "Text of the scene", "aria-describedby": "scene-error", spellcheck: "false", autocomplete: "off", wrap: "off" });
    const numbers = h("pre", { class: "line-numbers", "aria-hidden": "true" });
    const mark = h("div", { class: "mark", "aria-hidden": "true", hidden: true });
    const error = h("p", { id: "scene-error", role: "status" });
    const none = h("p", { class: "hint", hidden: true }, "This scene is not a text that can be edited here.");
    const paper = h("div", { class: "paper" }, area, mark);
    const sheet = h("div", { class: "sheet" }, numbers, paper);
    replace(byId("scene"), none, sheet, error);
    let path = "";
    let timer = 0;
    let line = 0;

    function layOut() {
        const lines = area.value.split("\n").length;
        numbers.textContent = Array.from({ length: lines }, (_, i) => i + 1).join("\n");
        numbers.scrollTop = area.scrollTop;
        mark.style.transform = `translate(${-area.scrollLeft}px, ${line * LINE - area.scrollTop}px)`;
    }
    /** @param {Failure | null} failure */
    function show(failure) {
        const place = failure?.place?.file === path ? failure.place : null;
        line = place?.line ?? 0;
        mark.hidden = place === null;
        // The column of an error is in characters, as those of the text.
        const message = failure?.message.replace(`${path}:${place?.line}:${place?.column}: `, "").replace(/^error: /, "") ?? "";
        mark.textContent = place ? `${" ".repeat(Math.max(0, place.column - 1))}^ ${message.split("\n")[0]}` : "";
        error.textContent = message;
        area.setAttribute("aria-invalid", String(failure !== null));
        layOut();
    }

    area.addEventListener("input", () => {
        clearTimeout(timer);
        timer = window.setTimeout(() => changed(path, area.value), PAUSE);
        layOut();
    });
    area.addEventListener("scroll", layOut);
    area.addEventListener("keydown", (event) => {
        // Tab leaves the text after Escape, for those who have only keys.
        if (event.key === "Escape" && !event.defaultPrevented) area.blur();
    });
    attachSuggestions(app, area, paper, () => /\.toml$/i.test(path));
    app.socket.on("error", (/** @type {Failure} */ failure) => void (failure.id === null && show(failure)));
    app.scene.on(() => show(null));

    return {
        /** Shows the text of another scene. @param {string} of @param {Uint8Array} bytes */
        open(of, bytes) {
            clearTimeout(timer);
            path = of;
            const isText = TEXTS.test(of) && bytes.length <= LONGEST;
            [none.hidden, sheet.hidden] = [isText, !isText];
            area.value = isText ? new TextDecoder().decode(bytes) : "";
            area.scrollTop = 0;
            show(null);
        },
    };
}
