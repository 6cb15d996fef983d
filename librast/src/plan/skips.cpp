#include "plan/skips.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "plan/draw_choice.h"
#include "plan/light_bounds.h"
#include "shading/texture.h"

namespace rast::detail {
namespace {

using Code = prep::ReasonCode;
using prep::MapKind;
using prep::Material;
using prep::TextureRef;

// Of colours, lengths and directions: products of a few stay far inside float's range.
constexpr float ordinary = 1e6f;

bool is_ordinary(float x) {
    return std::abs(x) <= ordinary;  // NaN fails
}
bool is_plain_zero(const glm::vec3& v) {
    bool zero = true;
    for (int k = 0; k < 3; ++k) zero = zero && v[k] == 0 && !std::signbit(v[k]);
    return zero;
}

class Prover {
  public:
    Prover(const prep::PreparedScene& scene, const RenderPlan& plan, const DrawnContents& drawn)
        : scene_(scene),
          plan_(plan),
          request_(plan.request),
          drawn_(drawn),
          materials_(drawn.materials),
          consumer_(consumer_of(plan)),
          normals_left_((std::uint64_t(1) << 24) + 8 * drawn.vertices) {}

    ProvedSkips run() {
        out_.skips.materials.resize(scene_.scene.materials.size());
        // Of textures as colours and as data: slopes are no question.
        out_.texel_questions.resize((texture_uses - 1) * scene_.scene.textures.size());
        out_.skips.inside_samples = request_.prune && request_.samples > 1;
        lights();
        for (const std::uint32_t m : materials_) {
            highlights(m);
            emissive_map(m);
            normal_map(m);
            bump_map(m);
            mask(m);
        }
        return std::move(out_);
    }

  private:
    // Lights --------------------------------------------------------------------------------

    // Those of a request, and those that are set up, are no part of the scene.
    static std::string subject_of(const LightInstance& light, std::size_t index) {
        return light.node != prep::no_index ? prep::node_subject(light.node)
                                            : "light " + std::to_string(index);
    }

    void lights() {
        if (!request_.prune || !consumer_.colors || !drawn_.lit) return;
        const std::vector<LightInstance>& all = plan_.lights;
        out_.skips.lights.assign(all.size(), false);
        std::size_t left = 0, last = all.size();
        for (std::size_t l = 0; l < all.size(); ++l) {
            if (all[l].kind == prep::LightKind::ambient) continue;
            prep::Reason why = light(all[l], subject_of(all[l], l));
            const bool skipped = why.label == prep::ReasonLabel::proved_zero;
            out_.skips.lights[l] = skipped;
            left += !skipped;
            if (skipped) last = l;
            out_.lights.push_back(std::move(why));
        }
        if (left > 0) faint_lights();
        // With none at all, points are shaded in another way.
        if (left > 0 || last == all.size()) return;
        out_.skips.lights[last] = false;
        out_.lights.back() = prep::reason(Code::last_light, subject_of(all[last], last));
    }

    prep::Reason light(const LightInstance& light, const std::string& subject) {
        if (!are_ordinary_lights()) return prep::reason(Code::light, subject);
        if (light.color == glm::vec3(0)) return prep::reason(Code::light_black, subject);
        if (light.kind == prep::LightKind::directional)
            return is_behind_all(light) ? prep::reason(Code::light_behind, subject)
                                        : prep::reason(Code::light, subject);
        if (light.range > 0) {
            const double nearest = distance_to_all(light.position);
            const double slack = 1e-3 * double(light.range) + slack_of(light);
            if (nearest > double(light.range) + slack)
                return prep::reason(Code::light_range, subject, nearest, double(light.range));
        }
        if (light.kind == prep::LightKind::spot && is_past_all(light))
            return prep::reason(Code::light_cone, subject);
        return prep::reason(Code::light, subject);
    }

    // Of those that are left, the faintest, while all that they can add is allowed for.
    void faint_lights() {
        if (!(request_.allow_error > 0) || !are_ordinary_lights()) return;
        glm::dvec3 reflected(0);
        for (const std::uint32_t m : lit_materials())
            reflected = glm::max(reflected, greatest_reflection(material_of(m), ranges_of(m)));
        std::vector<double> most;
        std::vector<std::size_t> numbers;
        std::vector<prep::Reason*> reasons;
        auto why = out_.lights.begin();
        for (std::size_t l = 0; l < plan_.lights.size(); ++l) {
            if (plan_.lights[l].kind == prep::LightKind::ambient) continue;
            prep::Reason* const reason = &*why++;
            if (out_.skips.lights[l]) continue;
            most.push_back(greatest_addition(plan_.lights[l], reflected));
            numbers.push_back(l);
            reasons.push_back(reason);
        }
        const std::vector<bool> faint = smallest_within(most, double(request_.allow_error));
        for (std::size_t k = 0; k < faint.size(); ++k) {
            if (!faint[k]) continue;
            out_.skips.lights[numbers[k]] = true;
            *reasons[k] = prep::reason(Code::light_faint, reasons[k]->subject, most[k],
                                       double(request_.allow_error));
        }
    }

    // To any channel of any pixel.
    double greatest_addition(const LightInstance& light, const glm::dvec3& reflected) {
        if (light.kind != prep::LightKind::point && !is_unit(light.direction)) return HUGE_VAL;
        double distance = 0;
        if (light.kind != prep::LightKind::directional)
            distance = distance_to_all(light.position) - slack_of(light);
        const double strength = greatest_strength(light, distance);
        constexpr double rounding = 1.001;  // far above the kernels'
        double most = 0;
        for (int k = 0; k < 3; ++k) {
            const double channel = double(light.color[k]) * strength * reflected[k] * rounding;
            if (!(channel <= double(ordinary))) return HUGE_VAL;
            most = std::max(most, channel);
        }
        return most;
    }

    // In use; the default one where some triangle has none.
    std::vector<std::uint32_t> lit_materials() const {
        std::vector<std::uint32_t> out;
        for (const std::uint32_t m : materials_)
            if (!scene_.scene.materials[m].unlit) out.push_back(m);
        for (const prep::VertexMesh& mesh : scene_.meshes)
            for (const prep::VertexMesh::Range& range : mesh.ranges)
                if (range.material >= scene_.scene.materials.size()) {
                    out.push_back(prep::no_index);
                    return out;
                }
        return out;
    }
    const Material& material_of(std::uint32_t m) const {
        static const Material plain;
        return m < scene_.scene.materials.size() ? scene_.scene.materials[m] : plain;
    }

    MaterialRanges ranges_of(std::uint32_t m) {
        const Material& material = material_of(m);
        const auto range = [&](MapKind kind, const TextureRef& map) {
            return is_sampled(m, map) ? range_of(kind, map) : TexelRange();
        };
        MaterialRanges out;
        if (request_.textures) {
            out.diffuse = range(MapKind::diffuse, material.diffuse_map);
            out.specular = range(MapKind::specular, material.specular_map);
            if (material.metallic_roughness)
                out.metallic_roughness =
                    range(MapKind::metallic_roughness, material.metallic_roughness_map);
        }
        out.colors = greatest_colors();
        return out;
    }
    // Unbounded until the texels have been looked at.
    TexelRange range_of(MapKind kind, const TextureRef& map) {
        TexelRange out;
        if (!map) return out;
        TexelQuestions asked;
        asked.not_negative = true;
        const TexelFacts* const f = facts(kind, map, asked);
        // Facts that another question gathered may say that there are negative ones.
        if (f == nullptr || !overshoots_not(map) ||
            !glm::all(glm::greaterThanEqual(glm::dvec3(f->low), glm::dvec3(0))))
            return {glm::dvec3(0), glm::dvec3(HUGE_VAL)};
        return {glm::min(out.low, glm::dvec3(f->low)), glm::max(out.high, glm::dvec3(f->high))};
    }
    // Of all meshes' vertices. The draws take 1 for what is not finite.
    const glm::dvec3& greatest_colors() {
        if (colors_) return *colors_;
        colors_ = glm::dvec3(1);
        for (const prep::VertexMesh& mesh : scene_.meshes) {
            if (mesh.colors.empty()) continue;
            for (const glm::vec4& c : mesh.colors[0])
                for (int k = 0; k < 3; ++k)
                    if (std::isfinite(c[k]))
                        (*colors_)[k] = std::max((*colors_)[k], std::abs(double(c[k])));
        }
        return *colors_;
    }

    // Finite, none of them taking light away: what they add up to is never −0.
    bool are_ordinary_lights() {
        if (!ordinary_lights_)
            ordinary_lights_ = std::all_of(
                plan_.lights.begin(), plan_.lights.end(), [](const LightInstance& light) {
                    for (int k = 0; k < 3; ++k)
                        if (!is_ordinary(light.color[k]) || std::signbit(light.color[k]))
                            return false;
                    return true;
                });
        return *ordinary_lights_;
    }

    const std::optional<Bounds>& bounds() {
        if (!bounds_known_) bounds_ = world_bounds(scene_);
        bounds_known_ = true;
        return bounds_;
    }
    double extent() { return bounds() ? bounds()->radius() : 0; }

    // How far the kernels may take a point from where it is, seen from the light: they turn the
    // meshes' own coordinates into places from the eye, in float, and what is far larger than the
    // outcome (an eye far away, a node that brings distant coordinates back) is rounded with it.
    // Infinite or NaN: nothing can be said.
    double slack_of(const LightInstance& light) {
        if (!size_) size_ = size_from_eye();
        return 0x1p-20 * (*size_ + glm::length(light.position - plan_.view.eye())) +
               1e-5 * extent();
    }
    double size_from_eye() {
        constexpr double most = 1e12;  // floats' range is no matter
        double size = 0;
        for (std::size_t n = 0; n < scene_.scene.nodes.size(); ++n) {
            const std::uint32_t m = scene_.scene.nodes[n].mesh;
            if (m == prep::no_index || scene_.meshes[m].triangle_count() == 0) continue;
            const prep::VertexMesh& mesh = scene_.meshes[m];
            glm::dvec3 farthest(0);
            for (const glm::vec3& p : mesh.positions)
                for (int k = 0; k < 3; ++k)
                    if (std::isfinite(p[k]))
                        farthest[k] = std::max(farthest[k], std::abs(double(p[k])));
            const glm::dmat4& world = worlds()[n];
            const glm::dmat3 linear(world);
            const glm::dvec3 moved =
                (glm::dvec3(world[3]) - plan_.view.eye()) + linear * mesh.origin;
            const double stretch = norm(linear), reach = glm::length(farthest);
            if (!(stretch < most) || !(reach < most)) return HUGE_VAL;
            size = std::max(size, stretch * reach + glm::length(moved));
            if (std::isnan(glm::length(moved))) return HUGE_VAL;
        }
        return size;
    }
    // Frobenius': no vector is stretched by more.
    static double norm(const glm::dmat3& m) {
        return std::sqrt(glm::dot(m[0], m[0]) + glm::dot(m[1], m[1]) + glm::dot(m[2], m[2]));
    }
    const std::vector<glm::dmat4>& worlds() {
        if (worlds_.empty()) worlds_ = prep::world_transforms(scene_.scene);
        return worlds_;
    }
    static bool is_unit(const glm::dvec3& v) { return std::abs(glm::length(v) - 1) < 1e-6; }

    double distance_to_all(const glm::dvec3& from) {
        if (!bounds()) return 0;
        const glm::dvec3 nearest = glm::clamp(from, bounds()->low, bounds()->high);
        const double distance = glm::length(from - nearest);
        return distance < double(ordinary) ? distance : 0;
    }

    bool is_past_all(const LightInstance& light) {
        if (!bounds() || !is_unit(light.direction)) return false;
        const glm::dvec3 to = bounds()->centre() - light.position;
        // Of the sphere in which the kernels see everything.
        const double radius = bounds()->radius() * 1.001 + slack_of(light);
        const double distance = glm::length(to);
        if (!(distance > radius) || !(distance < double(ordinary))) return false;
        const double cosine = std::clamp(glm::dot(to, light.direction) / distance, -1.0, 1.0);
        // Of the direction into the sphere about everything that is nearest to the axis.
        const double nearest = std::max(std::acos(cosine) - std::asin(radius / distance), 0.0);
        constexpr double margin = 1e-4;
        return std::cos(nearest) < std::cos(double(light.outer_cone)) - margin;
    }

    // Whether every normal that is lit points away from it by more than rounding. Ends with the
    // first one that does not, which mostly is among the first ones there are. Normals alone are
    // looked at: back faces are left out, and smooth shading knows no others.
    bool is_behind_all(const LightInstance& light) {
        if (!are_fixed_normals() || !is_unit(light.direction)) return false;
        bool any = false;
        for (std::size_t n = 0; n < scene_.scene.nodes.size(); ++n) {
            const std::uint32_t m = scene_.scene.nodes[n].mesh;
            if (m == prep::no_index || scene_.meshes[m].triangle_count() == 0) continue;
            const prep::VertexMesh& mesh = scene_.meshes[m];
            const glm::dmat3 linear(worlds()[n]);
            const double volume = glm::determinant(linear);
            if (mesh.normals.empty() || !(std::abs(volume) > 1e-12) || !(std::abs(volume) < 1e12))
                return false;
            // Normals are turned by the inverse transpose, mirrored or not. The kernels round by
            // its largest elements, which matter where a node flattens: not by what comes out.
            const glm::dmat3 inverse = glm::inverse(linear);
            const glm::dvec3 towards = inverse * -light.direction;
            const double margin = 1e-3 * norm(inverse);
            if (mesh.normals.size() >= normals_left_) return false;
            const auto lit = std::find_if(mesh.normals.begin(), mesh.normals.end(),
                                          [&](const glm::vec3& normal) {
                                              const glm::dvec3 v(normal);
                                              const double length = glm::length(v);
                                              return !(length > 0.5 && length < 2) ||
                                                     !(glm::dot(v, towards) < -margin * length);
                                          });
            normals_left_ -= std::uint64_t(lit - mesh.normals.begin()) + 1;
            if (lit != mesh.normals.end()) return false;
            any = true;
        }
        return any;
    }
    // Whether what is lit has the meshes' own normals, seen from their front.
    bool are_fixed_normals() {
        if (!fixed_normals_)
            fixed_normals_ =
                request_.shading != Shading::flat &&  // those are found while drawing
                request_.cull != Cull::none && request_.cull != Cull::front &&
                std::none_of(materials_.begin(), materials_.end(), [&](std::uint32_t m) {
                    const Material& material = scene_.scene.materials[m];
                    const bool turns = material.double_sided && request_.cull == Cull::by_material;
                    const bool bends = (material.normal_map || material.bump_map) &&
                                       request_.shading == Shading::normal_mapped;
                    return !material.unlit && (turns || bends);
                });
        return *fixed_normals_;
    }

    // Materials -----------------------------------------------------------------------------

    const TexelFacts* facts(MapKind kind, const TextureRef& map, const TexelQuestions& asked) {
        const std::size_t slot = texture_slot(scene_.scene.textures.size(), kind, map);
        if (slot >= out_.texel_questions.size()) return nullptr;
        if (!request_.prune || !request_.textures) return nullptr;
        TexelQuestions& all = out_.texel_questions[slot];
        if (asked.alpha)
            all.least_alpha =
                all.alpha ? std::min(all.least_alpha, asked.least_alpha) : asked.least_alpha;
        all.constant |= asked.constant;
        all.not_negative |= asked.not_negative;
        all.alpha |= asked.alpha;
        if (!request_.texel_facts || slot >= request_.texel_facts->size()) return nullptr;
        const TexelFacts& f = (*request_.texel_facts)[slot];
        return f.known ? &f : nullptr;
    }

    template <class Test>
    bool all_meshes_with(std::uint32_t material, const Test& test) {
        if (users_.empty()) {
            users_.resize(scene_.scene.materials.size());
            for (std::uint32_t m = 0; m < scene_.meshes.size(); ++m)
                for (const prep::VertexMesh::Range& range : scene_.meshes[m].ranges) {
                    if (range.material >= users_.size() || range.triangle_count == 0) continue;
                    std::vector<std::uint32_t>& users = users_[range.material];
                    if (users.empty() || users.back() != m) users.push_back(m);
                }
        }
        return std::all_of(users_[material].begin(), users_[material].end(), test);
    }

    // Whether some mesh has the map's UVs. Elsewhere what it multiplies is multiplied by 1.
    bool is_sampled(std::uint32_t material, const TextureRef& map) {
        return map && !all_meshes_with(material, [&](std::uint32_t number) {
                   const prep::VertexMesh& mesh = scene_.meshes[number];
                   return map.uv_set >= mesh.uvs.size() || mesh.uvs[map.uv_set].empty();
               });
    }

    void highlights(std::uint32_t m) {
        const Material& material = scene_.scene.materials[m];
        if (material.unlit || !consumer_.colors) return;
        const std::string subject = prep::material_subject(m);
        if (!request_.prune || !is_zero(m, material)) {
            out_.highlights.push_back(prep::reason(Code::highlights, subject));
            return;
        }
        PlanSkips::OfMaterial& skips = out_.skips.materials[m];
        // At vertices, diffuse and mirrored light are summed together.
        skips.highlights = request_.shading != Shading::gouraud;
        out_.highlights.push_back(prep::reason(
            skips.highlights ? Code::highlights_zero : Code::highlights_at_vertices, subject));
        const prep::MaterialMap& map = prep::material_maps[std::size_t(MapKind::specular)];
        if (!is_sampled(m, material.specular_map) || !prep::map_is_read(material, map, consumer_))
            return;
        skips.maps |= 1u << unsigned(MapKind::specular);
        out_.maps.push_back(prep::reason(Code::map_times_zero, prep::map_subject(m, map)));
    }

    // Materials that do not glow multiply by nothing, whatever the texels are.
    void emissive_map(std::uint32_t m) {
        const Material& material = scene_.scene.materials[m];
        const prep::MaterialMap& map = prep::material_maps[std::size_t(MapKind::emissive)];
        if (!is_sampled(m, material.emissive_map) || material.emissive != glm::vec3(0) ||
            !request_.prune || !request_.textures || !prep::map_is_read(material, map, consumer_))
            return;
        out_.skips.materials[m].maps |= 1u << unsigned(MapKind::emissive);
        out_.maps.push_back(prep::reason(Code::map_times_zero, prep::map_subject(m, map)));
    }

    // Whether the specular colour is 0 wherever it is looked up, and what it multiplies finite.
    bool is_zero(std::uint32_t m, const Material& material) {
        if (material.metallic_roughness || !is_plain_zero(material.specular)) return false;
        if (!are_ordinary_lights()) return false;
        if (!is_sampled(m, material.specular_map) || !request_.textures) return true;
        TexelQuestions asked;
        asked.not_negative = true;
        const TexelFacts* const f = facts(MapKind::specular, material.specular_map, asked);
        if (f == nullptr || !overshoots_not(material.specular_map)) return false;
        for (int k = 0; k < 3; ++k)
            if (!(f->low[k] >= 0) || !is_ordinary(f->high[k])) return false;
        return true;
    }

    void normal_map(std::uint32_t m) {
        const Material& material = scene_.scene.materials[m];
        const prep::MaterialMap& map = prep::material_maps[std::size_t(MapKind::normal)];
        // A buffer of normals keeps the sign of a zero.
        if (!material.normal_map || material.normal_map_space != prep::NormalMapSpace::tangent ||
            consumer_.normals || !request_.textures || !prep::map_is_read(material, map, consumer_))
            return;
        TexelQuestions asked;
        asked.constant = true;
        const TexelFacts* const f = facts(MapKind::normal, material.normal_map, asked);
        if (f == nullptr || !f->constant || f->low.z != 1) return;
        const bool straight = f->low.x == 0.5f && f->low.y == 0.5f;
        if (!is_ordinary(material.normal_map.strength)) return;
        if (!straight &&
            !(material.normal_map.strength == 0 && is_ordinary(f->low.x) && is_ordinary(f->low.y)))
            return;
        if (!all_meshes_with(m, [&](std::uint32_t mesh) { return has_ordinary_frames(mesh); }))
            return;
        out_.skips.materials[m].maps |= 1u << unsigned(MapKind::normal);
        out_.maps.push_back(prep::reason(flat_map_code(map.kind), prep::map_subject(m, map)));
    }

    bool has_ordinary_frames(std::uint32_t number) {
        if (frames_.empty()) frames_.resize(scene_.meshes.size());
        std::optional<bool>& known = frames_[number];
        if (known) return *known;
        const auto ordinary_vectors = [](const auto& vectors) {
            return std::all_of(vectors.begin(), vectors.end(), [](const auto& v) {
                for (int k = 0; k < int(v.length()); ++k)
                    if (!is_ordinary(v[k])) return false;
                return true;
            });
        };
        const prep::VertexMesh& mesh = scene_.meshes[number];
        known = ordinary_vectors(mesh.tangents) && ordinary_vectors(mesh.normals);
        return *known;
    }

    // Of a mesh's vertex colours, and 1.
    struct AlphaRange {
        double least = 1, highest = 1;
    };
    const AlphaRange& alphas_of(std::uint32_t number) {
        if (alphas_.empty()) alphas_.resize(scene_.meshes.size());
        std::optional<AlphaRange>& known = alphas_[number];
        if (known) return *known;
        known.emplace();
        for (const glm::vec4& c : scene_.meshes[number].colors[0]) {
            if (!std::isfinite(c.a)) continue;  // 1 takes its place
            known->least = std::min(known->least, double(c.a));
            known->highest = std::max(known->highest, double(c.a));
        }
        return *known;
    }

    // Heights times 0. Slopes are finite, and so are their gradients by the position.
    void bump_map(std::uint32_t m) {
        const Material& material = scene_.scene.materials[m];
        const prep::MaterialMap& map = prep::material_maps[std::size_t(MapKind::bump)];
        if (!material.bump_map || material.bump_map.strength != 0 || consumer_.normals ||
            !request_.prune || !request_.textures || !prep::map_is_read(material, map, consumer_))
            return;
        out_.skips.materials[m].maps |= 1u << unsigned(MapKind::bump);
        out_.maps.push_back(prep::reason(flat_map_code(map.kind), prep::map_subject(m, map)));
    }

    void mask(std::uint32_t m) {
        const Material& material = scene_.scene.materials[m];
        if (material.alpha_mode != prep::AlphaMode::mask) return;
        const std::string subject = prep::material_subject(m);
        // Of the three factors: where a mesh lacks the map's UVs or colours, theirs is 1.
        const double own = double(material.diffuse.a);
        double least_texel = 1, highest_texel = 1, least_color = 1, highest_color = 1;
        bool exact = true, known = request_.prune && is_ordinary(material.diffuse.a) && own >= 0;
        if (is_sampled(m, material.diffuse_map) && request_.textures) {
            TexelQuestions asked;
            asked.alpha = true;
            // Less than this cuts, whatever the other factors are.
            if (own > 0)
                asked.least_alpha = float(std::max(double(material.alpha_cutoff) / own, 0.0));
            const TexelFacts* const f =
                own > 0 ? facts(MapKind::diffuse, material.diffuse_map, asked) : nullptr;
            known = known && f != nullptr && f->low.a >= 0 && is_ordinary(f->high.a) &&
                    overshoots_not(material.diffuse_map);
            if (f != nullptr) {
                least_texel = std::min(1.0, double(f->low.a));
                highest_texel = std::max(1.0, double(f->high.a));
            }
            exact = false;
        }
        known = known && all_meshes_with(m, [&](std::uint32_t mesh) {
                    if (scene_.meshes[mesh].colors.empty()) return true;
                    exact = false;
                    least_color = std::min(least_color, alphas_of(mesh).least);
                    highest_color = std::max(highest_color, alphas_of(mesh).highest);
                    return least_color >= 0 && highest_color <= double(ordinary);
                });
        const double least = own * least_texel * least_color;
        // Filters and interpolation round, by the largest of what they mix; coarser levels are
        // means, rounded once more each.
        const double margin = exact ? 0 : 1e-3 * own * highest_texel * highest_color;
        if (known && least >= double(material.alpha_cutoff) + margin) {
            out_.skips.materials[m].mask = true;
            out_.masks.push_back(
                prep::reason(Code::mask_never_cuts, subject, least, double(material.alpha_cutoff)));
        } else {
            out_.masks.push_back(prep::reason(Code::mask_of, subject));
        }
    }

    // Filters with negative weights leave the range of what they read.
    bool overshoots_not(const TextureRef& map) const {
        return filter_for(request_.filter, scene_.scene.textures[map.texture]) !=
               TextureFilter::bicubic;
    }

    const prep::PreparedScene& scene_;
    const RenderPlan& plan_;
    const RenderRequest& request_;
    const DrawnContents& drawn_;
    const std::set<std::uint32_t>& materials_;
    prep::Consumer consumer_;
    ProvedSkips out_;
    std::optional<Bounds> bounds_;
    bool bounds_known_ = false;
    std::optional<double> size_;
    std::optional<bool> ordinary_lights_;  // of all; asked for by each
    std::optional<glm::dvec3> colors_;
    std::vector<glm::dmat4> worlds_;
    std::optional<bool> fixed_normals_;
    // That lights are still held against: then none is proved to be behind them.
    std::uint64_t normals_left_;
    std::vector<std::vector<std::uint32_t>> users_;  // meshes, by material
    std::vector<std::optional<bool>> frames_;        // by mesh
    std::vector<std::optional<AlphaRange>> alphas_;
};

}  // namespace

prep::ReasonCode flat_map_code(MapKind kind) {
    return kind == MapKind::bump ? Code::bump_map_flat : Code::normal_map_flat;
}

ProvedSkips prove_skips(const prep::PreparedScene& scene, const RenderPlan& plan,
                        const DrawnContents& drawn) {
    return Prover(scene, plan, drawn).run();
}

}  // namespace rast::detail
