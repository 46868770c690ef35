// What may stand at a place of a scene in our own format: keys of its table, names of tables, and names that the text defines.
//
// The tables and their keys are those of the program. A text that is being typed is no TOML yet, so only its tokens are read.

/** @typedef {import("../../lookfrom-view/assets/protocol.js").Table} Table */

/**
 * Texts that may replace a part of the text, from one place to another.
 * @typedef {object} Completions
 * @property {number} from
 * @property {number} to
 * @property {string[]} options
 */

/**
 * A table as far as it is written: its path, its keys with their places, and its type.
 * @typedef {object} Written
 * @property {string[]} path
 * @property {boolean} isArray
 * @property {{name: string, at: number}[]} keys
 * @property {string | null} type
 */

/**
 * Where the caret is: at a key or in a value of a table, or in a table's header.
 * @typedef {object} Place
 * @property {Written} table
 * @property {"key" | "value" | "header"} state
 * @property {string} key What stands before the caret, or the key of the value.
 * @property {string} token
 * @property {number} at Where the token begins.
 */

const TOKENS = /#[^\n]*|"""[^]*?(?:"""|$)|'''[^]*?(?:'''|$)|"(?:\\.|[^"\\\n])*"?|'[^'\n]*'?|[\w.-]+|[^]/g;
const HEADER = /\[\[?([^\]\n]*)\]{0,2}/y;

const PART = "[[solid.of]]";

/** @param {string} path */
const parts = (path) => path.split(".").map((part) => part.trim().replace(/^["']|["']$/g, ""));

/** @param {string[]} path @returns {Written} */
const written = (path, isArray = false) => ({ path, isArray, keys: [], type: null });

/**
 * Reads a text, and returns where the caret is; null within comments.
 * @param {string} text
 * @param {number} caret
 * @returns {Place | null}
 */
function placeIn(text, caret) {
    /** The tables that are open: that of the last header, and what is written in it with braces and brackets. */
    let open = [written([])];
    let [state, key] = [/** @type {"key" | "value"} */ ("key"), ""];
    /** @type {Place | null} */
    let place = null;
    TOKENS.lastIndex = 0;
    for (let found = TOKENS.exec(text); found; found = TOKENS.exec(text)) {
        const [token] = found;
        const at = found.index;
        const table = open[open.length - 1];
        const isHere = at < caret && caret <= at + token.length;
        const isWord = /^[\w."'-]/.test(token);
        if (isHere && token.startsWith("#")) return null;
        if (open.length === 1 && state === "key" && key === "" && token === "[") {
            HEADER.lastIndex = at;
            const [header, name] = /** @type {RegExpExecArray} */ (HEADER.exec(text));
            TOKENS.lastIndex = at + header.length;
            open = [written(parts(name))];
            if (at < caret && caret <= at + header.length) place = { table: open[0], state: "header", key: "", token: header, at };
            continue;
        }
        if (isHere && isWord) place = { table, state, key, token, at };
        if (token === "\n" && open.length === 1) [state, key] = ["key", ""];
        else if (state === "key" && token === "=") state = "value";
        else if (state === "key" && isWord) {
            key += token;
            table.keys.push({ name: parts(key)[0], at });
        } else if (token === "{" || token === "[") {
            open.push(written(table.isArray ? table.path : [...table.path, ...parts(key)], token === "["));
            [state, key] = [token === "{" ? "key" : "value", ""];
        } else if ((token === "}" || token === "]") && open.length > 1) {
            open.pop();
            [state, key] = ["value", ""];
        } else if (token === ",") [state, key] = [table.isArray || open.length === 1 ? "value" : "key", ""];
        else if (state === "value" && key === "type" && isWord) table.type = token.replace(/["']/g, "");
        if (isHere && !isWord) place = { table: open[open.length - 1], state, key, token: "", at: caret };
    }
    return place ?? { table: open[0], state, key, token: "", at: caret };
}

/** The header of a table, as its title begins: `[[light]]` of `[[light]] point`. @param {Table} table */
const headerOf = ({ title }) => /^\[+[^\]]*\]+/.exec(title)?.[0] ?? null;

/** @param {Table[]} tables */
function headers(tables) {
    const named = tables.map(headerOf).filter((header) => header !== null);
    const known = new Set(named.map((header) => parts(header.replace(/[[\]]/g, ""))[0]));
    const others = (tables[0]?.keys ?? []).filter((key) => !known.has(key) && key !== "import").map((key) => `[${key}]`);
    return [...new Set([...named, ...others])];
}

/**
 * The tables of the format that a written one may be: several where its type is not there yet.
 * @param {Table[]} tables
 * @param {Written} table
 */
function tablesOf(tables, { path, type }) {
    if (path.length === 0) return tables.slice(0, 1);
    if (path[0] === "variables") return [];
    const last = path[path.length - 1];
    // Of materials, textures, media and objects each has a name; the shapes of an object are those of a scene.
    const named = `[${path[0]}.NAME]`;
    const isNamed = path.length === 2 && tables.some((known) => headerOf(known) === named);
    const wanted = isNamed ? [named] : [`[${last}]`, `[[${last}]]`, last];
    const found = tables.filter((known) => wanted.includes(headerOf(known) ?? known.title) || known.title.endsWith(`.${last}]]`));
    // What is written in place of a number or a colour may be a texture, a picture, numbers by the wavelength, the place or the time.
    const fitting = found.length > 0 ? found : tables.slice(1).filter((known) => headerOf(known) === "[textures.NAME]" || /^(a |numbers |keyframes$)/.test(known.title));
    // A part of a solid has the keys of its shape, too.
    if (found.some((known) => known.title === PART)) return tables.filter((known) => known.title === PART || known.title === `[[${type}]]`);
    const typed = fitting.filter((known) => known.title === `${headerOf(known)} ${type}`);
    return typed.length > 0 ? typed : fitting;
}

/** Names that the text defines in a group such as `materials`. @param {string} text @param {string} group */
const namesIn = (text, group) => [...text.matchAll(new RegExp(`^\\s*\\[+${group}\\.([\\w-]+)|^${group}\\.([\\w-]+)`, "gm"))].map((found) => found[1] ?? found[2]);

/** The words of a text value. @param {Table[]} tables @param {Place} place @param {string} text */
function words(tables, { table, key }, text) {
    if (key === "type") {
        const kinds = tablesOf(tables, { ...table, type: null }).map((known) => known.title.slice((headerOf(known) ?? "").length).trim());
        return kinds.filter((kind) => /^\w+$/.test(kind));
    }
    const group = { material: "materials", texture: "textures", medium: "media", object: "objects" }[key];
    return group ? namesIn(text, group) : [];
}

/**
 * What may stand at the caret; null where nothing can be completed.
 * @param {Table[]} tables The vocabulary, the outermost table first.
 * @param {string} text
 * @param {number} caret
 * @returns {Completions | null}
 */
export function completions(tables, text, caret) {
    const place = placeIn(text, caret);
    if (!place) return null;
    const { table, state, token, at } = place;
    const typed = text.slice(at, caret);
    /** @param {string[]} all @param {string} prefix @param {number} from @param {number} to */
    const those = (all, prefix, from, to) => {
        const options = [...new Set(all)].filter((option) => option.replace(/^\[+/, "").startsWith(prefix) && text.slice(from, to) !== option);
        return options.length > 0 ? { from, to, options } : null;
    };
    if (state === "header") return those(headers(tables), typed.replace(/^\[+/, ""), at, at + token.length);
    if (state === "value") {
        const isText = /^["'](?!["'])|^["']{2}$/.test(token);
        const end = at + token.length - (token.length > 1 && token.endsWith(token[0]) ? 1 : 0);
        return isText && caret <= end ? those(words(tables, place, text), typed.slice(1), at + 1, end) : null;
    }
    const before = typed.lastIndexOf(".") + 1;
    const inner = before > 0 ? written([...table.path, ...parts(typed.slice(0, before - 1))]) : table;
    const taken = new Set(inner.keys.filter((key) => key.at !== at).map(({ name }) => name));
    const keys = tablesOf(tables, inner).flatMap((known) => known.keys).filter((key) => !taken.has(key));
    const [from, to] = [at + before, at + token.length];
    const isFollowed = /^\s*[=.]/.test(text.slice(to));
    const named = keys.map((key) => (isFollowed ? key : `${key} = `));
    // A line may begin a table. Those of the outermost one are keys in name only.
    const isLine = before === 0 && !isFollowed && /(^|\n)[ \t]*$/.test(text.slice(0, at)) && inner === table;
    const isOutermost = table.path.length === 0 && isLine;
    return those([...(isOutermost ? named.filter((key) => key === "import = ") : named), ...(isLine ? headers(tables) : [])], typed.slice(before), from, to);
}
