// Decodes glTF and GLB files with @gltf-transform and writes what they hold, value by value.
//
//   node decode_gltf.mjs NODE_MODULES LIST.json
//
// NODE_MODULES is the folder of the npm packages. LIST.json is a list of {"input", "output"}. For
// each, "output" (JSON) and "output".bin (the long lists, see ARRAY) are written; a file that the
// package refuses gives {"error": "…"}. Sparse values, Draco, meshopt, quantization and normalisation
// are undone. Everything is in the order of the file's own lists, so that indices mean the same; null
// is "none". The JSON:
//
//   scene                 index of the default scene, or null
//   scenes[]              name, nodes[]
//   nodes[]               name, matrix[16] (column-major, to the parent; the file's own numbers where
//                         it has a matrix), mesh, skin, camera, light, children[], weights[], extras,
//                         instances {semantic: ARRAY} or null (EXT_mesh_gpu_instancing)
//   meshes[]              name, weights[], extras, primitives[]: mode, material, indices (ARRAY, or
//                         null), attributes {semantic: ARRAY}, targets[] {semantic: ARRAY}, extras,
//                         variants[] {material, names[]}
//   skins[]               name, joints[], skeleton, inverseBindMatrices (ARRAY or null)
//   animations[]          name, channels[]: node, path, sampler; samplers[]: interpolation,
//                         input (ARRAY), output (ARRAY)
//   materials[]           name, extras, every property of the package's Material (baseColorFactor,
//                         alphaCutoff, …) and extensions {name: {property: value}}; defaults filled in.
//                         A property that is a texture is TEXTURE or null.
//   lights[]              name, type, color[3], intensity, range (null: no limit), innerConeAngle,
//                         outerConeAngle
//   cameras[]             name, type, yfov, aspectRatio, xmag, ymag, znear, zfar (null: infinite)
//   images[]              name, uri, mimeType, bytes (their number), hash (FNV-1a, 32 bits)
//   extensionsUsed[], extensionsRequired[]
//
//   ARRAY    {"type": "VEC3", "width": 3, "count": elements, "componentType": 5126, "normalized":
//            false, "store": "f32" | "f64" | "u32", "at": byte in the .bin}; little-endian. Lists
//            whose every value is a float are "f32".
//   TEXTURE  {"image", "texCoord" (what KHR_texture_transform makes of it), "offset", "rotation",
//            "scale", "wrapS", "wrapT", "magFilter", "minFilter" (null: the file names none)}
//
// Exit 1 only where LIST.json itself cannot be worked on.
import { readFileSync, writeFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { createRequire } from 'node:module';
import { pathToFileURL } from 'node:url';

const [, , folder, listFile] = process.argv;
const nodeModules = resolve(folder);
const require = createRequire(join(nodeModules, 'none.js'));
const { NodeIO, Texture, Verbosity, Logger } = require('@gltf-transform/core');
const { ALL_EXTENSIONS } = require('@gltf-transform/extensions');

const { MeshoptDecoder } = await import(pathToFileURL(join(nodeModules, 'meshoptimizer', 'meshopt_decoder.mjs')));

const list = JSON.parse(readFileSync(listFile, 'utf8'));
await MeshoptDecoder.ready;
const io = new NodeIO()
  .setLogger(new Logger(Verbosity.SILENT))
  .registerExtensions(ALL_EXTENSIONS)
  .registerDependencies({
    'draco3d.decoder': await require('draco3dgltf').createDecoderModule(),
    'meshopt.decoder': MeshoptDecoder,
  });

function rawJson(bytes) {
  if (bytes.length < 20 || bytes.readUInt32LE(0) !== 0x46546c67) return JSON.parse(bytes.toString('utf8'));
  return JSON.parse(bytes.subarray(20, 20 + bytes.readUInt32LE(12)).toString('utf8'));
}

function fnv1a(bytes) {
  let hash = 0x811c9dc5;
  for (let i = 0; i < bytes.length; ++i) hash = Math.imul(hash ^ bytes[i], 0x01000193);
  return hash >>> 0;
}

class Decoded {
  constructor(document, raw) {
    this.root = document.getRoot();
    this.raw = raw;
    this.parts = [];
    this.size = 0;
    this.known = new Map();
    this.lights = (raw.extensions?.KHR_lights_punctual?.lights ?? []).length
      ? this.root.listExtensionsUsed().find((e) => e.extensionName === 'KHR_lights_punctual')?.listProperties() ?? []
      : [];
  }

  index(list, item) {
    const at = item ? list.indexOf(item) : -1;
    return at < 0 ? null : at;
  }

  array(accessor) {
    if (!accessor) return null;
    if (this.known.has(accessor)) return this.known.get(accessor);
    const count = accessor.getCount(), width = accessor.getElementSize();
    const whole = accessor.getComponentType() === 5125;
    let values, store;
    if (whole && !accessor.getNormalized()) {
      values = Uint32Array.from(accessor.getArray());
      store = 'u32';
    } else {
      const exact = new Float64Array(count * width), element = [];
      for (let i = 0; i < count; ++i) {
        accessor.getElement(i, element);
        for (let k = 0; k < width; ++k) exact[i * width + k] = element[k];
      }
      const floats = new Float32Array(exact);
      const same = floats.every((v, i) => Object.is(v, exact[i]));
      values = same ? floats : exact;
      store = same ? 'f32' : 'f64';
    }
    const out = {
      type: accessor.getType(), width, count, componentType: accessor.getComponentType(),
      normalized: accessor.getNormalized(), store, at: this.size,
    };
    this.parts.push(Buffer.from(values.buffer, values.byteOffset, values.byteLength));
    this.size += values.byteLength;
    this.known.set(accessor, out);
    return out;
  }

  // {semantic: ARRAY} of whatever has listSemantics() and getAttribute().
  attributes(owner) {
    return Object.fromEntries(owner.listSemantics().map((s) => [s, this.array(owner.getAttribute(s))]));
  }

  texture(image, info) {
    if (!image) return null;
    const transform = info?.getExtension('KHR_texture_transform');
    return {
      image: this.index(this.root.listTextures(), image),
      texCoord: transform?.getTexCoord() ?? info?.getTexCoord() ?? 0,
      offset: transform?.getOffset() ?? [0, 0],
      rotation: transform?.getRotation() ?? 0,
      scale: transform?.getScale() ?? [1, 1],
      wrapS: info?.getWrapS() ?? 10497,
      wrapT: info?.getWrapT() ?? 10497,
      magFilter: info?.getMagFilter() ?? null,
      minFilter: info?.getMinFilter() ?? null,
    };
  }

  // Everything that an object of the package has a getter for.
  properties(object) {
    const out = {};
    for (const getter of Object.getOwnPropertyNames(Object.getPrototypeOf(object))) {
      if (!/^get[A-Z]/.test(getter) || /^getDefaults$|TextureInfo$/.test(getter) || object[getter].length > 0) continue;
      const key = getter[3].toLowerCase() + getter.slice(4);
      const value = object[getter]();
      if (value instanceof Texture) out[key] = this.texture(value, object[getter + 'Info']?.());
      else out[key] = typeof value === 'number' && !Number.isFinite(value) ? null : value;
    }
    return out;
  }

  primitive(primitive) {
    const materials = this.root.listMaterials();
    const variants = primitive.getExtension('KHR_materials_variants');
    return {
      mode: primitive.getMode(),
      material: this.index(materials, primitive.getMaterial()),
      indices: this.array(primitive.getIndices()),
      attributes: this.attributes(primitive),
      targets: primitive.listTargets().map((t) => this.attributes(t)),
      variants: (variants?.listMappings() ?? []).map((m) => ({
        material: this.index(materials, m.getMaterial()),
        names: m.listVariants().map((v) => v.getName()),
      })),
      extras: primitive.getExtras(),
    };
  }

  node(node, index) {
    const root = this.root;
    const instances = node.getExtension('EXT_mesh_gpu_instancing');
    return {
      name: node.getName(),
      // The package takes matrices apart; sheared ones would not come back.
      matrix: this.raw.nodes[index].matrix ?? Array.from(node.getMatrix()),
      mesh: this.index(root.listMeshes(), node.getMesh()),
      skin: this.index(root.listSkins(), node.getSkin()),
      camera: this.index(root.listCameras(), node.getCamera()),
      light: this.index(this.lights, node.getExtension('KHR_lights_punctual')),
      children: node.listChildren().map((n) => root.listNodes().indexOf(n)),
      weights: node.getWeights(),
      instances: instances ? this.attributes(instances) : null,
      extras: node.getExtras(),
    };
  }

  animation(animation) {
    const samplers = animation.listSamplers();
    return {
      name: animation.getName(),
      channels: animation.listChannels().map((c) => ({
        node: this.index(this.root.listNodes(), c.getTargetNode()),
        path: c.getTargetPath(),
        sampler: this.index(samplers, c.getSampler()),
      })),
      samplers: samplers.map((s) => ({
        interpolation: s.getInterpolation(), input: this.array(s.getInput()), output: this.array(s.getOutput()),
      })),
    };
  }

  json() {
    const root = this.root;
    return {
      scene: this.index(root.listScenes(), root.getDefaultScene()),
      scenes: root.listScenes().map((s) => ({
        name: s.getName(), nodes: s.listChildren().map((n) => root.listNodes().indexOf(n)),
      })),
      nodes: root.listNodes().map((n, i) => this.node(n, i)),
      meshes: root.listMeshes().map((m) => ({
        name: m.getName(), weights: m.getWeights(), extras: m.getExtras(),
        primitives: m.listPrimitives().map((p) => this.primitive(p)),
      })),
      skins: root.listSkins().map((s) => ({
        name: s.getName(),
        joints: s.listJoints().map((n) => root.listNodes().indexOf(n)),
        skeleton: this.index(root.listNodes(), s.getSkeleton()),
        inverseBindMatrices: this.array(s.getInverseBindMatrices()),
      })),
      animations: root.listAnimations().map((a) => this.animation(a)),
      materials: root.listMaterials().map((m) => ({
        name: m.getName(), extras: m.getExtras(), ...this.properties(m),
        extensions: Object.fromEntries(m.listExtensions().map((e) => [e.extensionName, this.properties(e)])),
      })),
      lights: this.lights.map((l) => ({ name: l.getName(), ...this.properties(l) })),
      cameras: root.listCameras().map((c, i) => ({
        name: c.getName(), type: c.getType(), yfov: c.getYFov(), aspectRatio: c.getAspectRatio(),
        xmag: c.getXMag(), ymag: c.getYMag(), znear: c.getZNear(),
        // The package has 100 where the file says that it is infinite.
        zfar: this.raw.cameras[i][c.getType()]?.zfar ?? null,
      })),
      images: root.listTextures().map((t) => ({
        name: t.getName(), uri: t.getURI(), mimeType: t.getMimeType(),
        bytes: t.getImage()?.byteLength ?? 0, hash: t.getImage() ? fnv1a(t.getImage()) : 0,
      })),
      extensionsUsed: this.raw.extensionsUsed ?? [],
      extensionsRequired: this.raw.extensionsRequired ?? [],
    };
  }
}

for (const { input, output } of list) {
  try {
    const decoded = new Decoded(await io.read(input), rawJson(readFileSync(input)));
    const json = decoded.json();
    writeFileSync(output + '.bin', Buffer.concat(decoded.parts));
    writeFileSync(output, JSON.stringify(json));
  } catch (error) {
    writeFileSync(output, JSON.stringify({ error: String(error?.message ?? error) }));
  }
}
