# Times Blender's subdivision surface and displace modifiers on a cage with a height map.
#
#   blender --background --factory-startup --python bench/blender_displacement.py -- \
#       CAGE.obj HEIGHTS.png SCALE LEVEL
#
# Prints "blender TRIANGLES SECONDS CPU-SECONDS PEAK-MB": what evaluating the modifiers takes, up to
# the mesh with its vertex normals.
import resource
import sys
import time

import bpy

cage, heights, scale, level = sys.argv[sys.argv.index("--") + 1 :]
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.wm.obj_import(filepath=cage)
thing = bpy.context.selected_objects[0]
image = bpy.data.images.load(heights)
image.colorspace_settings.name = "Non-Color"
texture = bpy.data.textures.new("heights", type="IMAGE")
texture.image = image
texture.use_interpolation = True
subdivision = thing.modifiers.new("subdivision", "SUBSURF")
subdivision.levels = subdivision.render_levels = int(level)
displace = thing.modifiers.new("displace", "DISPLACE")
displace.texture = texture
displace.texture_coords = "UV"
displace.strength = float(scale)
displace.mid_level = 0.5
image.pixels[0]  # decoded before anything is timed
subdivision.show_viewport = displace.show_viewport = False
bpy.context.view_layer.update()
subdivision.show_viewport = displace.show_viewport = True
start, cpu = time.perf_counter(), time.process_time()
mesh = thing.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
mesh.calc_normals()
seconds, processor = time.perf_counter() - start, time.process_time() - cpu
triangles = 2 * len(mesh.polygons)
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
print("blender", triangles, seconds, processor, peak, flush=True)
