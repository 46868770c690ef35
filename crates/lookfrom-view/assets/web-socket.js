// The way to a server: a WebSocket, opened again when the server comes back.

/** @typedef {import("./socket.js").Transport} Transport */

/** @returns {Transport} */
export function webSocket() {
    /** @type {WebSocket | null} */
    let socket = null;
    let pause = 250;

    /** @param {import("./socket.js").Events} events */
    function open(events) {
        const url = new URL("/socket" + location.search, location.href);
        url.protocol = url.protocol === "https:" ? "wss:" : "ws:";
        socket = new WebSocket(url);
        socket.binaryType = "arraybuffer";
        socket.onopen = () => {
            pause = 250;
            events.opened();
        };
        socket.onmessage = ({ data }) => events.heard(data);
        socket.onclose = () => {
            events.closed();
            setTimeout(() => open(events), pause);
            pause = Math.min(2 * pause, 5000);
        };
    }

    return {
        open,
        send: (text) => socket?.send(text),
        isOpen: () => socket?.readyState === WebSocket.OPEN,
        whenLost: "The server is not there; trying again …",
        whenBroken: "The file is watched: save it again.",
    };
}
