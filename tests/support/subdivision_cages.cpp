#include "subdivision_cages.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include "prep/load.h"
#include "shapes.h"

namespace test {

namespace {

using prep::BoundaryRule;
using prep::SubdivisionScheme;
using Location = SubdivisionOracle::Location;

void bend(prep::Mesh& mesh, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    shapes::jitter(mesh, 0.2F, random);
}

Cage cage_of(std::string name, prep::Mesh mesh, prep::SubdivideOptions options = {}) {
    Cage cage{std::move(name), std::move(mesh), options};
    cage.mesh.name = cage.name;
    if (!cage.options.boundary) cage.options.boundary = BoundaryRule::edge_and_corner;
    return cage;
}

// Edges of a face, with one sharpness for each.
void crease_face(prep::Mesh& mesh, std::uint32_t face, std::initializer_list<float> sharpness) {
    const std::uint32_t first = mesh.face_offsets[face];
    const std::uint32_t n = mesh.face_offsets[face + 1] - first;
    std::uint32_t i = 0;
    for (const float s : sharpness) {
        if (s > 0)
            mesh.subdivision.creases.push_back({mesh.corner_vertices[first + i % n],
                                                mesh.corner_vertices[first + (i + 1) % n], s});
        ++i;
    }
}

Cage creased_cube(std::string name, std::initializer_list<float> top,
                  std::initializer_list<float> bottom, bool chaikin = false) {
    prep::Mesh mesh = shapes::cube();
    bend(mesh, 3);
    crease_face(mesh, 0, top);
    crease_face(mesh, 1, bottom);
    prep::SubdivideOptions options;
    if (chaikin) options.creasing = prep::CreasingMethod::chaikin;
    return cage_of(std::move(name), std::move(mesh), options);
}

// An L of five quads and a triangle: convex and concave corners, a border vertex of three faces.
prep::Mesh bent_border() {
    prep::Mesh mesh = shapes::mesh_of({{0, 0, 0},
                                       {1, 0, 0.2F},
                                       {2, 0, 0},
                                       {0, 1, 0.3F},
                                       {1, 1, 0},
                                       {2, 1, 0.4F},
                                       {0, 2, 0},
                                       {1, 2, 0.5F},
                                       {2.5F, 2.2F, 0}},
                                      {{0, 1, 4, 3}, {1, 2, 5, 4}, {3, 4, 7, 6}, {4, 5, 8}});
    return mesh;
}

void add_boundaries(std::vector<Cage>& cages) {
    for (const BoundaryRule rule :
         {BoundaryRule::none, BoundaryRule::edge_and_corner, BoundaryRule::edge_only}) {
        const std::string suffix(prep::name_of(rule));
        prep::SubdivideOptions options;
        options.boundary = rule;
        cages.push_back(cage_of("bent_border_" + suffix, bent_border(), options));
        prep::Mesh grid = shapes::grid(4, 3);
        bend(grid, 5);
        grid.subdivision.corners.push_back({7, 2.3F});
        grid.subdivision.corners.push_back({0, 1.5F});
        crease_face(grid, 5, {3.4F, 0, 0.7F});
        cages.push_back(cage_of("grid_" + suffix, std::move(grid), options));
        options.scheme = SubdivisionScheme::loop;
        prep::Mesh fan = shapes::fan_triangulated(shapes::grid(3, 3));
        bend(fan, 6);
        crease_face(fan, 7, {1.4F, 10});
        cages.push_back(cage_of("loop_grid_" + suffix, std::move(fan), options));
    }
}

void add_creases(std::vector<Cage>& cages) {
    cages.push_back(creased_cube("cube_smooth", {}, {}));
    cages.push_back(creased_cube("cube_fractional", {2.5F, 0.3F, 1, 3.7F}, {0.5F, 0.5F}));
    cages.push_back(creased_cube("cube_infinite", {10, 10, 10, 10}, {10, 10}));
    cages.push_back(creased_cube("cube_dart", {10}, {2}));
    cages.push_back(creased_cube("cube_nine_point_five", {9.5F, 7.9F}, {4.4F, 4.4F, 4.4F}));
    cages.push_back(creased_cube("cube_chaikin", {2.5F, 0.3F, 1, 3.7F}, {0.5F, 5}, true));
    Cage corners = creased_cube("cube_corners", {1.5F, 10}, {});
    corners.mesh.subdivision.corners = {{0, 10}, {3, 1.2F}, {6, 0.4F}};
    cages.push_back(std::move(corners));
    prep::SubdivideOptions loop;
    loop.scheme = SubdivisionScheme::loop;
    prep::Mesh ball = shapes::icosphere(0);
    bend(ball, 8);
    crease_face(ball, 0, {10, 10, 2.2F});
    crease_face(ball, 9, {0.6F, 10});
    ball.subdivision.corners = {{ball.corner_vertices[40], 1.7F}};
    cages.push_back(cage_of("loop_icosahedron_creased", std::move(ball), loop));
    Cage dart = cage_of("loop_dart", shapes::icosphere(0), loop);
    bend(dart.mesh, 9);
    crease_face(dart.mesh, 4, {10});
    cages.push_back(std::move(dart));
}

void add_topologies(std::vector<Cage>& cages) {
    prep::Mesh prism = shapes::cylinder(5);
    bend(prism, 10);
    cages.push_back(cage_of("pentagons", prism));
    prep::SubdivideOptions bilinear;
    bilinear.scheme = SubdivisionScheme::bilinear;
    cages.push_back(cage_of("bilinear_pentagons", prism, bilinear));
    prep::Mesh ball = shapes::uv_sphere(6, 4);
    bend(ball, 11);
    cages.push_back(cage_of("triangles", ball));
    prep::SubdivideOptions smooth;
    smooth.smooth_triangles = true;
    cages.push_back(cage_of("smooth_triangles", shapes::icosphere(0), smooth));
    bend(cages.back().mesh, 12);
    Cage hole = creased_cube("hole", {1.5F}, {});
    hole.mesh.subdivision.holes = {2};
    cages.push_back(std::move(hole));
    // Two quads back to back: every vertex has valence 2.
    prep::Mesh pillow = shapes::mesh_of({{0, 0, 0}, {1, 0, 0.3F}, {1, 1, 0}, {0, 1, 0.4F}},
                                        {{0, 1, 2, 3}, {3, 2, 1, 0}});
    cages.push_back(cage_of("valence_two", std::move(pillow)));
    for (const SubdivisionScheme scheme : {SubdivisionScheme::catmark, SubdivisionScheme::loop})
        for (const std::uint32_t valence : {3U, 16U}) cages.push_back(pole(scheme, valence));
    // Pages of two quads at a spine, of three and of four; a page that ends in its middle.
    const auto page = [](std::uint32_t a) {
        return shapes::Faces{{0, a, a + 1, 1}, {1, a + 1, a + 2, 2}};
    };
    std::mt19937_64 random(13);
    for (const std::uint32_t pages : {3U, 4U}) {
        shapes::Faces faces;
        for (std::uint32_t p = 0; p < pages; ++p)
            for (const auto& face : page(3 + 3 * p)) faces.push_back(face);
        if (pages == 4) faces.pop_back();
        std::vector<glm::vec3> points{{0, 0, 0}, {0, 0, 1}, {0, 0, 2}};
        for (std::uint32_t p = 0; p < pages; ++p)
            for (int z = 0; z < 3; ++z) {
                const double angle = 1.3 * p;
                points.emplace_back(std::cos(angle), std::sin(angle), z);
            }
        prep::Mesh book = shapes::mesh_of(points, faces);
        shapes::jitter(book, 0.1F, random);
        cages.push_back(cage_of(pages == 3 ? "spine" : "spine_half", std::move(book)));
    }
    prep::Mesh turned = shapes::grid(3, 3);
    bend(turned, 14);
    std::reverse(turned.corner_vertices.begin() + 16, turned.corner_vertices.begin() + 20);
    cages.push_back(cage_of("turned_face", std::move(turned)));
    cages.push_back(cage_of("touching_tetrahedra", shapes::bow_tie()));
    cages.push_back(cage_of("moebius", shapes::moebius(7)));
    // A face that uses a vertex twice.
    prep::Mesh folded = shapes::grid(3, 3);
    bend(folded, 15);
    folded.corner_vertices[18] = folded.corner_vertices[17];
    cages.push_back(cage_of("vertex_twice", std::move(folded)));
}

struct FeatureCorner {
    std::uint32_t face, sub_face, corner;
};
struct Features {
    std::vector<FeatureCorner> corners, edges;  // edges: from the corner to the next
};

Features features_of(const Cage& cage, const SubdivisionOracle& oracle) {
    const prep::Mesh& mesh = cage.mesh;
    const std::uint32_t regular = cage.options.scheme == SubdivisionScheme::loop ? 6 : 4;
    const auto ends = [](std::uint32_t a, std::uint32_t b) {
        return std::pair{std::min(a, b), std::max(a, b)};
    };
    std::map<std::pair<std::uint32_t, std::uint32_t>, float> creases;
    std::vector<std::uint32_t> faces(mesh.positions.size()), crease_ends(mesh.positions.size());
    for (const prep::EdgeMark& mark : mesh.subdivision.creases) {
        creases[ends(mark.v0, mark.v1)] = mark.sharpness;
        ++crease_ends[mark.v0];
        ++crease_ends[mark.v1];
    }
    for (const std::uint32_t v : mesh.corner_vertices) ++faces[v];
    std::vector<bool> special(mesh.positions.size());
    for (std::uint32_t v = 0; v < special.size(); ++v)
        special[v] = faces[v] != regular || crease_ends[v] == 1 || crease_ends[v] > 2;
    for (const prep::VertexMark& mark : mesh.subdivision.corners) special[mark.vertex] = true;
    Features found;
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
        if (oracle.is_hole(f)) continue;
        const std::uint32_t first = mesh.face_offsets[f], n = mesh.face_offsets[f + 1] - first;
        const bool split = oracle.is_split_in_quads(f);
        for (std::uint32_t i = 0; i < n; ++i) {
            const std::uint32_t v = mesh.corner_vertices[first + i];
            const std::uint32_t w = mesh.corner_vertices[first + (i + 1) % n];
            if (special[v]) found.corners.push_back({f, split ? i : 0, split ? 0 : i});
            if (split) found.corners.push_back({f, i, 2});
            const auto crease = creases.find(ends(v, w));
            if (crease != creases.end() && crease->second > 0 && crease->second < 10)
                found.edges.push_back({f, split ? i : 0, split ? 0 : i});
        }
    }
    return found;
}

}  // namespace

Cage pole(SubdivisionScheme scheme, std::uint32_t valence) {
    prep::SubdivideOptions options;
    options.scheme = scheme;
    const bool loop = scheme == SubdivisionScheme::loop;
    // A ring around the pole and one beyond, of quads or triangles; up and down a little.
    std::vector<glm::vec3> points{{0, 0, 0.4F}};
    shapes::Faces faces;
    const std::uint32_t around = loop ? valence : 2 * valence;
    for (std::uint32_t ring = 1; ring <= 3; ++ring)
        for (std::uint32_t i = 0; i < around; ++i) {
            const double angle = 2 * std::numbers::pi * i / around;
            const double height = 0.3 / ring + 0.1 * std::sin(3 * angle + ring);
            points.emplace_back(ring * std::cos(angle), ring * std::sin(angle), height);
        }
    const auto at = [&](std::uint32_t ring, std::uint32_t i) {
        return 1 + (ring - 1) * around + i % around;
    };
    for (std::uint32_t i = 0; i < around; i += loop ? 1 : 2)
        faces.push_back(loop ? std::vector{0U, at(1, i), at(1, i + 1)}
                             : std::vector{0U, at(1, i), at(1, i + 1), at(1, i + 2)});
    for (std::uint32_t ring = 1; ring < 3; ++ring)
        for (std::uint32_t i = 0; i < around; ++i) {
            if (!loop) {
                faces.push_back(
                    {at(ring, i), at(ring + 1, i), at(ring + 1, i + 1), at(ring, i + 1)});
                continue;
            }
            faces.push_back({at(ring, i), at(ring + 1, i), at(ring + 1, i + 1)});
            faces.push_back({at(ring, i), at(ring + 1, i + 1), at(ring, i + 1)});
        }
    return cage_of(std::string(loop ? "loop_" : "") + "pole_" + std::to_string(valence),
                   shapes::mesh_of(points, faces), options);
}

std::vector<Cage> own_cages() {
    std::vector<Cage> cages;
    add_creases(cages);
    add_boundaries(cages);
    add_topologies(cages);
    return cages;
}

Cage random_cage(std::mt19937_64& random) {
    const auto below = [&](std::uint64_t n) { return std::uint32_t(random() % n); };
    prep::SubdivideOptions options;
    options.scheme = SubdivisionScheme(below(3));
    options.boundary = BoundaryRule(below(3));
    options.creasing = prep::CreasingMethod(below(2));
    options.smooth_triangles = below(2) == 1;
    prep::Mesh mesh;
    switch (below(6)) {
        case 0:
            mesh = shapes::cube();
            break;
        case 1:
            mesh = shapes::grid(1 + below(4), 1 + below(4));
            break;
        case 2:
            mesh = shapes::cylinder(3 + below(5));
            break;
        case 3:
            mesh = shapes::uv_sphere(3 + below(5), 2 + below(3));
            break;
        case 4:
            mesh = shapes::moebius(3 + below(6));
            break;
        default:
            mesh = shapes::torus(3 + below(4), 3 + below(3));
            break;
    }
    if (options.scheme == SubdivisionScheme::loop || below(4) == 0)
        mesh = shapes::fan_triangulated(mesh, below(4));
    shapes::jitter(mesh, 0.3F, random);
    const auto sharpness = [&] { return below(3) == 0 ? 10.0F : float(below(1000)) / 100; };
    for (std::uint32_t k = below(8); k > 0; --k)
        crease_face(mesh, below(mesh.face_count()), {sharpness(), below(2) ? sharpness() : 0});
    for (std::uint32_t k = below(3); k > 0; --k)
        mesh.subdivision.corners.push_back({below(mesh.positions.size()), sharpness()});
    if (below(5) == 0) mesh.subdivision.holes.push_back(below(mesh.face_count()));
    if (below(6) == 0 && mesh.face_count() > 3) {  // non-manifold: two vertices made one
        const std::uint32_t a = below(mesh.positions.size()), b = below(mesh.positions.size());
        for (std::uint32_t& v : mesh.corner_vertices)
            if (v == a) v = b;
        mesh.subdivision = {};
    }
    return cage_of("random", std::move(mesh), options);
}

std::vector<std::string> corpus_cage_names(const std::filesystem::path& shared) {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(shared / "corpus" / "subdiv"))
        if (entry.path().extension() == ".obj") names.push_back(entry.path().stem().string());
    std::ranges::sort(names);
    return names;
}

Cage corpus_cage(const std::filesystem::path& shared, const std::string& name) {
    auto scene = prep::load_scene(shared / "corpus" / "subdiv" / (name + ".obj"));
    Cage cage;
    cage.name = name;
    if (!scene || scene->meshes.empty()) return cage;
    cage.mesh = std::move(scene->meshes[0]);
    if (name.starts_with("loop")) cage.options.scheme = SubdivisionScheme::loop;
    if (name.starts_with("bilinear")) cage.options.scheme = SubdivisionScheme::bilinear;
    return cage;
}

SubdivisionRules rules_of(const Cage& cage) {
    SubdivisionRules rules;
    rules.scheme = SubdivisionRules::Scheme(int(cage.options.scheme));
    rules.boundary = cage.options.boundary
                         ? SubdivisionRules::Boundary(int(*cage.options.boundary))
                         : SubdivisionRules::Boundary(cage.mesh.subdivision.interpolate_boundary);
    rules.chaikin = cage.options.creasing == prep::CreasingMethod::chaikin;
    rules.smooth_triangles =
        cage.options.smooth_triangles && cage.options.scheme == SubdivisionScheme::catmark;
    return rules;
}

std::vector<Location> random_locations(const Cage& cage, const SubdivisionOracle& oracle,
                                       std::size_t count, std::size_t near,
                                       std::mt19937_64& random) {
    const bool loop = cage.options.scheme == SubdivisionScheme::loop;
    constexpr std::uint32_t size = 1U << location_levels;
    const std::int64_t corners[4][2] = {{0, 0}, {size, 0}, {loop ? 0 : size, size}, {0, size}};
    const std::uint32_t n = loop ? 3 : 4;
    std::vector<std::uint32_t> faces;
    for (std::uint32_t f = 0; f < oracle.face_count(); ++f)
        if (!oracle.is_hole(f)) faces.push_back(f);
    std::vector<Location> out;
    if (faces.empty()) return out;
    const Features features = features_of(cage, oracle);
    const std::size_t kinds = features.corners.size() + features.edges.size();
    const auto inside = [&](std::int64_t x, std::int64_t y) {
        return x > 0 && y > 0 && x < size && y < size && x % 2 && y % 2 && (!loop || x + y < size);
    };
    while (out.size() < count) {
        Location at;
        std::int64_t x = 0, y = 0;
        if (kinds > 0 && out.size() < near) {
            const std::size_t pick = random() % kinds;
            const bool at_corner = pick < features.corners.size();
            const FeatureCorner& feature =
                at_corner ? features.corners[pick] : features.edges[pick - features.corners.size()];
            at.face = feature.face;
            at.sub_face = feature.sub_face;
            const auto* own = corners[feature.corner];
            const auto* next = corners[(feature.corner + 1) % n];
            const auto* last = corners[(feature.corner + n - 1) % n];
            const std::int64_t a = std::int64_t(random() % (at_corner ? 8 : size));
            const std::int64_t b = std::int64_t(random() % 8);
            if (at_corner && a * a + b * b > 64) continue;
            x = own[0] + (a * (next[0] - own[0]) + b * (last[0] - own[0])) / size;
            y = own[1] + (a * (next[1] - own[1]) + b * (last[1] - own[1])) / size;
        } else {
            at.face = faces[random() % faces.size()];
            if (oracle.is_split_in_quads(at.face))
                at.sub_face = std::uint32_t(random() % oracle.corner_count(at.face));
            x = std::int64_t(random() % size);
            y = std::int64_t(random() % size);
        }
        if (!inside(x, y)) continue;
        at.x = std::uint32_t(x);
        at.y = std::uint32_t(y);
        out.push_back(at);
    }
    return out;
}

prep::SurfaceLocation surface_location(const SubdivisionOracle& oracle, const Location& at,
                                       int levels) {
    const double size = double(std::uint32_t(1) << levels);
    const double u = at.x / size, v = at.y / size;
    if (!oracle.is_split_in_quads(at.face)) return {at.face, u, v};
    const std::uint32_t n = oracle.corner_count(at.face);
    const auto across = 1 + std::uint32_t(std::floor(std::sqrt(double(n - 1))));
    return {at.face, at.sub_face % across + u / 2, std::floor(at.sub_face / across) + v / 2};
}

double parameter_scale(const SubdivisionOracle& oracle, std::uint32_t face) {
    return oracle.is_split_in_quads(face) ? 0.5 : 1;
}

double angle_degrees(const glm::dvec3& a, const glm::dvec3& b) {
    return 2 * std::asin(std::min(1.0, glm::length(a - b) / 2)) * 180 / std::numbers::pi;
}

}  // namespace test
