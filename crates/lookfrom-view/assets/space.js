// The second view of the scene: a picture by the same kernel from an observer's eye, with the sample's rays on top.

import { add, cross, dot, length, mix, scale, subtract, unit } from "./vector.js";
import { attachControls } from "./controls.js";
import { project, screenFromWorld } from "./camera.js";
import { byId } from "./html.js";
import { drawSpace } from "./space-drawing.js";
import { end, shadows } from "./rays.js";

/** @typedef {import("./protocol.js").Camera} Camera */
/** @typedef {import("./protocol.js").Vector} Vector */

const FOV = 36;
/** While the hand moves, pictures are smaller by this factor. */
const COARSE = 3;
const MOST_PIXELS = 700_000;

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
        const coarse = isMoving ? COARSE : Math.max(1, Math.sqrt((overlay.clientWidth * overlay.clientHeight) / MOST_PIXELS));
        const size = [overlay.clientWidth, overlay.clientHeight].map((n) => Math.max(8, Math.round(n / coarse)));
        const timeout = setTimeout(() => (asked = false), 10_000);
        try {
            await show(await app.socket.request("space", { camera, size }));
        } catch {
            // The scene is being loaded: the next one asks again.
        }
        clearTimeout(timeout);
        asked = false;
        if (again) ask();
    }

    /** @param {import("./protocol.js").Binary} answer */
    async function show({ header, payload }) {
        const { width, height, sizes, screenFromWorld: matrix } = /** @type {import("./protocol.js").SpaceHeader} */ (header);
        const bitmap = await createImageBitmap(new Blob([payload.slice(0, sizes[0])], { type: "image/png" }));
        const depths = new Float32Array(payload.slice(sizes[0], sizes[0] + sizes[1]));
        frame = { matrix, depths, width, height };
        [canvas.width, canvas.height] = [width, height];
        canvas.getContext("2d")?.drawImage(bitmap, 0, 0);
        hint.hidden = true;
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
        const { clientWidth, clientHeight } = overlay;
        const shown = frame;
        const [sx, sy] = shown ? [clientWidth / shown.width, clientHeight / shown.height] : [1, 1];
        const matrix = shown?.matrix ?? screenFromWorld(camera, [clientWidth, clientHeight]);
        drawSpace(context, {
            inspection,
            camera: viewed,
            size: app.size(),
            lobe,
            selected: app.ray.get(),
            isCameraRayShown: true,
            farAway: sceneSize(),
            project(p) {
                const [x, y, depth] = project(matrix, p);
                return [x * sx, y * sy, depth];
            },
            isHidden(x, y, depth) {
                if (!shown) return false;
                const [column, row] = [Math.floor(x / sx), Math.floor(y / sy)];
                if (column < 0 || row < 0 || column >= shown.width || row >= shown.height) return false;
                return shown.depths[row * shown.width + column] < depth * 0.997;
            },
        });
    }

    /** An observer beside the rays, who sees the eye and all hits. */
    function frameRays() {
        const inspection = app.inspection.get();
        const viewed = app.camera();
        if (!inspection || !viewed) return;
        const first = inspection.rays[0]?.met?.point;
        const reach = Math.min(sceneSize() / 4, first ? 0.6 * length(subtract(first, viewed.lookfrom)) : Infinity);
        const points = inspection.rays.flatMap((ray) => [ray.a, end(ray, reach), ...shadows(ray).filter(({ shadow }) => !shadow.is_endless).map(({ shadow }) => shadow.to)]);
        /** @type {(pick: (...values: number[]) => number) => Vector} */
        const corner = (pick) => /** @type {Vector} */ ([0, 1, 2].map((i) => pick(...points.map((p) => p[i]))));
        const middle = mix(corner(Math.min), corner(Math.max), 0.5);
        const forward = unit(subtract(viewed.lookat, viewed.lookfrom));
        const up = unit(viewed.up);
        const side = unit(cross(forward, up));
        const direction = unit(add(add(scale(side, 0.85), scale(up, 0.45)), scale(forward, -0.35)));
        const size = /** @type {[number, number]} */ ([overlay.clientWidth || 1, overlay.clientHeight || 1]);
        let distance = 3 * Math.max(...points.map((p) => length(subtract(p, middle))), 1e-3);
        // Nearer or farther until the outermost point is just inside; three steps are enough.
        for (let i = 0; i < 3; i++) {
            camera = { lookfrom: add(middle, scale(direction, distance)), lookat: middle, up: viewed.up, fov: FOV };
            const matrix = screenFromWorld(camera, size);
            const outermost = Math.max(...points.map((p) => {
                const [x, y] = project(matrix, p);
                return Math.max(Math.abs((2 * x) / size[0] - 1), Math.abs((2 * y) / size[1] - 1));
            }));
            distance *= Math.max(0.05, outermost / 0.8);
        }
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
            const ray = nearestRay(inspection.rays, x, y);
            if (ray !== null) app.ray.set(ray);
        },
    });

    /** The ray that passes within a finger's reach. @param {import("./protocol.js").Ray[]} rays @param {number} x @param {number} y */
    function nearestRay(rays, x, y) {
        let [best, distance] = [/** @type {number | null} */ (null), 12];
        const at = (/** @type {Vector} */ p) => {
            const [px, py, depth] = project(frame?.matrix ?? [], p);
            return { x: (px * overlay.clientWidth) / (frame?.width ?? 1), y: (py * overlay.clientHeight) / (frame?.height ?? 1), depth };
        };
        for (const ray of rays) {
            const [a, b] = [at(ray.a), at(end(ray, sceneSize()))];
            if (a.depth <= 0 || b.depth <= 0) continue;
            const [dx, dy] = [b.x - a.x, b.y - a.y];
            const s = Math.max(0, Math.min(1, ((x - a.x) * dx + (y - a.y) * dy) / (dx * dx + dy * dy || 1)));
            const d = Math.hypot(a.x + s * dx - x, a.y + s * dy - y);
            if (d < distance) [best, distance] = [ray.address, d];
        }
        return best;
    }

    byId("space-frame").addEventListener("click", () => {
        frameRays();
        ask();
    });
    app.inspection.on((inspection) => {
        document.body.classList.toggle("has-sample", inspection !== null);
        lobe = null;
        // The eye of the observer stays while it still sees the rays.
        if (inspection && (!camera || !isInView(inspection))) frameRays();
        draw();
        ask();
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

    /** @param {import("./protocol.js").Inspection} inspection */
    function isInView(inspection) {
        if (!camera) return false;
        const { lookfrom, lookat } = camera;
        const forward = unit(subtract(lookat, lookfrom));
        const matrix = screenFromWorld(camera, [1, 1]);
        return inspection.rays.every(({ met }) => {
            if (!met?.point) return true;
            const [x, y] = project(matrix, met.point);
            return dot(subtract(met.point, lookfrom), forward) > 0 && Math.abs(x - 0.5) < 0.9 && Math.abs(y - 0.5) < 0.5;
        });
    }
}
