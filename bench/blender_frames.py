# Blender's own normals and tangents of GLB files, beside those that the files hold, corner by corner.
#
#   blender --background --factory-startup --python-use-system-env --python bench/blender_frames.py \
#       -- FILE.glb... [--polygons FILE.glb...]
#
# Files behind --polygons are made of faces of more than three corners: MikkTSpace takes quads whole, and
# Blender sees the triangles that were written. Their tangents count apart.
#
# Normals: what Blender makes of the file's, which it stores as two angles of 16 bits about its own.
# Tangents: Blender's MikkTSpace of those normals and the file's UVs. The base shape is compared, in the
# file's own space: neither joints nor targets act on it.
#
# Prints for each file its counts and percentiles, and each corner that is more than 1 degree apart
# with its cause, the first that applies of those listed at `causes_of_*`; at the end the same of all.
# Corners of faces that Blender drops (those that name a vertex twice, or stand twice) are counted. Exits
# with 0 always; the last line begins with "frames agree" or "frames DIFFER".
import os
import sys

import numpy as np

np.bool = bool  # Blender 3.4's glTF importer with NumPy 1.24 and later
import bpy
from io_scene_gltf2.blender.imp import gltf2_blender_mesh as importer
from io_scene_gltf2.io.imp.gltf2_io_binary import BinaryData
from io_scene_gltf2.io.imp.gltf2_io_gltf import glTFImporter

limit = 0.25  # degrees, of the 99th percentile
listed = 1.0  # degrees: corners farther apart are listed
sources = []  # (Blender's mesh, the file's corners) of the file that is being imported


class Corners:
    """The triangles' corners of a glTF mesh, in the importer's order and axes."""

    def __init__(self, gltf, mesh):
        self.vertices, self.points, self.normals, self.tangents, self.uv_sets = [], [], [], [], []
        count = 0
        for primitive in mesh.primitives:
            attributes = primitive.attributes
            if "POSITION" not in attributes:
                continue
            read = lambda name: np.array(BinaryData.decode_accessor(gltf, attributes[name]), dtype=np.float64)
            points = read("POSITION")
            if primitive.indices is None:
                indices = np.arange(len(points), dtype=np.uint32)
            else:
                indices = BinaryData.decode_accessor(gltf, primitive.indices).reshape(-1)
            indices = importer.points_edges_tris(4 if primitive.mode is None else primitive.mode, indices)[2]
            if indices is None:
                continue
            self.vertices.append(np.unique(indices, return_inverse=True)[1] + count)
            count += len(np.unique(indices))
            self.points.append(points[indices])
            nothing = np.full((len(indices), 4), np.nan)
            self.normals.append(read("NORMAL")[indices] if "NORMAL" in attributes else nothing[:, :3])
            self.tangents.append(read("TANGENT")[indices] if "TANGENT" in attributes else nothing)
            self.uv_sets.append(np.full(len(indices), self.uv_set(gltf, primitive)))
        if not self.points:
            return
        self.vertices, self.points, self.normals, self.tangents, self.uv_sets = map(
            np.concatenate, (self.vertices, self.points, self.normals, self.tangents, self.uv_sets))
        for vectors in (self.points, self.normals, self.tangents):
            vectors[:, [1, 2]] = vectors[:, [2, 1]]
            vectors[:, 1] *= -1

    @staticmethod
    def uv_set(gltf, primitive):
        """That of the normal map: tangents are along it."""
        if primitive.material is None:
            return 0
        material = gltf.data.materials[primitive.material]
        texture = material.normal_texture
        return texture.tex_coord or 0 if texture is not None else 0


def keep_corners(create):
    def wrapped(gltf, index, skin, mesh, thing):
        create(gltf, index, skin, mesh, thing)
        sources.append((mesh, Corners(gltf, gltf.data.meshes[index])))

    return wrapped


def number_corners(smooth):
    # Called just before Mesh.validate(), which drops faces: what is left tells which corner it was.
    def wrapped(gltf, source, mesh, normals, corners):
        smooth(gltf, source, mesh, normals, corners)
        if len(mesh.loops):
            layer = mesh.attributes.new("source corner", "INT", "CORNER")
            layer.data.foreach_set("value", np.arange(len(mesh.loops), dtype=np.int32))

    return wrapped


def pass_textures(start):
    # An extension of pictures, which nothing here looks at.
    def wrapped(self, *arguments):
        start(self, *arguments)
        self.extensions_managed.append("KHR_texture_basisu")

    return wrapped


glTFImporter.__init__ = pass_textures(glTFImporter.__init__)
importer.do_primitives = keep_corners(importer.do_primitives)
importer.set_poly_smoothing = number_corners(importer.set_poly_smoothing)
importer.skin_into_bind_pose = lambda *everything, **named: None  # the file's own space


def degrees(a, b):
    with np.errstate(invalid="ignore", divide="ignore"):
        a = a / np.linalg.norm(a, axis=1, keepdims=True)
        b = b / np.linalg.norm(b, axis=1, keepdims=True)
        return np.degrees(2 * np.arctan2(np.linalg.norm(a - b, axis=1), np.linalg.norm(a + b, axis=1)))


def get(things, name, width):
    values = np.empty(len(things) * width, dtype=np.float32)
    things.foreach_get(name, values)
    return values.reshape(-1, width).astype(np.float64)


def ids(*columns):
    """A number for each row; equal rows, bit for bit but for the sign of zero, have the same."""
    rows = np.ascontiguousarray(np.concatenate(columns, axis=1) + 0.0)
    return np.unique(rows.view([("", rows.dtype)] * rows.shape[1]).reshape(-1), return_inverse=True)[1]


def anywhere(corners_of, marked):
    """Whether any corner of the same number is marked."""
    out = np.zeros(corners_of.max() + 1, dtype=bool)
    out[corners_of[marked]] = True
    return out[corners_of]


def without_area(a, b, c):
    """Triangles, of points or UVs, whose height is below 1e-5 of their length."""
    u, v = b - a, c - a
    longest = np.maximum(np.maximum((u * u).sum(1), (v * v).sum(1)), ((c - b) ** 2).sum(1))
    if u.shape[1] == 2:
        twice = np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
    else:
        twice = np.linalg.norm(np.cross(u, v), axis=1)
    return ~(twice > 1e-5 * longest)


def fans(vertices):
    """Corners at vertices of several fans, or on edges of three faces or of two that run alike."""
    triangles = vertices.reshape(-1, 3)
    start, end = vertices, triangles[:, [1, 2, 0]].reshape(-1)
    low, high = np.minimum(start, end).astype(np.int64), np.maximum(start, end)
    edges, edge, count = np.unique(low * (high.max() + 1) + high, return_inverse=True, return_counts=True)
    forward = np.zeros(len(edges), dtype=int)
    np.add.at(forward, edge, start == low)
    odd = (count > 2) | ((count == 2) & (forward != 1))
    bad = np.zeros(vertices.max() + 1, dtype=bool)
    bad[start[odd[edge]]] = True
    bad[end[odd[edge]]] = True
    faces = np.bincount(vertices, minlength=len(bad))
    inner = np.zeros(len(bad), dtype=int)  # twice: each inner edge has two corners
    shared = count[edge] == 2
    np.add.at(inner, start[shared], 1)
    np.add.at(inner, end[shared], 1)
    return (bad | (faces - inner // 2 > 1))[vertices]


def off_normal(points, normals, k):
    """The sine between each corner's normal and its edge to the corner k places on."""
    triangles = points.reshape(-1, 3, 3)
    edge = triangles[:, [k % 3, (k + 1) % 3, (k + 2) % 3]].reshape(-1, 3) - points
    edge /= np.maximum(np.linalg.norm(edge, axis=1, keepdims=True), 1e-300)
    return np.linalg.norm(np.cross(edge, normals), axis=1)


def causes_of_normals(file, loops, own):
    a, b, c = file.points[0::3], file.points[1::3], file.points[2::3]
    flat = np.repeat(without_area(a, b, c), 3)
    yield "no normal in the file", ~(np.linalg.norm(file.normals, axis=1) > 0)
    yield "triangle without area", flat
    yield "beside a triangle without area", anywhere(file.vertices, flat)
    yield "fans or non-manifold edges at the vertex", fans(file.vertices)
    # Blender's angles are about its own normal, from an edge; along each other they tell nothing.
    sine = np.minimum(*(off_normal(file.points, own, k) for k in (1, 2)))
    yield "an edge along Blender's normal", anywhere(file.vertices, sine < 0.014)  # cosine over 0.9999


def causes_of_tangents(file, loops, uv, normals_apart, theirs, polygons):
    flat = np.repeat(without_area(*(file.points[k::3] for k in range(3))), 3)
    flat_uv = np.repeat(without_area(*(uv[k::3] for k in range(3))), 3)
    same = ids(file.points, file.normals, uv)  # what MikkTSpace takes for one vertex
    yield "no tangent in the file", ~(np.linalg.norm(file.tangents[:, :3], axis=1) > 0)
    yield "triangle without area", flat
    yield "triangle without UV area", flat_uv
    yield "beside a triangle without area or UV area", anywhere(same, flat | flat_uv)
    yield "normals are apart", anywhere(same, normals_apart > listed)
    # One vertex of the file that Blender's rounded normals make several of: triangles that meet in it
    # share no edge any more, so that their groups at the edge's other end are apart as well.
    rounded = ids(file.points, loops, uv)
    first = np.full(same.max() + 1, -1)
    first[same] = rounded
    parted = anywhere(same, first[same] != rounded)
    yield "Blender's rounded normals part the vertex", parted
    beside = np.repeat(parted.reshape(-1, 3).any(axis=1), 3)
    yield "Blender's rounded normals part an edge's other end", anywhere(same, beside)
    # Corners weigh by their angles in the plane of the normal, in which an edge along it has hardly a
    # direction: what rounding turns the normal by, divided by the sine between the two, turns it.
    sine = np.minimum(*(off_normal(file.points, file.normals, k) for k in (1, 2)))
    yield "an edge along the normal: the corner's angle is undetermined", anywhere(
        same, normals_apart > listed * sine)
    triangles = uv.reshape(-1, 3, 2)
    u, v = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    mirrored = np.repeat(u[:, 0] * v[:, 1] < u[:, 1] * v[:, 0], 3)
    yield "mirrored seam", anywhere(same, mirrored) & anywhere(same, ~mirrored)
    yield "gradients that cancel: Blender has no tangent", ~(np.linalg.norm(theirs, axis=1) > 0)
    if polygons:
        yield "of polygons, not of their triangles", np.ones(len(same), dtype=bool)


def causes(which, apart):
    far = ~(apart <= listed)
    names = np.full(len(apart), "", dtype=object)
    for name, holds in which:
        names[far & holds & (names == "")] = name
    names[far & (names == "")] = "unexplained"
    return names


def compare(name, mesh, corners, polygons):
    """(normals' angles, tangents' angles, faces not compared); prints what is far apart."""
    kept = np.empty(len(mesh.loops), dtype=np.int32)
    mesh.attributes["source corner"].data.foreach_get("value", kept)
    dropped = len(corners.points) - len(kept)
    file = corners
    for part in ("points", "normals", "tangents", "vertices", "uv_sets"):
        setattr(file, part, getattr(file, part)[kept])
    if np.isnan(file.normals).all():
        return [], [], dropped
    plain = mesh.copy()  # without the file's normals
    plain.normals_split_custom_set(np.zeros((len(kept), 3)))
    plain.calc_normals_split()
    own = get(plain.loops, "normal", 3)
    bpy.data.meshes.remove(plain)
    mesh.calc_normals_split()
    loops = get(mesh.loops, "normal", 3)
    normals = degrees(file.normals, loops)
    tell(name, mesh, "normal", normals, causes(causes_of_normals(file, loops, own), normals))
    tangents = []
    for uv_set in np.unique(file.uv_sets):
        if np.isnan(file.tangents).all() or uv_set >= len(mesh.uv_layers):
            continue
        layer = mesh.uv_layers[int(uv_set)]
        uv = get(layer.data, "uv", 2)
        mesh.calc_tangents(uvmap=layer.name)
        theirs, sign = get(mesh.loops, "tangent", 3), get(mesh.loops, "bitangent_sign", 1)[:, 0]
        mesh.free_tangents()
        here = (file.uv_sets == uv_set) & ~np.isnan(file.tangents[:, 0])
        apart = degrees(file.tangents[:, :3], theirs)
        apart[sign != file.tangents[:, 3]] = 180  # the bitangent is on the other side
        apart[~here] = 0
        tell(name, mesh, "tangent", apart,
             causes(causes_of_tangents(file, loops, uv, normals, theirs, polygons), apart))
        tangents.append(apart[here])
    return normals[~np.isnan(file.normals[:, 0])], np.concatenate(tangents) if tangents else [], dropped


counted = {}  # (normal or tangent, cause) of the corners listed


def tell(file, mesh, what, apart, causes):
    for corner in np.flatnonzero(causes != ""):
        cause = causes[corner]
        counted[what, cause] = counted.get((what, cause), 0) + 1
        print("corner\t%s\t%s\t%s\t%d\t%.3f\t%s" % (file, mesh.name, what, corner, apart[corner], cause))


def figures(angles):
    angles = np.concatenate(angles) if angles else np.empty(0)
    if not len(angles):
        return "none", 0, 0.0
    far = np.nan_to_num(angles, nan=180.0)
    p99 = float(np.percentile(far, 99))
    return "%d corners, median %.4f, p99 %.3f, max %.2f, %d beyond %g" % (
        len(far), np.median(far), p99, far.max(), (far > listed).sum(), listed), len(far), p99


paths = sys.argv[sys.argv.index("--") + 1 :]
of_polygons = set()
if "--polygons" in paths:
    of_polygons = set(paths[paths.index("--polygons") + 1 :])
    paths.remove("--polygons")
all_normals, all_tangents, polygon_tangents, all_dropped, failed = [], [], [], 0, 0
for path in paths:
    name = os.path.basename(path)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    sources.clear()
    try:
        bpy.ops.import_scene.gltf(filepath=path)
    except RuntimeError as problem:
        print("file\t%s\tnot read: %s" % (name, str(problem).strip().splitlines()[-1]))
        failed += 1
        continue
    normals, tangents, dropped = [], [], 0
    for mesh, corners in sources:
        if not len(mesh.loops):
            continue
        n, t, d = compare(name, mesh, corners, path in of_polygons)
        normals.append(n)
        tangents.append(t)
        dropped += d
    print("file\t%s\tnormals: %s; tangents: %s; %d corners of faces that Blender drops" % (
        name, figures(normals)[0], figures(tangents)[0], dropped), flush=True)
    all_normals += normals
    (polygon_tangents if path in of_polygons else all_tangents).extend(tangents)
    all_dropped += dropped
for (what, cause), count in sorted(counted.items()):
    print("cause\t%s\t%s\t%d" % (what, cause, count))
n, t, p = figures(all_normals), figures(all_tangents), figures(polygon_tangents)
unexplained = sum(count for (what, cause), count in counted.items() if cause == "unexplained")
good = n[1] > 0 and t[1] > 0 and n[2] <= limit and t[2] <= limit and not failed and not unexplained
print("all\tnormals: " + n[0])
print("all\ttangents: " + t[0])
print("all\ttangents of polygons, beside those of their triangles: " + p[0])
print("all\t%d files; %d not read; %d corners of faces that Blender drops" % (len(paths), failed, all_dropped))
print("frames agree" if good else "frames DIFFER", flush=True)
