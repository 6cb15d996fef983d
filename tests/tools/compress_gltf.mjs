// Compresses glTF and GLB files with @gltf-transform, for tests of what becomes of such files.
//
//   node compress_gltf.mjs NODE_MODULES LIST.json
//
// NODE_MODULES is the folder of the npm packages. LIST.json is a list of {"input", "output",
// "method"}; the method is "edgebreaker" or "sequential" (KHR_draco_mesh_compression, the package's
// own quantisation), "exact" (Edgebreaker without quantisation), "meshopt" or "filter"
// (EXT_meshopt_compression; with the filters that the package chooses for each accessor). What the
// package cannot write has no output. Exit 1 only where LIST.json itself cannot be worked on.
import { readFileSync, rmSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { createRequire } from 'node:module';
import { pathToFileURL } from 'node:url';

const [, , folder, listFile] = process.argv;
const nodeModules = resolve(folder);
const require = createRequire(join(nodeModules, 'none.js'));
const { NodeIO, Verbosity, Logger } = require('@gltf-transform/core');
const { ALL_EXTENSIONS, KHRDracoMeshCompression, EXTMeshoptCompression } = require('@gltf-transform/extensions');
const of = (file) => import(pathToFileURL(join(nodeModules, 'meshoptimizer', file)));
const { MeshoptDecoder } = await of('meshopt_decoder.mjs');
const { MeshoptEncoder } = await of('meshopt_encoder.js');
const draco = require('draco3dgltf');
await MeshoptDecoder.ready;
await MeshoptEncoder.ready;

const io = new NodeIO()
  .setLogger(new Logger(Verbosity.SILENT))
  .registerExtensions(ALL_EXTENSIONS)
  .registerDependencies({
    'draco3d.decoder': await draco.createDecoderModule(),
    'draco3d.encoder': await draco.createEncoderModule(),
    'meshopt.decoder': MeshoptDecoder,
    'meshopt.encoder': MeshoptEncoder,
  });

for (const { input, output, method } of JSON.parse(readFileSync(listFile, 'utf8'))) {
  try {
    const document = await io.read(input);
    for (const extension of document.getRoot().listExtensionsUsed())
      if ([KHRDracoMeshCompression, EXTMeshoptCompression].some((e) => extension instanceof e)) extension.dispose();
    if (method === 'meshopt' || method === 'filter') {
      const { QUANTIZE, FILTER } = EXTMeshoptCompression.EncoderMethod;
      document.createExtension(EXTMeshoptCompression).setRequired(true)
        .setEncoderOptions({ method: method === 'filter' ? FILTER : QUANTIZE });
    } else {
      const { EDGEBREAKER, SEQUENTIAL } = KHRDracoMeshCompression.EncoderMethod;
      const none = { POSITION: 0, NORMAL: 0, COLOR: 0, TEX_COORD: 0, GENERIC: 0 };
      document.createExtension(KHRDracoMeshCompression).setRequired(true).setEncoderOptions({
        method: method === 'sequential' ? SEQUENTIAL : EDGEBREAKER,
        ...(method === 'exact' ? { quantizationBits: none } : {}),
      });
    }
    await io.write(output, document);
  } catch (error) {
    console.error(`${input} by ${method}: ${error?.message ?? error}`);
    rmSync(output, { force: true });
  }
}
