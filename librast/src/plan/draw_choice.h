// How a run of triangles is shaded: one decision, which the plan tells and the draws obey.
#pragma once

#include <cstdint>

#include "prep/material.h"
#include "rast/render.h"

namespace rast::detail {

enum class NormalSource : std::uint8_t { none, face, interpolated, tangent_map, object_map };

struct DrawChoice {
    NormalSource source = NormalSource::interpolated;
    std::uint32_t maps = 0;      // bit k: MapKind k is read
    std::uint32_t could_be = 0;  // and those that would be, had the material and the mesh them
    bool masked = false, highlights = true;
    bool has(prep::MapKind kind) const { return (maps >> unsigned(kind) & 1u) != 0; }
};

// Each of `textures` has a slot for each of its uses: all as colours, then all as data, then the
// slopes of all as bump maps. That of a map; beyond all where its material names none that there
// is.
inline constexpr std::size_t texture_uses = 3;
std::size_t texture_slot(std::size_t textures, prep::MapKind kind, const prep::TextureRef& ref);

// `material`: the mesh's, of this number (the default one beyond all). Textures that cannot be read
// are known only when they are: they drop out of the draw then.
DrawChoice choose(const RenderPlan& plan, const prep::Consumer& consumer,
                  const prep::VertexMesh& mesh, const prep::Material& material,
                  std::uint32_t number);

// What prep::calls_for() is asked on behalf of a plan: `lights` aside, the request's doing.
prep::Consumer consumer_for(const RenderRequest& request, bool lights);

}  // namespace rast::detail
