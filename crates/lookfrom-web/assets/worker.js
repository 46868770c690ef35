// The worker of a page without a server: holds a session in WebAssembly, and gives it turns between the messages of the page.
//
// In: {module} once, then {forget}, {file: {path, bytes}}, {open: {scene, reference}} and {say: text}. Out: texts and frames, as those
// of a server; null once it is ready; {fault} where the program has ended.
//
// Helpers render parts of the picture in workers of their own: {idle: count} tells of some, {lent: part} asks one, {part, film} gives
// back what it has made. A helper gets {render: part} in the same view, says nothing else, and takes no turns.

/** @typedef {{memory: WebAssembly.Memory, start(): void, input(length: number): number, output(): number, output_length(): number, add_file(path: number): void, forget_files(): void, open_scene(scene: number): void, hear(): void, turn(): number, say(): number, lend(): number, render_part(): void, take_part(part: number): void}} Exports */

const utf8 = new TextEncoder();
/** @type {Exports | null} */
let exports = null;
let isDead = false;
let isScheduled = false;
let isHelper = false;
/** Helpers that wait for a part, and those that could not render one: they may be asked again once the files are others. */
let [idle, unable] = [0, 0];

// Between two turns the messages of the page arrive.
const channel = new MessageChannel();
channel.port1.onmessage = () => {
    isScheduled = false;
    guarded(() => {
        if (exports?.turn()) schedule();
        for (; exports && idle > 0 && exports.lend(); idle--) postMessage({ lent: new TextDecoder().decode(output(exports)) });
    });
};

function schedule() {
    if (!isScheduled) channel.port2.postMessage(null);
    isScheduled = true;
}

/** Writes the input of a call. @param {...Uint8Array} parts */
function write(...parts) {
    if (!exports) return;
    const length = parts.reduce((sum, part) => sum + part.length, 0);
    let at = exports.input(length);
    for (const part of parts) {
        new Uint8Array(exports.memory.buffer, at, part.length).set(part);
        at += part.length;
    }
}

/** The output of a call, until the next one. @param {Exports} of */
const output = (of) => new Uint8Array(of.memory.buffer, of.output(), of.output_length());

/** Sends all messages for the page. */
function deliver() {
    if (!exports || isHelper) return;
    for (;;) {
        const kind = exports.say();
        if (kind === 0) return;
        const bytes = output(exports);
        if (kind === 1) postMessage(new TextDecoder().decode(bytes));
        else {
            const { buffer } = bytes.slice();
            postMessage(buffer, { transfer: [buffer] });
        }
    }
}

/** Does something and sends what there is to say; a trap ends the program. @param {() => void} act */
function guarded(act) {
    if (isDead) return;
    try {
        act();
        deliver();
    } catch (error) {
        isDead = true;
        postMessage({ fault: String(error) });
    }
}

/** @param {any} message */
function hear({ forget, file, open, say, helps, idle: more, render, part, film }) {
    if (!exports) return;
    if (forget) exports.forget_files();
    if (file) {
        const path = utf8.encode(file.path);
        write(path, file.bytes);
        exports.add_file(path.length);
    }
    if (open) {
        const scene = utf8.encode(open.scene);
        write(scene, utf8.encode(open.reference ?? ""));
        exports.open_scene(scene.length);
        [idle, unable] = [idle + unable, 0];
    }
    if (say !== undefined) {
        write(utf8.encode(say));
        exports.hear();
    }
    if (helps) isHelper = true;
    if (more) idle += more;
    if (render) {
        write(utf8.encode(render));
        exports.render_part();
        const { buffer } = output(exports).slice();
        postMessage({ part: render, film: buffer }, { transfer: [buffer] });
    }
    if (part) {
        const text = utf8.encode(part);
        write(text, new Uint8Array(film));
        exports.take_part(text.length);
        if (film.byteLength > 0) idle++;
        else unable++;
    }
    if (!isHelper && (open || part || say !== undefined)) schedule();
}

onmessage = ({ data }) => {
    WebAssembly.instantiate(/** @type {WebAssembly.Module} */ (data.module), { page: { now: () => performance.now() } }).then((instance) => {
        exports = /** @type {Exports} */ (/** @type {unknown} */ (instance.exports));
        exports.start();
        onmessage = ({ data }) => guarded(() => hear(data));
        postMessage(null);
    });
};
