#include "plan/shade_stages.h"

#include <algorithm>
#include <bitset>

namespace rast::detail {
namespace {

using Values = std::bitset<point_values>;

struct Step {
    Stage stage;
    Values reads, writes;
};

// Such a stage reads all that it reads of a point before it writes any: what it writes may take the
// place of what it is the last to read. Maps go over the points several times.
bool works_in_place(StageKind kind) {
    return kind != StageKind::interpolation && kind != StageKind::maps;
}

class Compiler {
  public:
    Compiler(const StageRequest& request, const std::vector<bool>& local_lights)
        : r_(request), local_(local_lights) {}

    StageList run() {
        lit_ = r_.color && !r_.unlit && !r_.vertex_light && !local_.empty();
        glossy_ = lit_ && r_.highlights;
        // From the last stage to the first: what is read decides what is made.
        if (r_.color)
            color();
        else
            attributes();
        if (lit_) lights();
        if (lit_ || (!r_.color && r_.normals)) normals();
        maps();
        interpolation();
        std::reverse(steps_.begin(), steps_.end());
        for (const Step& s : steps_) {
            list_.stages.push_back(s.stage);
            ++list_.times[std::size_t(s.stage.kind)];
            if (s.stage.kind == StageKind::maps) list_.map_count += s.stage.end - s.stage.begin;
        }
        assign_planes();
        note_live_planes();
        return std::move(list_);
    }

  private:
    Step& step(StageKind kind, std::uint32_t begin = 0, std::uint32_t end = 0) {
        steps_.push_back({{kind, begin, end}, {}, {}});
        return steps_.back();
    }
    static void add(Values& to, PointValue value) { to.set(std::size_t(value)); }
    void read(Step& step, PointValue value) {
        add(step.reads, value);
        add(read_, value);
    }
    bool has_map(MapKind kind) const {
        return std::any_of(r_.maps.begin(), r_.maps.begin() + r_.map_count,
                           [&](const StageRequest::Map& map) { return map.kind == kind; });
    }
    void read_map(Step& step, MapKind kind) {
        if (has_map(kind)) read(step, texels_of(kind));
    }

    void color() {
        Step& s = step(StageKind::color);
        const bool reflects = lit_ || r_.vertex_light, highlights = glossy_ || r_.vertex_light;
        if (r_.vertex_colors) read(s, PointValue::color);
        read_map(s, MapKind::diffuse);
        if (!r_.unlit) {
            if (r_.glows || r_.in_full) read_map(s, MapKind::emissive);
            read_map(s, MapKind::occlusion);
            if (highlights || r_.in_full) read_map(s, MapKind::specular);
            if (r_.metallic_roughness && (reflects || r_.in_full))
                read_map(s, MapKind::metallic_roughness);
            if (r_.vertex_light) read(s, PointValue::vertex_light);
        }
        if (lit_) read(s, PointValue::light);
        if (glossy_) read(s, PointValue::gloss);
    }

    void attributes() {
        Step& s = step(StageKind::attributes);
        if (r_.normals) read(s, PointValue::normal);
        if (r_.uvs) read(s, PointValue::uv);
        if (r_.weights) read(s, PointValue::weights);
        if (r_.positions) read(s, PointValue::position);
    }

    void lights() {
        for (std::size_t l = local_.size(); l-- > 0;) {
            if (glossy_) highlights(l);
            Step& s = step(glossy_ ? StageKind::light : StageKind::matte_light, std::uint32_t(l));
            read(s, PointValue::normal);
            if (local_[l] || r_.in_full) read(s, PointValue::position);
            if (l > 0) read(s, PointValue::light);
            add(s.writes, PointValue::light);
            if (!glossy_) continue;
            read(s, PointValue::eye);
            add(s.writes, PointValue::angle);
            add(s.writes, PointValue::half);
        }
        if (glossy_) add(step(StageKind::eye).writes, PointValue::eye);
    }
    void highlights(std::size_t light) {
        const auto number = std::uint32_t(light);
        Step& sum = step(StageKind::gloss, number);
        if (light > 0) read(sum, PointValue::gloss);
        read(sum, PointValue::angle);
        read(sum, PointValue::exponent);
        if (r_.metallic_roughness) read_map(sum, MapKind::metallic_roughness);
        if (local_[light]) read(sum, PointValue::position);
        add(sum.writes, PointValue::gloss);
        Step& s = step(StageKind::exponents, number);
        read(s, PointValue::angle);
        read(s, PointValue::half);
        if (r_.metallic_roughness) read_map(s, MapKind::metallic_roughness);
        add(s.writes, PointValue::exponent);
    }

    void normals() {
        Step& s = step(StageKind::normals);
        read(s, PointValue::id);
        if (r_.source != NormalSource::object_map) read(s, PointValue::normal);
        if (r_.source == NormalSource::tangent_map) read(s, PointValue::tangent);
        list_.normal_maps =
            r_.source == NormalSource::tangent_map || r_.source == NormalSource::object_map;
        if (list_.normal_maps) read_map(s, MapKind::normal);
        if (has_map(MapKind::bump)) {
            read_map(s, MapKind::bump);
            read(s, PointValue::uv_gradients);
            list_.normal_maps = true;
        }
        add(s.writes, PointValue::normal);
    }

    // Those on the same texels at a time, where something is read of them.
    void maps() {
        std::uint32_t end = r_.map_count;
        const auto is_read = [&](std::uint32_t m) {
            return read_.test(std::size_t(texels_of(r_.maps[m].kind)));
        };
        while (end > 0) {
            std::uint32_t begin = end - 1;
            if (!is_read(begin)) {
                end = begin;
                continue;
            }
            while (r_.maps[begin].same_texels && is_read(begin - 1)) --begin;
            Step& s = step(StageKind::maps, begin, end);
            read(s, coordinates_of(r_.maps[begin].place));
            for (std::uint32_t m = begin; m < end; ++m) add(s.writes, texels_of(r_.maps[m].kind));
            end = begin;
        }
    }

    void interpolation() {
        Step& s = step(StageKind::interpolation);
        Values made;
        for (const Step& other : steps_) made |= other.writes;
        s.writes = read_ & ~made;
        // It bends the one that is interpolated.
        if (r_.source != NormalSource::object_map && read_.test(std::size_t(PointValue::normal)))
            add(s.writes, PointValue::normal);
    }

    // A linear scan (Poletto and Sarkar 1999) over live ranges from the first write to the last
    // read, first fit; of values that begin together the widest first, so that gaps stay wide.
    void assign_planes() {
        list_.first.fill(StageList::no_plane);
        std::array<std::size_t, point_values> last{};
        for (std::size_t s = 0; s < steps_.size(); ++s)
            for (std::size_t v = 0; v < point_values; ++v)
                if (steps_[s].reads.test(v)) last[v] = s;
        std::bitset<most_planes + 1> taken;
        const auto give_back = [&](std::size_t s) {
            for (std::size_t v = 0; v < point_values; ++v)
                if (last[v] == s && steps_[s].reads.test(v) && list_.has(PointValue(v)))
                    for (std::size_t p = 0; p < planes_of(PointValue(v)); ++p)
                        taken.reset(list_.first[v] + p);
        };
        for (std::size_t s = 0; s < steps_.size(); ++s) {
            const bool in_place = works_in_place(steps_[s].stage.kind);
            if (in_place) give_back(s);
            for (std::size_t width = 6; width > 0; --width)
                for (std::size_t v = 0; v < point_values; ++v) {
                    if (planes_of(PointValue(v)) != width || !steps_[s].writes.test(v) ||
                        !read_.test(v) || list_.has(PointValue(v)))
                        continue;
                    std::size_t at = 0, p = 0;
                    while (p < width) {
                        if (taken[at + p]) {
                            at += p + 1;
                            p = 0;
                        } else {
                            ++p;
                        }
                    }
                    for (p = 0; p < width; ++p) taken.set(at + p);
                    list_.first[v] = std::uint8_t(at);
                    list_.planes = std::max(list_.planes, std::uint32_t(at + width));
                }
            if (!in_place) give_back(s);
        }
    }

    // What a later stage reads before it is made anew.
    void note_live_planes() {
        list_.live.resize(steps_.size());
        Values read;
        for (std::size_t s = steps_.size(); s-- > 0;) {
            for (std::size_t v = 0; v < point_values; ++v)
                for (std::size_t p = 0; read.test(v) && p < planes_of(PointValue(v)); ++p)
                    list_.live[s].set(list_.first[v] + p);
            read = (read & ~steps_[s].writes) | steps_[s].reads;
        }
    }

    const StageRequest& r_;
    const std::vector<bool>& local_;
    bool lit_ = false, glossy_ = false;
    std::vector<Step> steps_;
    Values read_;  // by the stages so far
    StageList list_;
};

}  // namespace

StageList stages_for(const StageRequest& request, const std::vector<bool>& local_lights) {
    return Compiler(request, local_lights).run();
}

}  // namespace rast::detail
