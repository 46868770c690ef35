// The files of a zip archive (PKWARE, APPNOTE 6.3.10), stored or deflated.

const [END, ENTRY, LOCAL] = [0x06054b50, 0x02014b50, 0x04034b50];
const [STORED, DEFLATED] = [0, 8];
/** The most bytes of an archive's files together. */
const MOST = 2 ** 30;

/** @param {Uint8Array<ArrayBuffer>} bytes @param {CompressionFormat} format */
export async function inflated(bytes, format) {
    return new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream(format))).arrayBuffer());
}

/** @param {Uint8Array<ArrayBuffer>} bytes @param {CompressionFormat} format */
export async function deflated(bytes, format) {
    return new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(new CompressionStream(format))).arrayBuffer());
}

/**
 * @param {Uint8Array<ArrayBuffer>} archive
 * @returns {Promise<import("./worker-transport.js").File[]>}
 */
export async function unzip(archive) {
    const view = new DataView(archive.buffer, archive.byteOffset, archive.byteLength);
    const damaged = () => new Error("this zip archive is damaged, or longer than 4 GB");
    // The record at the end is followed by a comment of at most 65535 bytes.
    let end = archive.length - 22;
    while (end >= 0 && view.getUint32(end, true) !== END) end = archive.length - end > 22 + 0xffff ? -1 : end - 1;
    if (end < 0) throw damaged();
    const files = [];
    let [at, total] = [view.getUint32(end + 16, true), 0];
    for (let left = view.getUint16(end + 10, true); left > 0; left--) {
        if (at + 46 > archive.length || view.getUint32(at, true) !== ENTRY) throw damaged();
        const [flags, method] = [view.getUint16(at + 8, true), view.getUint16(at + 10, true)];
        const [packed, size, local] = [view.getUint32(at + 20, true), view.getUint32(at + 24, true), view.getUint32(at + 42, true)];
        const name = view.getUint16(at + 28, true);
        const path = new TextDecoder().decode(archive.subarray(at + 46, at + 46 + name));
        at += 46 + name + view.getUint16(at + 30, true) + view.getUint16(at + 32, true);
        if (path.endsWith("/")) continue;
        if (flags & 1) throw new Error(`${path} of this zip archive is encrypted`);
        if (method !== STORED && method !== DEFLATED) throw new Error(`${path} of this zip archive is compressed by method ${method}; expected 0 or 8`);
        if ((total += size) > MOST) throw new Error("the files of this zip archive are longer than a gigabyte");
        if (local + 30 > archive.length || view.getUint32(local, true) !== LOCAL) throw damaged();
        const start = local + 30 + view.getUint16(local + 26, true) + view.getUint16(local + 28, true);
        if (start + packed > archive.length) throw damaged();
        const content = archive.slice(start, start + packed);
        const bytes = method === STORED ? content : await inflated(content, "deflate-raw").catch(() => Promise.reject(damaged()));
        if (bytes.length !== size) throw damaged();
        files.push({ path, bytes });
    }
    return files;
}
