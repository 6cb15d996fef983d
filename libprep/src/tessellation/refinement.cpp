#include "tessellation/refinement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/finite.h"
#include "base/outward.h"
#include "base/parallel.h"

namespace prep::detail {
namespace {

constexpr std::size_t block = 256;
// More than rounding to floats moves corners by.
double rounding_gap(std::span<const glm::dvec3> corners) {
    double largest = 0;
    for (const glm::dvec3& p : corners)
        for (glm::length_t k = 0; k < 3; ++k) largest = std::max(largest, std::abs(p[k]));
    return 0x1p-22 * largest;
}

double farthest_apart(const std::array<glm::dvec3, 3>& p, const std::array<glm::dvec3, 3>& q) {
    double apart = 0;
    for (std::size_t k = 0; k < 3; ++k) apart = std::max(apart, glm::length(p[k] - q[k]));
    return apart;
}

std::array<double, 3> edge_lengths(const std::array<glm::dvec3, 3>& corners) {
    return {glm::length(corners[1] - corners[0]), glm::length(corners[2] - corners[1]),
            glm::length(corners[0] - corners[2])};
}

double longest_of(const std::array<double, 3>& lengths) {
    return std::max({lengths[0], lengths[1], lengths[2]});
}

constexpr float unknown = -1;  // a bound that was not computed

// What there is over what is asked for: above 1 the triangle has to be halved. What refinement
// cannot take away is made up for as long as that is less than half of all. `misses`: whether the
// certificate will say so, which is exact, and not by what the subtraction rounds.
double excess_over(const TriangleBound& bound, double asked, bool misses) {
    const double left = std::max(asked - double(bound.gap), 0.5 * asked);
    return std::max(misses && left > 0.5 * asked ? std::nextafter(1.0, 2.0) : 0.0,
                    double(bound.refinable) / left);
}

}  // namespace

Refinement::Refinement(const Mesh& cage, const Domain& domain, const DisplacedSurface& surface,
                       const TessellateOptions& options)
    : cage_(cage),
      domain_(domain),
      surface_(surface),
      options_(options),
      screens_(options.pixel_error ? options.screens : std::vector<ScreenMetric>{}),
      mesh_(0, {}) {}

void Refinement::make_cage_vertices() {
    const std::uint32_t count = domain_.cage_vertices;
    samples_.resize(count);
    // Points by cage vertex: each fan's corner, once.
    std::vector<std::uint32_t> offsets(std::size_t(count) + 1, 0);
    const auto vertex = [&](std::uint32_t r) {
        return cage_.corner_vertices[domain_.roots[r].corners[0]];
    };
    for (std::uint32_t r = 0; r < domain_.roots.size(); ++r) ++offsets[vertex(r) + 1];
    std::partial_sum(offsets.begin(), offsets.end(), offsets.begin());
    std::vector<RootPoint> points(domain_.roots.size());
    std::vector<std::uint32_t> next(offsets.begin(), offsets.end() - 1);
    for (std::uint32_t r = 0; r < domain_.roots.size(); ++r)
        points[next[vertex(r)]++] = {r, {1, 0, 0}};
    parallel_blocks(count, block, options_.threads, [&](std::size_t begin, std::size_t end) {
        for (auto v = std::uint32_t(begin); v < end; ++v) {
            const auto at = std::span(points).subspan(offsets[v], offsets[v + 1] - offsets[v]);
            if (at.empty()) continue;
            std::vector<BasePoint> sides(at.size());
            surface_.base().evaluate(at, sides);
            surface_.make_vertex(at, sides, v, samples_);
        }
    });
}

std::vector<Nearer> Refinement::nearer_diagonals() const {
    std::vector<Nearer> nearer(domain_.fans(), Nearer::neither);
    parallel_blocks(
        nearer.size(), block, options_.threads, [&](std::size_t begin, std::size_t end) {
            std::vector<std::uint32_t> quads;
            std::vector<RootPoint> centres;
            for (auto fan = std::uint32_t(begin); fan < end; ++fan)
                if (domain_.fan_roots[fan + 1] - domain_.fan_roots[fan] == 4) {
                    quads.push_back(fan);
                    centres.push_back({domain_.fan_roots[fan], {0, 0, 1}});
                }
            std::vector<glm::dvec3> truths(centres.size());
            surface_.truths(centres, truths);
            for (std::size_t q = 0; q < quads.size(); ++q) {
                std::array<glm::dvec3, 4> p;
                for (std::uint32_t k = 0; k < 4; ++k) {
                    const DomainRoot& root = domain_.roots[domain_.fan_roots[quads[q]] + k];
                    p[k] = glm::dvec3(samples_[cage_.corner_vertices[root.corners[0]]].position);
                }
                const double first = glm::length(truths[q] - 0.5 * (p[0] + p[2]));
                const double second = glm::length(truths[q] - 0.5 * (p[1] + p[3]));
                // Of a plane's both are roundings, of polygons both are the same.
                constexpr double clearly = 0.9375;
                const double gap = rounding_gap(p);
                if (first < clearly * second - gap) nearer[quads[q]] = Nearer::first;
                if (second < clearly * first - gap) nearer[quads[q]] = Nearer::second;
            }
        });
    return nearer;
}

void Refinement::start() {
    make_cage_vertices();
    const DomainStart start = make_start(domain_, cage_, nearer_diagonals());
    const std::uint32_t cage = domain_.cage_vertices;
    mesh_ = BisectionMesh(cage + std::uint32_t(start.centres.size()), start.triangles);
    samples_.resize(mesh_.vertex_count());
    parallel_blocks(
        start.centres.size(), block, options_.threads, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k) {
                const RootPoint at{domain_.fan_roots[start.centres[k]], {0, 0, 1}};
                BasePoint point;
                surface_.base().evaluate({&at, 1}, {&point, 1});
                surface_.make_vertex({&at, 1}, {&point, 1}, cage + std::uint32_t(k), samples_);
            }
        });
    for (const VertexSample& v : samples_)
        for (int k = 0; k < 3; ++k)
            if (std::isfinite(v.position[k]))
                largest_coordinate_ =
                    std::max(largest_coordinate_, std::abs(double(v.position[k])));
}

void Refinement::make_new_vertices() {
    const BisectionMesh::NewVertices& news = mesh_.news();
    samples_.resize_to_fill(mesh_.vertex_count());
    const auto make = [&](std::size_t begin, std::size_t end) {
        const std::size_t first = news.offsets[begin], count = news.offsets[end] - first;
        std::vector<RootPoint> points(count);
        for (std::size_t k = 0; k < count; ++k) points[k] = news.edges[first + k].middle();
        std::vector<BasePoint> sides(count);
        surface_.base().evaluate(points, sides);
        for (std::size_t k = begin; k < end; ++k) {
            const std::size_t from = news.offsets[k] - first;
            const std::size_t of_vertex = news.offsets[k + 1] - news.offsets[k];
            surface_.make_vertex(std::span(points).subspan(from, of_vertex),
                                 std::span(sides).subspan(from, of_vertex),
                                 news.first + std::uint32_t(k), samples_);
        }
    };
    parallel_blocks(news.offsets.size() - 1, block, options_.threads, make);
}

std::array<glm::dvec3, 3> Refinement::corners(const BisectedTriangle& triangle) const {
    std::array<glm::dvec3, 3> corners;
    for (std::size_t k = 0; k < 3; ++k)
        corners[k] = glm::dvec3(samples_[triangle.vertices[k]].position);
    return corners;
}

bool Refinement::is_shared(const BisectedTriangle& triangle) const {
    return std::any_of(triangle.vertices.begin(), triangle.vertices.end(),
                       [&](std::uint32_t v) { return samples_[v].shared; });
}

// Enough is what is left beside the gap, or half where that is not known yet; never more is left
// than all.
Asked Refinement::asked(const BisectedTriangle& triangle) const {
    const double chord = options_.chord_error.value_or(std::numeric_limits<double>::infinity());
    double most = chord;
    if (options_.pixel_error) {
        const auto corners = this->corners(triangle);
        for (const ScreenBound& screen : screens_.around(corners, 0))
            most = std::min(most, screen.length_of(corners, *options_.pixel_error));
    }
    const double left = is_shared(triangle) ? 0 : most - rounding_gap(corners(triangle));
    return {std::max(0.5 * most, left), most, chord};
}

// Triangles within the goal have no order among each other; nor have those whose bounds are no
// more than an error that is there. What shared corners are off by comes on top.
Asked Refinement::worth_proving(std::uint32_t t) const {
    Asked result;
    const BisectedTriangle& triangle = mesh_.triangles()[t];
    if (!options_.chord_error && !options_.pixel_error) {
        const auto seen = corners(triangle);
        const double gap =
            is_shared(triangle) ? farthest_apart(surface_.own_corners(triangle), seen) : 0;
        result.enough = std::max(0.0, largest_seen_ - gap - rounding_gap(seen));
        return result;
    }
    const double enough = asked(triangle).enough;
    if (std::isfinite(enough)) result.enough = enough;
    return result;
}

double Refinement::largest_point_error() const {
    const std::size_t count = mesh_.triangles().size();
    std::vector<double> of_blocks(count / block + 1, 0.0);
    parallel_blocks(count, block, options_.threads, [&](std::size_t begin, std::size_t end) {
        std::vector<RootPoint> middles;
        for (std::size_t t = begin; t < end; ++t)
            middles.push_back(surface_.points(mesh_.triangles()[t]).at({0.5, 0.5, 0}));
        std::vector<glm::dvec3> truths(middles.size());
        surface_.truths(middles, truths);
        double& most = of_blocks[begin / block];
        for (std::size_t t = begin; t < end; ++t) {
            const auto p = corners(mesh_.triangles()[t]);
            most = std::max(most, glm::length(truths[t - begin] - 0.5 * (p[0] + p[1])));
        }
    });
    return *std::max_element(of_blocks.begin(), of_blocks.end());
}

// Of a triangle's edges, each as long as the triangle's own side has it where that is less: what
// sides that share a corner disagree by stays, however fine the triangles are.
double Refinement::longest_edge(std::uint32_t t) const {
    const BisectedTriangle& triangle = mesh_.triangles()[t];
    const auto seen = corners(triangle);
    const auto lengths = edge_lengths(seen);
    const double longest = longest_of(lengths);
    if (!(longest > *options_.edge_length) || !is_shared(triangle)) return longest;
    const auto own = surface_.own_corners(triangle);
    if (farthest_apart(own, seen) <= rounding_gap(seen)) return longest;
    const auto own_lengths = edge_lengths(own);
    std::array<double, 3> less;
    for (std::size_t k = 0; k < 3; ++k) less[k] = std::min(lengths[k], own_lengths[k]);
    return longest_of(less);
}

bool Refinement::has_long_edge(std::uint32_t t) const {
    return options_.edge_length && longest_edge(t) / *options_.edge_length > 1;
}

bool Refinement::stays_long(std::uint32_t t) const {
    return options_.edge_length &&
           longest_of(edge_lengths(corners(mesh_.triangles()[t]))) / *options_.edge_length > 1;
}

// By the true point in the middle of the edge that would be halved. Never true where the bound
// would say otherwise: no bound is below the error of a point.
bool Refinement::surely_misses(std::uint32_t t, const glm::dvec3& middle) const {
    const auto corners = this->corners(mesh_.triangles()[t]);
    const double error = glm::length(middle - 0.5 * (corners[0] + corners[1]));
    const double refinable = error - rounding_gap(corners);  // the least that the bound may be
    if (options_.chord_error && refinable > *options_.chord_error) return true;
    return options_.pixel_error &&
           refinable * pixels_per_unit(screens_.around(corners, error), corners, error) >
               *options_.pixel_error;
}

// What the triangles after the k-th are made of, which lies anywhere in memory.
void Refinement::fetch_ahead(std::span<const Touched> fresh, std::size_t k) const {
    constexpr std::size_t triangles_ahead = 12, samples_ahead = 4, line = 64;
    if (k + triangles_ahead < fresh.size()) {
        const std::uint32_t t = fresh[k + triangles_ahead].triangle;
        __builtin_prefetch(&mesh_.triangles()[t]);
        __builtin_prefetch(&bounds_[t], 1);
        __builtin_prefetch(&excess_[t], 1);
    }
    if (k + samples_ahead < fresh.size())
        for (const std::uint32_t v :
             mesh_.triangles()[fresh[k + samples_ahead].triangle].vertices) {
            const auto* const sample = reinterpret_cast<const char*>(&samples_[v]);
            __builtin_prefetch(sample);
            __builtin_prefetch(sample + line);
        }
}

// Of those that will be halved, the triangles on both sides.
void Refinement::fetch_rings_ahead(std::size_t k) const {
    constexpr std::size_t triangles_ahead = 24, rings_ahead = 12;
    const auto fetch = [&](std::uint32_t t) { __builtin_prefetch(&mesh_.triangles()[t], 1); };
    if (k + triangles_ahead < fresh_.size() && to_halve_[k + triangles_ahead] != 0)
        fetch(fresh_[k + triangles_ahead].triangle);
    if (k + rings_ahead < fresh_.size() && to_halve_[k + rings_ahead] != 0)
        fetch(mesh_.triangles()[fresh_[k + rings_ahead].triangle].next[0] / 3);
}

// Those that a look shows to be halved get no bound; nor do those that nothing is asked of. Looks
// take a point of the base each, which costs more than a quick bound and less than a tight one.
void Refinement::look(std::span<const Touched> fresh) {
    std::vector<std::uint32_t> unsure;
    std::vector<RootPoint> middles;
    for (std::size_t k = 0; k < fresh.size(); ++k) {
        fetch_ahead(fresh, k);
        if (!mesh_.is_there(fresh[k])) continue;
        const std::uint32_t t = fresh[k].triangle;
        const BisectedTriangle& triangle = mesh_.triangles()[t];
        bounds_[t] = {unknown, 0};
        if (has_long_edge(t)) {
            excess_[t] = std::numeric_limits<float>::infinity();
        } else if (!(options_.chord_error || options_.pixel_error)) {
            excess_[t] = 0;
        } else if (is_shared(triangle) || triangle.is_closed()) {
            prove(t, asked(triangle));
        } else {
            const std::array<glm::dvec3, 3> weights = path_weights(triangle.path);
            if (const auto quick =
                    surface_.quick_bound(triangle, weights, samples_, asked(triangle))) {
                bounds_[t] = *quick;
                excess_[t] = excess(t);
            } else {
                unsure.push_back(t);
                middles.push_back({triangle.root, 0.5 * (weights[0] + weights[1])});
            }
        }
    }
    std::vector<glm::dvec3> truths(middles.size());
    surface_.truths(middles, truths);
    for (std::size_t k = 0; k < unsure.size(); ++k) {
        if (surely_misses(unsure[k], truths[k]))
            excess_[unsure[k]] = std::numeric_limits<float>::infinity();
        else
            prove(unsure[k], asked(mesh_.triangles()[unsure[k]]));
    }
}

void Refinement::prove(std::uint32_t t, const Asked& asked) {
    bounds_[t] = surface_.bound(mesh_.triangles()[t], samples_, asked);
    excess_[t] = excess(t);
}

void Refinement::measure(std::span<const Touched> fresh, Effort effort) {
    bounds_.resize_to_fill(mesh_.triangles().size());
    excess_.resize_to_fill(mesh_.triangles().size());
    to_halve_.resize_to_fill(fresh.size());
    parallel_blocks(fresh.size(), block, options_.threads, [&](std::size_t begin, std::size_t end) {
        const auto part = fresh.subspan(begin, end - begin);
        if (effort == Effort::looking) look(part);
        for (std::size_t k = begin; k < end; ++k) {
            const std::uint32_t t = fresh[k].triangle;
            const bool is_there = mesh_.is_there(fresh[k]);
            if (is_there && effort == Effort::proving) prove(t, worth_proving(t));
            to_halve_[k] = is_there && excess_[t] > 1 && can_be_halved(t);
        }
    });
}

double Refinement::proved_pixels(std::uint32_t t) const {
    const double error = bounds_[t].sum();
    const auto corners = this->corners(mesh_.triangles()[t]);
    const double scale = pixels_per_unit(screens_.around(corners, error), corners, error);
    return scale == 0 || error == 0 ? 0 : scale * error;
}

float Refinement::excess(std::uint32_t t) const {
    const TriangleBound& bound = bounds_[t];
    double most = 0;
    const double error = bound.sum();
    if (options_.chord_error)
        most = excess_over(bound, *options_.chord_error, error > *options_.chord_error);
    if (options_.pixel_error) {
        const auto corners = this->corners(mesh_.triangles()[t]);
        const double asked = *options_.pixel_error;
        for (const ScreenBound& screen : screens_.around(corners, error)) {
            const double scale = screen.pixels_per_unit(corners, error);
            if (scale == 0) continue;
            // By lengths, not by pixels, which have no order where they reach the eye.
            most = std::max(
                most, excess_over(bound, screen.length_of(corners, asked), scale * error > asked));
        }
    }
    if (options_.edge_length) most = std::max(most, longest_edge(t) / *options_.edge_length);
    if (!options_.chord_error && !options_.pixel_error && !options_.edge_length)
        most = double(bound.refinable);
    return float_not_below(most);  // what exceeds by an ulp has to be halved as well
}

// Where the vertex would be that halving makes.
glm::dvec3 Refinement::middle_position(std::uint32_t t) const {
    std::vector<RootPoint> at;
    std::uint32_t h = 3 * t;
    do {
        const BisectedTriangle& triangle = mesh_.triangles()[h / 3];
        glm::dvec3 weights(0.0);
        const auto side = glm::length_t(h % 3);
        weights[side] = weights[(side + 1) % 3] = 0.5;
        at.push_back(surface_.points(triangle).at(weights));
        h = triangle.next[h % 3];
    } while (h != 3 * t && (mesh_.triangles()[t].on_border & 1) != 0);
    std::vector<BasePoint> sides(at.size());
    surface_.base().evaluate(at, sides);
    VertexSamples made;
    made.resize_to_fill(1);
    surface_.make_vertex(at, sides, 0, made);
    return glm::dvec3(made[0].position);
}

// Not where the middle of its edge would fall on one of its ends, nor where that holds for what is
// halved first; closed faces can always be opened.
bool Refinement::can_be_halved(std::uint32_t t) const {
    const BisectedTriangle& triangle = mesh_.triangles()[t];
    if (triangle.is_closed()) return true;
    if (triangle.depth() >= deepest_bisection) return false;
    std::array<const VertexSample*, 3> v;
    for (std::size_t k = 0; k < 3; ++k) v[k] = &samples_[triangle.vertices[k]];
    const glm::dvec3 a(v[0]->position), b(v[1]->position);
    const auto are_apart = [&](const glm::dvec3& p, const glm::dvec3& q) {
        constexpr double few_steps = 0x1p-20;
        const glm::dvec3 step = glm::abs(p - q);
        const glm::dvec3 least = few_steps * glm::max(glm::abs(a), glm::abs(b));
        return step.x > least.x || step.y > least.y || step.z > least.z;
    };
    if (!are_apart(a, b)) return false;
    // Apart by their displacement rather than on the surface: where a direction jumps at a vertex,
    // the middle of an edge to it is where its other end is, level by level, and that of an edge
    // around it where the level before has one.
    constexpr double steep = 64;
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec3 side = v[k]->point.position - v[(k + 1) % 3]->point.position;
        if (!(glm::dot(a - b, a - b) > steep * steep * glm::dot(side, side))) return true;
    }
    const glm::dvec3 middle = middle_position(t);
    const auto falls_on = [&](const glm::dvec3& p) { return !are_apart(middle, p); };
    const auto tip = [&](std::uint32_t of) {
        return glm::dvec3(samples_[mesh_.triangles()[of].vertices[2]].position);
    };
    if (falls_on(a) || falls_on(b) || falls_on(tip(t))) return false;
    for (std::uint32_t h = triangle.next[0]; h != 3 * t; h = mesh_.triangles()[h / 3].next[h % 3])
        if (h % 3 != 0 ? !can_be_halved(h / 3) : falls_on(tip(h / 3))) return false;
    return true;
}

Result<void> Refinement::take_news() {
    make_new_vertices();
    if (Result<void> range = check_range(mesh_.news().first); !range) return range;
    mesh_.take_touched(fresh_);
    return {};
}

// Heights may be beyond floats, or no numbers: refinement would have no end.
Result<void> Refinement::check_range(std::uint32_t first) const {
    for (std::size_t v = first; v < samples_.size(); ++v)
        if (!is_finite(samples_[v].position))
            return Error{ErrorCode::limit,
                         "the displacement moves a point out of the range of floats: check its "
                         "scale and its heights",
                         cage_.name.empty() ? "" : "mesh '" + cage_.name + "'"};
    return {};
}

Error Refinement::too_many() const {
    return {ErrorCode::limit,
            "what is asked for takes more than " + std::to_string(options_.triangle_limit) +
                " triangles: allow a larger error, or set a maximum of triangles",
            cage_.name.empty() ? "" : "mesh '" + cage_.name + "'"};
}

Result<void> Refinement::refine_to_error() {
    for (;;) {
        bool any = false;
        for (std::size_t k = 0; k < fresh_.size(); ++k) {
            fetch_rings_ahead(k);
            if (to_halve_[k] == 0 || !mesh_.is_there(fresh_[k])) continue;
            any = true;
            mesh_.bisect(fresh_[k].triangle);
            if (mesh_.triangles().size() > options_.triangle_limit) return too_many();
        }
        if (!any) break;
        if (Result<void> news = take_news(); !news) return news;
        measure(fresh_, Effort::looking);
    }
    // What a look decided, what nothing depended on, and what cannot be halved.
    if (!options_.chord_error && !options_.pixel_error) largest_seen_ = largest_point_error();
    fresh_.clear();
    for (std::uint32_t t = 0; t < bounds_.size(); ++t)
        if (bounds_[t].refinable == unknown || excess_[t] > 1) fresh_.push_back(mesh_.as_it_is(t));
    measure(fresh_, Effort::proving);
    return {};
}

Result<void> Refinement::refine_to_budget() {
    const bool has_goal = options_.chord_error || options_.pixel_error || options_.edge_length;
    const float goal = has_goal ? 1.0F : float(0x1p-30 * largest_coordinate_);  // rounding's
    const std::uint64_t most = *options_.max_triangles;
    struct Mark {
        Touched touched;
        float excess;
    };
    // A heap, the worst at its top; those that were halved since are among them. What is there is
    // as it was measured: once at each depth.
    std::vector<Mark> heap, batch;
    const auto is_better = [](const Mark& a, const Mark& b) {
        return a.excess != b.excess ? a.excess < b.excess : a.touched.triangle > b.touched.triangle;
    };
    const auto add_fresh = [&] {
        for (const Touched& touched : fresh_) {
            const std::uint32_t t = touched.triangle;
            if (!mesh_.is_there(touched) || !(excess_[t] > goal) || !can_be_halved(t)) continue;
            heap.push_back({touched, excess_[t]});
            std::push_heap(heap.begin(), heap.end(), is_better);
        }
    };
    add_fresh();
    // A batch is so small a part of what is left that worst-first would have taken all of it.
    constexpr std::uint64_t part = 16;
    bool full = false;
    while (!full && mesh_.triangles().size() < most) {
        const std::uint64_t left = most - mesh_.triangles().size();
        const std::uint64_t wanted = std::max<std::uint64_t>(1, left / part);
        batch.clear();
        while (batch.size() < wanted && !heap.empty()) {
            std::pop_heap(heap.begin(), heap.end(), is_better);
            if (mesh_.is_there(heap.back().touched)) batch.push_back(heap.back());
            heap.pop_back();
        }
        if (batch.empty()) return {};
        for (const Mark& mark : batch) {
            if (!mesh_.is_there(mark.touched)) continue;
            full = mesh_.triangles().size() + mesh_.cost(mark.touched.triangle) > most;
            if (full) break;
            mesh_.bisect(mark.touched.triangle);
        }
        if (Result<void> news = take_news(); !news) return news;
        measure(fresh_, Effort::proving);
        add_fresh();
    }
    return {};
}

// The box is larger than the mesh, so that few triangles and their errors reach out of it.
Result<void> Refinement::focus_screens() {
    glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
    for (std::uint32_t t = 0; t < mesh_.triangles().size(); ++t)
        for (const glm::dvec3& p : corners(mesh_.triangles()[t])) {
            low = glm::min(low, p);
            high = glm::max(high, p);
        }
    const double around = 0.25 * glm::length(high - low);
    screens_.focus(low - around, high + around);
    constexpr std::size_t most = 4096;
    if (screens_.count() <= most) return {};
    return Error{ErrorCode::limit,
                 fmt::format("{} pictures of nodes decide how fine the mesh has to be, more than "
                             "{}: ask for fewer views, or for a chord error",
                             screens_.count(), most),
                 cage_.name.empty() ? "" : "mesh '" + cage_.name + "'"};
}

// Corners that are seen, and stay: half a step of their floats is the least that can be asked for.
// With a budget refinement ends in any case.
Result<void> Refinement::check_pixels() const {
    if (options_.max_triangles) return {};
    constexpr double half_step = 0x1p-25;
    double least = 0;
    for (std::uint32_t t = 0; t < mesh_.triangles().size(); ++t)
        for (const glm::dvec3& p : corners(mesh_.triangles()[t])) {
            const glm::dvec3 size = glm::abs(p);
            const double step = half_step * std::max({size.x, size.y, size.z});
            const std::array<glm::dvec3, 3> alone{p, p, p};
            const double scale = pixels_per_unit(screens_.around(alone, 0), alone, 0);
            if (step > 0 && std::isfinite(scale)) least = std::max(least, step * scale);
        }
    if (least <= *options_.pixel_error) return {};
    return Error{ErrorCode::limit,
                 fmt::format("an error of {:.3g} pixels is finer than floats of the mesh's size "
                             "hold where it is seen: ask for at least {:.3g}",
                             *options_.pixel_error, 8 * least),
                 cage_.name.empty() ? "" : "mesh '" + cage_.name + "'"};
}

Result<void> Refinement::run() {
    start();
    constexpr double float_steps = 0x1p-22;  // over twice what rounding moves a position by
    if (options_.chord_error && *options_.chord_error < float_steps * largest_coordinate_)
        return Error{ErrorCode::limit,
                     fmt::format("an error of {:.3g} is finer than floats of the mesh's size hold: "
                                 "ask for at least {:.3g}",
                                 *options_.chord_error, 1.01 * float_steps * largest_coordinate_),
                     cage_.name.empty() ? "" : "mesh '" + cage_.name + "'"};
    if (mesh_.triangles().size() > options_.triangle_limit) return too_many();
    if (Result<void> range = check_range(0); !range) return range;
    if (options_.pixel_error) {
        if (Result<void> focused = focus_screens(); !focused) return focused;
        if (Result<void> checked = check_pixels(); !checked) return checked;
    }
    for (std::uint32_t t = 0; t < mesh_.triangles().size(); ++t)
        fresh_.push_back(mesh_.as_it_is(t));
    measure(fresh_, options_.max_triangles ? Effort::proving : Effort::looking);
    const Result<void> refined = options_.max_triangles ? refine_to_budget() : refine_to_error();
    if (!refined) return refined;
    if (!options_.chord_error && !options_.pixel_error && !options_.edge_length) return {};
    for (std::uint32_t t = 0; t < excess_.size(); ++t) {
        if (excess_[t] > 1)
            ++(can_be_halved(t) ? over_budget_ : unresolved_);
        else if (stays_long(t))
            ++unresolved_;
    }
    return {};
}

}  // namespace prep::detail
