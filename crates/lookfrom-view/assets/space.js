// The second view of the scene: a picture by the same kernel from an observer's eye, with the sample's rays on top.

import { length, subtract } from "./vector.js";
import { attachControls } from "./controls.js";
import { project, screenFromWorld } from "./camera.js";
import { byId } from "./html.js";
import { drawSpace } from "./space-drawing.js";
import { observer, sight, vertices } from "./observer.js";

/** @typedef {import("./protocol.js").Camera} Camera */
/** @typedef {import("./protocol.js").Vector} Vector */

/** While the hand moves, pictures are smaller by this factor. */
const COARSE = 3;
/** At rest there are several samples for each pixel of the screen, which the browser averages when it draws them smaller. */
const [SIDE_OF_PIXEL, MOST_PIXELS] = [2, 2_500_000];

/** @param {import("./app.js").App} app */
export function showSpace(app) {
    const overlay = /** @type {HTMLCanvasElement} */ (byId("space-overlay"));
    const canvas = /** @type {HTMLCanvasElement} */ (byId("space"));
    const hint = byId("space-hint");
    /** @type {Camera | null} */
    let camera = null;
    /** @type {{matrix: number[], depths: Float32Array, width: number, height: number} | null} */
    let frame = null;
    /** @type {import("./protocol.js").Lobe | null} */
    let lobe = null;
    let asked = false;
    let again = false;
    let isMoving = false;
    /** @type {import("./observer.js").Place} */
    let place = "beside";
    /** Whether the observer's place is our choice, which may turn out to be behind a wall. */
    let isFresh = false;

    const sceneSize = () => {
        const bounds = app.scene.get()?.bounds;
        return bounds ? length(subtract(bounds.max, bounds.min)) || 1 : 10;
    };

    /** A picture at a time; the newest camera is asked for when one has come. */
    async function ask() {
        if (!camera || canvas.closest("[hidden]") || overlay.clientWidth < 20) return;
        if (asked) return void (again = true);
        asked = true;
        again = false;
        const [width, height] = [overlay.clientWidth, overlay.clientHeight];
        const fine = Math.min(SIDE_OF_PIXEL * (window.devicePixelRatio || 1), Math.sqrt(MOST_PIXELS / (width * height)));
        const isFirst = !frame;
        const scale = isMoving || isFirst ? 1 / COARSE : fine;
        const size = [width, height].map((n) => Math.max(8, Math.round(n * scale)));
        const timeout = setTimeout(() => (asked = false), 10_000);
        try {
            await show(await app.socket.request("space", { camera, size }));
            again ||= isFirst && !isMoving;
        } catch {
            // The scene is being loaded: the next one asks again.
        }
        clearTimeout(timeout);
        asked = false;
        if (again) ask();
    }

    /** @param {import("./protocol.js").Answers["space"]} answer */
    async function show({ header, payload }) {
        const { width, height, sizes, screen_from_world: matrix } = header;
        const bitmap = await createImageBitmap(new Blob([payload.slice(0, sizes[0])], { type: "image/png" }));
        const depths = new Float32Array(payload.slice(sizes[0], sizes[0] + sizes[1]));
        frame = { matrix, depths, width, height };
        [canvas.width, canvas.height] = [width, height];
        canvas.getContext("2d")?.drawImage(bitmap, 0, 0);
        hint.hidden = true;
        if (isFresh && isBlind()) comeNearer();
        isFresh = false;
        draw();
    }

    function draw() {
        const ratio = window.devicePixelRatio || 1;
        [overlay.width, overlay.height] = [overlay.clientWidth * ratio, overlay.clientHeight * ratio];
        const context = /** @type {CanvasRenderingContext2D} */ (overlay.getContext("2d"));
        const inspection = app.inspection.get();
        const viewed = app.camera();
        if (!camera || !inspection || !viewed) return;
        context.scale(ratio, ratio);
        drawSpace(context, {
            inspection,
            camera: viewed,
            size: app.size(),
            lobe,
            selected: app.ray.get(),
            isCameraRayShown: true,
            sceneSize: sceneSize(),
            project: projected,
            isHidden,
        });
    }

    /** A point of the world in pixels of the page, by the matrix of the picture that is shown. @param {Vector} p @returns {[number, number, number]} */
    function projected(p) {
        const { clientWidth, clientHeight } = overlay;
        if (!frame) return camera ? project(screenFromWorld(camera, [clientWidth, clientHeight]), p) : [0, 0, -1];
        const [x, y, depth] = project(frame.matrix, p);
        return [(x * clientWidth) / frame.width, (y * clientHeight) / frame.height, depth];
    }

    /** @param {number} x @param {number} y @param {number} depth */
    function isHidden(x, y, depth) {
        if (!frame) return false;
        const [column, row] = [Math.floor((x * frame.width) / overlay.clientWidth), Math.floor((y * frame.height) / overlay.clientHeight)];
        if (column < 0 || row < 0 || column >= frame.width || row >= frame.height) return false;
        return frame.depths[row * frame.width + column] < depth * 0.995;
    }

    /** @param {import("./observer.js").Place} place */
    function cameraAt(place) {
        const inspection = app.inspection.get();
        const viewed = app.camera();
        return inspection && viewed && observer(inspection, viewed, [overlay.clientWidth || 1, overlay.clientHeight || 1], sceneSize(), place);
    }

    /** @param {import("./observer.js").Place} next */
    function stand(next) {
        const there = cameraAt(next);
        if (!there) return;
        [place, camera] = [next, there];
        ask();
    }

    /** Goes within the walls, unless most would be out of sight from there. */
    function comeNearer() {
        const inspection = app.inspection.get();
        const there = cameraAt("near");
        if (inspection && there && sight(inspection, there) > 0.5) stand("near");
    }

    /** Whether walls stand between the observer and most of the vertices. */
    function isBlind() {
        const inspection = app.inspection.get();
        const points = inspection ? vertices(inspection) : [];
        const hidden = points.filter((point) => {
            const [x, y, depth] = projected(point);
            return isHidden(x, y, depth);
        });
        return points.length > 0 && hidden.length > 0.5 * points.length;
    }

    attachControls(overlay, {
        camera: () => camera,
        size: sceneSize,
        move(next, moving) {
            camera = next;
            isMoving = moving;
            ask();
            if (!frame) draw();
        },
        click(x, y) {
            const inspection = app.inspection.get();
            if (!inspection || !frame) return;
            const ray = nearestRay(inspection.segments, x, y);
            if (ray !== null) app.ray.set(ray);
        },
    });

    /** The ray that passes within a finger's reach, or the one whose shadow ray does. @param {import("./protocol.js").Segment[]} segments @param {number} x @param {number} y */
    function nearestRay(segments, x, y) {
        let [best, distance] = [/** @type {number | null} */ (null), 12];
        for (const { address, from, to } of segments) {
            const [[x0, y0, d0], [x1, y1, d1]] = [projected(from), projected(to)];
            if (d0 <= 0 || d1 <= 0) continue;
            const [dx, dy] = [x1 - x0, y1 - y0];
            const s = Math.max(0, Math.min(1, ((x - x0) * dx + (y - y0) * dy) / (dx * dx + dy * dy || 1)));
            const d = Math.hypot(x0 + s * dx - x, y0 + s * dy - y);
            if (d < distance) [best, distance] = [address, d];
        }
        return best;
    }

    byId("space-frame").addEventListener("click", () => stand(place === "near" ? "beside" : "near"));
    app.inspection.on((inspection) => {
        document.body.classList.toggle("has-sample", inspection !== null);
        showKinds(inspection?.segments ?? []);
        lobe = null;
        // The eye of the observer stays while it still sees the rays.
        if (inspection && (!camera || sight(inspection, camera) < 1)) {
            stand("beside");
            isFresh = true;
        } else ask();
        draw();
    });
    app.ray.on(async (address) => {
        lobe = null;
        draw();
        const ray = app.selectedRay();
        const [pixel, sample] = [app.pixel.get(), app.sample.get()];
        if (address === null || !pixel || sample === null || !ray?.met) return;
        try {
            lobe = await app.socket.request("lobe", { x: pixel[0], y: pixel[1], sample, address });
            draw();
        } catch {
            // No balloon: this surface scatters in single directions only.
        }
    });
    app.scene.on(() => {
        camera = null;
        frame = null;
        ask();
    });
    new ResizeObserver(() => {
        draw();
        ask();
    }).observe(overlay);
}

/** Keeps those colours in the legend that there are. @param {import("./protocol.js").Segment[]} segments */
function showKinds(segments) {
    const kinds = new Set(segments.map(({ kind }) => kind));
    for (const row of byId("rays-legend").children) {
        const named = row.getAttribute("data-kinds")?.split(", ") ?? [];
        /** @type {HTMLElement} */ (row).hidden = !named.some((kind) => kinds.has(/** @type {any} */ (kind)));
    }
}
