// The view with undo and redo, without a browser.

import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { SCENES_OWN, returned, viewState } from "../../../assets/state.js";

let state;
beforeEach(() => {
    state = viewState();
});

test("a revision is no step: undo and redo lead to revised views", () => {
    state.set({ size: [4, 3] });
    state.set({ depth: 2 });
    state.set({ depth: 2, samples: 9 });
    state.undo();
    state.revise((view) => (view.size ? { ...view, size: [8, 6] } : view));
    assert.deepEqual([state.get().size, state.get().depth], [[8, 6], 2]);
    assert.ok(state.redo());
    assert.deepEqual([state.get().size, state.get().samples], [[8, 6], 9]);
    for (let i = 0; i < 3; i++) assert.ok(state.undo());
    assert.deepEqual([state.get(), state.canUndo()], [SCENES_OWN, false]);
});

test("a step that a revision takes back is none any more", () => {
    state.set({ depth: 2 });
    state.set({ samples: 0 });
    state.revise((view) => ({ ...view, samples: null }));
    assert.ok(state.undo());
    assert.equal(state.get().depth, null);
});

test("while a hand moves, a revision changes both its view and the one at rest", () => {
    const heard = [];
    state.set({ depth: 2 }, true);
    state.on((view, moving) => heard.push([view.depth, view.samples, moving]));
    state.revise((view) => ({ ...view, samples: 3 }));
    state.set({ depth: 4 });
    assert.ok(state.undo());
    assert.deepEqual(heard, [[2, 3, true], [4, 3, false], [null, 3, false]]);
});

test("of a refused view its change goes, and later changes stay", () => {
    const accepted = { ...SCENES_OWN, depth: 2 };
    const back = returned({ ...accepted, samples: 0 }, accepted);
    const later = { ...accepted, samples: 0, exposure: 1 };
    assert.deepEqual(back(later), { ...accepted, exposure: 1 });
    const mended = { ...accepted, samples: 4 };
    assert.equal(back(mended), mended);
    assert.equal(returned({ ...accepted }, accepted), null);
});
