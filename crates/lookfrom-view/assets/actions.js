// What the buttons of the header and single keys do: undo, copy, save, full help.

import { byId, h, replace } from "./html.js";
import { Disconnected } from "./socket.js";

/** @param {import("./app.js").App} app */
export function attachActions(app) {
    const [undo, redo] = [byId("undo"), byId("redo")];
    undo.addEventListener("click", () => app.view.undo());
    redo.addEventListener("click", () => app.view.redo());
    app.view.on(() => {
        // The last step leaves the focus where it is, which a disabled button would lose.
        undo.ariaDisabled = String(!app.view.canUndo());
        redo.ariaDisabled = String(!app.view.canRedo());
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
        // Letters alone belong to the pictures: elsewhere a voice that dictates would press them.
        const isOnPicture = isOn("canvas");
        const key = event.key.toLowerCase();
        if ((event.ctrlKey || event.metaKey) && key === "z" && !isTyping) {
            event.preventDefault();
            event.shiftKey ? app.view.redo() : app.view.undo();
        } else if ((event.ctrlKey || event.metaKey) && key === "y" && !isTyping) {
            event.preventDefault();
            app.view.redo();
        } else if (!isOnPicture || event.ctrlKey || event.metaKey || event.altKey) return;
        else if (event.key === "?") /** @type {HTMLDialogElement} */ (byId("help")).showModal();
        else if (key === "l") byId("loupe-button").click();
        else if (key === "home" && event.target === byId("picture-overlay")) app.view.set({ camera: null });
    });
}

/** @param {import("./app.js").App} app */
function attachMenu(app) {
    const menu = /** @type {HTMLDetailsElement} */ (byId("menu"));
    /** @type {Record<string, () => Promise<void>>} */
    const actions = {
        "copy-toml": async () => copy((await app.socket.request("words")).toml, "The view as TOML"),
        "copy-command": async () => copy((await app.socket.request("words")).command, "The command line", app.scene.get()?.camera.projection === "orthographic" ? "; no option says the height of this view, but the TOML does" : ""),
        "copy-link": async () => copy(location.href, "The link"),
        "save-png": async () => save(await app.socket.request("save", { format: "png" })),
        "save-exr": async () => save(await app.socket.request("save", { format: "exr" })),
        "save-page": async () => save(await app.socket.request("handout", { pixel: app.pixel.get(), sample: app.sample.get() })),
    };
    for (const [id, action] of Object.entries(actions)) {
        byId(id).addEventListener("click", () => {
            close();
            // Who asks for a file waits for it.
            action().catch((error) => (error instanceof Disconnected ? app.toast(error.message) : app.complain(error)));
        });
    }
    const isOutside = (/** @type {EventTarget | null} */ target) => target instanceof Node && !menu.contains(target);
    document.addEventListener("click", ({ target }) => void (isOutside(target) && (menu.open = false)));
    menu.addEventListener("focusout", ({ relatedTarget }) => void (isOutside(relatedTarget) && (menu.open = false)));
    menu.addEventListener("keydown", (event) => void (event.key === "Escape" && close()));

    /** Closes the menu, whose button has the focus then: also after a dialog. */
    function close() {
        menu.open = false;
        menu.querySelector("summary")?.focus();
    }

    /** @param {string} text @param {string} what @param {string} [but] What the text lacks. */
    async function copy(text, what, but = "") {
        try {
            await navigator.clipboard.writeText(text);
            app.toast(`${what} is in the clipboard${but}`);
        } catch {
            // Without permission, the text is shown to be copied by hand.
            const box = /** @type {HTMLDialogElement} */ (byId("text"));
            replace(box, h("h2", {}, what + but), h("pre", { tabindex: "0" }, text), h("form", { method: "dialog" }, h("button", {}, "Close")));
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
