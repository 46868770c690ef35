// Runs a program for WASI in the current folder: node .ci/wasi.mjs PROGRAM ARGUMENT…
import { readFile } from "node:fs/promises";
import { WASI } from "node:wasi";

const [program, ...rest] = process.argv.slice(2);
const wasi = new WASI({ version: "preview1", args: [program, ...rest], preopens: { ".": "." } });
const module = await WebAssembly.compile(await readFile(program));
// Debian's wasi-libc has no realpath, without which files are known by their names as written.
const env = { realpath: () => 0 };
process.exitCode = wasi.start(await WebAssembly.instantiate(module, { ...wasi.getImportObject(), env }));
