// Labelled fields of forms.

import { h } from "./html.js";

/**
 * A control, or several, and how they come to show anew what they stand for.
 * @typedef {{element: HTMLElement, show: () => void}} Control
 */

let lastId = 0;

/**
 * A label beside its control, and below what it means: a finger and keys meet no tooltip.
 * @param {string} label
 * @param {Control} control
 * @param {string} [meaning]
 * @returns {Control}
 */
export function field(label, { element, show }, meaning) {
    const id = (element.id ||= `field-${++lastId}`);
    if (meaning) element.setAttribute("aria-describedby", `${id}-meaning`);
    const below = meaning && h("p", { class: "meaning", id: `${id}-meaning` }, meaning);
    return { element: h("div", { class: "field" }, h("label", { for: id }, label), element, below), show };
}

/**
 * @param {readonly (readonly [value: string, title: string])[]} options
 * @param {() => string} value
 * @param {(value: string) => void} change
 * @param {string} [name] for screen readers, where there is no label
 */
export function select(options, value, change, name) {
    const element = h("select", { "aria-label": name }, choices(options));
    element.addEventListener("change", () => change(element.value));
    const show = () => void (element.value = value());
    show();
    return { element, show };
}

/** The elements of what can be selected. @param {readonly (readonly [value: string, title: string])[]} options */
export const choices = (options) => options.map(([value, title]) => h("option", { value }, title));

/**
 * @param {string} label
 * @param {() => boolean} value
 * @param {(value: boolean) => void} change
 * @param {string} [title]
 */
export function check(label, value, change, title) {
    const control = h("input", { type: "checkbox" });
    control.addEventListener("change", () => change(control.checked));
    const show = () => void (control.checked = value());
    show();
    return { element: h("label", { class: "check", title }, control, label), show };
}

/**
 * A number; empty means the scene's own. What is being typed stays until it is confirmed, or left.
 * @param {() => number | null} value
 * @param {{min?: number, max?: number, step?: number | string, placeholder?: string, name?: string}} limits `name` is for screen readers, where there is no label.
 * @param {(value: number | null) => void} change
 */
export function number(value, { name, ...limits }, change) {
    const element = h("input", { type: "number", inputmode: "decimal", ...limits, step: limits.step ?? "any", "aria-label": name });
    let confirmed = "";
    element.addEventListener("change", () => {
        if (!element.reportValidity()) return;
        confirmed = element.value;
        change(confirmed === "" ? null : element.valueAsNumber);
    });
    const set = () => void (confirmed = element.value = String(value() ?? ""));
    element.addEventListener("blur", set);
    const show = () => void ((element === document.activeElement && element.value !== confirmed) || set());
    show();
    return { element, show };
}

/**
 * A slider with its value beside it.
 * @param {string} label
 * @param {{min: number, max: number, step: number | string}} limits
 * @param {() => number} value
 * @param {(value: number) => void} input
 * @param {(value: number) => string} [format]
 */
export function slider(label, limits, value, input, format = String) {
    // Screen readers are told the value by the slider itself.
    const text = h("span", { class: "value", "aria-hidden": "true" });
    const control = h("input", { type: "range", ...limits, "aria-label": label });
    /** @param {number} value */
    const tell = (value) => {
        text.textContent = format(value);
        control.setAttribute("aria-valuetext", format(value));
    };
    control.addEventListener("input", () => {
        input(control.valueAsNumber);
        tell(control.valueAsNumber);
    });
    function show() {
        control.value = String(value());
        tell(value());
    }
    show();
    return { element: h("div", { class: "slider" }, h("span", { class: "label" }, label), control, text), show };
}
