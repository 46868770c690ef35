// The loupe: the pixels around the pointer, enlarged, and the film's values of the one under it.

import { byId, h, replace } from "./html.js";
import { lanes, short, swatch } from "./format.js";
import { Unanswered } from "./socket.js";

/** Pixels to each side of the middle. */
const REACH = 5;
const ZOOM = 11;

/**
 * @param {import("./app.js").App} app
 * @param {{pixelAt: (x: number, y: number) => [number, number] | null, canvas: HTMLCanvasElement, overlay: HTMLCanvasElement}} picture
 */
export function showLoupe(app, { pixelAt, canvas, overlay }) {
    const readout = byId("readout");
    const loupe = /** @type {HTMLCanvasElement} */ (byId("loupe"));
    const button = byId("loupe-button");
    /** @type {[number, number] | null} */
    let pixel = null;
    let timer = 0;

    const isOn = () => button.getAttribute("aria-pressed") === "true";
    button.addEventListener("click", () => {
        button.setAttribute("aria-pressed", String(!isOn()));
        draw();
    });

    overlay.addEventListener("pointermove", (event) => {
        const box = overlay.getBoundingClientRect();
        move(pixelAt(event.clientX - box.left, event.clientY - box.top), event.clientX - box.left, box.width);
    });
    overlay.addEventListener("pointerleave", () => move(app.pixel.get(), 0, 1));
    app.pixel.on((selected) => move(selected, 0, 1));
    app.frame.on(() => move(pixel ?? app.pixel.get(), 0, 1));

    /** @param {[number, number] | null} next @param {number} x @param {number} width */
    function move(next, x, width) {
        pixel = next;
        loupe.classList.toggle("left", x > width / 2);
        draw();
        clearTimeout(timer);
        if (pixel) timer = window.setTimeout(ask, 40);
        else replace(readout);
    }

    async function ask() {
        if (!pixel || !app.frame.get()) return;
        const [x, y] = pixel;
        try {
            show(await app.socket.request("value", { x, y }));
        } catch (error) {
            // Between two scenes there is no film.
            if (!(error instanceof Unanswered)) replace(readout);
        }
    }

    /** @param {import("./protocol.js").Value} value */
    function show({ x, y, rgb, samples, deviation, reference }) {
        replace(
            readout,
            h("span", { class: "where" }, `${x}, ${y}`),
            swatch(rgb),
            h("span", {}, lanes(rgb)),
            samples > 1 && h("span", { class: "faint", title: "standard deviation of the samples' luminance" }, `σ ${short(Number(deviation), 3)}`),
            reference && h("span", { class: "faint" }, `reference ${lanes(reference)}`),
            h("span", { class: "faint" }, `${samples} sample${samples === 1 ? "" : "s"}`),
        );
    }

    function draw() {
        loupe.hidden = !isOn() || !pixel || !app.frame.get();
        if (loupe.hidden || !pixel) return;
        const size = (2 * REACH + 1) * ZOOM;
        [loupe.width, loupe.height] = [size, size];
        const context = /** @type {CanvasRenderingContext2D} */ (loupe.getContext("2d"));
        context.imageSmoothingEnabled = false;
        const side = 2 * REACH + 1;
        context.drawImage(canvas, pixel[0] - REACH, pixel[1] - REACH, side, side, 0, 0, size, size);
        for (const [style, width] of /** @type {[string, number][]} */ ([["#000", 3], ["#fff", 1]])) {
            context.strokeStyle = style;
            context.lineWidth = width;
            context.strokeRect(REACH * ZOOM + 0.5, REACH * ZOOM + 0.5, ZOOM - 1, ZOOM - 1);
        }
    }
}
