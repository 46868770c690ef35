// A figure that is dragged, by a pointer or by the arrow keys.

/** Steps of an arrow key with Shift. */
const LARGE = 10;

/**
 * @typedef {object} Dragged
 * @property {(x: number, y: number, right: number, down: number) => void} to Called with a place in the units of the figure's view box, and the way from the
 *     place before.
 * @property {(right: number, up: number) => void} by Called with steps of the arrow keys.
 * @property {() => void} [rest] Called when the hand lets go, and after each key.
 */

/**
 * @param {SVGSVGElement} figure
 * @param {Dragged} dragged
 */
export function draggable(figure, { to, by, rest = () => {} }) {
    let last = [0, 0];
    /** @param {PointerEvent} event */
    const place = (event) => {
        const [box, { x, y, width, height }] = [figure.getBoundingClientRect(), figure.viewBox.baseVal];
        return [x + ((event.clientX - box.left) / box.width) * width, y + ((event.clientY - box.top) / box.height) * height];
    };
    /** @param {PointerEvent} event */
    function move(event) {
        const [x, y] = place(event);
        const way = [x - last[0], y - last[1]];
        last = [x, y];
        to(x, y, way[0], way[1]);
    }
    figure.addEventListener("pointerdown", (event) => {
        figure.setPointerCapture(event.pointerId);
        last = place(event);
        move(event);
    });
    figure.addEventListener("pointermove", (event) => void (figure.hasPointerCapture(event.pointerId) && move(event)));
    figure.addEventListener("lostpointercapture", rest);
    figure.addEventListener("keydown", (event) => {
        const [right, up] = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key] ?? [0, 0];
        if (right === 0 && up === 0) return;
        event.preventDefault();
        const step = event.shiftKey ? LARGE : 1;
        by(right * step, up * step);
        rest();
    });
}
