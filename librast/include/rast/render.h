// Drawing a prepared scene: a plan first (what will be done and why), then the picture.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "prep/calls/calls_for.h"
#include "prep/calls/reason.h"
#include "prep/enum_names.h"
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

// What a plan would know of a texture's texels.
struct TexelQuestions {
    bool constant = false;      // are all alike, their blue 1?
    bool not_negative = false;  // are red, green and blue at least 0?
    bool alpha = false;         // is every alpha at least
    float least_alpha = 0;      // this?
    explicit operator bool() const { return constant || not_negative || alpha; }
    friend bool operator==(const TexelQuestions&, const TexelQuestions&) = default;
};

// What the texels of a texture are like: gathered when it has been read, until each question is
// answered with no. They hold for the decoding and the levels of the plan that asked: plans of
// another filter, or of other materials, gather their own.
struct TexelFacts {
    bool known = false;  // and all are finite
    // Bounds of every texel, decoded, and of what lies beyond a border: tight unless each question
    // is answered with no. `constant`: of every level alike.
    glm::vec4 low{0.0f}, high{0.0f};
    bool constant = false;
};

namespace detail {
struct FramePass;
struct StageWatch;
}  // namespace detail

// What is asked for. Unset choices are made by plan().
struct RenderRequest : prep::RenderChoices {
    std::optional<View> view;  // unset: the scene's camera, else the whole scene
    std::optional<std::vector<LightInstance>> lights;  // unset: the scene's, else three lights
    bool textures = true;                              // false: material colours only
    bool keep_color = true;  // false: nothing is shaded, for those who want other buffers alone
    // With coverage `area`: of the colours alpha alone is meant, how much of each pixel is covered.
    // Nothing is shaded, nor found what is in front, whatever the plan's steps would do.
    bool alpha_alone = false;
    bool keep_depth = false;  // Frame::depth
    bool keep_ids = false;    // Frame::triangle and Frame::instance
    bool keep_normals = false, keep_uvs = false, keep_barycentrics = false, keep_positions = false;
    // Whether what nothing reads is left out. Off, every map that a material could have is sampled
    // (a neutral one where it has none), all buffers are kept, all levels of detail made: the same
    // picture, for tests and for measuring what leaving out is worth.
    bool prune = true;
    // Whether what each part of drawing takes is measured: Frame::part_ms. The picture does not
    // depend on it; clocks take some of its time.
    bool timed = false;
    // By RenderPlan::texel_questions; SceneRenderer::texel_facts() gathers them. Null: nothing is
    // known, and nothing is left out for what texels are like.
    std::shared_ptr<const std::vector<TexelFacts>> texel_facts;
    std::optional<Crop> crop;  // unset: the whole picture
    // Before and after the main one: detail::add_pass().
    std::vector<std::shared_ptr<const detail::FramePass>> passes = {};
    PixelFormat pixels = PixelFormat::floats;
    // Of a band's pixels in render_bands(). Lists of triangles by tile take as much at most, beside
    // up to 28 bytes a triangle (small ones take 3), unless one row of tiles takes more: then they
    // are made for groups of rows, one after the other.
    std::uint64_t band_bytes = std::uint64_t(1) << 26;
    int threads = 0;             // 0: all cores; the picture does not depend on it
    bool hierarchical_z = true;  // skip what is hidden by blocks of pixels; nor on this
    prep::SimdLevel simd = prep::SimdLevel::automatic;  // nor on this
};

// What a plan can have, by the name that is printed, in the order in which it is told.
enum class PlanStepKind : std::uint8_t {
    camera,
    lights,
    normal_maps,
    vertex_lighting,
    vertex_normals,
    highlights,
    textures,
    srgb_decoding,
    texture_filter,
    mip_levels,
    ripmap_levels,
    shading,
    multisampling,
    exact_areas,
    supersampling,
    depth_test,
    culling,
    alpha_blending,
    alpha_mask,
    depth_output,
    triangle_numbers_output,
    normal_output,
    uv_output,
    barycentric_output,
    position_output,
    crop,
    bands
};
constexpr auto names_of(PlanStepKind) {
    return std::to_array<prep::EnumName<PlanStepKind>>(
        {{"camera", PlanStepKind::camera},
         {"lights", PlanStepKind::lights},
         {"normal maps", PlanStepKind::normal_maps},
         {"vertex lighting", PlanStepKind::vertex_lighting},
         {"vertex normals", PlanStepKind::vertex_normals},
         {"highlights", PlanStepKind::highlights},
         {"textures", PlanStepKind::textures},
         {"sRGB decoding", PlanStepKind::srgb_decoding},
         {"texture filter", PlanStepKind::texture_filter},
         {"mip levels", PlanStepKind::mip_levels},
         {"ripmap levels", PlanStepKind::ripmap_levels},
         {"shading", PlanStepKind::shading},
         {"multisampling", PlanStepKind::multisampling},
         {"exact areas", PlanStepKind::exact_areas},
         {"supersampling", PlanStepKind::supersampling},
         {"depth test", PlanStepKind::depth_test},
         {"culling", PlanStepKind::culling},
         {"alpha blending", PlanStepKind::alpha_blending},
         {"alpha mask", PlanStepKind::alpha_mask},
         {"depth output", PlanStepKind::depth_output},
         {"triangle numbers output", PlanStepKind::triangle_numbers_output},
         {"normal output", PlanStepKind::normal_output},
         {"UV output", PlanStepKind::uv_output},
         {"barycentric output", PlanStepKind::barycentric_output},
         {"position output", PlanStepKind::position_output},
         {"crop", PlanStepKind::crop},
         {"bands", PlanStepKind::bands}});
}

struct PlanStep {
    PlanStepKind kind = PlanStepKind::camera;
    bool run = false;
    std::string reason;  // tied to scene data
    prep::ReasonLabel label = prep::ReasonLabel::run;
    // As data: its own first, then by light, material and map.
    std::vector<prep::Reason> reasons = {};
};

// What is left out though it is asked for: it is proved to change no bit of the picture, or, of
// lights, to add no more than RenderChoices::allow_error.
struct PlanSkips {
    struct OfMaterial {
        bool highlights = false, mask = false;
        std::uint32_t maps = 0;  // bit k: MapKind k
    };
    std::vector<bool> lights;           // by RenderPlan::lights; empty: none is left out
    std::vector<OfMaterial> materials;  // by Scene::materials; empty: as well
    bool inside_samples = false;        // tiles inside one triangle take one sample a pixel
    OfMaterial of(std::uint32_t material) const {
        return material < materials.size() ? materials[material] : OfMaterial{};
    }
    bool light(std::size_t index) const { return index < lights.size() && lights[index]; }
};

// Draws that are shaded by the same steps.
struct PlanVariant {
    std::string name;             // "tangent-space normal map, diffuse map, masked"
    std::uint64_t triangles = 0;  // instanced
    // What its points take, beside their surface.
    std::uint32_t maps = 0;  // read
    bool lit = false, highlights = false, bends_normals = false, masked = false;
};

struct RenderPlan {         // a value; made by plan(), obeyed by render()
    RenderRequest request;  // with every choice made
    View view;
    std::vector<LightInstance> lights;
    PlanSkips skips;
    std::vector<PlanStep> steps;
    std::vector<PlanVariant> variants;  // by falling number of triangles
    // Before and after the main one: the request's, then those of effects (none has been made yet);
    // and how many pixels beyond a crop or a band are drawn for what those after it look at.
    std::vector<std::shared_ptr<const detail::FramePass>> passes = {};
    std::uint32_t halo = 0;
    detail::StageWatch* watch = nullptr;  // looks at each stage of shading, for tests
    // Of Scene::textures: which are read as colours, which as data, which as heights of bump maps,
    // one list after the other. Colours are decoded from sRGB, where files encode them so.
    std::vector<bool> textures_read;
    // As colours, then as data: texel_facts() might leave something out by them.
    std::vector<TexelQuestions> texel_questions;
    std::uint64_t triangles = 0, vertices = 0;  // instanced
    std::uint32_t band_rows = 0;                // of what render_bands() draws at a time
    // Bytes, of the whole picture at once, without textures; planes of passes among them.
    std::uint64_t memory_estimate = 0;
    std::uint64_t band_memory_estimate = 0;  // the same for render_bands()
    std::vector<std::string> warnings;
};

// Pure. Errors: invalid (no extent; a crop that is empty or leaves the picture; a sample count,
// an anisotropy or a supersampling that is not offered; samples beside exact areas; a view that
// makes no picture: see View), limit (larger than max_picture_extent, times the supersampling; 2^31
// triangles and more over all instances; over 2^29 vertices of a mesh, 178,956,970 with light at
// vertices, or 715,827,882 triangles).
prep::Result<RenderPlan> plan(const prep::PreparedScene& scene, const RenderRequest& request = {});

// What the plan's consumer reads of the meshes' vertices, by PreparedScene::meshes: the table of
// prep::calls_for(), and so never more than prep::requirements() provides for the same consumer.
prep::Consumer consumer_of(const RenderPlan& plan);
std::vector<prep::AttributeReads> reads_of(const prep::PreparedScene& scene,
                                           const RenderPlan& plan);

// Stages of shading, in the order in which points go through them; names for what counts them.
inline constexpr std::array<std::string_view, 9> shade_stage_names = {
    "interpolation", "maps",       "normals", "eye", "light", "light without highlights",
    "exponents",     "highlights", "color"};
inline constexpr std::size_t shade_stages = shade_stage_names.size();

// Parts of drawing that have a time of their own: the stages of shading first, by their number.
enum class DrawingPart : std::uint8_t {
    normal_mapping = shade_stages,  // normals of draws that have a map of them
    buffers,                        // what is kept beside colours
    textures,                       // read and decoded
    levels,                         // texels as they are sampled, and levels of detail
    vertices,                       // transformed
    vertex_light,                   // Gouraud
    culling,                        // and lists of triangles by tile
    clearing,                       // memory for the picture, tiles
    visibility,                     // depth test, alpha mask
    sorting,                        // of points by triangle, one sample a pixel
    resolving,                      // several samples: points found, sorted and summed
    areas,                          // exact ones, their points shaded
    reducing,                       // of a finer picture
    passes,                         // before and after the main one
    count
};
inline constexpr std::size_t drawing_parts = std::size_t(DrawingPart::count);
// "light", "visibility", …; empty: there is no such part.
std::string_view name_of(DrawingPart part);

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
    // Stages at shaded points: lights, highlights of lights, normals bent by a map.
    std::uint64_t light_points = 0, highlight_points = 0, normal_map_points = 0;
    // All stages of shading: points that went through each, as often as they did.
    std::array<std::uint64_t, shade_stages> stage_points{};
    std::uint64_t masked_triangles = 0;  // in tiles, for each of their samples
    std::uint64_t sample_points = 0;     // pixels of tiles that are not empty, times their samples
    std::uint64_t textures_read = 0;     // files and embedded pictures decoded
    std::uint64_t texture_levels = 0;    // made of them, first levels included
    std::uint64_t buffer_bytes = 0;      // of the frame's buffers
    std::uint64_t list_bytes = 0;        // of the lists of triangles by tile, at most at a time
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
    double geometry_ms = 0, raster_ms = 0;  // by the clock on the wall; raster includes shading
    // By DrawingPart, with RenderRequest::timed: milliseconds of all threads, summed. A thread that
    // waits for the processor counts as well. Textures and levels: those of the plan, by the clock
    // on the wall, whichever picture had them made. What is in no part: setting up, waiting.
    std::array<double, drawing_parts> part_ms{};
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
    // Reads the textures of plan.texel_questions. They are kept: drawing does not read them again.
    // For RenderRequest::texel_facts; null where there are none to be read.
    std::shared_ptr<const std::vector<TexelFacts>> texel_facts(const RenderPlan& plan);

  private:
    std::unique_ptr<detail::Painter> painter_;
};

// sRGB-encoded picture, three channels, by the exposure and the tone map of `choices`; colours
// above 1 are clipped. A tone map reads the background that the frame was drawn with, exposed
// (expose()), and alpha as the share of surfaces in a pixel. `threads` 0: all cores; the picture
// does not depend on it.
prep::Image to_srgb(const Frame& frame, const prep::RenderChoices& choices = {}, int threads = 0);

}  // namespace rast
