#include "formats/transparency.h"

#include <set>

namespace prep::detail {

void settle_transparency(Scene& scene, Transparency choice) {
    std::set<std::uint32_t> used;
    for (const Mesh& mesh : scene.meshes) {
        // Faces without a material are seen.
        if (mesh.face_count() > 0 && mesh.face_materials.empty()) return;
        std::uint32_t last = no_index;
        for (const std::uint32_t m : mesh.face_materials) {
            if (m >= scene.materials.size()) return;
            if (m != last) used.insert(m);
            last = m;
        }
    }
    if (used.empty()) return;
    for (const std::uint32_t m : used) {
        const Material& material = scene.materials[m];
        if (material.alpha_mode == AlphaMode::opaque || material.diffuse.a > 0 ||
            (material.alpha_mode == AlphaMode::mask && material.alpha_cutoff <= 0))
            return;
    }
    const std::string what = used.size() == 1 ? "the only material is wholly transparent"
                                              : "all " + std::to_string(used.size()) +
                                                    " materials are wholly transparent";
    if (choice == Transparency::file || scene.retained_file) {
        scene.warnings.push_back(what +
                                 " (opacity 0): nothing of the model is seen where that is "
                                 "obeyed");
        return;
    }
    for (const std::uint32_t m : used) {
        scene.materials[m].diffuse.a = 1;
        scene.materials[m].alpha_mode = AlphaMode::opaque;
    }
    scene.warnings.push_back(what +
                             " (opacity 0, as \"Tr 1\" and \"d 0\" say): made opaque; "
                             "--transparency file keeps it");
}

}  // namespace prep::detail
