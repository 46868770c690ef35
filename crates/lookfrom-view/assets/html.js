// Elements of HTML and SVG, made by a call each.

/** @typedef {Node | string | number | null | undefined | false} Child */
/** @typedef {Record<string, any>} Attributes */

/**
 * @param {Element} element
 * @param {Attributes} attributes
 * @param {(Child | Child[])[]} children
 */
function fill(element, attributes, children) {
    for (const [name, value] of Object.entries(attributes)) {
        if (value === null || value === undefined || value === false) continue;
        if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
        else element.setAttribute(name, value === true ? "" : String(value));
    }
    append(element, children);
}

/**
 * @param {Element} element
 * @param {(Child | Child[])[]} children
 */
export function append(element, children) {
    for (const child of children.flat()) {
        if (child === null || child === undefined || child === false) continue;
        element.append(child instanceof Node ? child : String(child));
    }
}

/**
 * An element of HTML. Attributes that start with "on" are listeners.
 * @template {keyof HTMLElementTagNameMap} T
 * @param {T} tag
 * @param {Attributes} [attributes]
 * @param {...(Child | Child[])} children
 * @returns {HTMLElementTagNameMap[T]}
 */
export function h(tag, attributes = {}, ...children) {
    const element = document.createElement(tag);
    fill(element, attributes, children);
    return element;
}

/**
 * An element of SVG.
 * @template {keyof SVGElementTagNameMap} T
 * @param {T} tag
 * @param {Attributes} [attributes]
 * @param {...(Child | Child[])} children
 * @returns {SVGElementTagNameMap[T]}
 */
export function svg(tag, attributes = {}, ...children) {
    const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
    fill(element, attributes, children);
    return element;
}

const CONTROLS = "a[href], button, input, select, summary, [tabindex]";

/** What a control is called, to find it among those that replace it. @param {Element} control */
const called = (control) => {
    const label = /** @type {HTMLInputElement} */ (control).labels?.[0];
    return `${control.tagName} ${control.getAttribute("aria-label") ?? (label ?? control).textContent}`;
};

/**
 * Replaces all children. Where one of them has the focus, the control of the same name has it then, or what is around it.
 * @param {Element} element
 * @param {...(Child | Child[])} children
 */
export function replace(element, ...children) {
    const active = document.activeElement;
    const name = active && active !== element && element.contains(active) ? called(active) : null;
    element.replaceChildren();
    append(element, children);
    if (name === null) return;
    const control = [...element.querySelectorAll(CONTROLS)].find((control) => called(control) === name) ?? element.closest("[tabindex]");
    if (control instanceof HTMLElement || control instanceof SVGElement) control.focus({ preventScroll: true });
}

/**
 * The element with this id, which index.html has.
 * @param {string} id
 * @returns {HTMLElement}
 */
export function byId(id) {
    const element = document.getElementById(id);
    if (!element) throw new Error(`index.html has no element "${id}"`);
    return element;
}
