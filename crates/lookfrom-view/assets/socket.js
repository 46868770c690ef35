// The connection to whoever renders: texts and binary messages, answers matched to their questions.

/** @typedef {ReturnType<typeof connect>} Socket */

/** The error of a question that gets no answer: a later one has replaced it, or the connection is lost. */
export class Unanswered extends Error {}

/** There is no connection, or it is lost. */
export class Disconnected extends Unanswered {}

/**
 * The parts of a binary message: a JSON header after its length, then the payload.
 * @param {ArrayBuffer} buffer
 * @returns {import("./protocol.js").Binary}
 */
export function parts(buffer) {
    const length = new DataView(buffer).getUint32(0, true);
    const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
    return { header, payload: buffer.slice(4 + length) };
}

/**
 * What happens on the way to the other end.
 * @typedef {object} Events
 * @property {() => void} opened
 * @property {(data: string | ArrayBuffer) => void} heard
 * @property {() => void} closed
 */

/**
 * The way to the other end: a server, or a worker of this page.
 * @typedef {object} Transport
 * @property {(events: Events) => void} open
 * @property {(text: string) => void} send
 * @property {() => boolean} isOpen
 * @property {string} whenLost What the status says while the other end is not there.
 * @property {string} whenBroken What to do about a scene that cannot be shown.
 */

/**
 * Questions and answers over a transport.
 * @param {Transport} transport
 */
export function connect(transport) {
    /** @type {Map<string, ((message: any) => void)[]>} */
    const listeners = new Map();
    /** @type {Map<number, {type: string, resolve: (answer: any) => void, reject: (error: Error) => void}>} */
    const waiting = new Map();
    let lastId = 0;

    /** @param {string} type @param {any} message */
    const tell = (type, message) => (listeners.get(type) ?? []).forEach((listener) => listener(message));

    /** @param {number} id @param {any} answer */
    function settle(id, answer) {
        const question = waiting.get(id);
        if (!question) return false;
        // Answers come in the order of questions: earlier ones of this type have been replaced on their way, and get none.
        for (const [other, { type }] of waiting) if (type === question.type && other <= id) waiting.delete(other);
        if (answer.type === "error") question.reject(new Error(answer.message));
        else question.resolve(answer);
        return true;
    }

    const events = {
        opened: () => tell("open", null),
        /** @param {string | ArrayBuffer} data */
        heard(data) {
            if (typeof data !== "string") {
                const binary = parts(data);
                if (!settle(binary.header.id ?? -1, binary)) tell(binary.header.kind, binary);
                return;
            }
            const message = JSON.parse(data);
            if (!settle(message.id ?? -1, message)) tell(message.type, message);
        },
        closed() {
            for (const question of waiting.values()) question.reject(new Disconnected("The connection is lost"));
            waiting.clear();
            tell("close", null);
        },
    };

    /**
     * @param {string} type
     * @param {object} body
     * @returns {number} the message's id
     */
    function send(type, body) {
        const id = ++lastId;
        if (transport.isOpen()) transport.send(JSON.stringify({ type, id, ...body }));
        return id;
    }

    return {
        open: () => transport.open(events),
        send,
        get whenLost() {
            return transport.whenLost;
        },
        whenBroken: transport.whenBroken,
        /**
         * Sends a question. The promise is rejected by the error of the other end, as {@link Unanswered} where a later question of
         * the same type replaces this one, and as {@link Disconnected} where the connection is or gets lost.
         * @template {keyof import("./protocol.js").Answers} T
         * @param {T} type
         * @param {object} [body]
         * @returns {Promise<import("./protocol.js").Answers[T]>}
         */
        request(type, body = {}) {
            // They keep their places until a later one is answered: what still comes for them, an error too, concerns nobody.
            for (const question of waiting.values()) if (question.type === type) question.reject(new Unanswered("A later question has replaced this one"));
            return new Promise((resolve, reject) => {
                if (transport.isOpen()) waiting.set(send(type, body), { type, resolve, reject });
                else reject(new Disconnected("There is no connection"));
            });
        },
        /**
         * @param {string} type a message's type, a binary's kind, "open" or "close"
         * @param {(message: any) => void} listener
         */
        on(type, listener) {
            listeners.set(type, [...(listeners.get(type) ?? []), listener]);
        },
    };
}
