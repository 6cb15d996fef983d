#include "baking/residual_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "base/finite.h"
#include "base/parallel.h"

namespace prep::detail {
namespace {

constexpr int side = 4;  // samples of a texel: 4 × 4, a bit each
constexpr std::uint8_t overlapping = 1, facing_away = 2;
constexpr std::int64_t rows_in_band = 32;  // of texels: a task

// Charts may cross the picture's border; UVs that repeat it many times are no charts. Both keep the
// work in proportion to the picture.
constexpr double most_tiles = 16;      // that all triangles cover together
constexpr double farthest_tile = 1e6;  // beyond, floats have no texels
constexpr double most_rows = 0x1p32;   // and columns, of samples, over all triangles

std::int64_t folded(std::int64_t i, std::int64_t size) {
    const std::int64_t r = i % size;
    return r < 0 ? r + size : r;
}

}  // namespace

// In units of samples: one lies at (i + ½, j + ½).
struct ResidualPicture::Triangle {
    std::uint32_t index = 0;  // of the written mesh
    std::array<glm::dvec2, 3> corners{};
    glm::dmat2 inverse{1.0};                    // to weights of the second and third corner
    std::int64_t first_row = 0, last_row = -1;  // of texels

    glm::dvec3 weights(const glm::dvec2& at) const {
        const glm::dvec2 w = inverse * (at - corners[0]);
        return {1 - w.x - w.y, w.x, w.y};
    }
    // Samples of row j, from first to last.
    std::pair<std::int64_t, std::int64_t> samples_of(std::int64_t j) const {
        const double y = double(j) + 0.5;
        double low = 1, high = 0;
        bool any = false;
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec2 &p = corners[k], &q = corners[(k + 1) % 3];
            if (std::min(p.y, q.y) > y || std::max(p.y, q.y) < y) continue;
            const double x = p.y == q.y ? p.x : p.x + (y - p.y) / (q.y - p.y) * (q.x - p.x);
            const double other = p.y == q.y ? q.x : x;
            low = any ? std::min({low, x, other}) : std::min(x, other);
            high = any ? std::max({high, x, other}) : std::max(x, other);
            any = true;
        }
        if (!any) return {0, -1};
        return {std::int64_t(std::ceil(low - 0.5)), std::int64_t(std::floor(high - 0.5))};
    }
};

struct ResidualPicture::Band {
    std::int64_t first = 0, last = 0;  // rows of texels: last is behind
    double degrees = 0, largest = 0;
    std::uint64_t samples = 0;
    // What a triangle has in a texel.
    struct Piece {
        std::size_t texel = 0;
        std::size_t first = 0;  // of `weights`
        std::size_t count = 0;
    };
    std::vector<Piece> pieces;
    std::vector<glm::dvec3> weights;  // of the triangle's corners, a sample each
    std::vector<RootPoint> points;
    std::vector<BaseFrame> frames;
};

ResidualPicture::ResidualPicture(std::uint32_t size)
    : size_(size),
      sums_(std::size_t(size) * size, glm::vec3(0.0f)),
      owned_(sums_.size(), 0),
      flags_(sums_.size(), 0) {}

std::optional<std::string> ResidualPicture::add(const BakedMesh& baked, std::uint32_t material,
                                                int threads) {
    const VertexMesh& mesh = baked.mesh;
    const std::vector<glm::vec2>& uvs = mesh.uvs[baked.uv_set];
    const double samples = double(size_) * side;
    std::vector<Triangle> triangles;
    double tiles = 0, rows = 0, columns = 0;
    for (const VertexMesh::Range& range : mesh.ranges) {
        if (range.material != material) continue;
        for (std::uint32_t k = 0; k < range.triangle_count; ++k) {
            Triangle t;
            t.index = range.first_triangle + k;
            bool usable = true;
            for (std::size_t c = 0; c < 3; ++c) {
                const glm::dvec2 uv(uvs[mesh.indices[3 * std::size_t(t.index) + c]]);
                usable = usable && std::abs(uv.x) < farthest_tile && std::abs(uv.y) < farthest_tile;
                t.corners[c] = uv * samples;
            }
            if (!usable) return "some are no numbers, or lie a million pictures away";
            const glm::dmat2 edges(t.corners[1] - t.corners[0], t.corners[2] - t.corners[0]);
            const double area = glm::determinant(edges);
            if (area == 0) continue;
            t.inverse = glm::inverse(edges);
            const auto [low, high] = std::minmax({t.corners[0].y, t.corners[1].y, t.corners[2].y});
            t.first_row = std::int64_t(std::floor(low / side));
            t.last_row = std::int64_t(std::floor(high / side));
            tiles += 0.5 * std::abs(area) / (samples * samples);
            rows += high - low + side;
            const auto [left, right] =
                std::minmax({t.corners[0].x, t.corners[1].x, t.corners[2].x});
            columns += right - left + side;
            triangles.push_back(t);
        }
    }
    if (tiles > most_tiles) return fmt::format("they repeat the picture {:.3g} times", tiles);
    if (rows > most_rows)
        return fmt::format("they are slivers: together {:.3g} times as high as the picture",
                           rows / samples);
    if (columns > most_rows)
        return fmt::format("they are slivers: together {:.3g} times as wide as the picture",
                           columns / samples);

    const std::int64_t size = size_, bands = (size + rows_in_band - 1) / rows_in_band;
    const auto over_bands = [&](const Triangle& t, const auto& body) {
        if (t.last_row - t.first_row + 1 >= size) {
            for (std::int64_t b = 0; b < bands; ++b) body(std::size_t(b));
            return;
        }
        const std::int64_t first = folded(t.first_row, size) / rows_in_band;
        const std::int64_t last = folded(t.last_row, size) / rows_in_band;
        const bool wraps = folded(t.first_row, size) > folded(t.last_row, size);
        for (std::int64_t b = 0; b < bands; ++b)
            if (wraps ? b >= first || b <= last : b >= first && b <= last) body(std::size_t(b));
    };
    std::vector<std::size_t> offsets(std::size_t(bands) + 1, 0);
    for (const Triangle& t : triangles) over_bands(t, [&](std::size_t b) { ++offsets[b + 1]; });
    std::partial_sum(offsets.begin(), offsets.end(), offsets.begin());
    std::vector<std::uint32_t> of_band(offsets.back());
    std::vector<std::size_t> next(offsets.begin(), offsets.end() - 1);
    for (std::uint32_t t = 0; t < triangles.size(); ++t)
        over_bands(triangles[t], [&](std::size_t b) { of_band[next[b]++] = t; });

    std::vector<Band> counts(static_cast<std::size_t>(bands));
    parallel_tasks(std::size_t(bands), threads, [&](std::size_t b) {
        Band band;
        band.first = std::int64_t(b) * rows_in_band;
        band.last = std::min(size, band.first + rows_in_band);
        for (std::size_t k = offsets[b]; k < offsets[b + 1]; ++k)
            if (const Triangle& t = triangles[of_band[k]]; claim(t, band)) bake(baked, t, band);
        counts[b].degrees = band.degrees;
        counts[b].largest = band.largest;
        counts[b].samples = band.samples;
    });
    for (const Band& band : counts) {
        degrees_ += band.degrees;
        largest_degrees_ = std::max(largest_degrees_, band.largest);
        samples_ += band.samples;
    }
    return std::nullopt;
}

bool ResidualPicture::claim(const Triangle& t, Band& band) {
    constexpr double inside = 1e-6;  // of a weight: beyond the roundings of a shared edge
    const std::int64_t size = size_;
    band.pieces.clear();
    band.weights.clear();
    // Tile by tile, the rows of this band.
    const auto tile_of = [&](std::int64_t row) { return (row - folded(row, size)) / size; };
    for (std::int64_t tile = tile_of(t.first_row); tile <= tile_of(t.last_row); ++tile) {
        const std::int64_t from = std::max(t.first_row, tile * size + band.first);
        const std::int64_t to = std::min(t.last_row, tile * size + band.last - 1);
        for (std::int64_t row = from; row <= to; ++row) {
            std::array<std::pair<std::int64_t, std::int64_t>, side> spans;
            std::int64_t first = std::numeric_limits<std::int64_t>::max();
            std::int64_t last = std::numeric_limits<std::int64_t>::min();
            for (int s = 0; s < side; ++s) {
                auto& span = spans[std::size_t(s)];
                span = t.samples_of(row * side + s);
                if (span.first > span.second) continue;
                first = std::min(first, span.first);
                last = std::max(last, span.second);
            }
            if (first > last) continue;
            for (std::int64_t x = (first - folded(first, side)) / side; x * side <= last; ++x) {
                const std::size_t texel = std::size_t(folded(row, size) * size + folded(x, size));
                Band::Piece piece{texel, band.weights.size(), 0};
                for (int s = 0; s < side; ++s)
                    for (int c = 0; c < side; ++c) {
                        const std::int64_t i = x * side + c;
                        const auto& span = spans[std::size_t(s)];
                        if (i < span.first || i > span.second) continue;
                        const glm::dvec3 w =
                            t.weights({double(i) + 0.5, double(row * side + s) + 0.5});
                        const auto bit = std::uint16_t(1u << (s * side + c));
                        if (owned_[texel] & bit) {
                            if (std::min({w.x, w.y, w.z}) > inside) flags_[texel] |= overlapping;
                            continue;
                        }
                        owned_[texel] |= bit;
                        const glm::dvec3 kept = glm::max(w, glm::dvec3(0.0));
                        band.weights.push_back(kept / (kept.x + kept.y + kept.z));
                        ++piece.count;
                    }
                if (piece.count > 0) band.pieces.push_back(piece);
            }
        }
    }
    return !band.pieces.empty();
}

// The base is smooth, heights are not: one frame a texel, heights at each sample.
void ResidualPicture::bake(const BakedMesh& baked, const Triangle& t, Band& band) {
    const VertexMesh& mesh = baked.mesh;
    const TrianglePlace& place = baked.places[mesh.triangle_faces[t.index]];
    const TrianglePoints points(baked.surface.heights().domain(), place.root, place.path);
    std::vector<glm::dvec3> means;
    band.points.clear();
    for (const Band::Piece& piece : band.pieces) {
        glm::dvec3 mean(0.0);
        for (std::size_t k = 0; k < piece.count; ++k) mean += band.weights[piece.first + k];
        means.push_back(mean / double(piece.count));
        band.points.push_back(points.at(means.back()));
    }
    band.frames.resize(band.points.size());
    baked.surface.base().frames(band.points, band.frames);
    std::array<glm::dvec3, 3> normals, tangents;
    double sign = 1;
    for (std::size_t c = 0; c < 3; ++c) {
        const std::uint32_t v = mesh.indices[3 * std::size_t(t.index) + c];
        normals[c] = glm::dvec3(mesh.normals[v]);
        tangents[c] = glm::dvec3(glm::vec3(mesh.tangents[v]));
        sign = double(mesh.tangents[v].w);
    }
    for (std::size_t p = 0; p < band.pieces.size(); ++p) {
        const Band::Piece& piece = band.pieces[p];
        glm::dvec3 truth(0.0);
        for (std::size_t k = 0; k < piece.count; ++k) {
            const RootPoint at = points.at(band.weights[piece.first + k]);
            BaseFrame frame = band.frames[p];
            if (at.root == band.points[p].root) {
                const glm::dvec3 step = at.weights - band.points[p].weights;
                frame.point.position +=
                    step.y * frame.position_steps[0] + step.z * frame.position_steps[1];
            } else {
                baked.surface.base().frames({&at, 1}, {&frame, 1});
            }
            truth += baked.surface.normal(frame, at);
        }
        const glm::dvec3& w = means[p];
        const glm::dvec3 n = w.x * normals[0] + w.y * normals[1] + w.z * normals[2];
        const glm::dvec3 along = w.x * tangents[0] + w.y * tangents[1] + w.z * tangents[2];
        const glm::dmat3 axes(along, sign * glm::cross(n, along), n);
        glm::dvec3 made(0, 0, 1);
        if (glm::length(truth) > 0 && std::abs(glm::determinant(axes)) > 1e-12) {
            const glm::dvec3 in_frame = glm::normalize(glm::inverse(axes) * glm::normalize(truth));
            if (is_finite(in_frame)) made = in_frame;
        }
        if (made.z < 0) {
            flags_[piece.texel] |= facing_away;
            const double across = std::hypot(made.x, made.y);
            made =
                across > 0 ? glm::dvec3(made.x / across, made.y / across, 0) : glm::dvec3(0, 0, 1);
        }
        const double length = glm::length(n) * glm::length(truth);
        if (length > 0) {
            const double degrees =
                std::atan2(glm::length(glm::cross(n, truth)), glm::dot(n, truth)) * 180 /
                std::numbers::pi;
            band.degrees += double(piece.count) * degrees;
            band.largest = std::max(band.largest, degrees);
        }
        band.samples += piece.count;
        sums_[piece.texel] += glm::vec3(double(piece.count) * made);
    }
}

void ResidualPicture::count(ResidualMap& report) const {
    for (std::size_t i = 0; i < sums_.size(); ++i) {
        report.texels += owned_[i] != 0;
        report.overlapping += (flags_[i] & overlapping) != 0;
        report.facing_away += (flags_[i] & facing_away) != 0;
    }
    report.mean_degrees = samples_ > 0 ? degrees_ / double(samples_) : 0;
    report.largest_degrees = largest_degrees_;
}

// Rings around what is covered, each texel the mean of its neighbours in those before; the picture
// repeats.
Image ResidualPicture::image() && {
    const std::int64_t size = size_;
    std::vector<glm::vec3> values = std::move(sums_);
    enum : std::uint8_t { unknown, listed, known };
    std::vector<std::uint8_t> state = std::move(flags_);
    std::fill(state.begin(), state.end(), unknown);
    const auto unit = [](const glm::vec3& sum) {
        const float length = glm::length(sum);
        return length > 0 ? sum / length : glm::vec3(0, 0, 1);
    };
    for (std::size_t i = 0; i < values.size(); ++i) {
        values[i] = owned_[i] != 0 ? unit(values[i]) : glm::vec3(0, 0, 1);
        if (owned_[i] != 0) state[i] = known;
    }
    owned_ = {};
    const auto over_neighbours = [&](std::size_t i, const auto& body) {
        const auto y = std::int64_t(i) / size, x = std::int64_t(i) % size;
        for (std::int64_t dy = -1; dy <= 1; ++dy)
            for (std::int64_t dx = -1; dx <= 1; ++dx)
                body(std::size_t(folded(y + dy, size) * size + folded(x + dx, size)));
    };
    std::vector<std::size_t> ring, following;
    const auto list_around = [&](std::size_t i) {
        over_neighbours(i, [&](std::size_t j) {
            if (state[j] != unknown) return;
            state[j] = listed;
            following.push_back(j);
        });
    };
    for (std::size_t i = 0; i < values.size(); ++i)
        if (state[i] == known) list_around(i);
    while (!following.empty()) {
        ring.swap(following);
        following.clear();
        for (const std::size_t i : ring) {
            glm::vec3 sum(0.0f);
            over_neighbours(i, [&](std::size_t j) {
                if (state[j] == known) sum += values[j];
            });
            values[i] = unit(sum);
        }
        for (const std::size_t i : ring) state[i] = known;
        for (const std::size_t i : ring) list_around(i);
    }
    Image out{.width = size_, .height = size_, .channels = 3, .pixels = {}};
    out.pixels.reserve(3 * values.size());
    for (const glm::vec3& n : values)
        for (int k = 0; k < 3; ++k) out.pixels.push_back(0.5f + 0.5f * n[k]);
    return out;
}

}  // namespace prep::detail
