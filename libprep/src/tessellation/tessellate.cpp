// Checks, surface, refinement, certificate, mesh.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/finite.h"
#include "base/outward.h"
#include "base/parallel.h"
#include "tessellation/height_functions.h"
#include "tessellation/limit/limit_base.h"
#include "tessellation/polygon_surface.h"
#include "tessellation/tessellation.h"

namespace prep::detail {
namespace {

std::string place_of(const Mesh& mesh) {
    return mesh.name.empty() ? std::string() : fmt::format("mesh '{}'", mesh.name);
}

// Of numbers whose products are numbers.
bool is_view(const ScreenMetric& screen) {
    constexpr double most = 1e60;
    double largest = std::max({screen.near_distance, 1 / screen.near_distance,
                               std::abs(screen.pixels.x), std::abs(screen.pixels.y)});
    for (const glm::dvec4& row : {screen.x, screen.y, screen.w}) {
        if (!is_finite(row)) return false;
        largest = std::max(largest, glm::length(row));
    }
    return screen.near_distance > 0 && is_finite(screen.pixels) && largest < most;
}

Result<void> check_options(const Mesh& cage, const TessellateOptions& options) {
    const auto wrong = [&](const std::string& text) {
        return Error{ErrorCode::invalid, text, place_of(cage)};
    };
    if (!options.chord_error && !options.pixel_error && !options.edge_length &&
        !options.max_triangles)
        return wrong(
            "nothing says how fine the triangles shall be: ask for a chord error, a pixel "
            "error, an edge length or a number of triangles");
    const std::pair<const char*, const std::optional<double>*> lengths[] = {
        {"chord error", &options.chord_error},
        {"pixel error", &options.pixel_error},
        {"edge length", &options.edge_length}};
    for (const auto& [name, length] : lengths)
        if (*length && !(**length > 0 && std::isfinite(**length)))
            return wrong(
                fmt::format("the {} is {}; a positive number is expected", name, **length));
    if (options.max_triangles && *options.max_triangles == 0)
        return wrong("the number of triangles is 0; a positive number is expected");
    if (options.pixel_error && options.screens.empty())
        return wrong("a pixel error needs a view that it is seen in");
    for (const ScreenMetric& s : options.screens)
        if (options.pixel_error && !is_view(s))
            return wrong(
                "a pixel error needs a view of finite numbers with a near distance above 0");
    for (const Displacement& d : options.displacements)
        if (!std::isfinite(d.scale) || !std::isfinite(d.midlevel))
            return wrong("a displacement's scale or mid-level is not a finite number");
    for (const std::uint32_t d : options.material_displacements)
        if (d != no_index && d >= options.displacements.size())
            return wrong(fmt::format("a material names displacement {}; there are {}", d,
                                     options.displacements.size()));
    return {};
}

Result<void> check_mesh(const Mesh& cage) {
    for (std::size_t v = 0; v < cage.vertex_count(); ++v)
        if (!is_finite(cage.positions[v]))
            return Error{
                ErrorCode::invalid,
                fmt::format("the position of vertex {} is not finite: give it coordinates, or "
                            "take its faces away, before the mesh is tessellated",
                            v),
                place_of(cage)};
    for (std::size_t f = 0; f < cage.face_count(); ++f)
        if (cage.face_offsets[f + 1] - cage.face_offsets[f] < 3)
            return Error{ErrorCode::invalid, fmt::format("face {} has fewer than 3 corners", f),
                         place_of(cage)};
    const bool has_targets = !cage.morph_targets.empty();
    if (has_targets || !cage.skin_influences.empty())
        return Error{ErrorCode::unsupported,
                     fmt::format("the mesh has {}, which would not fit the new points: displace "
                                 "without them, or keep the cage",
                                 has_targets ? "morph targets" : "skin weights"),
                     place_of(cage)};
    return {};
}

// Before a minute is spent on what cannot be: the area of the cage over that of the largest
// triangle with such edges. A limit surface may have less than its cage.
Result<void> check_edge_length(const Mesh& cage, const TessellateOptions& options) {
    if (!options.edge_length || options.max_triangles) return {};
    constexpr double float_steps = 0x1p-22, least_share = 1.0 / 64;
    const double edge = *options.edge_length;
    double largest = 0, area = 0;
    for (const std::uint32_t v : cage.corner_vertices)
        for (int k = 0; k < 3; ++k)
            largest = std::max(largest, double(std::abs(cage.positions[v][k])));
    if (edge < float_steps * largest)
        return Error{ErrorCode::limit,
                     fmt::format("an edge length of {:.3g} is finer than floats of the mesh's size "
                                 "hold: ask for at least {:.3g}",
                                 edge, 1.01 * float_steps * largest),
                     place_of(cage)};
    for (const double of_face : fan_areas(cage)) area += of_face;
    if (options.scheme) area *= least_share;
    const double triangles = area / (std::sqrt(3.0) / 4 * edge * edge);
    if (!(triangles > double(options.triangle_limit))) return {};
    return Error{ErrorCode::limit,
                 fmt::format("an edge length of {:.3g} takes more than {:.2g} triangles, beyond "
                             "the limit of {}: allow longer edges, or set a maximum of triangles",
                             edge, triangles, options.triangle_limit),
                 place_of(cage)};
}

void certify(const TessellateOptions& options, const Domain& domain, const Refinement& refinement,
             TessellationCertificate& certificate) {
    certificate.asked = options.chord_error;
    certificate.triangles = refinement.mesh().triangles().size();
    certificate.unresolved = refinement.unresolved();
    certificate.over_budget = refinement.over_budget();
    if (options.pixel_error) {
        certificate.asked_pixels = options.pixel_error;
        certificate.proved_pixels = 0;
    }
    const std::span<const TriangleBound> bounds = refinement.bounds();
    for (std::uint32_t t = 0; t < bounds.size(); ++t) {
        const BisectedTriangle& triangle = refinement.mesh().triangles()[t];
        certificate.deepest = std::max(certificate.deepest, triangle.depth());
        const double proved = bounds[t].sum();
        certificate.largest_shared_gap =
            std::max(certificate.largest_shared_gap, double(bounds[t].gap));
        certificate.proved_refinable =
            std::max(certificate.proved_refinable, double(bounds[t].refinable));
        if (certificate.proved_pixels)
            certificate.proved_pixels =
                std::max(*certificate.proved_pixels, refinement.proved_pixels(t));
        if (certificate.worst_triangle != no_index && !(proved > certificate.proved)) continue;
        certificate.proved = proved;
        certificate.worst_triangle = t;
        certificate.worst_face = domain.roots[triangle.root].face;
    }
}

// The largest distance of `samples` points from where they should be: triangles in turn, at points
// of the sequence of Roberts 2018 ("R2"), folded into the triangle.
double measured_error(const DisplacedSurface& surface, const BisectionMesh& mesh,
                      const VertexSamples& vertices, std::uint64_t samples, int threads) {
    const std::uint64_t count = mesh.triangles().size();
    if (count == 0 || samples == 0) return 0;
    constexpr double step_x = 0.7548776662466927, step_y = 0.5698402909980532;
    constexpr std::size_t block = 256;
    std::vector<double> largest((samples + block - 1) / block, 0.0);
    parallel_blocks(samples, block, threads, [&](std::size_t begin, std::size_t end) {
        double& most = largest[begin / block];
        for (std::size_t k = begin; k < end; ++k) {
            const auto t =
                samples < count
                    ? std::uint32_t(std::uint64_t(double(k) / double(samples) * double(count)))
                    : std::uint32_t(k % count);
            double x = std::fmod(0.5 + double(k) * step_x, 1.0);
            double y = std::fmod(0.5 + double(k) * step_y, 1.0);
            if (x + y > 1) x = 1 - x, y = 1 - y;
            const BisectedTriangle& triangle = mesh.triangles()[t];
            const glm::dvec3 w(1 - x - y, x, y);
            const RootPoint at = surface.points(triangle).at(w);
            glm::dvec3 facet(0.0);
            for (int c = 0; c < 3; ++c)
                facet += w[c] * glm::dvec3(vertices[triangle.vertices[std::size_t(c)]].position);
            most = std::max(most, glm::length(surface.truth(at) - facet));
        }
    });
    return *std::max_element(largest.begin(), largest.end());
}

}  // namespace

Result<TessellatedMesh> tessellate(const Mesh& cage, const Domain& domain, const BaseSurface& base,
                                   const TessellateOptions& options,
                                   const TessellationHooks& hooks) {
    if (Result<void> checked = check_options(cage, options); !checked) return checked.error();
    if (Result<void> checked = check_mesh(cage); !checked) return checked.error();
    if (Result<void> checked = check_edge_length(cage, options); !checked) return checked.error();
    // Half-edges and corners are numbered with 32 bits.
    TessellateOptions limited = options;
    limited.triangle_limit = std::min<std::uint64_t>(options.triangle_limit, (no_index - 1) / 3);
    if (limited.max_triangles)
        limited.max_triangles = std::min(*limited.max_triangles, limited.triangle_limit);
    const auto heights = RootHeights::make(cage, domain, base, limited);
    if (!heights) return heights.error();
    const DisplacedSurface surface(base, *heights);
    Refinement refinement(cage, domain, surface, limited);
    if (Result<void> refined = refinement.run(); !refined) return refined.error();
    TessellatedMesh out = output_mesh(cage, domain, surface, refinement, hooks, options.threads);
    certify(options, domain, refinement, out.certificate);
    if (options.keep_errors) {
        out.errors.reserve(refinement.bounds().size());
        for (const TriangleBound& bound : refinement.bounds())
            out.errors.push_back(float_not_below(bound.sum()));
    }
    out.certificate.samples = out.certificate.triangles == 0 ? 0 : options.samples;
    out.certificate.measured = measured_error(surface, refinement.mesh(), refinement.samples(),
                                              options.samples, options.threads);
    return out;
}

Result<TessellatedMesh> tessellate(const Mesh& cage, const TessellateOptions& options,
                                   const TessellationHooks& hooks) {
    if (Result<void> checked = check_mesh(cage); !checked) return checked.error();
    if (options.scheme) {
        SubdivideOptions subdivision = options.subdivision;
        subdivision.scheme = *options.scheme;
        subdivision.threads = options.threads;
        auto base = LimitBase::make(cage, subdivision, !options.displacements.empty());
        if (!base) return base.error();
        const Domain domain = make_domain(cage, base->left_out(), false, options.threads);
        base->set_domain(domain);
        auto made = tessellate(cage, domain, *base, options, hooks);
        if (made)
            for (const std::uint8_t hole : base->left_out()) made->holes += hole;
        return made;
    }
    const Domain domain = make_domain(cage, {}, true, options.threads);
    const auto surface = PolygonSurface::make(cage, domain, options.hard_edges, options.threads);
    if (!surface) return surface.error();
    return tessellate(cage, domain, *surface, options, hooks);
}

}  // namespace prep::detail

namespace prep {

Result<TessellatedMesh> tessellate(const Mesh& cage, const TessellateOptions& options) {
    return detail::tessellate(cage, options, {});
}

}  // namespace prep
