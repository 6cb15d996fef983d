// Pictures of random scenes, small ones, and what is compared of them.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "builders.h"
#include "random_scenes.h"

namespace test {

inline prep::PreparedScene prepared_random_scene(std::uint32_t seed,
                                                 const prep::PrepareOptions& options = {}) {
    auto prepared = prep::prepare(random_scene(seed), options);
    if (!prepared) throw std::runtime_error(to_string(prepared.error()));
    return *std::move(prepared);
}

// Every shading, 1 and 4 samples, each buffer that there is.
inline rast::RenderRequest random_request(std::uint32_t seed) {
    RandomNumbers r(seed + 0x10000);
    rast::RenderRequest request;
    request.width = 40 + r.below(60);
    request.height = 30 + r.below(60);
    request.shading = rast::Shading(r.below(4));
    request.samples = r.chance(0.5) ? 1 : 4;
    request.background = {r.between(0, 1), r.between(0, 1), r.between(0, 1)};
    request.cull = rast::Cull(r.chance(0.7) ? 0 : r.below(4));
    if (r.chance(0.5)) request.filter = rast::TextureFilter(r.below(9));
    request.keep_depth = request.keep_ids = request.keep_normals = request.keep_uvs =
        request.keep_barycentrics = request.keep_positions = true;
    return request;
}

// A plan that knows its textures' texels, and its picture.
struct Drawing {
    rast::RenderPlan plan;
    rast::Frame frame;
};
inline Drawing draw_knowing_texels(const prep::PreparedScene& scene, rast::RenderRequest request) {
    const auto planned = [&] {
        auto plan = rast::plan(scene, request);
        if (!plan) throw std::runtime_error(to_string(plan.error()));
        return *std::move(plan);
    };
    rast::SceneRenderer renderer(scene);
    Drawing out{planned(), {}};
    request.texel_facts = renderer.texel_facts(out.plan);
    if (request.texel_facts) out.plan = planned();
    if (auto done = renderer.render(out.plan, out.frame); !done)
        throw std::runtime_error(to_string(done.error()));
    return out;
}

// The same with nothing left out; of the buffers, those that are asked for.
inline rast::Frame draw_in_full(const prep::PreparedScene& scene, rast::RenderRequest request) {
    const rast::RenderRequest asked = request;
    request.prune = false;
    rast::Frame frame = draw(scene, request);
    if (!asked.keep_depth) frame.depth.clear();
    if (!asked.keep_ids) frame.triangle.clear();
    if (!asked.keep_ids) frame.instance.clear();
    if (!asked.keep_normals) frame.normal.clear();
    if (!asked.keep_uvs) frame.uv.clear();
    if (!asked.keep_barycentrics) frame.barycentric.clear();
    if (!asked.keep_positions) frame.position.clear();
    return frame;
}

// What differs between two frames of one size, by name; empty: nothing does, to the bit.
inline std::string differing(const rast::Frame& a, const rast::Frame& b) {
    std::string out;
    const auto compare = [&](const char* name, const auto& x, const auto& y) {
        if (x.size() != y.size())
            out += std::string(name) + " is not there in both; ";
        else if (!x.empty() && std::memcmp(x.data(), y.data(), x.size() * sizeof(x[0])) != 0)
            out += std::string(name) + " differs; ";
    };
    compare("color", a.color, b.color);
    compare("bytes", a.bytes, b.bytes);
    compare("depth", a.depth, b.depth);
    compare("triangle", a.triangle, b.triangle);
    compare("instance", a.instance, b.instance);
    compare("normal", a.normal, b.normal);
    compare("uv", a.uv, b.uv);
    compare("barycentric", a.barycentric, b.barycentric);
    compare("position", a.position, b.position);
    return out;
}

// FNV-1a over all that a frame holds.
inline std::uint64_t hash_of(const rast::Frame& f) {
    std::uint64_t h = 0xcbf29ce484222325ull;
    const auto add = [&](const auto& values) {
        const auto* bytes = reinterpret_cast<const unsigned char*>(values.data());
        for (std::size_t i = 0; i < values.size() * sizeof(values[0]); ++i)
            h = (h ^ bytes[i]) * 0x100000001b3ull;
        h = (h ^ 0xff) * 0x100000001b3ull;
    };
    add(f.color);
    add(f.bytes);
    add(f.depth);
    add(f.triangle);
    add(f.instance);
    add(f.normal);
    add(f.uv);
    add(f.barycentric);
    add(f.position);
    return h;
}

}  // namespace test
