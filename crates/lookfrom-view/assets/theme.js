// Light and dark: the system's, unless the switch says otherwise.

import { byId } from "./html.js";
import { memory } from "./memory.js";

const NEXT = { system: "dark", dark: "light", light: "system" };

/** @param {() => void} changed Called after each change, since canvases read colours from the style sheet. */
export function attachTheme(changed) {
    const button = byId("theme");
    let theme = /** @type {keyof typeof NEXT} */ (memory()?.getItem("theme") ?? "system");
    if (!(theme in NEXT)) theme = "system";
    const show = () => {
        if (theme === "system") delete document.documentElement.dataset.theme;
        else document.documentElement.dataset.theme = theme;
        button.dataset.shows = theme;
        button.setAttribute("aria-label", `Colours: ${theme}`);
        button.title = `Colours: ${theme}`;
        changed();
    };
    button.addEventListener("click", () => {
        theme = /** @type {keyof typeof NEXT} */ (NEXT[theme]);
        memory()?.setItem("theme", theme);
        show();
    });
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", changed);
    show();
}
