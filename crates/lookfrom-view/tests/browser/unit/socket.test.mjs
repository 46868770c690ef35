// Questions and answers of the page's connection, without a browser: a WebSocket that a test opens, answers and closes.

import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { Disconnected, Unanswered, connect } from "../../../assets/socket.js";
import { webSocket } from "../../../assets/web-socket.js";

/** The connection that was made last. */
let server;

class FakeWebSocket {
    static OPEN = 1;
    readyState = FakeWebSocket.OPEN;
    sent = [];

    constructor() {
        server = this;
    }
    send(text) {
        this.sent.push(JSON.parse(text));
    }
    answer(message) {
        this.onmessage({ data: JSON.stringify(message) });
    }
    close() {
        this.readyState = 3;
        this.onclose({ reason: "" });
    }
}

let socket;
beforeEach(() => {
    globalThis.WebSocket = FakeWebSocket;
    globalThis.location = { href: "http://localhost/", search: "" };
    socket = connect(webSocket());
    socket.open();
    server.onopen();
});

test("an answer settles its question, an error rejects it", async () => {
    const [value, words] = [socket.request("value"), socket.request("words")];
    const [first, second] = server.sent;
    server.answer({ type: "words", id: second.id, toml: "a = 1" });
    server.answer({ type: "error", id: first.id, message: "no film" });
    assert.equal((await words).toml, "a = 1");
    await assert.rejects(value, (error) => error.message === "no film" && !(error instanceof Unanswered));
});

test("a later question of the same type replaces a question, which is rejected", async () => {
    const [first, other, second] = [socket.request("pixel", { x: 1 }), socket.request("value"), socket.request("pixel", { x: 2 })];
    await assert.rejects(first, Unanswered);
    const told = [];
    socket.on("error", (message) => told.push(message));
    server.answer({ type: "error", id: 1, message: "concerns nobody" });
    for (const { type, id } of server.sent.slice(1)) server.answer({ type, id });
    assert.deepEqual(told, []);
    assert.equal((await second).id, 3);
    assert.equal((await other).id, 2);
});

test("a lost connection rejects what waits, and what is asked while there is none", async () => {
    const [pixel, value] = [socket.request("pixel"), socket.request("value")];
    server.close();
    await assert.rejects(pixel, Disconnected);
    await assert.rejects(value, Disconnected);
    await assert.rejects(socket.request("pixel"), Disconnected);
});

test("a question that was replaced on its way, and is never answered, is forgotten once a later one is", async () => {
    const first = socket.request("pixel", { x: 1 });
    const second = socket.request("pixel", { x: 2 });
    await assert.rejects(first, (error) => error instanceof Unanswered && !(error instanceof Disconnected));
    server.answer({ type: "pixel", id: 2 });
    await second;
    // A question that waits would have been settled by this, and nobody told.
    const told = [];
    socket.on("pixel", (message) => told.push(message.id));
    server.answer({ type: "pixel", id: 1 });
    assert.deepEqual(told, [1]);
});
