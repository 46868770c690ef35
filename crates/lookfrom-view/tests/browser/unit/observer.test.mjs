// Where an observer stands, and what is in sight from there, without a browser.

import assert from "node:assert/strict";
import { test } from "node:test";
import { observer, sight } from "../../../assets/observer.js";

const segment = (kind, from, to, is_endless = false) => ({ address: 1, kind, from, to, is_endless, width: 1, name: null, title: "" });
const viewed = { lookfrom: [0, 0, -10], lookat: [0, 0, 0], up: [0, 1, 0], fov: 40 };
/** Two points of a fog, of which no surface knows, a lamp far away, and the sky. */
const inFog = {
    rays: [{ met: null }, { met: null }],
    segments: [
        segment("camera", [0, 0, -10], [0, 0, 0]),
        segment("scattered", [0, 0, 0], [1, 1, 0]),
        segment("shadow", [1, 1, 0], [500, 500, 0]),
        segment("scattered", [1, 1, 0], [-900, 0, 0], true),
    ],
};

test("vertices in media count as seen only where they are in the frame", () => {
    assert.equal(sight(inFog, viewed), 1);
    const away = { ...viewed, lookat: [0, 0, -20] };
    assert.equal(sight(inFog, away), 0);
    assert.equal(sight({ ...inFog, segments: inFog.segments.slice(3) }, away), 1);
});

test("near the camera, an observer sees the vertices, however far a lamp is", () => {
    const near = observer(inFog, viewed, [400, 200], 1000, "near");
    assert.ok(Math.hypot(...near.lookat) < 2, near.lookat.join());
    assert.equal(sight(inFog, near), 1);
});
