# Tests that are compiled together, a program a line, where MESHPREP_UNITY is on (CMakeLists.txt): in
# less than half the time, as headers, and the templates that each file makes anew, take most of it.
# A test that is in no line is a program of its own, as all are without MESHPREP_UNITY.
#
# In a line names at namespace scope must differ. Either all tests of a line run under sanitizers
# (sanitized.cmake) or none does, and the same for tests about threads: otherwise CI builds tests that
# it does not run. About 120 kB of sources a line keep a compiler within a gigabyte.
set(tests_together
    "prep arithmetic check corner_normals file_bytes gltf_large"
    "prep face_normals hard_edges vertex_normals gltf_compression"
    "prep assimp authored_tangents check_values compressed_files exact_cases formats gltf_bounds
     image_files load mesh_cases number_text picture_search"
    "prep assimp_formats assimp_keys assimp_lost assimp_scenes assimp_split assimp_texts
     limit_surface_oracle one_definition scene_json_values subdivide_face_varying"
    "prep gltf_corpus image_values invariance ply_records render_choices requirements result samples
     simd stability tangent_conventions tangents_fallback"
    "prep gltf_lost gltf_requantize prepare_reports repair_page repair_values save
     subdivision_oracle tangents_golden tangents_options tangents_pole tangents_reference written_text written_values"
    "prep one_picture ordered_files scene scene_json_defaults scene_shapes tangents_npm"
    "prep bilinear_deviation chart_filter large_vector tessellation_campaign tessellation_closed_faces
     tessellation_closed_form tessellation_economy tessellation_limit_bounds"
    "prep height_filters tessellation_frames tessellation_triangle_bounds"
    "prep noise_field tessellation_maps"
    "prep tessellation_screens tessellation_sources"
    "prep contained_mutations gltf_mend gltf_repair gltf_values moving_cages mtl obj_names odd_files prepare_subdivide
     recover_quads repair_flat repair_holes"
    "prep image_damage obj_values off openmesh ply ply_colors repair
     repair_marks scene_bytes"
    "prep crease_fans obj prepare source_corners subdivide_attributes triangulate weld"
    "prep split stl tangents_cases tangents_identity topology"
    "prep assimp_motion contained height_map limit_surface subdivide"
    "prep gltf_accessors gltf_compression_odd gltf_container gltf_rewrite_cases scene_json"
    "prep gltf_build gltf_conformance gltf_moving_scenes gltf_rewrite gltf_skins materials_corpus
     real_gltf_files written_corpus"
    "prep gltf_extensions gltf_materials gltf_meshes gltf_morph gltf_scene_data unit_normals"
    "prep gltf_quantize gltf_written_materials material_mapping morph_targets"
    "prep gltf_repeated_data gltf_scene gltf_targets gltf_written_back vertex_order"
    "prep map_charts tessellation_hard_cases"
    "prep tessellation_limit tessellation_polygons"
    "rast alpha_cutoff area_coverage blending bounded_skips bump_maps camera crossing depth derivatives
     effects exposure instances"
    "rast interpolation lights material_spheres mip_levels offset pixel_edges raster_batch
     scene_renderer shade_stages skip_margins skip_table"
    "rast materials part_times plan_reads shading skips tangent_lighting texel_facts texels"
    "rast frame_passes plan plan_limits plan_reasons texture_placement thin_textures view visibility"
    "rast anti_aliasing rendering"
    "rast bands hard_cases hazards partial_pixels texture texture_instructions triangulation"
    "tools batch command cost_command cost_measure residual_map"
    "tools budget_ms console corpus cost_fitted_normals cost_flip cost_grids cost_ladders diff
     displacement_views docs optimize silhouettes"
    "tools diff_values displace_options displace_refusals explain gate_cases gate_command
     height_to_normal image_error"
    "tools gate inspect_cage pixel_error plan_page quantize_budget render render_costs
     render_defaults render_exposure render_usage samples"
    "tools inspect prepare_budget prepare_for prepare_for_document prepare_report prepare_words
     render_options render_report report_cages"
    "tools render_outputs report_drawing report_edges report_figures report_page residual_surface schema
     selftest shell_files source_rules streams"
    "tools render_values report_panels spared_files subdivide_options subdivided_files tangents validate
     validate_counts"
    "tools cost_oracles displaced_files loaded_libraries odd_surroundings option_effects placement
     resumed_batches tessellation_errors validate_report"
    "tools contained cost_pages gate_json input_file odd_inputs typed_lines world")

# In no line: what replaces a function of the whole program (operator new, time), what scripts and
# pages run by its name, and CGAL's headers, which no other test reads.
set(tests_alone prep_image prep_tangents_memory rast_coverage rast_random_scenes tools_cost_faults
    tools_large_blocks tools_surface_distance)
