# What every change runs under the address and undefined-behaviour sanitizers (.ci/run sanitizers):
# tests that give damaged, hostile or random input to code that reads, indexes or computes addresses.
# The others compare results that do not depend on it; `ctest --preset asan-ubsan` runs all.
set(sanitized_tests
    # files
    prep_assimp_motion prep_contained prep_contained_mutations prep_gltf_accessors
    prep_gltf_compression_odd prep_gltf_container prep_gltf_mend
    prep_gltf_repair prep_gltf_rewrite_cases prep_gltf_values prep_image_damage prep_mtl prep_obj
    prep_obj_names prep_obj_values prep_odd_files prep_off prep_openmesh prep_ply prep_ply_colors prep_scene_bytes prep_scene_json
    prep_stl prep_threemf
    # meshes
    prep_crease_fans prep_height_map prep_limit_surface prep_map_charts prep_moving_cages prep_prepare prep_prepare_subdivide
    prep_recover_quads prep_repair prep_repair_flat prep_repair_holes prep_repair_marks prep_source_corners prep_split prep_subdivide
    prep_subdivide_attributes prep_tangents_cases prep_tangents_identity prep_tessellation_hard_cases
    prep_topology prep_triangulate prep_weld
    # drawing
    rast_bands rast_coverage rast_hard_cases rast_hazards rast_partial_pixels rast_texture
    rast_texture_instructions rast_triangulation
    # the command
    tools_contained tools_cost_pages tools_gate_json tools_input_file tools_large_blocks
    tools_odd_inputs tools_typed_lines tools_world)
list(TRANSFORM sanitized_tests APPEND _test)

# Builds them.
add_custom_target(sanitizer_tests)

# Sets `label` in the caller: what ctest -L chooses a program of these files by.
function(meshprep_test_label program folder stems)
  set(names ${stems})
  list(TRANSFORM names PREPEND ${folder}_)
  list(TRANSFORM names APPEND _test)
  set(others ${names})
  list(REMOVE_ITEM others ${sanitized_tests})
  if(NOT others)
    add_dependencies(sanitizer_tests ${program})
    set(label ${folder}-sanitized PARENT_SCOPE)
  elseif(others STREQUAL names)
    set(label ${folder} PARENT_SCOPE)
  else()
    message(FATAL_ERROR "tests/together.cmake: ${program} has tests under sanitizers and others: "
                        "${others}")
  endif()
endfunction()

# A test that was renamed must not drop out in silence.
function(meshprep_check_sanitized_tests)
  foreach(name IN LISTS sanitized_tests)
    if(NOT TARGET ${name} AND (MESHPREP_BUILD_TOOLS OR NOT name MATCHES "^tools_"))
      message(FATAL_ERROR "tests/sanitized.cmake names ${name}, which is no test")
    endif()
  endforeach()
endfunction()
