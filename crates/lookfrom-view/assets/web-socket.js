// The way to a server: a WebSocket, opened again when the server comes back.

/** @typedef {import("./socket.js").Transport} Transport */

/** A connection of a page is not closed for so long, and pauses between attempts are longer and longer; in milliseconds. */
const [LASTS, FIRST_PAUSE, LAST_PAUSE] = [5000, 250, 5000];
const GONE = "The server is not there; trying again …";
const ANEW = "The server was started anew: open the address that it has printed.";

/** Whether the page's own address is still, or not yet, that of a server. One that was started anew refuses it, which a WebSocket does not tell. */
async function isThere() {
    try {
        return (await fetch(location.pathname + location.search, { method: "HEAD" })).status !== 403;
    } catch {
        return true;
    }
}

/** @returns {Transport} */
export function webSocket() {
    /** @type {WebSocket | null} */
    let socket = null;
    let pause = FIRST_PAUSE;
    let whenLost = GONE;

    /** @param {import("./socket.js").Events} events */
    function open(events) {
        const url = new URL("/socket" + location.search, location.href);
        url.protocol = url.protocol === "https:" ? "wss:" : "ws:";
        socket = new WebSocket(url);
        socket.binaryType = "arraybuffer";
        let opened = Infinity;
        socket.onopen = () => {
            opened = performance.now();
            events.opened();
        };
        socket.onmessage = ({ data }) => events.heard(data);
        socket.onclose = async ({ reason }) => {
            if (opened < Infinity) whenLost = reason || GONE;
            events.closed();
            // A server that takes no more windows opens a connection only to say so.
            pause = performance.now() - opened > LASTS ? FIRST_PAUSE : Math.min(2 * pause, LAST_PAUSE);
            setTimeout(() => open(events), pause);
            if (opened === Infinity) whenLost = (await isThere()) ? GONE : ANEW;
        };
    }

    return {
        open,
        send: (text) => socket?.send(text),
        isOpen: () => socket?.readyState === WebSocket.OPEN,
        get whenLost() {
            return whenLost;
        },
        whenBroken: "The file is watched: save it again.",
    };
}
