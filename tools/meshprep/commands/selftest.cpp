#include "meshprep/commands/selftest.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <random>

#include "exact_dihedrals.h"
#include "hard_cases.h"
#include "meshprep/output/console.h"
#include "prep/prepare.h"
#include "rast/render.h"
#include "shapes.h"

namespace meshprep {
namespace {

using hard_cases::Case;
using prep::Mesh;
using prep::MeshView;
using prep::NormalWeight;
using prep::Precision;

constexpr double degrees_per_radian = 180 / std::numbers::pi;
// Half an ulp below one in each component of a unit vector.
constexpr double rounding = std::numbers::sqrt3 * 0x1p-25;

prep::CornerNormals normals_of(const Mesh& mesh, NormalWeight weight, Precision precision,
                               int threads) {
    const MeshView view(mesh);
    const prep::Topology topology = prep::build_topology(view, {}, threads);
    const prep::FaceNormals faces = prep::face_normals(view, precision, threads);
    prep::HardEdgeOptions edges;
    edges.angle_degrees.reset();
    edges.threads = threads;
    const auto hard = prep::hard_edges(view, topology, faces, edges);
    prep::NormalOptions options;
    options.weight = weight;
    options.precision = precision;
    options.keep_doubles = true;
    options.threads = threads;
    return *prep::corner_normals(view, topology, faces, *hard, options);
}

double angle_between(const glm::dvec3& a, const glm::dvec3& b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * degrees_per_radian;
}

bool unit(const glm::vec3& v) {
    return std::abs(glm::length(glm::dvec3(v)) - 1) < 1e-6;
}

bool all_finite(const Mesh& mesh) {
    return std::all_of(mesh.positions.begin(), mesh.positions.end(), [](const glm::vec3& p) {
        return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
    });
}

SelftestCase check_case(const Case& c, int threads) {
    SelftestCase result;
    result.name = c.axis;
    result.value = c.value;
    result.ok = true;
    const bool finite = all_finite(c.mesh);
    for (const NormalWeight weight : {NormalWeight::area, NormalWeight::angle}) {
        const auto truth = normals_of(c.mesh, weight, Precision::exact, threads);
        std::vector<char> flagged(c.mesh.corner_count());
        for (const auto& f : truth.fallbacks) flagged[f.corner] = 1;
        std::vector<std::uint32_t> first(truth.doubles.size(), prep::no_index);
        for (std::uint32_t k = 0; k < c.mesh.corner_count(); ++k) {
            std::uint32_t& corner = first[truth.normals.indices[k]];
            corner = std::min(corner, k);
        }
        result.fans = truth.doubles.size();
        result.flagged = truth.fallbacks.size();
        for (const Precision precision : {Precision::fast, Precision::accurate}) {
            const auto ours = normals_of(c.mesh, weight, precision, threads);
            result.ok = result.ok && ours.normals.indices == truth.normals.indices &&
                        ours.fallbacks.size() == truth.fallbacks.size();
            if (!result.ok) return result;
            const bool fast = precision == Precision::fast;
            double& worst = fast ? result.fast : result.accurate;
            for (std::size_t i = 0; i < first.size(); ++i) {
                result.ok = result.ok && unit(ours.normals.values[i]);
                if (flagged[first[i]]) continue;
                const double error = angle_between(truth.doubles[i], ours.doubles[i]);
                const double rounded =
                    angle_between(truth.doubles[i], glm::dvec3(ours.normals.values[i]));
                result.ok = result.ok && error >= 0 && rounded >= 0;  // NaN is neither
                worst = std::max(worst, error);
                if (!fast) result.rounded = std::max(result.rounded, rounded);
            }
            for (std::size_t i = 0; i < ours.fallbacks.size(); ++i)
                result.ok = result.ok && flagged[ours.fallbacks[i].corner];
        }
    }
    result.ok = result.ok && (!finite || (result.fast <= selftest_fast_bound() &&
                                          result.accurate <= selftest_accurate_bound() &&
                                          result.rounded <= selftest_rounded_bound()));
    return result;
}

SelftestCheck dihedrals(int threads) {
    SelftestCheck check{"dihedrals exactly at the threshold, turned and scaled", "decisions"};
    std::mt19937_64 random(81);
    std::uniform_int_distribution<int> shift(-90, 80);
    for (const hard_cases::ExactAngle& angle : hard_cases::exact_angles()) {
        const Mesh pairs = hard_cases::exact_dihedrals(angle, 143, random);
        for (int turn = 0; turn < 10; ++turn) {
            Mesh mesh = pairs;
            const glm::dmat3 rotation = hard_cases::exact_rotation(25, random);
            if (!hard_cases::transform_exactly(mesh, rotation, shift(random))) {
                ++check.wrong;  // the cases are made to stay exact
                continue;
            }
            const MeshView view(mesh);
            const prep::Topology topology = prep::build_topology(view, {}, threads);
            prep::HardEdgeOptions options;
            options.threads = threads;
            for (const Precision p : {Precision::fast, Precision::accurate}) {
                const prep::FaceNormals faces = prep::face_normals(view, p, threads);
                options.angle_degrees = angle.degrees;
                check.wrong += prep::hard_edges(view, topology, faces, options)->hard_count;
                options.angle_degrees = angle.degrees - 1e-7;
                check.wrong += mesh.face_count() / 2 -
                               prep::hard_edges(view, topology, faces, options)->hard_count;
                check.tried += mesh.face_count();
            }
        }
    }
    return check;
}

SelftestCheck orders(int threads) {
    SelftestCheck check{"faces and vertices in another order", "normals"};
    std::mt19937_64 random(82);
    for (int i = 0; i < 10; ++i) {
        Mesh mesh = shapes::torus(24, 12);
        shapes::jitter(mesh, 0.1f, random);
        const auto order = shapes::random_order(mesh.face_count(), random);
        const auto numbers = shapes::random_order(mesh.vertex_count(), random);
        const Mesh other = shapes::with_vertex_order(shapes::with_face_order(mesh, order), numbers);
        const auto a = normals_of(mesh, NormalWeight::angle, Precision::accurate, threads).normals;
        const auto b = normals_of(other, NormalWeight::angle, Precision::accurate, threads).normals;
        for (std::uint32_t f = 0; f < order.size(); ++f)
            for (std::uint32_t k = 0; k < 4; ++k) {
                ++check.tried;
                check.wrong +=
                    a.values[a.indices[4 * order[f] + k]] != b.values[b.indices[4 * f + k]];
            }
    }
    return check;
}

template <class T>
std::uint64_t differing(const std::vector<T>& a, const std::vector<T>& b) {
    if (a.size() != b.size()) return 1;
    std::uint64_t count = 0;
    for (std::size_t i = 0; i < a.size(); ++i) count += std::memcmp(&a[i], &b[i], sizeof(T)) != 0;
    return count;
}

// Bytes of the prepared mesh and of its picture that depend on threads or instructions.
void sameness(SelftestCheck& threads_check, SelftestCheck& simd_check) {
    std::mt19937_64 random(83);
    Case c{"", 0, shapes::torus(200, 100)};
    shapes::jitter(c.mesh, 0.01f, random);
    c.mesh = hard_cases::with_uvs(std::move(c.mesh));
    struct Outcome {
        prep::VertexMesh mesh;
        rast::Frame frame;
    };
    const auto run = [&](int threads, prep::SimdLevel simd) {
        prep::PrepareOptions options;
        options.threads = threads;
        options.tangent.simd = simd;
        options.request.tangents = prep::Request::Level::always;
        const prep::PreparedScene scene = *prep::prepare(hard_cases::scene_of(c), options);
        rast::RenderRequest request;
        request.width = 320;
        request.height = 240;
        request.samples = 4;
        request.threads = threads;
        request.simd = simd;
        return Outcome{scene.meshes[0], *rast::render(scene, *rast::plan(scene, request))};
    };
    const auto compare = [](const Outcome& a, const Outcome& b, SelftestCheck& check) {
        check.tried += a.mesh.vertex_count() + a.frame.color.size();
        check.wrong += differing(a.mesh.normals, b.mesh.normals) +
                       differing(a.mesh.tangents, b.mesh.tangents) +
                       differing(a.mesh.indices, b.mesh.indices) +
                       differing(a.frame.color, b.frame.color);
    };
    const Outcome one = run(1, prep::SimdLevel::scalar);
    for (const int threads : {2, 8})
        compare(one, run(threads, prep::SimdLevel::scalar), threads_check);
    for (const prep::SimdLevel simd :
         {prep::SimdLevel::sse4, prep::SimdLevel::avx2, prep::SimdLevel::avx512})
        if (prep::simd_available(simd)) compare(one, run(1, simd), simd_check);
}

// Tangent frames and a small picture of one case.
void shade(const Case& c, int threads, SelftestCheck& frames, SelftestCheck& pixels,
           SelftestCheck& triangles) {
    Case with = c;
    with.mesh = hard_cases::with_uvs(std::move(with.mesh));
    prep::PrepareOptions options;
    options.threads = threads;
    options.request.tangents = prep::Request::Level::always;
    const auto scene = prep::prepare(hard_cases::scene_of(with), options);
    if (!scene) {
        ++frames.wrong;
        return;
    }
    const prep::VertexMesh& mesh = scene->meshes[0];
    frames.wrong += mesh.triangle_count() > 0 && mesh.tangents.size() != mesh.vertex_count();
    for (std::size_t v = 0; v < mesh.tangents.size(); ++v) {
        const glm::vec3 t(mesh.tangents[v]);
        const double lean = glm::dot(glm::dvec3(mesh.normals[v]), glm::dvec3(t));
        ++frames.tried;
        frames.wrong += !unit(t) || !unit(mesh.normals[v]) || !(std::abs(lean) < 1e-6);
    }
    rast::RenderRequest request;
    request.width = request.height = 64;
    request.threads = threads;
    const auto plan = rast::plan(*scene, request);
    const auto frame = plan ? rast::render(*scene, *plan) : prep::Result<rast::Frame>(plan.error());
    if (!frame) {
        ++pixels.wrong;
        return;
    }
    for (const glm::vec4& p : frame->color) {
        ++pixels.tried;
        pixels.wrong += !std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z);
    }
    const std::uint64_t expected = mesh.triangle_count(), counted = frame->counters.triangles;
    triangles.tried += expected;
    triangles.wrong += counted > expected ? counted - expected : expected - counted;
}

}  // namespace

bool Selftest::ok() const {
    return std::all_of(cases.begin(), cases.end(), [](const auto& c) { return c.ok; }) &&
           std::all_of(checks.begin(), checks.end(),
                       [](const auto& c) { return c.wrong == 0 && c.tried > 0; });
}

double selftest_fast_bound() {
    return prep::fast_normal_error * degrees_per_radian;
}
double selftest_accurate_bound() {
    return prep::accurate_normal_error * degrees_per_radian;
}
double selftest_rounded_bound() {
    return (prep::accurate_normal_error + rounding) * degrees_per_radian;
}

Selftest selftest(int threads) {
    const Clock::time_point start = Clock::now();
    Selftest result;
    SelftestCheck frames{"tangents unit and orthogonal to unit normals", "vertices"},
        pixels{"pictures without NaN and infinity", "pixels"},
        triangles{"every triangle of a picture counted", "triangles"};
    std::vector<Case> cases = hard_cases::measured(), odd = hard_cases::odd();
    std::move(odd.begin(), odd.end(), std::back_inserter(cases));
    for (const Case& c : cases) {
        // Cases of attributes and transforms say nothing about normals; exact arithmetic takes
        // seconds beyond.
        const bool of_shape = c.axis.find(':') == std::string::npos && c.mesh.face_count() > 0;
        if (of_shape && c.mesh.corner_count() <= 4000)
            result.cases.push_back(check_case(c, threads));
        shade(c, threads, frames, pixels, triangles);
    }
    SelftestCheck thread_check{"the same bytes on 1, 2 and 8 threads", "vertices and pixels"},
        simd_check{"the same bytes on every instruction set", "vertices and pixels"};
    sameness(thread_check, simd_check);
    result.checks = {dihedrals(threads), orders(threads), thread_check, frames, pixels, triangles};
    if (simd_check.tried > 0) result.checks.push_back(simd_check);  // where there are vectors
    result.milliseconds = milliseconds_since(start);
    return result;
}

}  // namespace meshprep
