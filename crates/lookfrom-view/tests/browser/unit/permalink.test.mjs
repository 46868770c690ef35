// Addresses of the page say the view that they are made of, without a browser.

import assert from "node:assert/strict";
import { test } from "node:test";
import { fragment, parse } from "../../../assets/permalink.js";
import { SCENES_OWN } from "../../../assets/state.js";

const round = (view, pixel, sample, ray) => parse(`#${fragment({ ...SCENES_OWN, ...view }, pixel, sample, ray)}`);

test("words of any characters, pixels, samples and rays come back", () => {
    for (const word of ["50%", "100%25", "a+b c", "a&b=c", "ö/ü,", "%2C%2F"]) {
        const back = round({ variant: word, depth: 3 }, [12, 34], 5, 6);
        assert.equal(back.view.variant, word);
        assert.equal(back.view.depth, 3);
        assert.deepEqual([back.pixel, back.sample, back.ray], [[12, 34], 5, 6]);
    }
});

test("eyes far from the origin come back to a micrometre, and links stay readable", () => {
    const camera = { lookfrom: [4123456.123456, -812345.654321, 0.1], lookat: [4123457.5, -812345, 0], up: [0, 1, 0], fov: 40 };
    assert.deepEqual(round({ camera }, null, null, null).view.camera, camera);
    const near = { lookfrom: [0, 1, 5], lookat: [0, 0, 0], up: [0, 1, 0], fov: null };
    assert.equal(fragment({ ...SCENES_OWN, camera: near }, null, null, null), "camera=0,1,5/0,0,0/0,1,0");
});

test("a sample and a ray are those of a pixel: without one the address has none", () => {
    assert.equal(fragment(SCENES_OWN, null, 5, 6), "");
    assert.equal(fragment(SCENES_OWN, [1, 2], null, 6), "pixel=1,2");
});

test("numbers that count things are whole", () => {
    const { view, pixel } = parse("#samples=0.5&depth=-1&animation=x&size=1.5x2&pixel=3,-4&at=0.5");
    assert.deepEqual([view, pixel], [{ ...SCENES_OWN, at: 0.5 }, null]);
});
