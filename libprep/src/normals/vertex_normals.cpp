// One normal per vertex, triangles in one pass (prep/corner_normals.h).
#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <compare>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>

#include "base/parallel.h"
#include "base/scratch_buffer.h"
#include "normals/area_vector.h"
#include "normals/fan_normal.h"
#include "normals/vertex_normals_path.h"
#include "normals/vertex_pages.h"
#include "normals/vertex_sums.h"
#include "prep/corner_normals.h"
#include "surface/corner_steps.h"
#include "surface/vertex_corners.h"

namespace prep {
namespace {

using Index = std::uint32_t;
using detail::all_components;
using detail::AreaSum;
using detail::block_triangles;
using detail::differs;
using detail::page_vertices;
using detail::PageUse;
using detail::range_triangles;
using detail::VertexNormalsPath;

constexpr std::size_t vertex_grain = 8192;
constexpr std::size_t page_grain = 64;

NormalOptions by_area(Precision precision) {
    NormalOptions options;
    options.precision = precision;
    return options;
}

void add_report(const detail::FanReport& report, VertexNormals& result) {
    result.fallbacks.insert(result.fallbacks.end(), report.fallbacks.begin(),
                            report.fallbacks.end());
    result.exact_sums += report.exact_sums;
}

void sort_fallbacks(VertexNormals& result) {
    std::sort(result.fallbacks.begin(), result.fallbacks.end(),
              [](const auto& a, const auto& b) { return a.corner < b.corner; });
}

// Corner by corner, whatever the faces.
VertexNormals by_corners(const MeshView& mesh, const VertexNormalOptions& options) {
    const std::size_t vertices = mesh.positions.size();
    const FaceNormals faces = face_normals(mesh, options.precision, options.threads);
    const detail::VertexCorners around =
        detail::corners_by_vertex(mesh.corner_vertices, vertices, options.threads);
    std::vector<Index> corner_faces;
    if (!detail::all_triangles(mesh)) {
        corner_faces.resize(mesh.corner_count());
        for (std::size_t f = 0; f < mesh.face_count(); ++f)
            std::fill(corner_faces.begin() + mesh.face_offsets[f],
                      corner_faces.begin() + mesh.face_offsets[f + 1], Index(f));
    }
    const NormalOptions fan_options = by_area(options.precision);
    VertexNormals result;
    result.normals.assign(vertices, {0, 0, 1});
    std::vector<detail::FanReport> reports((vertices + vertex_grain - 1) / vertex_grain);
    detail::with_steps(mesh, corner_faces, [&](const auto& steps) {
        detail::parallel_blocks(
            vertices, vertex_grain, options.threads, [&](std::size_t begin, std::size_t end) {
                detail::FanNormal normal_of(mesh, faces, fan_options, steps, {});
                for (std::size_t v = begin; v < end; ++v) {
                    const std::size_t first = around.offsets[v], last = around.offsets[v + 1];
                    if (first == last) continue;
                    result.normals[v] =
                        glm::vec3(normal_of({around.corners.data() + first, last - first},
                                            reports[begin / vertex_grain]));
                }
            });
    });
    for (const detail::FanReport& report : reports) add_report(report, result);
    sort_fallbacks(result);
    return result;
}

// Whether what is left goes faster corner by corner, on all threads.
bool more_than_few(std::size_t count, std::size_t all) {
    return count > 1024 && count > all / 64;
}

// A few vertices of a mesh of triangles, corner by corner, from the triangles that use them.
class OpenVertices {
  public:
    // `vertices`: ascending.
    OpenVertices(const MeshView& mesh, const PageUse& use, std::vector<Index> vertices)
        : mesh_(mesh), use_(use), vertices_(std::move(vertices)) {}

    // False: they have too many corners for one thread, and nothing was done.
    bool run(const VertexNormalOptions& options, VertexNormals& result) {
        if (vertices_.empty()) return true;
        if (!find_corners(options.threads)) return false;
        copy_triangles();
        MeshView some = mesh_;
        some.face_offsets = offsets_;
        some.corner_vertices = corner_vertices_;
        some.face_materials = some.face_smoothing = {};
        const FaceNormals faces = face_normals(some, options.precision, options.threads);
        const NormalOptions fan_options = by_area(options.precision);
        detail::FanNormal normal_of(some, faces, fan_options, detail::TriangleSteps{}, {});
        detail::FanReport report;
        std::vector<Index> corners;
        for (std::size_t i = 0; i < found_.size();) {
            const Index vertex = found_[i].vertex;
            corners.clear();
            for (; i < found_.size() && found_[i].vertex == vertex; ++i)
                corners.push_back(found_[i].corner);
            result.normals[vertex] = glm::vec3(normal_of(corners, report));
        }
        for (CornerNormals::Fallback& fallback : report.fallbacks)
            fallback.corner = 3 * triangles_[fallback.corner / 3] + fallback.corner % 3;
        add_report(report, result);
        sort_fallbacks(result);
        return true;
    }

  private:
    struct Found {
        Index vertex, corner;
        auto operator<=>(const Found&) const = default;
    };

    bool find_corners(int threads) {
        const std::size_t triangles = mesh_.face_count();
        std::vector<std::vector<Found>> found(use_.ranges.size());
        detail::parallel_blocks(triangles, range_triangles, threads,
                                [&](std::size_t begin, std::size_t end) {
                                    for (std::size_t t = begin; t < end; t += block_triangles)
                                        look_at_block(t, std::min(t + block_triangles, end),
                                                      found[begin / range_triangles]);
                                });
        std::size_t count = 0;
        for (const auto& list : found) count += list.size();
        if (more_than_few(count, mesh_.corner_count())) return false;
        found_.reserve(count);
        for (auto& list : found) {
            found_.insert(found_.end(), list.begin(), list.end());
            detail::release(list);
        }
        return true;
    }

    void look_at_block(std::size_t begin, std::size_t end, std::vector<Found>& found) const {
        const PageUse::Extent extent = use_.blocks[begin / block_triangles];
        const auto first = std::lower_bound(vertices_.begin(), vertices_.end(), extent.first);
        const auto last = std::upper_bound(first, vertices_.end(), extent.last);
        if (first == last) return;
        // Mostly it is one of them, and the block is one that only spans it.
        const Index least = *first, span = *(last - 1) - least;
        Index any = 0;
        for (std::size_t c = 3 * begin; c < 3 * end; ++c)
            any |= Index(mesh_.corner_vertices[c] - least <= span);
        if (any == 0) return;
        for (std::size_t c = 3 * begin; c < 3 * end; ++c) {
            const Index v = mesh_.corner_vertices[c];
            if (v - least <= span && std::binary_search(first, last, v))
                found.push_back({v, Index(c)});
        }
    }

    // Triangles with corners of interest, which get their numbers among these.
    void copy_triangles() {
        for (Found& f : found_) {
            const Index triangle = f.corner / 3;
            if (triangles_.empty() || triangles_.back() != triangle) {
                triangles_.push_back(triangle);
                for (Index k = 0; k < 3; ++k)
                    corner_vertices_.push_back(mesh_.corner_vertices[3 * triangle + k]);
                offsets_.push_back(Index(corner_vertices_.size()));
            }
            f.corner = Index(3 * (triangles_.size() - 1)) + f.corner % 3;
        }
        std::sort(found_.begin(), found_.end());
    }

    const MeshView& mesh_;
    const PageUse& use_;
    std::vector<Index> vertices_;
    std::vector<Found> found_;  // corners ascending, then by vertex
    std::vector<Index> triangles_, offsets_{0}, corner_vertices_;
};

// Triangles in their order, range by range.
template <class T>
class Stream {
  public:
    Stream(const MeshView& mesh, const PageUse& use, const VertexNormalOptions& options,
           std::span<glm::vec3> normals)
        : mesh_(mesh),
          use_(use),
          threads_(options.threads),
          normals_(normals),
          open_(use.owners.size(), 0),
          shared_(use.ranges.size()) {
        if constexpr (std::is_same_v<T, double>) {
            add_ = detail::double_sum_kernel(options.simd);
            finish_ = detail::double_finish_kernel(options.simd);
        } else {
            add_ = detail::float_sum_kernel(options.simd);
            finish_ = detail::float_finish_kernel(options.simd);
        }
    }

    // Ascending: the vertices that have no normal yet.
    std::vector<Index> run() {
        detail::parallel_blocks(use_.ranges.size(), 1, threads_, [&](std::size_t r, std::size_t) {
            std::unique_ptr<Scratch> scratch = take_scratch();
            go_through(r, *scratch);
            const std::lock_guard lock(mutex_);
            free_.push_back(std::move(scratch));
        });
        add_shared();
        std::vector<Index> open;
        for (std::size_t page = 0; page < open_.size(); ++page) {
            if (use_.owners[page] == PageUse::unused) {
                const auto first = normals_.subspan(page * page_vertices);
                std::fill_n(first.begin(), std::min(page_vertices, first.size()),
                            glm::vec3(0, 0, 1));
            }
            for (std::uint64_t rest = open_[page]; rest != 0; rest &= rest - 1)
                open.push_back(Index(page * page_vertices + std::size_t(std::countr_zero(rest))));
        }
        return open;
    }

  private:
    // What a range works in; pages of the mesh have places in the sums.
    struct Scratch {
        std::vector<Index> page_places;
        detail::ScratchBuffer<AreaSum<T>> sums;
        detail::ScratchBuffer<Index> counts;
        std::vector<std::uint8_t> components;  // by place
    };
    struct Page {
        std::array<AreaSum<T>, page_vertices> sums;
        std::array<Index, page_vertices> counts;
        Index number;
        unsigned components;
    };

    std::unique_ptr<Scratch> take_scratch() {
        {
            const std::lock_guard lock(mutex_);
            if (!free_.empty()) {
                std::unique_ptr<Scratch> scratch = std::move(free_.back());
                free_.pop_back();
                return scratch;
            }
        }
        auto scratch = std::make_unique<Scratch>();
        scratch->page_places.resize(use_.owners.size());
        return scratch;
    }

    void go_through(std::size_t r, Scratch& scratch) {
        const std::vector<Index>& pages = use_.ranges[r];
        const std::size_t vertices = pages.size() * page_vertices;
        if (scratch.sums.size() < vertices) {
            const std::size_t size =
                std::min(vertices + vertices / 4, detail::most_pages_of_range * page_vertices);
            detail::release(scratch.sums);
            detail::release(scratch.counts);
            scratch.sums = detail::ScratchBuffer<AreaSum<T>>(size);
            scratch.counts = detail::ScratchBuffer<Index>(size);
        }
        std::fill_n(scratch.sums.data(), vertices, AreaSum<T>());
        std::fill_n(scratch.counts.data(), vertices, 0);
        scratch.components.assign(pages.size(), 0);
        for (std::size_t i = 0; i < pages.size(); ++i)
            scratch.page_places[pages[i]] = Index(i * page_vertices);
        const std::size_t begin = r * range_triangles,
                          end = std::min(mesh_.face_count(), begin + range_triangles);
        for (std::size_t t = begin; t < end; t += block_triangles)
            add_block(t, std::min(t + block_triangles, end), scratch);

        shared_[r].reserve(std::size_t(std::count_if(pages.begin(), pages.end(), [&](Index page) {
            return use_.owners[page] == PageUse::shared;
        })));
        for (std::size_t i = 0; i < pages.size(); ++i) {
            const AreaSum<T>* const sums = scratch.sums.data() + i * page_vertices;
            const Index* const counts = scratch.counts.data() + i * page_vertices;
            if (use_.owners[pages[i]] == PageUse::shared) {
                Page& page = shared_[r].emplace_back();
                std::copy_n(sums, page_vertices, page.sums.data());
                std::copy_n(counts, page_vertices, page.counts.data());
                page.number = pages[i];
                page.components = scratch.components[i];
            } else {
                finish(pages[i], sums, counts, scratch.components[i]);
            }
        }
    }

    void add_block(std::size_t begin, std::size_t end, Scratch& scratch) const {
        const PageUse::Extent extent = use_.blocks[begin / block_triangles];
        const bool reads_behind = extent.last + 1 < mesh_.positions.size();
        unsigned components = add_(
            mesh_.positions.data(), mesh_.corner_vertices.data() + 3 * begin, end - begin,
            reads_behind, {scratch.page_places.data(), scratch.sums.data(), scratch.counts.data()});
        if (std::is_same_v<T, double> && (components & all_components) != components / differs)
            components = differing(begin, end, components);
        // All pages between the least and the greatest vertex: some too many at worst.
        const auto number = [&](Index vertex) {
            return scratch.page_places[vertex / page_vertices] / page_vertices;
        };
        const std::size_t last = number(extent.last);
        for (std::size_t page = number(extent.first); page <= last; ++page)
            scratch.components[page] |= std::uint8_t(components);
    }

    // Of components whose products are all equal, also those whose accurate area vectors are not
    // zero there: of some faces for which doubles do not do.
    unsigned differing(std::size_t begin, std::size_t end, unsigned components) const {
        const auto at = [&](std::size_t c) { return mesh_.positions[mesh_.corner_vertices[c]]; };
        for (std::size_t t = begin; t < end; ++t) {
            const detail::AreaVector plain =
                detail::plain_triangle_area(at(3 * t), at(3 * t + 1), at(3 * t + 2));
            const glm::dvec3& v = plain.value;
            if (plain.error <= accurate_face_error * detail::largest_component(v)) continue;
            if (!std::isfinite(plain.error + v.x + v.y + v.z))
                return components | (components & all_components) * differs;
            const glm::dvec3 area = detail::accurate_area_vector(mesh_, Index(t));
            components |= differs * ((area.x != 0 ? detail::component_x : 0u) |
                                     (area.y != 0 ? detail::component_y : 0u) |
                                     (area.z != 0 ? detail::component_z : 0u));
        }
        return components;
    }

    void finish(Index page, const AreaSum<T>* sums, const Index* counts, unsigned components) {
        const std::size_t first = std::size_t(page) * page_vertices;
        open_[page] = finish_(sums, counts, std::min(page_vertices, normals_.size() - first),
                              components, normals_.data() + first);
    }

    // Pages of several ranges: sums of theirs, in their order.
    void add_shared() {
        std::vector<const Page*> pages;
        for (const auto& list : shared_)
            for (const Page& page : list) pages.push_back(&page);
        std::stable_sort(pages.begin(), pages.end(),
                         [](const Page* a, const Page* b) { return a->number < b->number; });
        std::vector<std::size_t> starts;
        for (std::size_t i = 0; i < pages.size(); ++i)
            if (i == 0 || pages[i]->number != pages[i - 1]->number) starts.push_back(i);
        const std::size_t count = starts.size();
        starts.push_back(pages.size());
        detail::parallel_blocks(
            count, page_grain, threads_, [&](std::size_t begin, std::size_t end) {
                for (std::size_t i = begin; i < end; ++i)
                    add_pages({pages.data() + starts[i], starts[i + 1] - starts[i]});
            });
    }

    void add_pages(std::span<const Page* const> pages) {
        Page total = *pages[0];
        for (const Page* const page : pages.subspan(1)) {
            for (std::size_t i = 0; i < page_vertices; ++i) {
                total.sums[i].z += page->sums[i].z;
                total.sums[i].x += page->sums[i].x;
                total.sums[i].y += page->sums[i].y;
                total.sums[i].size += page->sums[i].size;
                total.counts[i] += page->counts[i];
            }
            total.components |= page->components;
        }
        finish(total.number, total.sums.data(), total.counts.data(), total.components);
    }

    const MeshView& mesh_;
    const PageUse& use_;
    int threads_;
    std::span<glm::vec3> normals_;
    detail::SumKernel<T> add_ = nullptr;
    detail::FinishKernel<T> finish_ = nullptr;
    std::vector<std::uint64_t> open_;  // per page a bit for each vertex
    std::vector<std::vector<Page>> shared_;
    std::mutex mutex_;
    std::vector<std::unique_ptr<Scratch>> free_;
};

// Whether all vertices have got their normals; the rest is in vain otherwise.
template <class T>
bool stream(const MeshView& mesh, const PageUse& use, const VertexNormalOptions& options,
            VertexNormals& result, VertexNormalsPath& path) {
    std::vector<Index> open = Stream<T>(mesh, use, options, result.normals).run();
    path.open_vertices = open.size();
    if (more_than_few(open.size(), mesh.positions.size())) return false;
    return OpenVertices(mesh, use, std::move(open)).run(options, result);
}

// Nothing where all triangles were gone through in vain.
std::optional<VertexNormals> by_triangles(const MeshView& mesh, const PageUse& use,
                                          const VertexNormalOptions& options,
                                          VertexNormalsPath& path) {
    VertexNormals result;
    result.normals.resize(mesh.positions.size());
    const bool done = options.precision == Precision::fast
                          ? stream<float>(mesh, use, options, result, path)
                          : stream<double>(mesh, use, options, result, path);
    if (!done) return std::nullopt;
    return result;
}

Error invalid_face(std::size_t face, std::string text) {
    return {ErrorCode::invalid, std::move(text), "face " + std::to_string(face)};
}

// Faces of three corners and more that follow each other over all corners.
std::optional<Error> bad_faces(const MeshView& mesh, int threads) {
    const std::size_t corners = mesh.corner_count();
    const std::span<const Index> offsets = mesh.face_offsets;
    if (offsets.empty() ? corners != 0 : offsets.front() != 0 || offsets.back() != corners)
        return Error{ErrorCode::invalid,
                     "face offsets do not go from 0 to the " + std::to_string(corners) +
                         " corners that there are",
                     "face_offsets"};
    const auto is_bad = [&](std::size_t f) {
        return offsets[f + 1] < offsets[f] || offsets[f + 1] - offsets[f] < 3;
    };
    std::atomic<bool> any = false;
    detail::parallel_blocks(
        mesh.face_count(), range_triangles, threads, [&](std::size_t begin, std::size_t end) {
            Index other = 0;  // than triangles: as many at once as vectors hold
            for (std::size_t f = begin; f < end; ++f)
                other |= ((offsets[f + 1] - offsets[f]) ^ 3) | Index(offsets[f + 1] < offsets[f]);
            bool bad = false;
            for (std::size_t f = begin; f < end && other != 0; ++f) bad |= is_bad(f);
            if (bad) any = true;
        });
    if (!any) return std::nullopt;
    std::size_t face = 0;
    while (!is_bad(face)) ++face;
    return invalid_face(face, "a face has fewer than 3 corners");
}

Error bad_vertex(const MeshView& mesh) {
    std::size_t c = 0, face = 0;
    while (mesh.corner_vertices[c] < mesh.positions.size()) ++c;
    while (mesh.face_offsets[face + 1] <= c) ++face;
    return invalid_face(face, "vertex " + std::to_string(mesh.corner_vertices[c]) + " of " +
                                  std::to_string(mesh.positions.size()));
}

bool any_bad_vertex(const MeshView& mesh, int threads) {
    std::atomic<bool> bad = false;
    detail::parallel_blocks(mesh.corner_count(), range_triangles, threads,
                            [&](std::size_t begin, std::size_t end) {
                                Index last = 0;
                                for (std::size_t c = begin; c < end; ++c)
                                    last = std::max(last, mesh.corner_vertices[c]);
                                if (last >= mesh.positions.size()) bad = true;
                            });
    return bad;
}

}  // namespace

Result<VertexNormals> detail::vertex_normals(const MeshView& mesh,
                                             const VertexNormalOptions& options,
                                             VertexNormalsPath& path) {
    if (auto error = bad_faces(mesh, options.threads)) return *std::move(error);
    path = {};
    if (options.precision == Precision::exact || !all_triangles(mesh)) {
        if (any_bad_vertex(mesh, options.threads)) return bad_vertex(mesh);
    } else if (mesh.corner_count() != 0) {
        const PageUse use =
            find_page_use(mesh.corner_vertices, mesh.positions.size(), options.threads);
        if (use.last_vertex >= mesh.positions.size()) return bad_vertex(mesh);
        if (!use.scattered)
            if (auto normals = by_triangles(mesh, use, options, path)) return *std::move(normals);
    }
    path.by_corners = true;
    return by_corners(mesh, options);
}

Result<VertexNormals> vertex_normals(const MeshView& mesh, const VertexNormalOptions& options) {
    VertexNormalsPath path;
    return detail::vertex_normals(mesh, options, path);
}

}  // namespace prep
