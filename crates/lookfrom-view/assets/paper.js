// The picture on paper, above the numbers of its pixel: with the rays and the marker that lie over it on the screen.

import { byId } from "./html.js";

/** @param {{canvas: HTMLCanvasElement, overlay: HTMLCanvasElement}} picture */
export function attachPaper({ canvas, overlay }) {
    const paper = /** @type {HTMLCanvasElement} */ (byId("paper"));
    window.addEventListener("beforeprint", () => {
        const [inner, outer] = [canvas, overlay].map((element) => element.getBoundingClientRect());
        const ratio = overlay.width / outer.width;
        [paper.width, paper.height] = [inner.width, inner.height].map((length) => Math.round(length * ratio));
        const context = paper.getContext("2d");
        context?.drawImage(canvas, 0, 0, paper.width, paper.height);
        context?.drawImage(overlay, (outer.left - inner.left) * ratio, (outer.top - inner.top) * ratio);
    });
}
