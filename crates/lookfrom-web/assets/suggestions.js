// The list of what may stand at the caret of a text, as a text box with a list box (WAI-ARIA 1.2): the focus stays in the text.

import { h, replace } from "../../lookfrom-view/assets/html.js";
import { completions } from "./complete.js";

/** @typedef {import("../../lookfrom-view/assets/protocol.js").Table} Table */

/** The height of a line in pixels, as in style.css. */
export const LINE = 18;
/** The columns of a tabulator, and the lines of a list. */
const [TAB, MOST_LINES] = [4, 9];
/** What stands in a header for a name of one's own. */
const NAME = "NAME";

/**
 * @param {import("../../lookfrom-view/assets/app.js").App} app
 * @param {HTMLTextAreaElement} area
 * @param {HTMLElement} paper What the list is placed in.
 * @param {() => boolean} isOurs Whether the text is in our own format.
 */
export function attachSuggestions(app, area, paper, isOurs) {
    // The focus stays in the text, whatever is clicked.
    const list = h("ul", { id: "completions", role: "listbox", tabindex: "0", "aria-label": "Completions", hidden: true, onmousedown: (/** @type {Event} */ event) => event.preventDefault() });
    paper.append(list);
    for (const [name, value] of [["aria-autocomplete", "list"], ["aria-controls", list.id]]) area.setAttribute(name, value);
    /** @type {Promise<Table[]> | null} */
    let tables = null;
    /** @type {import("./complete.js").Completions | null} */
    let shown = null;
    let chosen = 0;

    function close() {
        [shown, list.hidden] = [null, true];
        area.removeAttribute("aria-activedescendant");
    }

    /** @param {number} option */
    function choose(option) {
        chosen = option;
        [...list.children].forEach((item, i) => item.setAttribute("aria-selected", String(i === option)));
        area.setAttribute("aria-activedescendant", `completion-${option}`);
        list.children[option]?.scrollIntoView({ block: "nearest" });
    }

    /** Shows what fits; of one's own accord only where something has been typed. @param {boolean} isAsked */
    async function suggest(isAsked) {
        tables ??= app.socket.request("vocabulary").then((answer) => answer.tables);
        try {
            const known = await tables;
            const caret = area.selectionStart;
            const found = isOurs() && caret === area.selectionEnd ? completions(known, area.value, caret) : null;
            if (!found || (!isAsked && caret === found.from)) return close();
            shown = found;
        } catch {
            // The program has ended, or was asked again: another key asks anew.
            tables = null;
            return close();
        }
        replace(list, shown.options.map((option, i) =>
            h("li", { id: `completion-${i}`, role: "option", onclick: () => accept(i) }, option.replace(/ = $/, ""))));
        list.hidden = false;
        place(shown.from);
        choose(0);
        app.announce(`${shown.options.length} completions, the first is ${shown.options[0]}`);
    }

    /** Puts the list below the line of a place in the text, or above it where there is no room. @param {number} at */
    function place(at) {
        const lines = area.value.slice(0, at).split("\n");
        const column = [...lines[lines.length - 1]].reduce((columns, character) => columns + (character === "\t" ? TAB - (columns % TAB) : 1), 0);
        const top = 6 + lines.length * LINE - area.scrollTop;
        const height = Math.min(list.childElementCount, MOST_LINES) * (LINE + 4) + 8;
        const isAbove = top + height > paper.clientHeight && top - LINE > height;
        list.style.top = `${isAbove ? top - LINE - height - 4 : top + 2}px`;
        list.style.left = `clamp(0px, calc(${column}ch + ${8 - area.scrollLeft}px), calc(100% - 15em))`;
    }

    /** @param {number} option */
    function accept(option) {
        if (!shown) return;
        const { from, to, options } = shown;
        const text = options[option];
        close();
        area.focus();
        area.setSelectionRange(from, to);
        // The only way of a script to change a text so that it can be undone.
        if (!document.execCommand("insertText", false, text)) area.setRangeText(text, from, to, "end");
        close();
        const name = text.indexOf(NAME);
        if (name >= 0) area.setSelectionRange(from + name, from + name + NAME.length);
    }

    area.addEventListener("input", (event) => {
        if (/** @type {InputEvent} */ (event).inputType === "insertText" || shown) suggest(false);
    });
    area.addEventListener("blur", close);
    area.addEventListener("scroll", () => void (shown && place(shown.from)));
    area.addEventListener("pointerdown", close);
    // Before the keys of the text.
    area.addEventListener("keydown", (event) => {
        if (event.key === " " && event.ctrlKey) suggest(true);
        else if (!shown) return;
        else if (event.key === "ArrowDown") choose((chosen + 1) % shown.options.length);
        else if (event.key === "ArrowUp") choose((chosen + shown.options.length - 1) % shown.options.length);
        else if ((event.key === "Enter" || event.key === "Tab") && !event.shiftKey) accept(chosen);
        else if (event.key === "Escape") close();
        else {
            if (/^(Arrow|Home|End|Page)/.test(event.key)) close();
            return;
        }
        event.preventDefault();
    }, { capture: true });
}
