// The hand on a camera: orbit, pan, dolly and fly, by mouse, touch and keys.

import { dolly, fly, look, orbit, pan } from "./camera.js";
import { subtract } from "./vector.js";

/** @typedef {import("./protocol.js").Camera} Camera */

/**
 * @typedef {object} Hand
 * @property {() => Camera | null} camera
 * @property {(camera: Camera, moving: boolean) => void} move
 * @property {() => number} size The length of the scene, for the speed of flight.
 * @property {(x: number, y: number) => void} [click] In pixels of the page, from the element's corner.
 */

const FLIGHT = new Map(Object.entries({ a: [1, 0, 0], d: [-1, 0, 0], e: [0, 1, 0], q: [0, -1, 0], w: [0, 0, 1], s: [0, 0, -1] }));
/** With Shift, turns of the eye: to the left, and up. */
const LOOK = new Map(Object.entries({ a: [1, 0], d: [-1, 0], w: [0, 1], s: [0, -1] }));
/** Shorter movements are clicks. */
const CLICK = 4;
const KEY_STEP = Math.PI / 36;

/**
 * @param {HTMLElement} element
 * @param {Hand} hand
 */
export function attachControls(element, hand) {
    /** @type {Map<number, {x: number, y: number}>} */
    const pointers = new Map();
    let [travelled, isPanning, isLooking] = [0, false, false];
    let rest = 0;

    /** @param {(camera: Camera) => Camera} change @param {boolean} [moving] */
    function change(change, moving = true) {
        const camera = hand.camera();
        if (camera) hand.move(change(camera), moving);
    }
    /** Comes to rest a moment after the last turn of a wheel or press of a key. */
    function restSoon() {
        clearTimeout(rest);
        rest = window.setTimeout(() => change((camera) => camera, false), 180);
    }
    const spread = () => {
        const [a, b] = [...pointers.values()];
        return b ? Math.hypot(a.x - b.x, a.y - b.y) : 0;
    };

    element.addEventListener("pointerdown", (event) => {
        if (event.button === 2 && event.pointerType === "mouse") isLooking = true;
        element.setPointerCapture(event.pointerId);
        pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
        if (pointers.size === 1) travelled = 0;
        isPanning = event.button === 1 || event.shiftKey;
        if (event.button === 1) event.preventDefault();
    });
    element.addEventListener("contextmenu", (event) => event.preventDefault());

    element.addEventListener("pointermove", (event) => {
        const last = pointers.get(event.pointerId);
        if (!last) return;
        const [dx, dy, before] = [event.clientX - last.x, event.clientY - last.y, spread()];
        pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
        travelled += Math.hypot(dx, dy);
        if (travelled < CLICK) return;
        const { clientWidth, clientHeight } = element;
        if (pointers.size === 2) {
            const zoom = before / Math.max(spread(), 1);
            change((camera) => dolly(pan(camera, dx / 2 / clientHeight, dy / 2 / clientHeight), zoom));
        } else if (isPanning) {
            const perPixel = (2 * Math.tan((((hand.camera()?.fov ?? 40) / 2) * Math.PI) / 180)) / clientHeight;
            change((camera) => pan(camera, dx * perPixel, dy * perPixel));
        } else {
            const turn = isLooking ? look : orbit;
            const [yaw, pitch] = [(-2 * Math.PI * dx) / clientWidth, (Math.PI * dy) / clientHeight];
            change((camera) => turn(camera, yaw, isLooking ? -pitch : pitch));
        }
    });

    /** @param {PointerEvent} event */
    function release(event) {
        if (!pointers.delete(event.pointerId) || pointers.size > 0) return;
        isLooking = false;
        if (travelled >= CLICK) change((camera) => camera, false);
        else if (event.type === "pointerup" && event.button === 0) {
            const box = element.getBoundingClientRect();
            hand.click?.(event.clientX - box.left, event.clientY - box.top);
        }
    }
    element.addEventListener("pointerup", release);
    element.addEventListener("pointercancel", release);

    element.addEventListener("wheel", (event) => {
        event.preventDefault();
        const lines = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? event.deltaY * 33 : event.deltaY;
        change((camera) => dolly(camera, Math.exp(Math.max(-300, Math.min(300, lines)) / 600)));
        restSoon();
    }, { passive: false });

    attachKeys(element, hand, change, restSoon);
}

/**
 * @param {HTMLElement} element
 * @param {Hand} hand
 * @param {(change: (camera: Camera) => Camera, moving?: boolean) => void} change
 * @param {() => void} restSoon
 */
function attachKeys(element, hand, change, restSoon) {
    /** @type {Set<string>} */
    const held = new Set();
    let lastTime = 0;

    /** @param {number} now */
    function flight(now) {
        if (held.size === 0) return change((camera) => camera, false);
        const camera = hand.camera();
        const distance = camera ? Math.hypot(...subtract(camera.lookat, camera.lookfrom)) : 1;
        const length = (Math.min(hand.size(), 2 * distance) * Math.min(now - lastTime, 100)) / 4000;
        lastTime = now;
        /** @type {import("./vector.js").Vector} */
        const step = [0, 0, 0];
        for (const key of held) FLIGHT.get(key)?.forEach((x, i) => (step[i] += x * length));
        change((camera) => fly(camera, step));
        requestAnimationFrame(flight);
    }

    element.addEventListener("keydown", (event) => {
        if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return;
        const key = event.key.toLowerCase();
        const turn = event.shiftKey && LOOK.get(key);
        if (turn) {
            change((camera) => look(camera, turn[0] * KEY_STEP, turn[1] * KEY_STEP));
            restSoon();
            return event.preventDefault();
        }
        if (FLIGHT.has(key)) {
            if (held.size === 0) {
                lastTime = performance.now();
                requestAnimationFrame(flight);
            }
            held.add(key);
            return event.preventDefault();
        }
        const arrow = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
        if (arrow) {
            const [x, y] = arrow;
            change((camera) => (event.shiftKey ? pan(camera, -x * 0.03, y * 0.03) : orbit(camera, x * KEY_STEP, y * KEY_STEP)));
        } else if (key === "+" || key === "=") change((camera) => dolly(camera, 0.92));
        else if (key === "-") change((camera) => dolly(camera, 1 / 0.92));
        else return;
        event.preventDefault();
        restSoon();
    });
    element.addEventListener("keyup", (event) => held.delete(event.key.toLowerCase()));
    element.addEventListener("blur", () => held.clear());
}
