# Makes rigs as people export them: armatures of 1 to 8 influences, shape keys, pivots, scaled
# armatures, other units. FBX of each, and DAE where the exporter can say it.
#
#   blender --background --factory-startup --python bench/blender_rigs.py -- FOLDER
#
# Prints the name of each file. The files are the same for the same Blender.
import math
import os
import sys

import bpy
from mathutils import Euler, Matrix, Vector

folder = sys.argv[sys.argv.index("--") + 1]
os.makedirs(folder, exist_ok=True)


def clean():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.render.fps = 24
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 1, 41


def tube(name, rings=13, sides=8, height=6.0):
    vertices, faces = [], []
    for r in range(rings):
        for s in range(sides):
            a = 2 * math.pi * s / sides
            radius = 0.5 + 0.1 * math.sin(3 * a + r)
            vertices.append((radius * math.cos(a), radius * math.sin(a), height * r / (rings - 1)))
    for r in range(rings - 1):
        for s in range(sides):
            t = (s + 1) % sides
            faces.append((r * sides + s, r * sides + t, (r + 1) * sides + t, (r + 1) * sides + s))
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    mesh.update()
    thing = bpy.data.objects.new(name, mesh)
    bpy.context.collection.objects.link(thing)
    return thing


def armature(bones=8, height=6.0, scale=(1, 1, 1), location=(0, 0, 0)):
    data = bpy.data.armatures.new("rig")
    rig = bpy.data.objects.new("rig", data)
    bpy.context.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    last = None
    for b in range(bones):
        bone = data.edit_bones.new("bone%d" % b)
        bone.head = (0, 0, height * b / bones)
        bone.tail = (0, 0, height * (b + 1) / bones)
        bone.parent = last
        last = bone
    bpy.ops.object.mode_set(mode="OBJECT")
    rig.scale, rig.location = scale, location
    return rig


def bind(thing, rig, influences):
    modifier = thing.modifiers.new("skin", "ARMATURE")
    modifier.object = rig
    thing.parent = rig
    count = len(rig.data.bones)
    groups = [thing.vertex_groups.new(name="bone%d" % b) for b in range(count)]
    for v in thing.data.vertices:
        first = min(int(v.co.z / 6.0 * count), count - 1)
        weights = [1.0 / (1 + k) for k in range(influences)]
        for k, w in enumerate(weights):
            groups[(first + k) % count].add([v.index], w / sum(weights), "REPLACE")


def wave(rig):
    for b, bone in enumerate(rig.pose.bones):
        bone.rotation_mode = "XYZ"
        for frame in (1, 11, 21, 31, 41):
            bone.rotation_euler = Euler((0.3 * math.sin(frame + b), 0.2 * math.cos(2 * frame + b), 0.1 * b))
            bone.keyframe_insert("rotation_euler", frame=frame)
    rig.keyframe_insert("location", frame=1)
    rig.location = Vector(rig.location) + Vector((1, 2, 0.5))
    rig.keyframe_insert("location", frame=41)


def keys(thing):
    thing.shape_key_add(name="Basis")
    for k in range(3):
        key = thing.shape_key_add(name="key%d" % k)
        for i, point in enumerate(key.data):
            if i % 3 == k:
                point.co = point.co + Vector((0.2 * (k + 1), -0.1, 0.15 * k))
        for frame, value in ((1, 0.0), (15, 1.0 - 0.25 * k), (41, 0.3 * k)):
            key.value = value
            key.keyframe_insert("value", frame=frame)


def export(name, **options):
    path = os.path.join(folder, name + ".fbx")
    bpy.ops.export_scene.fbx(filepath=path, add_leaf_bones=False, bake_anim_simplify_factor=0.0,
                             bake_anim_use_all_actions=False, bake_anim_use_nla_strips=False, **options)
    print("rig " + path)


def export_dae(name):
    if not hasattr(bpy.ops.wm, "collada_export"):
        return
    path = os.path.join(folder, name + ".dae")
    try:
        bpy.ops.wm.collada_export(filepath=path, include_animations=True)
    except (AttributeError, RuntimeError):  # Debian may build without it
        return
    print("rig " + path)


for influences in (1, 2, 3, 4, 6, 8):
    clean()
    rig = armature()
    thing = tube("tube")
    bind(thing, rig, influences)
    wave(rig)
    export("influences%d" % influences)
    export_dae("influences%d" % influences)

clean()  # 7: shape keys alone
keys(tube("face"))
export("shape_keys")

clean()  # 8: shape keys under a skin
rig = armature()
thing = tube("body")
bind(thing, rig, 4)
keys(thing)
wave(rig)
export("shape_keys_and_skin")

clean()  # 9: a scaled, moved armature
rig = armature(scale=(2, 2, 2), location=(3, -1, 2))
thing = tube("scaled")
bind(thing, rig, 4)
wave(rig)
export("scaled_armature")

clean()  # 10: an armature scaled by other numbers along each axis
rig = armature(scale=(1.5, 0.75, 2))
thing = tube("stretched")
bind(thing, rig, 3)
wave(rig)
export("stretched_armature")

clean()  # 11: pivots: an object turned about the end of its parent, both animated
parent = tube("upper", height=2.0)
child = tube("lower", height=2.0)
child.parent = parent
child.matrix_parent_inverse = Matrix.Translation((0, 0, 2)) @ Matrix.Rotation(0.4, 4, "X")
for frame in (1, 21, 41):
    parent.rotation_euler = Euler((0.02 * frame, 0.01 * frame, 0))
    child.rotation_euler = Euler((0, 0.03 * frame, 0.02 * frame))
    child.delta_location = (0.5, 0, 0)
    parent.keyframe_insert("rotation_euler", frame=frame)
    child.keyframe_insert("rotation_euler", frame=frame)
export("pivots")

clean()  # 12: other units and axes
rig = armature()
thing = tube("units")
bind(thing, rig, 4)
wave(rig)
bpy.context.scene.unit_settings.system = "METRIC"
bpy.context.scene.unit_settings.scale_length = 0.01
export("other_units", apply_scale_options="FBX_SCALE_UNITS", axis_up="Z", axis_forward="Y")
