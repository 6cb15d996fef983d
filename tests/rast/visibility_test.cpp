// What is visible, against rays cast by Embree: surfaces that sweep through the near plane and
// through the eye.
#include <embree3/rtcore.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/gtc/quaternion.hpp>

#include "oracles.h"
#include "shapes.h"

namespace {

using namespace test;

constexpr std::uint32_t width = 96, height = 72;

// Pixels. A snapped corner moves by up to √2/512 = 0.0028, and with it the edges and the depth
// inside them; within this distance of an edge nothing is claimed.
constexpr double off_edges = 1.0 / 128;

// A mesh about the eye, in view space, as Embree sees it.
class Rays {
  public:
    explicit Rays(const prep::VertexMesh& mesh)
        : device_(rtcNewDevice("threads=1,set_affinity=0")), scene_(rtcNewScene(device_)) {
        rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
        RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        auto* points = static_cast<float*>(
            rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                    3 * sizeof(float), mesh.positions.size()));
        for (const glm::vec3& p : mesh.positions)
            for (int k = 0; k < 3; ++k) *points++ = p[k];
        auto* indices = static_cast<std::uint32_t*>(
            rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                    3 * sizeof(std::uint32_t), mesh.indices.size() / 3));
        std::copy(mesh.indices.begin(), mesh.indices.end(), indices);
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene_, geometry);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(scene_);
    }
    ~Rays() {
        rtcReleaseScene(scene_);
        rtcReleaseDevice(device_);
    }
    Rays(const Rays&) = delete;
    Rays& operator=(const Rays&) = delete;

    // The triangle seen through a point of the picture, between the near plane and the far one. The
    // eye is at the origin and looks along −z.
    std::uint32_t cast(const rast::View& view, double x, double y) const {
        const Ray ray = ray_at(view, width, height, x, y);
        RTCRayHit query{};
        query.ray.org_x = float(ray.from.x);
        query.ray.org_y = float(ray.from.y);
        query.ray.dir_x = float(ray.direction.x);
        query.ray.dir_y = float(ray.direction.y);
        query.ray.dir_z = -1;
        query.ray.tnear = float(view.znear);
        query.ray.tfar = view.zfar > 0 ? float(view.zfar) : INFINITY;
        query.ray.mask = ~0u;
        query.hit.geomID = query.hit.primID = RTC_INVALID_GEOMETRY_ID;
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        rtcIntersect1(scene_, &context, &query);
        return query.hit.geomID == RTC_INVALID_GEOMETRY_ID ? prep::no_index : query.hit.primID;
    }

  private:
    RTCDevice device_;
    RTCScene scene_;
};

struct Tally {
    std::size_t compared = 0, near_edges = 0, wrong = 0, depth_wrong = 0, not_finite = 0;
    std::uint64_t crossing = 0;
    std::size_t empty = 0;
};

rast::Frame draw_all(const prep::VertexMesh& mesh, const rast::View& view) {
    prep::Material material = white();
    material.double_sided = true;
    rast::RenderRequest request;
    request.width = width;
    request.height = height;
    request.view = view;
    request.shading = Shading::flat;
    request.keep_depth = request.keep_ids = request.keep_normals = true;
    request.keep_barycentrics = request.keep_positions = true;
    return test::draw(test::scene_of(mesh, material), request);
}

// Whether the triangle has an edge this close to a point of the picture, in double: slivers slip
// through between rays around the point.
bool near_edge(const prep::VertexMesh& mesh, std::uint32_t triangle, const rast::View& view,
               double x, double y) {
    if (triangle == prep::no_index) return false;
    const Ray ray = ray_at(view, width, height, x, y);
    // In an orthographic view the eye moves along with the point.
    const double pixel =
        2 * (view.perspective ? std::tan(view.yfov / 2) : view.half_height) / height;
    for (std::uint32_t k = 0; k < 3; ++k) {
        const glm::dvec3 a(mesh.positions[mesh.indices[3 * triangle + k]]);
        const glm::dvec3 b(mesh.positions[mesh.indices[3 * triangle + (k + 1) % 3]]);
        if (!view.perspective) {
            const glm::dvec2 along(b - a), to(ray.from - a);
            if (std::abs(along.x * to.y - along.y * to.x) < off_edges * pixel * glm::length(along))
                return true;
            continue;
        }
        const glm::dvec3 plane = glm::cross(a, b);  // through the eye and the edge
        if (std::abs(glm::dot(ray.direction, plane)) <
            off_edges * pixel * std::hypot(plane.x, plane.y))
            return true;
    }
    return false;
}

// Reversed depth of the triangle's plane; Embree's own distances are floats of large cancellations
// where planes pass close by the eye.
double depth_at(const prep::VertexMesh& mesh, std::uint32_t triangle, const rast::View& view,
                double x, double y) {
    glm::dvec3 p[3];
    for (std::uint32_t k = 0; k < 3; ++k)
        p[k] = glm::dvec3(mesh.positions[mesh.indices[3 * triangle + k]]);
    const glm::dvec3 normal = glm::cross(p[1] - p[0], p[2] - p[0]);
    const Ray ray = ray_at(view, width, height, x, y);
    const double across = glm::dot(ray.direction, normal);
    const double height_above = glm::dot(p[0] - ray.from, normal);
    if (!view.perspective) return (view.zfar - height_above / across) / (view.zfar - view.znear);
    const double inverse = across / height_above;  // of the distance along −z
    return view.zfar > 0 ? view.znear * (view.zfar * inverse - 1) / (view.zfar - view.znear)
                         : view.znear * inverse;
}

void compare(const prep::VertexMesh& mesh, const rast::View& view, Tally& tally) {
    const rast::Frame frame = draw_all(mesh, view);
    tally.crossing += frame.counters.crossing;
    const Rays rays(mesh);
    const auto finite = [](const glm::vec3& v) {
        return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
    };
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x) {
            const std::size_t at = std::size_t(y) * width + x;
            tally.not_finite += !finite(glm::vec3(frame.color[at])) || !finite(frame.normal[at]) ||
                                !finite(frame.barycentric[at]) || !finite(frame.position[at]) ||
                                !std::isfinite(frame.depth[at]);
            tally.empty += frame.triangle[at] == prep::no_index;
            const std::uint32_t centre = rays.cast(view, x + 0.5, y + 0.5);
            bool alone = !near_edge(mesh, frame.triangle[at], view, x + 0.5, y + 0.5) &&
                         !near_edge(mesh, centre, view, x + 0.5, y + 0.5);
            double low = 2, high = 0;
            for (int k = 0; k < 8 && alone; ++k) {
                const double turn = std::numbers::pi / 4 * k;
                const double u = x + 0.5 + off_edges * std::cos(turn);
                const double v = y + 0.5 + off_edges * std::sin(turn);
                alone = rays.cast(view, u, v) == centre;
                if (centre == prep::no_index) continue;
                const double depth = depth_at(mesh, centre, view, u, v);
                low = std::min(low, depth);
                high = std::max(high, depth);
                // Not beyond the near plane in double: a float's mistake.
                alone = alone && depth >= 0 && depth <= 1;
            }
            if (!alone) {
                ++tally.near_edges;
                continue;
            }
            ++tally.compared;
            if (frame.triangle[at] != centre) {
                ++tally.wrong;
                continue;
            }
            if (centre == prep::no_index) continue;
            const double depth = frame.depth[at];
            // Towards a far plane depth is a small difference, rounded like its terms.
            const double rounding = view.zfar > 0 ? 2e-7 : 0;
            tally.depth_wrong +=
                !(depth <= high * (1 + 1e-6) + rounding && depth >= low * (1 - 1e-6) - rounding);
        }
}

void report(const char* name, const Tally& tally) {
    std::printf(
        "%s: %zu pixels compared, %zu within 1/128 pixel of an edge, %zu wrong, "
        "%zu depths wrong, %llu triangles crossing\n",
        name, tally.compared, tally.near_edges, tally.wrong, tally.depth_wrong,
        static_cast<unsigned long long>(tally.crossing));
    EXPECT_EQ(tally.wrong, 0u);
    EXPECT_EQ(tally.depth_wrong, 0u);
    EXPECT_EQ(tally.not_finite, 0u);
    EXPECT_LT(double(tally.near_edges), 0.03 * double(tally.compared));
}

rast::View at_origin(double znear) {
    rast::View view;
    view.yfov = 1.1;
    view.znear = znear;
    return view;
}

glm::dmat3 random_rotation(std::mt19937_64& random) {
    std::normal_distribution<double> normal;
    const glm::dquat q(normal(random), normal(random), normal(random), normal(random));
    return glm::mat3_cast(glm::normalize(q));
}

prep::VertexMesh of(const prep::Mesh& source) {
    const prep::Mesh fans = shapes::fan_triangulated(source);
    prep::VertexMesh mesh;
    mesh.positions = fans.positions;
    mesh.indices = fans.corner_vertices;
    return mesh;
}

// A wide floor of uneven triangles from behind the eye to the distance.
prep::VertexMesh floor_mesh(double spacing, std::mt19937_64& random) {
    constexpr int n = 12;
    std::uniform_real_distribution<double> jitter(-0.3, 0.3);
    prep::VertexMesh mesh;
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i)
            mesh.positions.push_back(glm::vec3(glm::dvec3((i - n / 2 + jitter(random)) * spacing, 0,
                                                          (j - n / 2 + jitter(random)) * spacing)));
    for (std::uint32_t j = 0; j < n; ++j)
        for (std::uint32_t i = 0; i < n; ++i) {
            const std::uint32_t a = j * (n + 1) + i, b = a + n + 1;
            if (random() % 2)
                mesh.indices.insert(mesh.indices.end(), {a, b, a + 1, a + 1, b, b + 1});
            else
                mesh.indices.insert(mesh.indices.end(), {a, b, b + 1, a, b + 1, a + 1});
        }
    return mesh;
}

TEST(Visibility, PlaneSweptThroughTheEyeEqualsRays) {
    std::mt19937_64 random(1);
    Tally tally;
    constexpr int steps = 61;
    for (int n = 0; n < steps; ++n) {
        const prep::VertexMesh flat = floor_mesh(n % 3 == 0 ? 40 : 3, random);
        const glm::dmat3 turn = random_rotation(random);
        // Along its normal, through the eye: exactly at it in the middle of the sweep.
        const double height_here = 0.02 * (n - steps / 2);
        prep::VertexMesh mesh = flat;
        for (glm::vec3& p : mesh.positions)
            p = glm::vec3(turn * (glm::dvec3(p) + glm::dvec3(0.37, height_here, 0.21)));
        compare(mesh, at_origin(n % 2 ? 0.0625 : 0x1p-10), tally);
    }
    report("plane", tally);
    EXPECT_GT(tally.compared, 300000u);
    EXPECT_GT(tally.crossing, 100u);
}

TEST(Visibility, ClosedMeshesSweptThroughTheEyeEqualRays) {
    std::mt19937_64 random(2);
    Tally tally;
    constexpr int steps = 60;
    for (int n = 0; n < steps; ++n) {
        prep::Mesh source = n % 3 == 0   ? shapes::icosphere(2)
                            : n % 3 == 1 ? shapes::torus(24, 12)
                                         : shapes::cube();
        shapes::jitter(source, 0.02f, random);
        prep::VertexMesh mesh = of(source);
        const glm::dmat3 turn = random_rotation(random);
        const double away = 2.5 * double(n) / steps;  // from inside to outside
        for (glm::vec3& p : mesh.positions)
            p = glm::vec3(turn * glm::dvec3(p) - glm::dvec3(0, 0, away));
        compare(mesh, at_origin(n % 2 ? 0.125 : 0x1p-10), tally);
    }
    report("closed meshes", tally);
    EXPECT_GT(tally.compared, 300000u);
    EXPECT_GT(tally.crossing, 50u);
}

// A near and a far plane that both cut, and parallel rays.
TEST(Visibility, BetweenANearAndAFarPlaneEqualsRays) {
    std::mt19937_64 random(4);
    for (const bool perspective : {true, false}) {
        Tally tally;
        for (int n = 0; n < 30; ++n) {
            prep::Mesh source = n % 2 ? shapes::icosphere(2) : shapes::torus(24, 12);
            shapes::jitter(source, 0.02f, random);
            prep::VertexMesh mesh = of(source);
            const glm::dmat3 turn = random_rotation(random);
            const double away = 3.0 * double(n) / 30;
            for (glm::vec3& p : mesh.positions)
                p = glm::vec3(turn * glm::dvec3(p) - glm::dvec3(0, 0, away));
            rast::View view = at_origin(0.5);
            view.perspective = perspective;
            view.half_height = 1.25;
            view.zfar = 2.25;
            compare(mesh, view, tally);
        }
        report(perspective ? "perspective" : "orthographic", tally);
        EXPECT_GT(tally.compared, 150000u);
        EXPECT_GT(tally.crossing, 50u);
    }
}

// From inside a closed mesh there is no way out, edges or not.
TEST(Visibility, InsideAClosedMeshEveryPixelIsDrawn) {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> place(-0.6, 0.6);
    std::size_t pixels = 0;
    std::uint64_t crossing = 0;
    for (int n = 0; n < 60; ++n) {
        prep::VertexMesh mesh = of(n % 2 ? shapes::icosphere(3) : shapes::uv_sphere(40, 30));
        const glm::dmat3 turn = random_rotation(random);
        glm::dvec3 eye(place(random), place(random), place(random));
        // Every third time nearly on the surface.
        if (n % 3 == 0) eye = glm::normalize(eye) * 0.97;
        for (glm::vec3& p : mesh.positions) p = glm::vec3(turn * (glm::dvec3(p) - eye));
        const rast::Frame frame = draw_all(mesh, at_origin(0x1p-20));
        for (const std::uint32_t t : frame.triangle) ASSERT_NE(t, prep::no_index) << n;
        for (const float z : frame.depth) ASSERT_TRUE(z > 0 && z <= 1);
        pixels += frame.triangle.size();
        crossing += frame.counters.crossing;
    }
    EXPECT_GT(crossing, 20u);
    EXPECT_EQ(pixels, 60u * width * height);
}

}  // namespace
