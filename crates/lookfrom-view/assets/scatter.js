// The samples of a pixel as a scatter: brightness over depth, colour by light; a brush selects.

import { h, svg } from "./html.js";
import { short } from "./format.js";

/** @typedef {import("./protocol.js").SampleRow} SampleRow */

const [WIDTH, HEIGHT, LEFT, BOTTOM, TOP, RIGHT] = [440, 190, 42, 26, 8, 8];
const MOST_DOTS = 3000;
/** Colours in style.css. */
const COLORS = 8;

/** A number in [0, 1) for a sample, so that dots of the same depth stand side by side. @param {number} n */
const spread = (n) => (n * 0.6180339887) % 1;

/**
 * @param {SampleRow[]} rows brightest first
 * @param {{selected: number | null, select: (sample: number) => void, brush: (rows: SampleRow[]) => void}} hand
 */
export function scatter(rows, hand) {
    const shown = rows.slice(0, MOST_DOTS);
    const lit = shown.filter(({ luminance }) => luminance > 0 && luminance < Infinity);
    const lights = [...new Set(shown.map(({ light }) => light ?? "none"))];
    const deepest = Math.max(1, ...shown.map(({ depth }) => depth));
    // Five decades at most: what is darker lies on the line of zero.
    const brightest = Math.max(1e-6, ...lit.map(({ luminance }) => luminance));
    const high = Math.ceil(Math.log10(brightest) + 0.05);
    const low = Math.max(high - 5, Math.min(high - 1, Math.floor(Math.log10(Math.min(brightest, ...lit.map(({ luminance }) => luminance))))));
    const x = (/** @type {SampleRow} */ { depth, sample }) => LEFT + ((depth + 0.15 + 0.7 * spread(sample)) / (deepest + 1)) * (WIDTH - LEFT - RIGHT);
    const y = (/** @type {number} */ luminance) => {
        const part = luminance > 0 ? Math.min(1, (Math.log10(luminance) - low) / (high - low)) : -1;
        return part < 0 ? HEIGHT - BOTTOM - 4 : HEIGHT - BOTTOM - 20 - part * (HEIGHT - BOTTOM - TOP - 20);
    };

    const dots = shown.map((row) => svg("circle", { cx: x(row).toFixed(1), cy: y(row.luminance).toFixed(1), r: 3, class: `light-${lights.indexOf(row.light ?? "none") % COLORS}`, "data-sample": row.sample },
        svg("title", {}, `sample ${row.sample}: ${short(row.luminance, 4)}, depth ${row.depth}\n${row.expression}`)));
    const area = svg("rect", { class: "brush", x: 0, y: 0, width: 0, height: 0, visibility: "hidden" });
    const ticks = Array.from({ length: high - low + 1 }, (_, i) => low + i).map((power) => [
        svg("line", { x1: LEFT, x2: WIDTH - RIGHT, y1: y(10 ** power), y2: y(10 ** power), class: "grid" }),
        svg("text", { x: LEFT - 6, y: y(10 ** power) + 3.5, class: "end" }, Math.abs(power) <= 3 ? String(Number((10 ** power).toPrecision(1))) : `1e${power}`),
    ]);
    ticks.push([svg("line", { x1: LEFT, x2: WIDTH - RIGHT, y1: y(0), y2: y(0), class: "grid" }), svg("text", { x: LEFT - 6, y: y(0) + 3.5, class: "end" }, "0")]);
    const step = Math.ceil((deepest + 1) / 12);
    const depths = Array.from({ length: deepest + 1 }, (_, depth) => depth).filter((depth) => depth % step === 0).map((depth) =>
        svg("text", { x: LEFT + ((depth + 0.5) / (deepest + 1)) * (WIDTH - LEFT - RIGHT), y: HEIGHT - 15, class: "middle" }, String(depth)));
    const picture = svg("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, class: "scatter", role: "img", "aria-label": `${rows.length} samples: luminance over depth. The table below has the same.` },
        ticks.flat(), depths, svg("text", { x: WIDTH - RIGHT, y: HEIGHT - 3, class: "end" }, "bounces"), area, dots);

    /** @param {number | null} sample */
    function select(sample) {
        for (const dot of dots) {
            const isSelected = dot.getAttribute("data-sample") === String(sample);
            dot.classList.toggle("selected", isSelected);
            dot.setAttribute("r", isSelected ? "5.5" : "3");
            if (isSelected) picture.append(dot);
        }
    }
    select(hand.selected);
    attachBrush(picture, area, (box, isClick) => {
        if (isClick) {
            const nearest = closest(shown.map((row) => [x(row), y(row.luminance)]), box.x, box.y);
            if (nearest !== null) hand.select(shown[nearest].sample);
            hand.brush(rows);
            return;
        }
        hand.brush(shown.filter((row) => {
            const [px, py] = [x(row), y(row.luminance)];
            return px >= box.x && px <= box.x + box.width && py >= box.y && py <= box.y + box.height;
        }));
    });
    const legend = h("ul", { class: "lights" }, lights.slice(0, COLORS).map((light, i) => h("li", {}, h("span", { class: `key light-${i}` }), light)));
    return { element: h("figure", {}, h("figcaption", { class: "faint" }, "luminance of each sample over its bounces; drag to select"), picture, legend), select };
}

/** The index of the nearest point within a finger's reach. @param {number[][]} points @param {number} x @param {number} y */
function closest(points, x, y) {
    let [best, distance] = [/** @type {number | null} */ (null), 15];
    points.forEach(([px, py], i) => {
        const d = Math.hypot(px - x, py - y);
        if (d < distance) [best, distance] = [i, d];
    });
    return best;
}

/**
 * @param {SVGSVGElement} picture
 * @param {SVGRectElement} area
 * @param {(box: {x: number, y: number, width: number, height: number}, isClick: boolean) => void} done
 */
function attachBrush(picture, area, done) {
    /** @type {[number, number] | null} */
    let start = null;
    /** @param {PointerEvent} event @returns {[number, number]} */
    const place = (event) => {
        const box = picture.getBoundingClientRect();
        return [((event.clientX - box.left) / box.width) * WIDTH, ((event.clientY - box.top) / box.height) * HEIGHT];
    };
    /** @param {PointerEvent} event */
    const box = (event) => {
        const [[x0, y0], [x1, y1]] = [start ?? [0, 0], place(event)];
        return { x: Math.min(x0, x1), y: Math.min(y0, y1), width: Math.abs(x1 - x0), height: Math.abs(y1 - y0) };
    };
    picture.addEventListener("pointerdown", (event) => {
        start = place(event);
        picture.setPointerCapture(event.pointerId);
    });
    picture.addEventListener("pointermove", (event) => {
        if (!start) return;
        area.setAttribute("visibility", "visible");
        for (const [name, value] of Object.entries(box(event))) area.setAttribute(name, String(value));
    });
    picture.addEventListener("pointerup", (event) => {
        const found = box(event);
        const isClick = found.width + found.height < 5;
        if (isClick) area.setAttribute("visibility", "hidden");
        done(found, isClick);
        start = null;
    });
}
