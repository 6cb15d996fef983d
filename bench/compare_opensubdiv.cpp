// Subdivision beside OpenSubdiv, in one process and one run.
//
//   compare_opensubdiv limits CAGE.obj RATE        limit points with derivatives beside Bfr's
//   compare_opensubdiv mesh CAGE.obj LEVEL         refined mesh beside Far's PrimvarRefiner
//   compare_opensubdiv growth CAGE.obj LEVEL       levels up to this one: time and peak memory
//
// `limits`: the grid of each face (quads: (RATE + 1)² points). Bfr's error is its largest
// difference from ours at odd multiples of 2^-9 (ours is judged by the tests' oracle, and here by
// Bfr at level 10); the level at which it is rounding alone is found from 2 upwards, and its time
// is that level's: surfaces made, control points prepared, every point evaluated; on one thread,
// and faces shared between two. `mesh`: positions, normals by limit tangents and first UV set, from
// a loaded cage to arrays; one thread and two. `growth`: each level in a process of its own, on two
// threads. All times are medians: those of one thread the processor's, those of two the clock's,
// for which the machine must be idle.
#include <opensubdiv/bfr/refinerSurfaceFactory.h>
#include <opensubdiv/bfr/surface.h>
#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "prep/load.h"
#include "prep/subdivide.h"

namespace {

using namespace OpenSubdiv;
using Clock = std::chrono::steady_clock;

// The median of some runs. What runs on one thread is measured by the processor's time, which other
// programs of a busy machine do not lengthen as they do the clock's.
template <class Work>
double median_seconds(int runs, bool one_thread, const Work& work) {
    std::vector<double> times;
    for (int i = 0; i < runs; ++i) {
        const Clock::time_point start = Clock::now();
        const std::clock_t used = std::clock();
        work();
        times.push_back(one_thread ? double(std::clock() - used) / CLOCKS_PER_SEC
                                   : std::chrono::duration<double>(Clock::now() - start).count());
    }
    std::sort(times.begin(), times.end());
    return times[times.size() / 2];
}

// Two works in turn: medians of both times, and of the ratios of runs that follow each other, which
// what else the machine does disturbs least.
struct Comparison {
    double ours = 0, theirs = 0, ratio = 0;
};
template <class Ours, class Theirs>
Comparison compare(int runs, bool one_thread, const Ours& ours, const Theirs& theirs) {
    std::vector<Comparison> all;
    for (int i = 0; i < runs; ++i) {
        Comparison c;
        c.ours = median_seconds(1, one_thread, ours);
        c.theirs = median_seconds(1, one_thread, theirs);
        c.ratio = c.theirs / c.ours;
        all.push_back(c);
    }
    const auto median = [&](double Comparison::*member) {
        std::vector<double> values;
        for (const Comparison& c : all) values.push_back(c.*member);
        std::sort(values.begin(), values.end());
        return values[values.size() / 2];
    };
    return {median(&Comparison::ours), median(&Comparison::theirs), median(&Comparison::ratio)};
}

std::unique_ptr<Far::TopologyRefiner> refiner_of(const prep::Mesh& mesh) {
    Sdc::Options options;
    options.SetVtxBoundaryInterpolation(
        mesh.subdivision.interpolate_boundary == 0   ? Sdc::Options::VTX_BOUNDARY_NONE
        : mesh.subdivision.interpolate_boundary == 2 ? Sdc::Options::VTX_BOUNDARY_EDGE_ONLY
                                                     : Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER);
    options.SetFVarLinearInterpolation(Sdc::Options::FVAR_LINEAR_CORNERS_ONLY);
    std::vector<int> counts, corners(mesh.corner_vertices.begin(), mesh.corner_vertices.end());
    for (std::size_t f = 0; f < mesh.face_count(); ++f)
        counts.push_back(int(mesh.face_offsets[f + 1] - mesh.face_offsets[f]));
    std::vector<int> edges;
    std::vector<float> sharpness;
    for (const prep::EdgeMark& mark : mesh.subdivision.creases) {
        edges.insert(edges.end(), {int(mark.v0), int(mark.v1)});
        sharpness.push_back(mark.sharpness);
    }
    Far::TopologyDescriptor d;
    d.numVertices = int(mesh.vertex_count());
    d.numFaces = int(mesh.face_count());
    d.numVertsPerFace = counts.data();
    d.vertIndicesPerFace = corners.data();
    d.numCreases = int(sharpness.size());
    d.creaseVertexIndexPairs = edges.data();
    d.creaseWeights = sharpness.data();
    std::vector<int> uv_indices;
    Far::TopologyDescriptor::FVarChannel channel;
    if (!mesh.uvs.empty()) {
        uv_indices.assign(mesh.uvs[0].indices.begin(), mesh.uvs[0].indices.end());
        channel.numValues = int(mesh.uvs[0].values.size());
        channel.valueIndices = uv_indices.data();
        d.numFVarChannels = 1;
        d.fvarChannels = &channel;
    }
    using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
    return std::unique_ptr<Far::TopologyRefiner>(
        Factory::Create(d, Factory::Options(Sdc::SCHEME_CATMARK, options)));
}

// As LimitSurface's grids.
struct Grids {
    std::vector<glm::dvec3> positions, du, dv;
};

// What is measured is written in blocks of so many faces, into the same memory again and again, as
// a consumer would read it: the time of fresh pages is nobody's.
constexpr std::size_t block_quads = 1024;

using BfrFactory = Bfr::RefinerSurfaceFactory<>;

void bfr_faces(const BfrFactory& factory, const std::vector<double>& points, int rate, int first,
               int end, bool in_blocks, Grids& out) {
    std::vector<double> patch;
    Bfr::Surface<double> surface;
    for (int f = first; f < end; ++f) {
        if (in_blocks && f % int(block_quads) == 0)
            for (auto* values : {&out.positions, &out.du, &out.dv}) values->clear();
        if (!factory.InitVertexSurface(f, &surface)) continue;
        patch.resize(std::size_t(surface.GetNumPatchPoints()) * 3);
        surface.PreparePatchPoints(points.data(), 3, patch.data(), 3);
        const Bfr::Parameterization parameters = surface.GetParameterization();
        const int quads = parameters.HasSubFaces() ? parameters.GetFaceSize() : 1;
        const double scale = parameters.HasSubFaces() ? 0.5 : 1;
        for (int quad = 0; quad < quads; ++quad)
            for (int j = 0; j <= rate; ++j)
                for (int i = 0; i <= rate; ++i) {
                    const double own[2] = {double(i) / rate, double(j) / rate};
                    double uv[2] = {own[0], own[1]};
                    if (parameters.HasSubFaces())
                        parameters.ConvertNormalizedSubFaceToCoord(quad, own, uv);
                    glm::dvec3 p, du, dv;
                    surface.Evaluate(uv, patch.data(), 3, &p.x, &du.x, &dv.x);
                    out.positions.push_back(p);
                    out.du.push_back(du * scale);
                    out.dv.push_back(dv * scale);
                }
    }
}

Grids bfr_grids(const prep::Mesh& mesh, int rate, int level, int threads, bool in_blocks = false) {
    const auto refiner = refiner_of(mesh);
    BfrFactory::Options options;
    options.SetApproxLevelSmooth(level);
    options.SetApproxLevelSharp(level);
    const BfrFactory factory(*refiner, options);
    std::vector<double> points;
    for (const glm::vec3& p : mesh.positions)
        points.insert(points.end(), {double(p.x), double(p.y), double(p.z)});
    // Room for the grids that there will be, as for ours.
    const int faces = int(mesh.face_count());
    std::vector<Grids> parts(static_cast<std::size_t>(threads));
    std::vector<std::thread> others;
    const auto part = [&](int t) {
        const int first = faces * t / threads, end = faces * (t + 1) / threads;
        std::size_t quads = 0;
        for (int f = first; f < end; ++f) {
            const std::size_t size =
                mesh.face_offsets[std::size_t(f) + 1] - mesh.face_offsets[std::size_t(f)];
            quads += size == 4 ? 1 : size;
        }
        Grids& out = parts[std::size_t(t)];
        for (auto* values : {&out.positions, &out.du, &out.dv})
            values->reserve(std::min(quads, in_blocks ? 2 * block_quads : quads) *
                            std::size_t((rate + 1) * (rate + 1)));
        bfr_faces(factory, points, rate, first, end, in_blocks, out);
    };
    for (int t = 1; t < threads; ++t) others.emplace_back(part, t);
    part(0);
    for (std::thread& thread : others) thread.join();
    return std::move(parts[0]);  // all of them where there is one thread
}

prep::LimitSurface our_surface(const prep::Mesh& mesh, int threads) {
    prep::SubdivideOptions options;
    options.threads = threads;
    auto surface = prep::LimitSurface::make(mesh, options);
    if (!surface) {
        std::fprintf(stderr, "%s\n", to_string(surface.error()).c_str());
        std::exit(1);
    }
    return *std::move(surface);
}

Grids our_grids(const prep::Mesh& mesh, int rate, int threads) {
    const prep::LimitSurface made = our_surface(mesh, threads), *surface = &made;
    const std::size_t count = surface->grid_count() * surface->grid_size(rate);
    Grids out{std::vector<glm::dvec3>(count), std::vector<glm::dvec3>(count),
              std::vector<glm::dvec3>(count)};
    surface->evaluate_grids(rate, 0, surface->grid_count(), {out.positions, out.du, out.dv});
    return out;
}

// Places at odd multiples of 2^-9 in each quad, where Bfr's pieces end nowhere: at the points of a
// coarse grid its end caps look exact.
std::vector<prep::SurfaceLocation> odd_locations(const prep::Mesh& mesh) {
    std::vector<prep::SurfaceLocation> places;
    std::uint32_t random = 1;
    const auto odd = [&] {
        random = random * 1664525U + 1013904223U;
        return double((random >> 23) | 1U) / 512;
    };
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
        for (int k = 0; mesh.face_offsets[f + 1] - mesh.face_offsets[f] == 4 && k < 8; ++k) {
            // Half of them close to a corner.
            const double near = k % 2 == 0 ? 1 : 1.0 / 16;
            places.push_back({f, near * odd(), near * odd()});
        }
    return places;
}
double bfr_error(const prep::Mesh& mesh, int level,
                 const std::vector<prep::SurfaceLocation>& places,
                 const std::vector<prep::SurfacePoint>& truth) {
    const auto refiner = refiner_of(mesh);
    BfrFactory::Options options;
    options.SetApproxLevelSmooth(level);
    options.SetApproxLevelSharp(level);
    const BfrFactory factory(*refiner, options);
    std::vector<double> points, patch;
    for (const glm::vec3& p : mesh.positions)
        points.insert(points.end(), {double(p.x), double(p.y), double(p.z)});
    Bfr::Surface<double> surface;
    double worst = 0;
    for (std::size_t k = 0; k < places.size(); ++k) {
        if (k == 0 || places[k].face != places[k - 1].face) {
            factory.InitVertexSurface(int(places[k].face), &surface);
            if (!surface.IsValid()) continue;
            patch.resize(std::size_t(surface.GetNumPatchPoints()) * 3);
            surface.PreparePatchPoints(points.data(), 3, patch.data(), 3);
        }
        if (!surface.IsValid()) continue;
        const double uv[2] = {places[k].u, places[k].v};
        glm::dvec3 p;
        surface.Evaluate(uv, patch.data(), 3, &p.x);
        worst = std::max(worst, glm::length(p - truth[k].position));
    }
    return worst;
}

// As our_grids, for the clock: in blocks, into the same memory again and again.
void time_our_grids(const prep::Mesh& mesh, int rate, int threads) {
    const prep::LimitSurface surface = our_surface(mesh, threads);
    const std::size_t size = surface.grid_size(rate), most = block_quads * size;
    Grids out{std::vector<glm::dvec3>(most), std::vector<glm::dvec3>(most),
              std::vector<glm::dvec3>(most)};
    for (std::size_t first = 0; first < surface.grid_count(); first += block_quads) {
        const std::size_t count = std::min(block_quads, surface.grid_count() - first);
        const auto part = [&](std::vector<glm::dvec3>& values) {
            return std::span(values).first(count * size);
        };
        surface.evaluate_grids(rate, first, count,
                               {part(out.positions), part(out.du), part(out.dv)});
    }
}

double largest_difference(const std::vector<glm::dvec3>& a, const std::vector<glm::dvec3>& b) {
    if (a.size() != b.size()) return 1e300;
    double worst = 0;
    for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, glm::length(a[i] - b[i]));
    return worst;
}

int compare_limits(const prep::Mesh& mesh, int rate) {
    glm::dvec3 low(1e300), high(-1e300);
    for (const glm::vec3& p : mesh.positions) {
        low = glm::min(low, glm::dvec3(p));
        high = glm::max(high, glm::dvec3(p));
    }
    const double diagonal = glm::length(high - low);
    const Grids truth = bfr_grids(mesh, rate, 10, 1);
    const auto places = odd_locations(mesh);
    std::vector<prep::SurfacePoint> exact(places.size());
    our_surface(mesh, 1).evaluate(places, exact);
    const Grids ours = our_grids(mesh, rate, 1);
    const double own_error = largest_difference(ours.positions, truth.positions) / diagonal;
    std::printf(
        "%zu points of rate %d; ours differ from Bfr's at level 10 by %.1e of the diagonal\n",
        ours.positions.size(), rate, own_error);
    const double points = double(ours.positions.size());
    const double make = median_seconds(5, true, [&] { our_surface(mesh, 1); });
    std::printf("ours: %.1f ms to make the surface\n", make * 1e3);
    for (int level = 2; level <= 10; level += 2) {
        const double error = bfr_error(mesh, level, places, exact) / diagonal;
        const Comparison one = compare(
            7, true, [&] { time_our_grids(mesh, rate, 1); },
            [&] { bfr_grids(mesh, rate, level, 1, true); });
        const Comparison two = compare(
            7, false, [&] { time_our_grids(mesh, rate, 2); },
            [&] { bfr_grids(mesh, rate, level, 2, true); });
        std::printf(
            "Bfr, level %2d: error %.1e; ns a point, one thread: %6.1f, ours %6.1f (%.2f x); two: "
            "%6.1f, ours %6.1f (%.2f x)\n",
            level, error, one.theirs / points * 1e9, one.ours / points * 1e9, one.ratio,
            two.theirs / points * 1e9, two.ours / points * 1e9, two.ratio);
    }
    return 0;
}

template <int Size, class Real>
struct Value {
    std::array<Real, Size> v{};
    void Clear(void* = nullptr) { v = {}; }
    void AddWithWeight(const Value& other, Real weight) {
        for (std::size_t i = 0; i < Size; ++i) v[i] += weight * other.v[i];
    }
};

// Positions on the limit, unit normals from limit tangents, UVs and faces: what a mesh needs.
std::size_t far_mesh(const prep::Mesh& mesh, int level) {
    const auto refiner = refiner_of(mesh);
    Far::TopologyRefiner::UniformOptions options(level);
    options.fullTopologyInLastLevel = true;
    refiner->RefineUniform(options);
    const Far::PrimvarRefinerReal<float> primvar(*refiner);
    using Point = Value<3, float>;
    using Uv = Value<2, float>;
    std::vector<Point> points(mesh.vertex_count());
    for (std::size_t v = 0; v < points.size(); ++v)
        points[v].v = {mesh.positions[v].x, mesh.positions[v].y, mesh.positions[v].z};
    std::vector<Uv> uvs;
    if (!mesh.uvs.empty())
        for (const glm::vec2& uv : mesh.uvs[0].values) uvs.push_back({{uv.x, uv.y}});
    for (int l = 1; l <= level; ++l) {
        std::vector<Point> next(std::size_t(refiner->GetLevel(l).GetNumVertices()));
        primvar.Interpolate(l, points, next);
        points = std::move(next);
        if (mesh.uvs.empty()) continue;
        std::vector<Uv> next_uvs(std::size_t(refiner->GetLevel(l).GetNumFVarValues(0)));
        primvar.InterpolateFaceVarying(l, uvs, next_uvs, 0);
        uvs = std::move(next_uvs);
    }
    std::vector<Point> limits(points.size()), tangents(points.size()), other(points.size());
    primvar.Limit(points, limits, tangents, other);
    std::vector<glm::vec3> normals(points.size());
    for (std::size_t v = 0; v < normals.size(); ++v) {
        const auto &a = tangents[v].v, &b = other[v].v;
        const glm::vec3 n = glm::cross(glm::vec3(a[0], a[1], a[2]), glm::vec3(b[0], b[1], b[2]));
        const float length = glm::length(n);
        normals[v] = length > 0 ? n / length : glm::vec3(0, 0, 1);
    }
    std::vector<Uv> limit_uvs(uvs.size());
    if (!uvs.empty()) primvar.LimitFaceVarying(uvs, limit_uvs, 0);
    const Far::TopologyLevel& last = refiner->GetLevel(level);
    std::vector<int> corners, uv_corners;
    corners.reserve(std::size_t(last.GetNumFaceVertices()));
    if (!uvs.empty()) uv_corners.reserve(std::size_t(last.GetNumFaceVertices()));
    for (int f = 0; f < last.GetNumFaces(); ++f) {
        const Far::ConstIndexArray vertices = last.GetFaceVertices(f);
        corners.insert(corners.end(), vertices.begin(), vertices.end());
        if (uvs.empty()) continue;
        const Far::ConstIndexArray values = last.GetFaceFVarValues(f, 0);
        uv_corners.insert(uv_corners.end(), values.begin(), values.end());
    }
    return corners.size() + uv_corners.size() + normals.size();
}

std::size_t our_mesh(const prep::Mesh& mesh, int level, int threads) {
    prep::SubdivideOptions options;
    options.level = level;
    options.threads = threads;
    options.face_varying = prep::FaceVaryingRule::corners_only;
    const auto refined = prep::subdivide(mesh, options);
    if (!refined) {
        std::fprintf(stderr, "%s\n", to_string(refined.error()).c_str());
        std::exit(1);
    }
    return refined->mesh.face_count();
}

int compare_mesh(const prep::Mesh& mesh, int level) {
    std::size_t faces = 0;
    const Comparison one = compare(
        7, true, [&] { faces = our_mesh(mesh, level, 1); }, [&] { far_mesh(mesh, level); });
    const Comparison two = compare(
        7, false, [&] { our_mesh(mesh, level, 2); }, [&] { far_mesh(mesh, level); });
    std::printf(
        "level %d, %zu faces: Far %.2f s; ours %.2f s on one thread (%.2f x), %.2f s on two (%.2f "
        "x)\n",
        level, faces, one.theirs, one.ours, one.ratio, two.ours, two.ratio);
    return 0;
}

// Forked before anything is loaded: what a process has once used, its later peaks contain.
int measure_growth(const std::string& cage, int last) {
    std::printf("level    triangles        s  ns a triangle  peak MiB  bytes a triangle\n");
    for (int level = std::max(0, last - 3); level <= last; ++level) {
        std::fflush(stdout);
        const pid_t child = fork();
        if (child < 0) return 1;
        if (child == 0) {
            const auto scene = prep::load_scene(cage);
            if (!scene || scene->meshes.empty()) _exit(1);
            std::size_t faces = 0;
            const double time =
                median_seconds(3, false, [&] { faces = our_mesh(scene->meshes[0], level, 2); });
            rusage used{};
            getrusage(RUSAGE_SELF, &used);
            const double triangles = 2 * double(faces), kibibytes = double(used.ru_maxrss);
            std::printf("%5d  %11.0f  %7.2f  %13.1f  %8.0f  %16.0f\n", level, triangles, time,
                        time / triangles * 1e9, kibibytes / 1024, kibibytes * 1024 / triangles);
            std::fflush(stdout);
            _exit(0);
        }
        int status = 0;
        waitpid(child, &status, 0);
        if (status != 0) return 1;
    }
    return 0;
}

}  // namespace

int main(int count, char** arguments) {
    const std::vector<std::string> words(arguments, arguments + count);
    if (count != 4 || (words[1] != "limits" && words[1] != "mesh" && words[1] != "growth")) {
        std::fprintf(stderr, "usage: compare_opensubdiv limits|mesh|growth CAGE.obj RATE|LEVEL\n");
        return 2;
    }
    const int number = std::atoi(words[3].c_str());
    if (words[1] == "growth") return measure_growth(words[2], number);
    const auto scene = prep::load_scene(words[2]);
    if (!scene || scene->meshes.empty()) {
        std::fprintf(stderr, "%s\n", scene ? "no mesh" : to_string(scene.error()).c_str());
        return 1;
    }
    return words[1] == "limits" ? compare_limits(scene->meshes[0], number)
                                : compare_mesh(scene->meshes[0], number);
}
