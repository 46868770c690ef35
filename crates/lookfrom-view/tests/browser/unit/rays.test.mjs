// The segments of an inspection as lines on a canvas, without a browser.

import assert from "node:assert/strict";
import { test } from "node:test";
import { drawRays, linesOfRays } from "../../../assets/rays.js";

globalThis.document = { getElementById: () => ({}) };
globalThis.getComputedStyle = () => ({ getPropertyValue: (name) => name });

/** A canvas's context that keeps its lines with their colours and widths, and its dots. */
function recorder() {
    const drawn = { lines: [], dots: [] };
    let ends = [];
    const context = {
        beginPath: () => (ends = []),
        moveTo: (x, y) => ends.push([x, y]),
        lineTo: (x, y) => ends.push([x, y]),
        arc: (x, y) => (ends = [[x, y]]),
        fill: () => drawn.dots.push([...ends[0], context.fillStyle]),
        stroke: () => ends.length === 2 && drawn.lines.push([...ends.flat(), context.strokeStyle, context.lineWidth]),
        setLineDash: () => {},
        closePath: () => {},
    };
    return { context, drawn };
}

const segment = (address, kind, from, to, is_endless = false) => ({ address, kind, from, to, is_endless, width: 2, name: null, title: "" });
const segments = [
    segment(1, "camera", [0, 0, 1], [1, 0, 1]),
    segment(1, "shadow", [1, 0, 1], [1, 1, 1]),
    segment(1, "blocked", [1, 1, 1], [1, 2, 1]),
    segment(2, "straight on", [1, 0, 1], [2, 0, 1], true),
];
/** Rays at surfaces. */
const rays = [{ address: 1 }, { address: 2 }];

test("each segment is a line of its kind's colour, and an end is a dot", () => {
    const { context, drawn } = recorder();
    drawRays(context, { inspection: { segments, rays }, selected: null, project: (p) => p, isCameraRayShown: false });
    assert.deepEqual(drawn.lines.filter(([, , , , color]) => color.startsWith("--ray")), [
        [1, 0, 1, 1, "--ray-shadow", 2],
        [1, 1, 1, 2, "--ray-blocked", 2],
        [1, 0, 2, 0, "--ray-straight-on", 2],
    ]);
    assert.deepEqual(drawn.dots, [[1, 0, "--ray-camera"], [1, 1, "--ray-shadow"], [1, 2, "--ray-blocked"]]);
});

test("the selected ray is wider, and above the others", () => {
    const { context, drawn } = recorder();
    drawRays(context, { inspection: { segments, rays }, selected: 1, project: (p) => p, isCameraRayShown: true });
    const colors = drawn.lines.filter(([, , , , color]) => color.startsWith("--ray")).map(([, , , , color, width]) => [color, width]);
    assert.deepEqual(colors, [["--ray-straight-on", 2], ["--ray-camera", 3.5], ["--ray-shadow", 3.5], ["--ray-blocked", 3.5]]);
});

test("a point of a medium is a diamond, and null collisions of the selected ray are rings", () => {
    const { context, drawn } = recorder();
    let rings = 0;
    const arc = context.arc;
    context.arc = (x, y, ...rest) => {
        if (x === 0.25 && y === 0) rings++;
        arc(x, y, ...rest);
    };
    const collisions = [{ t: 0.25, is_real: false }, { t: 1, is_real: true }];
    const scattered = { address: 1, kind: "camera", a: [0, 0, 1], direction: [3, 0, 0], tracking: { collisions, scattered_at: [1, 0, 1] } };
    const draw = (selected) => drawRays(context, { inspection: { segments: segments.slice(0, 1), rays: [scattered] }, selected, project: (p) => p, isCameraRayShown: true });
    draw(null);
    assert.equal(rings, 0);
    // Its first corner is above the point.
    const [[x, y, color]] = drawn.dots;
    assert.ok(x === 1 && y < -3 && color === "--ray-camera");
    draw(1);
    assert.equal(rings, 1);
});

test("a ray has one line, its shadow rays have others", () => {
    assert.deepEqual([...linesOfRays({ segments })], [[1, segments[0]], [2, segments[3]]]);
});
