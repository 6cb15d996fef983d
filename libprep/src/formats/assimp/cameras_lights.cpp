// Cameras and lights. Assimp says in each of them where it looks from its node; here, as in glTF,
// all look along −Z with y up, so that others get a node of their own.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>
#include <utility>

#include "formats/assimp/import.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

// Assimp 5.2 passes over what Collada says of a camera, and then takes its own angle of π/4 for
// degrees: a picture of nearly nothing.
constexpr float unread_angle = 0.7853981634f * 0.0174532925f;

// From −Z and y to a direction and what is up for it; identity where the direction is none.
glm::dmat4 frame_of(const glm::dvec3& position, const glm::dvec3& direction, glm::dvec3 up) {
    const double length = glm::length(direction);
    glm::dmat4 frame(1.0);
    if (length > 0 && std::isfinite(length)) {
        const glm::dvec3 back = -direction / length;
        glm::dvec3 side = glm::cross(up, back);
        if (!(glm::length(side) > 1e-6 * glm::length(up))) {
            up = std::abs(back.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1);
            side = glm::cross(up, back);
        }
        side = glm::normalize(side);
        frame[0] = glm::dvec4(side, 0);
        frame[1] = glm::dvec4(glm::cross(back, side), 0);
        frame[2] = glm::dvec4(back, 0);
    }
    if (std::isfinite(position.x) && std::isfinite(position.y) && std::isfinite(position.z))
        frame[3] = glm::dvec4(position, 1);
    return frame;
}

// Whether a light says how it falls off, and otherwise than by the square of the distance. What
// Assimp has where a file says nothing is (0, 1, 0), and of Collada (1, 0, 0).
bool has_other_falloff(const aiLight& in) {
    const glm::vec3 stated(in.mAttenuationConstant, in.mAttenuationLinear,
                           in.mAttenuationQuadratic);
    if (stated == glm::vec3(0, 1, 0) || stated == glm::vec3(1, 0, 0)) return false;
    return !(stated.x == 0 && stated.y == 0);
}

// Of the largest mesh in its own space. Where a file gives no clip planes, Assimp has its own:
// they are to cut nothing.
double extent_of(const Scene& scene) {
    double most = 0;
    for (const Mesh& mesh : scene.meshes) {
        glm::vec3 low(std::numeric_limits<float>::infinity()), high(-low);
        for (const glm::vec3& p : mesh.positions) {
            low = glm::min(low, p);
            high = glm::max(high, p);
        }
        const double size = glm::length(glm::dvec3(high) - glm::dvec3(low));
        if (std::isfinite(size)) most = std::max(most, size);
    }
    return most > 0 ? most : 1;
}

class CameraAndLightImport {
  public:
    explicit CameraAndLightImport(AssimpImport& import)
        : import_(import),
          scene_(import.scene),
          extent_(import.from.mNumCameras > 0 ? extent_of(import.scene) : 0) {}

    void run() {
        import_all();
        // As glTF: that of the first node that has one.
        for (Index n = 0; n < scene_.nodes.size() && scene_.active_camera == no_index; ++n)
            if (scene_.nodes[n].camera != no_index) scene_.active_camera = n;
    }

  private:
    void import_all() {
        for (unsigned c = 0; c < import_.from.mNumCameras; ++c) camera(*import_.from.mCameras[c]);
        for (unsigned l = 0; l < import_.from.mNumLights; ++l) light(*import_.from.mLights[l]);
        import_.warn(no_kind_, "light", "lights",
                     "of a kind that is neither ambient, directional, point nor spot (area, "
                     "volume): left out");
        import_.warn(
            other_falloff_, "light", "lights",
            "with a falloff of its own: here, as in glTF, it is that of the inverse square");
        import_.warn(homeless_, "camera or light", "cameras and lights",
                     "without a node of its name: at the origin");
    }

    // The node itself, or one below it that looks where the camera or light does.
    template <Index Node::*slot>
    void attach(const aiString& name, const glm::dmat4& frame, Index what) {
        const AssimpNodes::Target* target = import_.nodes.find(name);
        Index node = target ? target->animated : no_index;
        if (!target) ++homeless_;
        const bool same = frame == glm::dmat4(1.0);
        if (target && same && scene_.nodes[node].*slot == no_index) {
            scene_.nodes[node].*slot = what;
            return;
        }
        Node own;
        own.name = text(name);
        own.parent = target ? node : (scene_.nodes.empty() ? no_index : 0);
        own.transform = frame;
        own.*slot = what;
        scene_.nodes.push_back(std::move(own));
    }

    void camera(const aiCamera& in) {
        Camera out;
        out.name = text(in.mName);
        out.aspect = std::isfinite(in.mAspect) && in.mAspect > 0 ? in.mAspect : 0;
        if (in.mOrthographicWidth > 0 && std::isfinite(in.mOrthographicWidth)) {
            out.perspective = false;  // half the width of the picture
            out.xmag = in.mOrthographicWidth;
            out.ymag = out.aspect > 0 ? out.xmag / out.aspect : out.xmag;
        }
        if (std::abs(in.mHorizontalFOV - unread_angle) < 1e-6f) {
            scene_.warnings.push_back("Assimp does not read the angle of the camera '" + out.name +
                                      "': it gets the usual one");
        } else {
            const double half = std::tan(horizontal_angle(in) / 2);
            const double aspect = in.mAspect > 0 ? double(in.mAspect) : 4.0 / 3.0;
            if (half > 0) out.yfov = 2 * std::atan(half / aspect);
            if (in.mClipPlaneNear == aiCamera().mClipPlaneNear &&
                in.mClipPlaneFar == aiCamera().mClipPlaneFar) {
                out.znear = std::min(out.znear, 1e-3 * extent_);
            } else {
                if (in.mClipPlaneNear > 0 && std::isfinite(in.mClipPlaneNear))
                    out.znear = in.mClipPlaneNear;
                out.zfar = std::isfinite(in.mClipPlaneFar) ? in.mClipPlaneFar : 0;
            }
        }
        out.xmag *= import_.scene.placement.file_unit;
        out.ymag *= import_.scene.placement.file_unit;
        out.znear *= import_.scene.placement.file_unit;
        out.zfar *= import_.scene.placement.file_unit;
        const glm::dvec3 ahead = vector(in.mLookAt);
        const glm::dmat4 frame =
            frame_of(vector(in.mPosition), looks_back() ? -ahead : ahead, vector(in.mUp));
        attach<&Node::camera>(in.mName, frame, Index(scene_.cameras.size()));
        scene_.cameras.push_back(std::move(out));
    }

    // Of these files' cameras Assimp says +Z, its usual axis; they look along −Z of their node.
    bool looks_back() const {
        return import_.is_by("ASE Importer") || import_.is_by("LightWave Scene");
    }

    // 3DS has a lens of so many millimetres, which Assimp takes for degrees (lib3ds: 2400 / lens).
    double horizontal_angle(const aiCamera& in) const {
        const double said = double(in.mHorizontalFOV);
        if (!import_.is_by("3DS") || !(said > 0)) return said;
        const double lens = glm::degrees(said);
        return glm::radians(std::min(2400 / lens, 170.0));
    }

    // Half the angles from rim to rim.
    std::pair<float, float> cones(const aiLight& in) const {
        const float inner = in.mAngleInnerCone, outer = in.mAngleOuterCone;
        // ISO/IEC 19775-1, 17.4.3: from the axis.
        if (import_.is_by("Extensible 3D")) return {inner, outer};
        // Assimp has added the inner to the outer one.
        if (import_.is_by("3DS")) return {inner / 2, (outer - inner) / 2};
        return {inner / 2, outer / 2};
    }

    void light(const aiLight& in) {
        Light out;
        out.name = text(in.mName);
        const aiColor3D* color = &in.mColorDiffuse;
        switch (in.mType) {
            case aiLightSource_AMBIENT:
                out.kind = LightKind::ambient;
                color = &in.mColorAmbient;
                break;
            case aiLightSource_DIRECTIONAL:
                out.kind = LightKind::directional;
                break;
            case aiLightSource_POINT:
                out.kind = LightKind::point;
                break;
            case aiLightSource_SPOT:
                out.kind = LightKind::spot;
                break;
            default:
                ++no_kind_;
                return;
        }
        const auto finite = [](float x) { return std::isfinite(x) ? x : 0.0f; };
        out.color = {finite(color->r), finite(color->g), finite(color->b)};
        if (out.kind == LightKind::point || out.kind == LightKind::spot)
            other_falloff_ += has_other_falloff(in);
        if (out.kind == LightKind::spot) {
            std::tie(out.inner_cone, out.outer_cone) = cones(in);
            // A quarter turn is the widest that there is, and the inner cone lies within.
            const float widest = float(std::numbers::pi / 2);
            if (!(out.outer_cone > 0 && out.outer_cone <= widest)) out.outer_cone = widest;
            if (!(out.inner_cone >= 0 && out.inner_cone < out.outer_cone))
                out.inner_cone = 0.999f * out.outer_cone;
        }
        // Ambient light has no place, and Assimp no direction for point lights.
        const bool aimed = out.kind == LightKind::directional || out.kind == LightKind::spot;
        const glm::dmat4 frame =
            frame_of(vector(in.mPosition), aimed ? vector(in.mDirection) : glm::dvec3(0, 0, -1),
                     aimed ? vector(in.mUp) : glm::dvec3(0, 1, 0));
        attach<&Node::light>(in.mName, frame, Index(scene_.lights.size()));
        scene_.lights.push_back(std::move(out));
    }

    AssimpImport& import_;
    Scene& scene_;
    double extent_;
    std::uint64_t no_kind_ = 0, homeless_ = 0, other_falloff_ = 0;
};

}  // namespace

void import_cameras_and_lights(AssimpImport& import) {
    CameraAndLightImport(import).run();
}

}  // namespace prep::detail
