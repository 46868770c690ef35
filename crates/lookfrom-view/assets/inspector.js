// The way from a pixel to its samples, and from a sample to its rays: questions to the server, answers to the page.

import { counted } from "./format.js";
import { Unanswered } from "./socket.js";
import { sameFilm } from "./state.js";

/** @param {import("./app.js").App} app */
export function attachInspector(app) {
    let lastView = app.view.get();
    let timer = 0;
    let tracing = 0;
    /** Whether the rays of the sample are those of another pixel or film. Its report alone has colours as they are developed. */
    let isStale = false;
    /** The sample that a link asks for, until its pixel is there. */
    let wanted = app.sample.get();
    let wantedRay = app.ray.get();

    app.pixel.on(() => {
        isStale = true;
        app.report.set(null);
        app.sample.set(wanted);
        if (wanted === null) app.inspection.set(null);
        load();
    });
    app.sample.on(inspect);
    app.scene.on(() => {
        isStale = true;
        load();
    });
    app.view.on((view, moving) => {
        if (moving) return;
        const isSameFilm = sameFilm(view, lastView);
        if (isSameFilm && view.exposure === lastView.exposure && view.tonemap === lastView.tonemap) return;
        isStale ||= !isSameFilm;
        lastView = view;
        clearTimeout(timer);
        timer = window.setTimeout(load, 250);
    });

    async function load() {
        const pixel = app.pixel.get();
        const scene = app.scene.get();
        document.body.classList.toggle("has-pixel", pixel !== null);
        if (!pixel || !scene) return;
        const [width, height] = app.size();
        if (pixel[0] >= width || pixel[1] >= height) return app.pixel.set(null);
        traced(1);
        try {
            const { report } = await app.socket.request("pixel", { x: pixel[0], y: pixel[1] });
            app.report.set(finite(report));
            choose(report.all?.[0]?.sample ?? 0);
            const [red, green, blue] = report.color8;
            app.announce(`Pixel ${pixel.join(" ")}: red ${red}, green ${green}, blue ${blue}; ${counted(report.samples, "sample")}`);
        } catch (error) {
            app.complain(error);
            if (!(error instanceof Unanswered)) choose(0);
        } finally {
            traced(-1);
        }
    }

    /** Counts questions for pixels that are under way: one may replace another. @param {1 | -1} more */
    function traced(more) {
        tracing += more;
        document.body.classList.toggle("is-tracing", tracing > 0);
    }

    /** Keeps the sample that is chosen, or that the link asks for. @param {number} otherwise */
    function choose(otherwise) {
        if (!isStale) return;
        isStale = false;
        const sample = wanted ?? app.sample.get() ?? otherwise;
        wanted = null;
        if (app.sample.get() === sample) inspect(sample);
        else app.sample.set(sample);
    }

    /** @param {number | null} sample */
    async function inspect(sample) {
        const pixel = app.pixel.get();
        if (!pixel || sample === null || !app.scene.get()) return;
        try {
            const { inspection } = await app.socket.request("inspect", { x: pixel[0], y: pixel[1], sample });
            const address = wantedRay ?? app.ray.get();
            wantedRay = null;
            app.inspection.set(inspection);
            const known = inspection.rays.some((ray) => ray.address === address);
            app.ray.set(known ? address : brightest(inspection));
        } catch (error) {
            app.complain(error);
            if (!(error instanceof Unanswered)) keep(sample);
        }
    }

    /** Goes on with the sample that is shown, or with the brightest, where another one cannot be. @param {number} refused */
    function keep(refused) {
        const other = app.inspection.get()?.sample ?? app.report.get()?.all[0]?.sample ?? null;
        app.sample.set(other === refused ? null : other);
    }
}

/**
 * A report whose luminances are numbers: JSON has those that are not finite as strings.
 * @param {import("./protocol.js").PixelReport} report
 * @returns {import("./protocol.js").PixelReport}
 */
function finite(report) {
    return {
        ...report,
        all: report.all.map((row) => ({ ...row, luminance: Number.isFinite(Number(row.luminance)) ? Number(row.luminance) : Infinity })),
    };
}

/**
 * The ray whose own hit contributes most: the answer to "why is this pixel bright?".
 * @param {import("./protocol.js").Inspection} inspection
 */
function brightest(inspection) {
    const sum = (/** @type {import("./protocol.js").Ray} */ ray) => ray.added.rgb.reduce((total, x) => total + x, 0);
    return inspection.rays.reduce((best, ray) => (sum(ray) > sum(best) ? ray : best)).address;
}
