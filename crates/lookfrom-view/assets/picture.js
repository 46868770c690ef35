// The picture: frames as they come, fitted into the stage, with the wipe, the selected pixel and its rays.

import { project } from "./camera.js";
import { attachControls } from "./controls.js";
import { byId } from "./html.js";
import { drawRays } from "./rays.js";
import { length, subtract } from "./vector.js";

/** @typedef {import("./app.js").App} App */

/** @param {App} app */
export function showPicture(app) {
    const canvas = /** @type {HTMLCanvasElement} */ (byId("picture"));
    const overlay = /** @type {HTMLCanvasElement} */ (byId("picture-overlay"));
    const handle = byId("wipe");
    /** @type {ImageBitmap[]} */
    let bitmaps = [];
    let wipe = 0.5;
    let isDecoding = false;
    /** @type {import("./protocol.js").Picture | null} */
    let next = null;

    app.socket.on("picture", (frame) => {
        next = frame;
        if (!isDecoding) decode();
    });

    /** Decodes the newest frame; those that come while another is decoded replace each other. */
    async function decode() {
        isDecoding = true;
        while (next) {
            const { header, payload } = next;
            next = null;
            const sizes = header.sizes ?? [payload.byteLength];
            let start = 0;
            const pictures = sizes.map((size) => new Blob([payload.slice(start, (start += size))], { type: "image/png" }));
            try {
                const decoded = await Promise.all(pictures.map((picture) => createImageBitmap(picture)));
                for (const old of bitmaps) old.close();
                bitmaps = decoded;
            } catch {
                app.toast("A picture could not be decoded");
                continue;
            }
            draw();
            document.body.classList.add("has-picture");
            canvas.dataset.done = String(header.done);
            app.frame.set(header);
        }
        isDecoding = false;
    }

    function draw() {
        if (bitmaps.length === 0) return;
        const [width, height] = app.size();
        if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
        const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
        context.imageSmoothingEnabled = false;
        const [picture, reference] = bitmaps;
        context.drawImage(picture, 0, 0, width, height);
        handle.hidden = !reference;
        if (reference) {
            const x = Math.round(wipe * width);
            const part = reference.width / width;
            context.drawImage(reference, x * part, 0, (width - x) * part, reference.height, x, 0, width - x, height);
        }
        drawOverlay();
    }

    /** The place of the picture in its frame, in pixels of the page. */
    function place() {
        const frame = overlay.getBoundingClientRect();
        const ratio = window.devicePixelRatio || 1;
        const fit = Math.min(frame.width / canvas.width, frame.height / canvas.height);
        // A picture of the window's size has exactly a pixel for each of the screen.
        const scale = Math.abs(fit * ratio - 1) < 0.01 ? 1 / ratio : fit;
        const [width, height] = [canvas.width * scale, canvas.height * scale];
        const [left, top] = [frame.width - width, frame.height - height].map((rest) => Math.round((rest / 2) * ratio) / ratio);
        return { left, top, width, height, scale };
    }

    function drawOverlay() {
        const ratio = window.devicePixelRatio || 1;
        const { left, top, width, height, scale } = place();
        [overlay.width, overlay.height] = [overlay.clientWidth * ratio, overlay.clientHeight * ratio];
        for (const [name, value] of Object.entries({ left, top, width, height })) canvas.style.setProperty(name, `${value}px`);
        canvas.classList.toggle("enlarged", scale * ratio > 1.5);
        handle.style.left = `${left + wipe * width}px`;
        handle.style.top = `${top}px`;
        handle.style.height = `${height}px`;
        const context = /** @type {CanvasRenderingContext2D} */ (overlay.getContext("2d"));
        context.scale(ratio, ratio);
        context.translate(left, top);
        const [inspection, matrix, pixel] = [app.inspection.get(), app.frame.get()?.screen_from_world, app.pixel.get()];
        if (inspection && matrix && app.raysOverPicture.get()) {
            context.save();
            context.beginPath();
            context.rect(0, 0, width, height);
            context.clip();
            /** @param {import("./vector.js").Vector} p @returns {[number, number, number]} */
            const projected = (p) => {
                const [x, y, depth] = project(matrix, p);
                return [x * scale, y * scale, depth];
            };
            drawRays(context, { inspection, selected: app.ray.get(), project: projected, isCameraRayShown: false });
            context.restore();
        }
        if (pixel) drawMarker(context, pixel, scale);
    }

    /** @param {CanvasRenderingContext2D} context @param {[number, number]} pixel @param {number} scale */
    function drawMarker(context, [x, y], scale) {
        const size = Math.max(scale, 9);
        const [left, top] = [(x + 0.5) * scale - size / 2, (y + 0.5) * scale - size / 2];
        for (const [color, width] of /** @type {[string, number][]} */ ([["#000a", 3.5], ["#fff", 1.5]])) {
            context.strokeStyle = color;
            context.lineWidth = width;
            context.strokeRect(left, top, size, size);
        }
    }

    const sceneSize = () => {
        const bounds = app.scene.get()?.bounds;
        return bounds ? length(subtract(bounds.max, bounds.min)) : 10;
    };

    /** The pixel at a place of the overlay. @param {number} x @param {number} y @returns {[number, number] | null} */
    function pixelAt(x, y) {
        const { left, top, scale } = place();
        const [column, row] = [Math.floor((x - left) / scale), Math.floor((y - top) / scale)];
        return column >= 0 && row >= 0 && column < canvas.width && row < canvas.height ? [column, row] : null;
    }

    attachControls(overlay, {
        camera: app.camera,
        move: (camera, moving) => app.view.set({ camera }, moving),
        size: sceneSize,
        click(x, y) {
            const pixel = pixelAt(x, y);
            if (pixel) app.pixel.set(pixel);
        },
    });
    attachCrosshair(app, overlay);
    attachWipe(handle, overlay, place, () => wipe, (value) => {
        wipe = value;
        draw();
    });

    new ResizeObserver(drawOverlay).observe(overlay);
    for (const signal of [app.pixel, app.frame, app.inspection, app.ray, app.raysOverPicture]) signal.on(() => requestAnimationFrame(drawOverlay));
    return { pixelAt, canvas, overlay };
}

/**
 * The selected pixel by keys: I places it, then Ctrl and the arrows move it (with Shift by ten).
 * @param {App} app
 * @param {HTMLElement} overlay
 */
function attachCrosshair(app, overlay) {
    overlay.addEventListener("keydown", (event) => {
        if (!app.frame.get()) return;
        const [width, height] = app.size();
        const pixel = app.pixel.get();
        if (event.key.toLowerCase() === "i" && !event.ctrlKey) {
            app.pixel.set(pixel ?? [Math.floor(width / 2), Math.floor(height / 2)]);
        } else if ((event.ctrlKey || event.metaKey) && event.key.startsWith("Arrow")) {
            const step = event.shiftKey ? 10 : 1;
            const [x, y] = pixel ?? [Math.floor(width / 2), Math.floor(height / 2)];
            const [dx, dy] = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key] ?? [0, 0];
            app.pixel.set([clamp(x + dx * step, width), clamp(y + dy * step, height)]);
        } else return;
        event.preventDefault();
    });
}

/** @param {number} x @param {number} size */
const clamp = (x, size) => Math.max(0, Math.min(size - 1, x));

/**
 * The handle between picture and reference.
 * @param {HTMLElement} handle
 * @param {HTMLElement} overlay
 * @param {() => {left: number, width: number}} place
 * @param {() => number} get
 * @param {(value: number) => void} set
 */
function attachWipe(handle, overlay, place, get, set) {
    /** @param {number} value */
    const show = (value) => {
        const clamped = Math.max(0, Math.min(1, value));
        handle.setAttribute("aria-valuenow", String(Math.round(clamped * 100)));
        set(clamped);
    };
    handle.addEventListener("pointerdown", (event) => handle.setPointerCapture(event.pointerId));
    handle.addEventListener("pointermove", (event) => {
        if (!handle.hasPointerCapture(event.pointerId)) return;
        const { left, width } = place();
        show((event.clientX - overlay.getBoundingClientRect().left - left) / width);
    });
    handle.addEventListener("keydown", (event) => {
        const step = { ArrowLeft: -0.02, ArrowRight: 0.02, Home: -1, End: 1 }[event.key];
        if (step === undefined) return;
        event.preventDefault();
        show(get() + step);
    });
}
