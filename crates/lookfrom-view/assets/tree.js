// The tree of rays of a sample, with the keys of an ARIA tree.

import { byId, h, replace } from "./html.js";
import { fileName, luminance, short, swatch } from "./format.js";
import { linesOfRays } from "./rays.js";

/** @typedef {import("./protocol.js").Ray} Ray */

/** @param {import("./app.js").App} app */
export function showTree(app) {
    const element = byId("tree");
    /** @type {Set<number>} */
    const closed = new Set();

    const show = () => {
        const inspection = app.inspection.get();
        if (!inspection) return replace(element);
        /** @type {Map<number | null, Ray[]>} */
        const children = new Map();
        const lines = linesOfRays(inspection);
        for (const ray of inspection.rays) children.set(ray.parent, [...(children.get(ray.parent) ?? []), ray]);
        const isTree = [...children.values()].some((siblings) => siblings.length > 1);
        replace(element, (children.get(null) ?? []).map((ray) => item(ray, 1)));

        /** @param {Ray} ray @param {number} level @returns {HTMLElement} */
        function item(ray, level) {
            const below = children.get(ray.address) ?? [];
            const isOpen = below.length > 0 ? !closed.has(ray.address) : null;
            const row = h("div", { class: "ray", id: `row-${ray.address}` },
                h("span", { class: `kind ${ray.kind}`, "aria-hidden": "true" }),
                h("span", { class: "name" }, `${ray.address} ${ray.kind}`),
                h("span", { class: "met", title: ray.met?.shape }, ends(ray)),
                h("span", { class: "value", title: "contribution of this ray and all after it" }, swatch(ray.subtree.rgb), " ", short(luminance(ray.subtree.rgb), 3)));
            const kind = /** @type {HTMLElement} */ (row.firstChild);
            kind.style.height = `${lines.get(ray.address)?.width.toFixed(1)}px`;
            // Rays of a path follow each other: indented, they would leave the panel.
            const group = below.length > 0 && h("ul", { role: "group", class: isTree ? "nested" : "" }, isOpen ? below.map((ray) => item(ray, level + 1)) : null);
            return h("li", { role: "treeitem", id: `ray-${ray.address}`, "data-address": ray.address, "aria-level": level, "aria-expanded": isOpen === null ? null : String(isOpen), "aria-labelledby": `row-${ray.address}`, tabindex: "-1" }, row, group);
        }
        mark();
    };

    const items = () => /** @type {HTMLElement[]} */ ([...element.querySelectorAll('[role="treeitem"]')]);
    const address = (/** @type {Element} */ item) => Number(item.getAttribute("data-address"));

    function mark() {
        const all = items();
        const selected = all.find((item) => address(item) === app.ray.get());
        for (const item of all) {
            item.setAttribute("aria-selected", String(item === selected));
            item.tabIndex = item === (selected ?? all[0]) ? 0 : -1;
        }
        if (selected && element.contains(document.activeElement)) selected.focus();
    }

    element.addEventListener("click", ({ target }) => {
        const item = /** @type {HTMLElement} */ (target).closest('[role="treeitem"]');
        if (!item) return;
        const isSelected = address(item) === app.ray.get();
        if (isSelected && item.hasAttribute("aria-expanded")) toggle(address(item));
        app.ray.set(address(item));
        document.getElementById(`ray-${address(item)}`)?.focus();
    });
    element.addEventListener("keydown", (event) => {
        const item = /** @type {HTMLElement} */ (event.target).closest('[role="treeitem"]');
        if (!item) return;
        const all = items();
        const at = all.indexOf(/** @type {HTMLElement} */ (item));
        const open = item.getAttribute("aria-expanded");
        /** @type {HTMLElement | null | undefined} */
        let next;
        if (event.key === "ArrowDown") next = all[at + 1];
        else if (event.key === "ArrowUp") next = all[at - 1];
        else if (event.key === "Home") next = all[0];
        else if (event.key === "End") next = all.at(-1);
        else if (event.key === "ArrowRight" && open === "false") toggle(address(item));
        else if (event.key === "ArrowRight" && open === "true") next = all[at + 1];
        else if (event.key === "ArrowLeft" && open === "true") toggle(address(item));
        else if (event.key === "ArrowLeft") next = item.parentElement?.closest('[role="treeitem"]');
        else return;
        event.preventDefault();
        if (!next) return;
        next.focus();
        app.ray.set(address(next));
    });

    /** @param {number} ray */
    function toggle(ray) {
        if (!closed.delete(ray)) closed.add(ray);
        show();
        document.getElementById(`ray-${ray}`)?.focus();
    }

    app.inspection.on(show);
    app.ray.on(mark);
    app.ray.on((selected) => {
        // Only the tree scrolls, not the panel around it.
        const row = document.getElementById(`ray-${selected}`)?.firstElementChild;
        if (!row) return;
        const [box, frame] = [row.getBoundingClientRect(), element.getBoundingClientRect()];
        if (box.top < frame.top) element.scrollTop -= frame.top - box.top;
        if (box.bottom > frame.bottom) element.scrollTop += box.bottom - frame.bottom;
    });
}

/** What a ray meets, in words. @param {Ray} ray */
export const ends = (ray) => {
    if (ray.flight?.scattered_at || ray.tracking?.scattered_at) return "→ is scattered by a medium";
    return ray.met ? `→ ${fileName(ray.met.shape)}` : "→ leaves the scene";
};
