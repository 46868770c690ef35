// Why this pixel: its mean and variance, its largest contributions with the reason, and its samples.

import { byId, h, replace } from "./html.js";
import { exact, lanes, short, swatch } from "./format.js";
import { scatter } from "./scatter.js";

/** @typedef {import("./protocol.js").Contribution} Contribution */
/** @typedef {import("./protocol.js").PixelReport} PixelReport */

const MOST_ROWS = 60;

/** @param {import("./app.js").App} app */
export function showPixel(app) {
    const place = byId("pixel-place");
    const summary = byId("pixel-summary");
    const samples = byId("pixel-samples");
    const sampleSummary = byId("sample-summary");

    const showPlace = () => {
        const pixel = app.pixel.get();
        const axis = (/** @type {0 | 1} */ i) =>
            h("input", { type: "number", min: 0, max: app.size()[i] - 1, step: 1, value: pixel?.[i] ?? "", "aria-label": ["Column", "Row"][i], id: `pixel-${"xy"[i]}` });
        const [x, y] = [axis(0), axis(1)];
        const go = (/** @type {Event} */ event) => {
            event.preventDefault();
            if (x.value !== "" && y.value !== "") app.pixel.set([x.valueAsNumber, y.valueAsNumber]);
        };
        replace(place, h("form", { class: "row", onsubmit: go }, h("label", { for: "pixel-x" }, "Pixel"), x, y, h("button", {}, "Inspect")));
    };

    const show = () => {
        const report = app.report.get();
        const pixel = app.pixel.get();
        if (!report) {
            const hint = !pixel
                ? "Click a pixel of the picture, or press I in it, to see why it has its colour."
                : app.isConnected.get() ? "Tracing the pixel's samples …" : "There is no connection: the pixel's samples are traced when it is back.";
            replace(summary, h("p", { class: "hint" }, hint));
            replace(samples);
            return;
        }
        replace(summary, numbers(report), contributionList("Largest contributions", report.contributions, select));
        showSamples(report);
    };

    /** Selects a contribution: its sample, and the ray that made it. @param {Contribution} contribution */
    function select({ sample, address }) {
        if (address !== undefined) app.ray.set(address);
        app.sample.set(sample);
    }

    const showSample = () => {
        const inspection = app.inspection.get();
        if (!inspection) return replace(sampleSummary);
        const { sample, film, contributions } = inspection;
        replace(sampleSummary,
            h("h3", {}, `Sample ${sample}`),
            h("p", { class: "number" }, swatch(film), ` ${lanes(film, 6)}`),
            contributions && contributionList("Its largest contributions", contributions, select));
    };

    /** @param {PixelReport} report */
    function showSamples(report) {
        const list = h("div", { class: "list", id: "samples" });
        const plot = scatter(report.all, {
            selected: app.sample.get(),
            select: (sample) => app.sample.set(sample),
            brush: (rows) => fill(rows),
        });
        /** @param {PixelReport["all"]} rows */
        function fill(rows) {
            replace(
                list,
                h("p", { class: "faint" }, rows.length === report.all.length ? `${rows.length} samples, brightest first` : `${rows.length} of ${report.all.length} samples`),
                h("table", {}, h("thead", {}, h("tr", {}, ["sample", "luminance", "depth", "path"].map((name) => h("th", { scope: "col" }, name)))),
                    h("tbody", {}, rows.slice(0, MOST_ROWS).map((row) => sampleRow(row)))),
                rows.length > MOST_ROWS && h("p", { class: "faint" }, `… and ${rows.length - MOST_ROWS} darker ones`),
            );
            mark();
        }
        /** @param {PixelReport["all"][number]} row */
        const sampleRow = (row) =>
            h("tr", { "data-sample": row.sample },
                h("td", {}, h("button", { type: "button", class: "link", "aria-label": `Sample ${row.sample}`, onclick: () => app.sample.set(row.sample) }, String(row.sample))),
                h("td", {}, swatch(row.film), " ", short(row.luminance, 4)),
                h("td", {}, String(row.depth)),
                h("td", { class: "expression" }, row.expression));
        function mark() {
            for (const row of list.querySelectorAll("tr[data-sample]")) {
                const isSelected = row.getAttribute("data-sample") === String(app.sample.get());
                row.classList.toggle("selected", isSelected);
                row.querySelector("button")?.setAttribute("aria-pressed", String(isSelected));
            }
        }
        fill(report.all);
        replace(samples, plot.element, list);
        selectInList = () => {
            plot.select(app.sample.get());
            mark();
        };
    }
    let selectInList = () => {};

    app.scene.on(showPlace);
    app.pixel.on(showPlace);
    app.pixel.on(show);
    app.report.on(show);
    app.isConnected.on(() => void (app.report.get() || show()));
    app.inspection.on(showSample);
    app.sample.on(() => selectInList());
    showPlace();
    show();
}

/** @param {PixelReport} report */
function numbers(report) {
    const [r, g, b] = report.color8;
    return h("dl", { class: "facts numbers" },
        h("dt", {}, "mean"), h("dd", {}, swatch(report.mean), " ", lanes(report.mean), report.standard_error && h("span", { class: "faint" }, ` ± ${lanes(report.standard_error, 2)}`)),
        h("dt", {}, "variance"), h("dd", {}, lanes(report.variance)),
        h("dt", {}, "8 bit"), h("dd", {}, `${r} ${g} ${b}`),
        h("dt", {}, "samples"), h("dd", {}, exact(report.samples)));
}

/**
 * @param {string} title
 * @param {Contribution[]} contributions
 * @param {(contribution: Contribution) => void} select
 */
function contributionList(title, contributions, select) {
    if (contributions.length === 0) return h("p", { class: "hint" }, "No light.");
    return h("section", { class: "contributions", "aria-label": title },
        h("h3", {}, title),
        h("ol", {}, contributions.slice(0, 3).map((contribution) =>
            h("li", {}, h("button", { type: "button", onclick: () => select(contribution) },
                h("span", { class: "expression" }, contribution.expression),
                h("span", { class: "value" }, swatch(contribution.value), " ", lanes(contribution.value, 3)),
                h("span", { class: "why" }, contribution.why, h("span", {}, ` · sample ${contribution.sample}`)))))));
}
