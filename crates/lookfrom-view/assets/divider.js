// The edge between picture and panel: dragged, or moved by the arrow keys; a double click brings back its first place.

import { byId } from "./html.js";
import { memory } from "./memory.js";

/** The least widths of panel and picture, and the step of a key, in pixels of the page. */
const [LEAST_PANEL, LEAST_STAGE, STEP] = [320, 280, 24];

export function attachDivider() {
    const [divider, panel] = [byId("divider"), byId("panel")];
    const most = () => Math.max(LEAST_PANEL, window.innerWidth - LEAST_STAGE);

    /** @param {number | null} wanted null for the style sheet's own */
    function show(wanted) {
        const root = document.documentElement.style;
        if (wanted === null || !Number.isFinite(wanted)) root.removeProperty("--panel");
        else root.setProperty("--panel", `${Math.round(Math.max(LEAST_PANEL, Math.min(most(), wanted)))}px`);
        tell();
    }
    /** In such languages the panel is on the left. */
    const isRightToLeft = () => getComputedStyle(panel).direction === "rtl";
    const width = () => panel.getBoundingClientRect().width;
    const tell = () => {
        for (const [name, value] of Object.entries({ min: LEAST_PANEL, max: most(), now: width() })) divider.setAttribute(`aria-value${name}`, String(Math.round(value)));
    };
    const keep = () => memory()?.setItem("panel", String(Math.round(width())));

    divider.addEventListener("pointerdown", (event) => {
        divider.setPointerCapture(event.pointerId);
        event.preventDefault();
    });
    divider.addEventListener("pointermove", (event) => void (divider.hasPointerCapture(event.pointerId) && show(isRightToLeft() ? event.clientX : window.innerWidth - event.clientX)));
    divider.addEventListener("pointerup", keep);
    divider.addEventListener("dblclick", () => {
        show(null);
        memory()?.removeItem("panel");
    });
    divider.addEventListener("keydown", (event) => {
        const step = isRightToLeft() ? -STEP : STEP;
        const next = { ArrowLeft: width() + step, ArrowRight: width() - step, Home: LEAST_PANEL, End: most() }[event.key];
        if (next === undefined) return;
        event.preventDefault();
        show(next);
        keep();
    });
    window.addEventListener("resize", tell);
    const kept = memory()?.getItem("panel");
    show(kept ? Number(kept) : null);
}
