# Blender's evaluated meshes of an FBX file and of the GLB made of it, at 5 times.
#
#   blender --background --factory-startup --python bench/blender_compare.py -- IN.fbx IN.glb
#
# Prints "agrees D" or "DIFFERS D", D the largest distance relative to the size: of each vertex of
# either to the nearest of the other that has the same place in the first picture.
import os
import sys

import numpy

numpy.bool = bool  # Blender 3.4's glTF importer with NumPy 1.24 and later
import bpy

fbx, glb = sys.argv[sys.argv.index("--") + 1 :]
bound = 1e-3


def positions(load, path):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.render.fps = 24
    load(filepath=path)
    scene = bpy.context.scene
    actions = [a for a in bpy.data.actions if a.fcurves]
    first = min((a.frame_range[0] for a in actions), default=1)
    last = max((a.frame_range[1] for a in actions), default=1)
    frames = []
    for k in range(5):
        frame = first + (last - first) * k / 4
        scene.frame_set(int(frame), subframe=frame - int(frame))
        graph = bpy.context.evaluated_depsgraph_get()
        points = []
        for thing in sorted(scene.objects, key=lambda o: o.name):
            if thing.type != "MESH" or not thing.users_collection:
                continue
            shown = thing.evaluated_get(graph)
            mesh = shown.to_mesh()
            # The bones' shapes of the glTF importer are no part of the scene.
            if len(mesh.polygons) and not thing.name.startswith("Icosphere"):
                world = shown.matrix_world
                points += [tuple(world @ v.co) for v in mesh.vertices]
            shown.to_mesh_clear()
        frames.append(numpy.array(points))
    return frames, (last - first) / scene.render.fps * scene.render.fps_base


ours, our_length = positions(bpy.ops.import_scene.gltf, glb)
theirs, their_length = positions(bpy.ops.import_scene.fbx, fbx)
size = float(numpy.linalg.norm(theirs[0].max(axis=0) - theirs[0].min(axis=0)))


# By their ways through all five times, so that each vertex is compared with itself.
def ways(frames):
    return numpy.concatenate(frames, axis=1)


def farthest(a, b):
    worst = 0.0
    for start in range(0, len(a), 256):
        block = a[start : start + 256]
        apart = numpy.abs(block[:, None, :] - b[None, :, :]).max(axis=2).min(axis=1)
        worst = max(worst, float(apart.max()))
    return worst


a, b = ways(ours), ways(theirs)
largest = max(farthest(a, b), farthest(b, a)) / size
moved = float(numpy.abs(theirs[0] - theirs[2]).max()) / size
good = largest <= bound and abs(our_length - their_length) <= 1e-3
print("%s %.1e of the size; moved %.2f; %d and %d vertices; %.3f s and %.3f s; %s" % (
    "agrees" if good else "DIFFERS", largest, moved, len(a), len(b), our_length, their_length,
    os.path.basename(fbx)))
sys.exit(0)
