// Drawing a prepared scene: a plan first (what will be done and why), then the picture.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "prep/image.h"
#include "prep/prepared_scene.h"
#include "prep/render_choices.h"
#include "prep/result.h"
#include "prep/simd.h"
#include "rast/view.h"

namespace rast {

using prep::Coverage;
using prep::Cull;
using prep::DepthFormat;
using prep::max_picture_extent;
using prep::max_supersample;
using prep::Shading;
using prep::TextureFilter;
using prep::ToneMap;

// What a picture's colours are kept as, linear in both: floats (Frame::color), or bytes of red,
// green, blue and coverage (Frame::bytes), a fourth of the memory; colours above 1 are clipped.
enum class PixelFormat : std::uint8_t { floats, bytes };

// A part of the picture, in pixels. Its pixels are those of the whole picture, bit for bit.
struct Crop {
    std::uint32_t x = 0, y = 0, width = 0, height = 0;
};

// What is asked for. Unset choices are made by plan().
struct RenderRequest : prep::RenderChoices {
    std::optional<View> view;  // unset: the scene's camera, else the whole scene
    std::optional<std::vector<LightInstance>> lights;  // unset: the scene's, else three lights
    bool textures = true;                              // false: material colours only
    bool keep_color = true;   // false: nothing is shaded, for those who want other buffers alone
    bool keep_depth = false;  // Frame::depth
    bool keep_ids = false;    // Frame::triangle and Frame::instance
    bool keep_normals = false, keep_uvs = false, keep_barycentrics = false, keep_positions = false;
    // Whether what nothing reads is left out. Off, every map that a material could have is sampled
    // (a neutral one where it has none), all buffers are kept, all levels of detail made: the same
    // picture, for tests and for measuring what leaving out is worth.
    bool prune = true;
    std::optional<Crop> crop;  // unset: the whole picture
    PixelFormat pixels = PixelFormat::floats;
    // Of a band's pixels in render_bands(). Lists of triangles by tile take as much at most, beside
    // up to 28 bytes a triangle (small ones take 3), unless one row of tiles takes more: then they
    // are made for groups of rows, one after the other.
    std::uint64_t band_bytes = std::uint64_t(1) << 26;
    int threads = 0;             // 0: all cores; the picture does not depend on it
    bool hierarchical_z = true;  // skip what is hidden by blocks of pixels; nor on this
    prep::SimdLevel simd = prep::SimdLevel::automatic;  // nor on this
};

struct PlanStep {
    std::string name;  // "vertex lighting", "normal maps", "mip levels", …
    bool run = false;
    std::string reason;  // tied to scene data
};

// Draws that are shaded by the same steps.
struct PlanVariant {
    std::string name;             // "tangent-space normal map, diffuse map, masked"
    std::uint64_t triangles = 0;  // instanced
};

struct RenderPlan {         // a value; made by plan(), obeyed by render()
    RenderRequest request;  // with every choice made
    View view;
    std::vector<LightInstance> lights;
    std::vector<PlanStep> steps;
    std::vector<PlanVariant> variants;  // by falling number of triangles
    std::vector<bool> textures_used;    // per Scene::textures entry
    std::vector<bool> colour_textures;  // of those: decoded from sRGB
    std::uint64_t triangles = 0;        // instanced
    std::uint32_t band_rows = 0;        // of what render_bands() draws at a time
    std::uint64_t memory_estimate = 0;  // bytes, of the whole picture at once, without textures
    std::uint64_t band_memory_estimate = 0;  // the same for render_bands()
    std::vector<std::string> warnings;
};

// Pure. Errors: invalid (no extent; a crop that is empty or leaves the picture; a sample count,
// an anisotropy or a supersampling that is not offered; samples beside exact areas), limit (larger
// than max_picture_extent, times the supersampling).
prep::Result<RenderPlan> plan(const prep::PreparedScene& scene, const RenderRequest& request = {});

struct Counters {
    std::uint64_t triangles = 0;        // submitted
    std::uint64_t non_finite = 0;       // left out: a vertex is NaN or infinite
    std::uint64_t degenerate = 0;       // no area on screen
    std::uint64_t facing_away = 0;      // culled
    std::uint64_t outside = 0;          // off the picture or behind the near plane
    std::uint64_t between_samples = 0;  // cover no pixel centre
    std::uint64_t crossing = 0;         // drawn through homogeneous edges (near plane, guard band)
    std::uint64_t vertices_lit = 0;     // Gouraud
    std::uint64_t pixels_shaded = 0;
    std::uint64_t texture_samples = 0;  // maps read at shaded points
    std::uint64_t textures_read = 0;    // files and embedded pictures decoded
    std::uint64_t texture_levels = 0;   // made of them, first levels included
    std::uint64_t buffer_bytes = 0;     // of the frame's buffers
    std::uint64_t list_bytes = 0;       // of the lists of triangles by tile, at most at a time
};

struct Frame {
    std::uint32_t width = 0, height = 0;  // of the crop, where there is one
    std::vector<glm::vec4> color;         // linear; alpha is 1 where something was drawn
    std::vector<std::uint32_t> bytes;     // the same in bytes, red lowest; see PixelFormat
    std::vector<float> depth;             // reversed z: 1 near, 0 far or empty; when asked for
    std::vector<std::uint32_t> triangle;  // within the instance's mesh; no_index where empty
    std::vector<std::uint32_t> instance;  // node; no_index where empty
    // At the centres of the pixels whose first sample is covered, zero elsewhere; when asked for.
    std::vector<glm::vec3> normal;       // as it is lit: world axes, unit, on the side that is seen
    std::vector<glm::vec2> uv;           // of the first set; zero where the mesh has none
    std::vector<glm::vec3> barycentric;  // of the triangle's corners, perspective-correct
    std::vector<glm::vec3> position;     // from View::eye(), in world axes
    Counters counters;
    double geometry_ms = 0, raster_ms = 0;  // raster includes shading
    std::vector<std::string> warnings;
};

// Errors: none but those of plan(), which made the argument; textures that cannot be read become
// warnings and the material's plain colour is used.
prep::Result<Frame> render(const prep::PreparedScene& scene, const RenderPlan& plan);

// The picture of render(), bit for bit, in bands of plan.band_rows rows from top to bottom, so that
// large ones need never be held: take(band, first row) gets each once. An error of `take` ends it
// and is returned. The frame that comes back has no pixels; its counters are the sums over the
// bands (a triangle counts once, in bands of fewer than 64 rows once in each).
using BandSink = std::function<prep::Result<void>(const Frame& band, std::uint32_t first_row)>;
prep::Result<Frame> render_bands(const prep::PreparedScene& scene, const RenderPlan& plan,
                                 const BandSink& take);

// Draws one scene again and again: what its pictures share (textures and their levels, buffers) is
// kept between them. The scene must stay as it is meanwhile. One thread at a time may call it.
namespace detail {
class Painter;
}
class SceneRenderer {
  public:
    explicit SceneRenderer(const prep::PreparedScene& scene);
    SceneRenderer(SceneRenderer&&) noexcept;
    SceneRenderer& operator=(SceneRenderer&&) noexcept;
    ~SceneRenderer();
    // As render(), into a frame whose memory is used again.
    prep::Result<void> render(const RenderPlan& plan, Frame& frame);
    prep::Result<Frame> render_bands(const RenderPlan& plan, const BandSink& take);

  private:
    std::unique_ptr<detail::Painter> painter_;
};

// sRGB-encoded picture, three channels, by the exposure and the tone map of `choices`; colours
// above 1 are clipped. `threads` 0: all cores; the picture does not depend on it.
prep::Image to_srgb(const Frame& frame, const prep::RenderChoices& choices = {}, int threads = 0);

}  // namespace rast
