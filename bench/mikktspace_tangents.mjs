// Times the npm package mikktspace on a mesh in generate_torus's raw format.
//
//   node bench/mikktspace_tangents.mjs PACKAGE-FOLDER IN.raw RUNS
//
// Prints one line a run: "mikktspace SECONDS CPU-SECONDS". It takes unindexed triangles: they are
// made beforehand.
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';

const [, , packageFolder, file, runs] = process.argv;
const mikktspace = createRequire(import.meta.url)(packageFolder);
const bytes = readFileSync(file);
const data = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
const [vertices, triangles] = new Uint32Array(data, 0, 2);
let at = 8;
const floats = (count) => new Float32Array(data, (at += 4 * count) - 4 * count, count);
const positions = floats(3 * vertices), normals = floats(3 * vertices);
const corners = new Uint32Array(data, at, 3 * triangles);
at += 12 * triangles;
const uvs = floats(6 * triangles).slice();
const unshared = (values) => {
  const out = new Float32Array(9 * triangles);
  corners.forEach((v, c) => out.set(values.subarray(3 * v, 3 * v + 3), 3 * c));
  return out;
};
const p = unshared(positions), n = unshared(normals);
for (let run = 0; run < Number(runs); ++run) {
  const start = performance.now(), cpu = process.cpuUsage();
  mikktspace.generateTangents(p, n, uvs);
  const { user, system } = process.cpuUsage(cpu);
  console.log('mikktspace', (performance.now() - start) / 1e3, (user + system) / 1e6);
}
