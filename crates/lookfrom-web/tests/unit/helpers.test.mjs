// Helpers without a browser: workers that note what they are told.

import assert from "node:assert/strict";
import { test } from "node:test";
import { createHelpers } from "../../assets/helpers.js";

/** A worker that answers each part with a film of one byte, unless it cannot. */
class Told {
    messages = [];
    isEnded = false;
    /** @param {() => boolean} isAble */
    constructor(isAble) {
        this.isAble = isAble;
    }
    postMessage(message) {
        this.messages.push(Object.keys(message)[0]);
        if (message.module) queueMicrotask(() => this.onmessage({ data: null }));
        if (message.render) queueMicrotask(() => (this.isAble() ? this.onmessage({ data: { film: new ArrayBuffer(1) } }) : this.onmessage({ data: { fault: "a trap" } })));
    }
    terminate() {
        this.isEnded = true;
    }
}

test("a helper is told of files and views that it does not know, and used again", async () => {
    const [workers, shown] = [[], { edition: 1, view: "a", messages: () => [{ forget: true }, { file: { bytes: new Uint8Array(3) } }, { open: {} }] }];
    let isAble = true;
    const helpers = createHelpers(() => (workers.push(new Told(() => isAble)), workers.at(-1)), Promise.resolve({}), () => shown);
    assert.equal((await helpers.render("1")).byteLength, 1);
    await helpers.render("2");
    shown.view = "b";
    await helpers.render("3");
    shown.edition = 2;
    await helpers.render("4");
    assert.equal(workers.length, 1);
    assert.deepEqual(workers[0].messages.join(" "), "module helps forget file open say render render say render forget file open say render");
    await Promise.all([helpers.render("5"), helpers.render("6")]);
    assert.equal(workers.length, 2, "two parts at once");
    isAble = false;
    assert.equal((await helpers.render("7")).byteLength, 0, "nothing comes of a fault");
    assert.equal(workers.filter(({ isEnded }) => isEnded).length, 1);
    [isAble, shown.edition] = [true, 3];
    shown.messages = () => [{ file: { bytes: { length: 2 ** 27 } } }];
    assert.equal((await helpers.render("8")).byteLength, 0, "a large scene is held once");
});
