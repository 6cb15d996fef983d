// Runs the npm package mikktspace (the C reference in WebAssembly) over many unindexed triangle
// meshes.
//
//   node mikktspace_oracle.mjs PACKAGE-FOLDER INPUT OUTPUT
//
// INPUT, little-endian, per mesh: uint32 corners, float32 position[3] × corners, normal[3] ×
// corners, uv[2] × corners. OUTPUT, per mesh: uint32 1 and float32 tangent[4] × corners, or uint32 0
// where the package crashed. A crash leaves its memory undefined: it is then loaded anew.
import { readFileSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';

const [, , packageFolder, inputFile, outputFile] = process.argv;
const require = createRequire(import.meta.url);
let mikktspace = require(packageFolder);

const input = readFileSync(inputFile);
const bytes = input.buffer.slice(input.byteOffset, input.byteOffset + input.byteLength);
const parts = [];
let at = 0, crashes = 0, meshes = 0;
while (at < bytes.byteLength) {
  const corners = new Uint32Array(bytes, at, 1)[0];
  at += 4;
  const read = (perCorner) => {
    const values = new Float32Array(bytes, at, perCorner * corners);
    at += 4 * perCorner * corners;
    return values;
  };
  const positions = read(3), normals = read(3), uvs = read(2);
  ++meshes;
  let tangents = null;
  try {
    tangents = mikktspace.generateTangents(positions, normals, uvs);
  } catch (error) {
    ++crashes;
    delete require.cache[require.resolve(packageFolder)];
    mikktspace = require(packageFolder);
  }
  parts.push(Buffer.from(new Uint32Array([tangents ? 1 : 0]).buffer));
  if (tangents) parts.push(Buffer.from(tangents.buffer, tangents.byteOffset, tangents.byteLength));
}
writeFileSync(outputFile, Buffer.concat(parts));
console.log(`the package ran on ${meshes} meshes and crashed on ${crashes} of them`);
