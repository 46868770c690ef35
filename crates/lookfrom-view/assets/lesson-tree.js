// The tree of rays, grown and pruned by sliders; and the proof that its contributions are the pixel, bit for bit.

import { h, replace, svg } from "./html.js";
import { slider } from "./fields.js";
import { exact, fileName, short, single, swatch } from "./format.js";
import { linesOfRays } from "./rays.js";
import { noPixel } from "./no-pixel.js";

/** @typedef {import("./protocol.js").Inspection} Inspection */

/** @param {import("./app.js").App} app */
export function treeLesson(app) {
    const element = h("div");
    const picture = h("div");
    const sum = h("div", { id: "sum" });
    let depth = -1;
    /** The exponent of min_contribution; the lowest stands for 0. */
    let power = -6;
    let timer = 0;
    /** The sample as it is. @type {Inspection | null} */
    let whole = null;
    /** That or a tree of the sliders. @type {Inspection | null} */
    let last = null;
    const leastShare = () => (power <= -6 ? 0 : 10 ** power);
    return { element, show, leave };

    function show() {
        const inspection = app.inspection.get();
        const scene = app.scene.get();
        if (!inspection || !scene) return replace(element, noPixel());
        if (inspection === last) return draw(inspection);
        last = whole = inspection;
        depth = app.view.get().depth ?? scene.depth;
        const least = app.view.get().min_contribution ?? scene.min_contribution;
        power = least > 0 ? Math.max(-5.9, Math.log10(least)) : -6;
        const grow = slider("Depth", { min: 0, max: Math.max(12, Math.min(depth, 64)), step: 1 }, () => depth, (value) => ((depth = value), ask()));
        const prune = slider("Smallest share", { min: -6, max: 0, step: 0.1 }, () => power, (value) => ((power = value), ask()), () => short(leastShare(), 2));
        replace(element, h("p", {}, "Depth lets the tree grow; the smallest share prunes branches that carry less. The pixel is the sum of what is left."),
            grow.element, prune.element, picture, sum);
        draw(inspection);
    }

    function ask() {
        clearTimeout(timer);
        timer = window.setTimeout(async () => {
            const [pixel, sample] = [app.pixel.get(), app.sample.get()];
            if (!pixel || sample === null) return;
            try {
                const before = last;
                const { inspection } = await app.socket.request("inspect", { x: pixel[0], y: pixel[1], sample, depth, min_contribution: leastShare() });
                // Another sample, or the lesson is left.
                if (last !== before) return;
                last = inspection;
                app.inspection.set(inspection);
            } catch (error) {
                app.complain(error);
            }
        }, 60);
    }

    /** Outside of the lesson the sample is as the picture has it. */
    function leave() {
        clearTimeout(timer);
        if (last !== null && last !== whole && app.inspection.get() === last) {
            app.inspection.set(whole);
            if (!app.selectedRay()) app.ray.set(whole?.rays[0].address ?? null);
        }
        last = null;
    }

    /** @param {Inspection} inspection */
    function draw(inspection) {
        replace(picture, diagram(inspection, app.ray.get(), (address) => app.ray.set(address)));
        replace(sum, proof(inspection));
    }
}

/** @param {Inspection} inspection @param {number | null} selected @param {(address: number) => void} select */
function diagram(inspection, selected, select) {
    const { rays } = inspection;
    const lines = linesOfRays(inspection);
    /** @type {Map<number, {x: number, y: number}>} */
    const places = new Map();
    const levels = Math.max(...rays.map(({ depth }) => depth)) + 1;
    /** Leaves stand side by side, parents above the middle of their children. */
    let leaves = 0;
    /** @type {(address: number) => number} */
    const lay = (address) => {
        const below = rays.filter(({ parent }) => parent === address);
        const xs = below.map((ray) => lay(ray.address));
        const x = xs.length > 0 ? xs.reduce((a, b) => a + b) / xs.length : leaves++;
        places.set(address, { x, y: rays.find((ray) => ray.address === address)?.depth ?? 0 });
        return x;
    };
    rays.filter(({ parent }) => parent === null).forEach(({ address }) => lay(address));
    const tall = Math.min(26, 260 / levels);
    const at = (/** @type {number} */ address) => {
        const { x, y } = places.get(address) ?? { x: 0, y: 0 };
        return [20 + ((x + 0.5) / Math.max(leaves, 1)) * 360, 14 + y * tall];
    };
    return svg("svg", { viewBox: `0 0 400 ${28 + (levels - 1) * tall}`, class: "figure", role: "img", "aria-label": `A tree of ${rays.length} rays, ${levels} levels` },
        rays.map((ray) => {
            if (ray.parent === null) return null;
            const [[x1, y1], [x2, y2]] = [at(ray.parent), at(ray.address)];
            return svg("line", { x1, y1, x2, y2, class: `edge ${ray.kind}`, "stroke-width": lines.get(ray.address)?.width.toFixed(1) });
        }),
        rays.map((ray) => {
            const [cx, cy] = at(ray.address);
            return svg("circle", { cx, cy, r: ray.address === selected ? 6 : 4, class: `node ${ray.kind} ${ray.address === selected ? "selected" : ""}`, onclick: () => select(ray.address) }, svg("title", {}, `ray ${ray.address}: ${ray.kind}`));
        }));
}

/**
 * The page adds the contributions again, in f32 and in order, as the renderer did.
 * @param {Inspection} inspection
 */
function proof({ additions, radiance, film, adds_up, weight }) {
    /** @type {number[]} */
    let sum = radiance.lanes.map(() => 0);
    for (const { value } of additions) sum = sum.map((x, i) => Math.fround(x + Math.fround(value.lanes[i])));
    const isSame = sum.every((x, i) => x === Math.fround(radiance.lanes[i]));
    const row = (/** @type {string} */ name, /** @type {number[]} */ lanes, /** @type {readonly number[]} */ rgb, kind = "") =>
        h("tr", { class: kind }, h("th", { scope: "row" }, swatch(rgb), ` ${name}`), lanes.map((x) => h("td", {}, single(x))));
    return [
        h("p", { class: `verdict ${adds_up ? "good" : "bad"}`, role: "status", id: "adds-up" }, adds_up ? "It adds up, bit for bit." : "It does not add up: please report this."),
        h("div", { class: "scroll tall", tabindex: "0", role: "region", "aria-label": "contributions" }, h("table", { class: "twice" },
            h("tbody", {}, additions.map(({ address, term, value }) => row(`${address} ${fileName(term)}`, value.lanes, value.rgb))),
            h("tfoot", {},
                row("sum, by this page", sum, radiance.rgb, isSame ? "good" : "bad"),
                row("radiance", radiance.lanes, radiance.rgb),
                row(weight === 1 ? "film" : `film (weight ${exact(weight)})`, film, film, "film")))),
        h("p", { class: "hint" }, isSame ? "The page's own sum in f32 has the same bits as the renderer's." : "The page's sum differs from the renderer's."),
    ];
}
