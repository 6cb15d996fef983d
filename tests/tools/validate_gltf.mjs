// Judges glTF files with the official validator and counts what is in them.
//
//   node validate_gltf.mjs PACKAGE-FOLDER LIST.json
//
// PACKAGE-FOLDER is that of the npm package gltf-validator. LIST.json is a list of
// {"name", "input", "output", "before"}: the output is validated and counted; the input too where it
// is glTF, else "before" holds its counts. Prints a table, and below it every error of the validator
// and every count that is another (vertices split, and materials are copied for meshes without UVs:
// of these nothing may be missing). Exit 1 where there is any. Values are not compared here: that
// prep/gltf_corpus_test and prep/written_corpus_test do.
import { readFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { createRequire } from 'node:module';

const [, , packageFolder, listFile] = process.argv;
const validator = createRequire(import.meta.url)(packageFolder);

function readJson(bytes) {
  if (bytes.length < 20 || bytes.readUInt32LE(0) !== 0x46546c67) return JSON.parse(bytes.toString('utf8'));
  return JSON.parse(bytes.subarray(20, 20 + bytes.readUInt32LE(12)).toString('utf8'));
}

function triangles(primitive, accessors) {
  const source = primitive.indices ?? primitive.attributes.POSITION;
  const n = source === undefined ? 0 : accessors[source].count;
  const mode = primitive.mode ?? 4;
  return mode === 4 ? Math.floor(n / 3) : mode > 4 ? Math.max(0, n - 2) : 0;
}

function extensionsIn(value, found = new Set()) {
  if (Array.isArray(value)) value.forEach((v) => extensionsIn(v, found));
  else if (value && typeof value === 'object')
    for (const [key, v] of Object.entries(value)) {
      if (key === 'extensions' && v && typeof v === 'object') Object.keys(v).forEach((name) => found.add(name));
      extensionsIn(v, found);
    }
  return found;
}

function counts(json) {
  const primitives = (json.meshes ?? []).flatMap((m) => m.primitives);
  const accessors = json.accessors ?? [];
  const sum = (f) => primitives.reduce((n, p) => n + f(p), 0);
  return {
    vertices: sum((p) => (p.attributes.POSITION === undefined ? 0 : accessors[p.attributes.POSITION].count)),
    triangles: sum((p) => triangles(p, accessors)),
    meshes: (json.meshes ?? []).length,
    primitives: primitives.length,
    materials: (json.materials ?? []).length,
    textures: (json.textures ?? []).length,
    images: (json.images ?? []).length,
    nodes: (json.nodes ?? []).length,
    skins: (json.skins ?? []).length,
    animations: (json.animations ?? []).length,
    channels: (json.animations ?? []).reduce((n, a) => n + a.channels.length, 0),
    targets: sum((p) => (p.targets ?? []).length),
    cameras: (json.cameras ?? []).length,
    extensions: extensionsIn(json).size,
  };
}

// Compression may be undone.
const compression = ['KHR_draco_mesh_compression', 'EXT_meshopt_compression'];

const list = JSON.parse(readFileSync(listFile, 'utf8'));
const complaints = [];
const rows = [];
for (const { name, input, output, before: stated } of list) {
  const bytes = readFileSync(output);
  const report = await validator.validateBytes(new Uint8Array(bytes), {
    uri: output,
    maxIssues: 0,
    externalResourceFunction: async (uri) => new Uint8Array(readFileSync(join(dirname(output), decodeURIComponent(uri)))),
  });
  for (const m of report.issues.messages)
    if (m.severity === 0) complaints.push(`${name}: ${m.code} ${m.pointer ?? ''}: ${m.message}`);
  const outJson = readJson(bytes);
  const after = counts(outJson);
  let before = stated;
  if (!before) {
    const inJson = readJson(readFileSync(input));
    before = counts(inJson);
    const lost = [...extensionsIn(inJson)].filter((e) => !compression.includes(e) && !extensionsIn(outJson).has(e));
    if (lost.length) complaints.push(`${name}: extensions lost: ${lost.join(', ')}`);
    before.extensions -= compression.filter((e) => extensionsIn(inJson).has(e) && !extensionsIn(outJson).has(e)).length;
  }
  for (const key of Object.keys(before))
    if (key === 'materials' ? after[key] < before[key] : key !== 'vertices' && after[key] !== before[key])
      complaints.push(`${name}: ${before[key]} ${key} before, ${after[key]} after`);
  const errors = report.issues.numErrors, warnings = report.issues.numWarnings;
  rows.push([name, ...Object.keys(after).map((k) => (before[k] === undefined ? `${after[k]}` : before[k] === after[k] ? `${after[k]}` : `${before[k]}→${after[k]}`)), errors, warnings]);
}
const header = ['file', ...Object.keys(counts({})), 'errors', 'warnings'];
const width = header.map((h, i) => Math.max(h.length, ...rows.map((r) => String(r[i]).length)));
for (const row of [header, ...rows])
  console.log(row.map((c, i) => (i ? String(c).padStart(width[i]) : String(c).padEnd(width[i]))).join('  '));
const kinds = {};
for (const c of complaints) {
  const key = c.split(' ').slice(0, 2).join(' ');
  kinds[key] = (kinds[key] ?? 0) + 1;
  if (kinds[key] <= 3) console.log(c);
}
for (const [key, n] of Object.entries(kinds)) if (n > 3) console.log(`${key} … ${n} in all`);
console.log(`${list.length} files, ${complaints.length} complaints`);
process.exit(complaints.length ? 1 : 0);
