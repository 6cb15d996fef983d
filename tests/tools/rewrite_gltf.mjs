// Reads glTF and GLB files with @gltf-transform and writes them again, for tests of what another
// program's writing changes.
//
//   node rewrite_gltf.mjs NODE_MODULES LIST.json
//
// LIST.json is a list of {"input", "output"}.
import { readFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { createRequire } from 'node:module';

const [, , folder, listFile] = process.argv;
const require = createRequire(join(resolve(folder), 'none.js'));
const { NodeIO, Verbosity, Logger } = require('@gltf-transform/core');
const { ALL_EXTENSIONS } = require('@gltf-transform/extensions');
const io = new NodeIO().setLogger(new Logger(Verbosity.SILENT)).registerExtensions(ALL_EXTENSIONS);
for (const { input, output } of JSON.parse(readFileSync(listFile, 'utf8')))
  await io.write(output, await io.read(input));
