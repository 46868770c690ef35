// What the buttons of the header and single keys do: undo, copy, save, full help.

import { byId, h, replace } from "./html.js";
import { Disconnected } from "./socket.js";

const CONTROLS = "input, select, button";

/** @param {import("./app.js").App} app */
export function attachActions(app) {
    const [undo, redo] = ["undo", "redo"].map((id) => /** @type {HTMLButtonElement} */ (byId(id)));
    undo.addEventListener("click", () => app.view.undo());
    redo.addEventListener("click", () => app.view.redo());
    app.view.on(() => {
        undo.disabled = !app.view.canUndo();
        redo.disabled = !app.view.canRedo();
    });
    attachMenu(app);
    attachHelp();
    byId("skip").addEventListener("click", (event) => {
        // The fragment of the address is the view.
        event.preventDefault();
        byId("picture-overlay").focus();
    });
    document.addEventListener("keydown", (event) => {
        const isOn = (/** @type {string} */ controls) => event.target instanceof HTMLElement && event.target.matches(controls);
        const isTyping = isOn('textarea, input:not([type="range"], [type="checkbox"])');
        const key = event.key.toLowerCase();
        if ((event.ctrlKey || event.metaKey) && key === "z" && !isTyping) {
            event.preventDefault();
            keepingFocus(event.shiftKey ? app.view.redo : app.view.undo);
        } else if ((event.ctrlKey || event.metaKey) && key === "y" && !isTyping) {
            event.preventDefault();
            keepingFocus(app.view.redo);
        } else if (isTyping || isOn("select") || event.ctrlKey || event.metaKey || event.altKey) return;
        else if (event.key === "?") /** @type {HTMLDialogElement} */ (byId("help")).showModal();
        else if (key === "l") byId("loupe-button").click();
        else if (key === "home" && event.target === byId("picture-overlay")) app.view.set({ camera: null });
    });
}

/** Changes the view, which a control that has the focus shows, too, as those do that have none. @param {() => void} change */
function keepingFocus(change) {
    const active = document.activeElement;
    const group = active?.closest("#development, #settings");
    const place = group && active ? [...group.querySelectorAll(CONTROLS)].indexOf(active) : -1;
    if (group && active instanceof HTMLElement) active.blur();
    change();
    const control = group?.querySelectorAll(CONTROLS)[place];
    if (control instanceof HTMLElement) control.focus();
}

/** @param {import("./app.js").App} app */
function attachMenu(app) {
    /** @type {Record<string, () => Promise<void>>} */
    const actions = {
        "copy-toml": async () => copy((await app.socket.request("words")).toml, "The view as TOML"),
        "copy-command": async () => copy((await app.socket.request("words")).command, "The command line"),
        "copy-link": async () => copy(location.href, "The link"),
        "save-png": async () => save(await app.socket.request("save", { format: "png" })),
        "save-exr": async () => save(await app.socket.request("save", { format: "exr" })),
        "save-page": async () => save(await app.socket.request("handout", { pixel: app.pixel.get(), sample: app.sample.get() })),
    };
    for (const [id, action] of Object.entries(actions)) {
        byId(id).addEventListener("click", () => {
            /** @type {HTMLDetailsElement | null} */ (byId(id).closest("details"))?.removeAttribute("open");
            // Who asks for a file waits for it.
            action().catch((error) => (error instanceof Disconnected ? app.toast(error.message) : app.complain(error)));
        });
    }
    const menu = /** @type {HTMLDetailsElement} */ (byId("menu"));
    document.addEventListener("click", ({ target }) => void (menu.contains(/** @type {Node} */ (target)) || (menu.open = false)));
    menu.addEventListener("keydown", (event) => {
        if (event.key !== "Escape") return;
        menu.open = false;
        menu.querySelector("summary")?.focus();
    });

    /** @param {string} text @param {string} what */
    async function copy(text, what) {
        try {
            await navigator.clipboard.writeText(text);
            app.toast(`${what} is in the clipboard`);
        } catch {
            // Without permission, the text is shown to be copied by hand.
            const box = /** @type {HTMLDialogElement} */ (byId("text"));
            replace(box, h("h2", {}, what), h("pre", { tabindex: "0" }, text), h("form", { method: "dialog" }, h("button", {}, "Close")));
            box.showModal();
        }
    }

    /** @param {{header: import("./protocol.js").FileHeader, payload: ArrayBuffer}} file */
    function save({ header, payload }) {
        const url = URL.createObjectURL(new Blob([payload], { type: header.mime }));
        h("a", { href: url, download: header.name }).click();
        setTimeout(() => URL.revokeObjectURL(url), 10_000);
        app.toast(`${header.name} is saved`);
    }
}

function attachHelp() {
    const help = /** @type {HTMLDialogElement} */ (byId("help"));
    byId("help-button").addEventListener("click", () => help.showModal());
}
