# Times Blender's calc_tangents on a mesh in generate_torus's raw format.
#
#   blender --background --factory-startup --python bench/blender_tangents.py -- IN.raw RUNS
#
# Prints one line a run: "blender SECONDS CPU-SECONDS". Normals are made beforehand: only tangents
# are timed.
import array
import sys
import time

import bpy

path, runs = sys.argv[sys.argv.index("--") + 1 :]
with open(path, "rb") as file:
    vertices, triangles = array.array("I", file.read(8))
    positions = array.array("f", file.read(12 * vertices))
    file.seek(12 * vertices, 1)  # normals: Blender makes its own
    corners = array.array("i", file.read(12 * triangles))
    uvs = array.array("f", file.read(24 * triangles))

mesh = bpy.data.meshes.new("torus")
mesh.vertices.add(vertices)
mesh.vertices.foreach_set("co", positions)
mesh.loops.add(3 * triangles)
mesh.loops.foreach_set("vertex_index", corners)
mesh.polygons.add(triangles)
mesh.polygons.foreach_set("loop_start", array.array("i", range(0, 3 * triangles, 3)))
mesh.polygons.foreach_set("loop_total", array.array("i", [3]) * triangles)
mesh.polygons.foreach_set("use_smooth", [True] * triangles)
mesh.uv_layers.new(name="uv").data.foreach_set("uv", uvs)
mesh.update()
mesh.calc_normals_split()
for _ in range(int(runs)):
    start, cpu = time.perf_counter(), time.process_time()
    mesh.calc_tangents(uvmap="uv")
    print("blender", time.perf_counter() - start, time.process_time() - cpu, flush=True)
    mesh.free_tangents()
    mesh.calc_normals_split()
