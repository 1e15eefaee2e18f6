// Runs a program built for WASI in node. The program sees only the named folders, under their own names.
//
//   node tests/wasi.mjs PROGRAM.wasm FOLDER[:FOLDER...] ARGUMENTS...
import { readFile } from "node:fs/promises";
import { WASI } from "node:wasi";

const [program, folders, ...words] = process.argv.slice(2);
const preopens = Object.fromEntries(folders.split(":").map((folder) => [folder, folder]));
const wasi = new WASI({ version: "preview1", args: [program, ...words], preopens, returnOnExit: true });
const module = await WebAssembly.compile(await readFile(program));
const instance = await WebAssembly.instantiate(module, { wasi_snapshot_preview1: wasi.wasiImport });
process.exitCode = wasi.start(instance);
