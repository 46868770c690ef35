// Tabs with the keys that the ARIA authoring practices ask for.

/**
 * @param {HTMLElement} list An element with role "tablist", whose tabs name their panels by aria-controls.
 * @param {(panel: string) => void} [shown]
 */
export function attachTabs(list, shown) {
    const tabs = /** @type {HTMLElement[]} */ ([...list.querySelectorAll('[role="tab"]')]);

    /** @param {string} panel */
    function select(panel) {
        for (const tab of tabs) {
            const isSelected = tab.getAttribute("aria-controls") === panel;
            tab.setAttribute("aria-selected", String(isSelected));
            tab.tabIndex = isSelected ? 0 : -1;
            const element = document.getElementById(tab.getAttribute("aria-controls") ?? "");
            if (element) element.hidden = !isSelected;
        }
        shown?.(panel);
    }

    list.addEventListener("click", ({ target }) => {
        const tab = /** @type {HTMLElement} */ (target).closest('[role="tab"]');
        if (tab) select(tab.getAttribute("aria-controls") ?? "");
    });
    list.addEventListener("keydown", (event) => {
        const now = tabs.findIndex((tab) => tab === document.activeElement);
        const step = { ArrowRight: now + 1, ArrowLeft: now - 1, Home: 0, End: tabs.length - 1 }[event.key];
        if (step === undefined || now < 0) return;
        event.preventDefault();
        const tab = tabs[(step + tabs.length) % tabs.length];
        tab.focus();
        select(tab.getAttribute("aria-controls") ?? "");
    });
    return { select };
}
