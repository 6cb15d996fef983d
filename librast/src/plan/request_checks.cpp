#include "plan/request_checks.h"

#include <charconv>
#include <cmath>
#include <string>

#include "geometry/tile.h"

namespace rast::detail {
namespace {

using prep::Error;
using prep::ErrorCode;

Error too_many(const char* of_what, std::uint64_t most, std::uint64_t found) {
    return {ErrorCode::limit,
            std::string(of_what) + ": at most " + std::to_string(most) + " are drawn, found " +
                std::to_string(found),
            ""};
}

std::string text_of(double value) {
    char text[32];
    constexpr int digits = 6;
    const auto end =
        std::to_chars(text, text + sizeof text, value, std::chars_format::general, digits);
    return {text, end.ptr};
}

// Rotation and translation, as closely as matrices of floats have them.
bool is_rigid(const glm::dmat4& m) {
    constexpr double rounding = 1e-4;
    const glm::dmat3 turn(m), product = glm::transpose(turn) * turn;
    for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r)
            if (!(std::abs(product[c][r] - (c == r ? 1 : 0)) < rounding)) return false;
    for (int k = 0; k < 3; ++k)
        if (!(std::abs(m[k][3]) < rounding) || !std::isfinite(m[3][k])) return false;
    return std::abs(m[3][3] - 1) < rounding && glm::determinant(turn) > 0;
}

}  // namespace

std::optional<Error> fault_of_request(const RenderRequest& request) {
    if (request.width == 0 || request.height == 0)
        return Error{ErrorCode::invalid, "the picture has no extent", ""};
    if (request.width > max_picture_extent || request.height > max_picture_extent)
        return Error{ErrorCode::limit,
                     "the picture is larger than " + std::to_string(max_picture_extent) +
                         " pixels a side, found " + std::to_string(request.width) + "x" +
                         std::to_string(request.height),
                     ""};
    if (request.crop) {
        const Crop& c = *request.crop;
        if (c.width == 0 || c.height == 0 || c.x > request.width || c.y > request.height ||
            c.width > request.width - c.x || c.height > request.height - c.y)
            return Error{ErrorCode::invalid,
                         "the crop must be a part of the picture of " +
                             std::to_string(request.width) + "x" + std::to_string(request.height) +
                             ", found " + std::to_string(c.width) + "x" + std::to_string(c.height) +
                             " at " + std::to_string(c.x) + ", " + std::to_string(c.y),
                         ""};
    }
    if (request.max_anisotropy < 1 || request.max_anisotropy > 16)
        return Error{ErrorCode::invalid,
                     "anisotropy is 1 to 16, found " + std::to_string(request.max_anisotropy), ""};
    const int samples = request.samples;
    if (samples != 1 && samples != 2 && samples != 4 && samples != 8 && samples != 16)
        return Error{ErrorCode::invalid,
                     "a pixel has 1, 2, 4, 8 or 16 samples, found " + std::to_string(samples), ""};
    if (!(request.allow_error >= 0) || !std::isfinite(request.allow_error))
        return Error{ErrorCode::invalid,
                     "what lights that are left out may add is finite and not negative, found " +
                         std::to_string(request.allow_error),
                     ""};
    if (request.supersample < 1 || request.supersample > max_supersample)
        return Error{ErrorCode::invalid,
                     "supersampling is 1 to " + std::to_string(max_supersample) +
                         " pixels each way, found " + std::to_string(request.supersample),
                     ""};
    if (request.coverage == Coverage::area && samples != 1)
        return Error{ErrorCode::invalid,
                     "exact areas take the place of samples: ask for 1 sample a pixel, found " +
                         std::to_string(samples),
                     ""};
    if (request.alpha_alone && (request.coverage != Coverage::area || !request.keep_color))
        return Error{ErrorCode::invalid, "alpha alone is of colours that are kept, by exact areas",
                     ""};
    const std::uint32_t most = max_picture_extent / std::uint32_t(request.supersample);
    if (request.width > most || request.height > most)
        return Error{ErrorCode::limit,
                     "supersampled " + std::to_string(request.supersample) +
                         " times, a picture is at most " + std::to_string(most) +
                         " pixels a side, found " + std::to_string(request.width) + "x" +
                         std::to_string(request.height),
                     ""};
    return std::nullopt;
}

std::optional<Error> fault_of_size(const DrawnContents& drawn, Shading shading) {
    // Triangles of all instances are numbered below the bit of back faces; the last number is that
    // of no triangle.
    constexpr std::uint64_t most_numbers = id_none & ~id_back_face;
    if (drawn.triangles > most_numbers)
        return too_many("triangles of all instances", most_numbers, drawn.triangles);
    // Corners, and what vertices have, are gathered by signed numbers of 32 bits: up to four floats
    // of each, 12 of light at vertices.
    constexpr std::uint64_t most_gathered = std::uint64_t(1) << 31;
    if (drawn.most_triangles > most_gathered / 3)
        return too_many("triangles of a mesh", most_gathered / 3, drawn.most_triangles);
    const bool at_vertices = shading == Shading::gouraud;
    const std::uint64_t most_vertices = most_gathered / (at_vertices ? 12 : 4);
    if (drawn.most_vertices > most_vertices)
        return too_many(at_vertices ? "lit vertices of a mesh" : "vertices of a mesh",
                        most_vertices, drawn.most_vertices);
    return std::nullopt;
}

std::optional<Error> fault_of_view(const View& view) {
    const auto invalid = [](std::string text) { return Error{ErrorCode::invalid, text, ""}; };
    if (!is_rigid(view.world_to_view))
        return invalid("a view turns and moves the world, and neither stretches nor mirrors it");
    if (!(view.aspect >= 0) || !std::isfinite(view.aspect))
        return invalid("a view's aspect is not below 0, found " + text_of(view.aspect));
    if (view.perspective && !(view.yfov > 0 && view.yfov < 3.14159265358979323846))
        return invalid("a field of view is between 0 and pi, found " + text_of(view.yfov));
    if (!view.perspective && !(view.half_height > 0 && std::isfinite(view.half_height)))
        return invalid("half the height of what a view sees is above 0, found " +
                       text_of(view.half_height));
    if (!std::isfinite(view.znear) || (view.perspective && !(view.znear > 0)))
        return invalid("the near plane lies before the eye, found a distance of " +
                       text_of(view.znear));
    const bool endless = view.zfar == 0 || view.zfar == HUGE_VAL;
    if (!endless && !(view.zfar > view.znear))
        return invalid("the far plane lies beyond the near one, found " + text_of(view.zfar) +
                       " and " + text_of(view.znear));
    return std::nullopt;
}

}  // namespace rast::detail
