// The faces of a refined level: steps along their half-edges, and the fans around their corners.
#pragma once

#include <vector>

#include "limit_surface/refined_cage.h"

namespace prep::detail {

// The faces around a vertex that a face's corner belongs to, between sharp edges; by the half-edges
// that leave the vertex, counter-clockwise.
struct Fan {
    std::vector<std::uint32_t> corners;
    bool closed = false;
    bool sharp_edge = false;  // closed, over an edge that is sharp: corners begin there
};

class LevelFaces {
  public:
    LevelFaces(const RefinedLevel& level, std::uint32_t corners)
        : level_(level), corners_(corners) {
        if (level.face_offsets.empty()) return;
        corner_faces_.resize(level.corner_vertices.size());
        corner_places_.resize(level.corner_vertices.size());
        for (std::uint32_t f = 0; f + 1 < level.face_offsets.size(); ++f) {
            const std::uint32_t first = level.face_offsets[f], end = level.face_offsets[f + 1];
            for (std::uint32_t h = first; h < end; ++h) {
                corner_faces_[h] = f;
                corner_places_[h] = std::uint16_t(h - first);
            }
            if (end > first)
                corner_places_[end - 1] = std::uint16_t(corner_places_[end - 1] | last_of_face);
        }
    }
    const RefinedLevel& level() const { return level_; }
    bool polygons() const { return !corner_faces_.empty(); }
    std::uint32_t face(std::uint32_t h) const {
        return polygons() ? corner_faces_[h] : h / corners_;
    }
    std::uint32_t begin(std::uint32_t f) const {
        return polygons() ? level_.face_offsets[f] : corners_ * f;
    }
    std::uint32_t size(std::uint32_t f) const {
        return polygons() ? level_.face_offsets[f + 1] - level_.face_offsets[f] : corners_;
    }
    std::uint32_t next(std::uint32_t h) const {
        if (!polygons()) return h % corners_ + 1 == corners_ ? h + 1 - corners_ : h + 1;
        const std::uint32_t place = corner_places_[h];
        return place & last_of_face ? h - (place & ~last_of_face) : h + 1;
    }
    std::uint32_t previous(std::uint32_t h) const {
        if (!polygons()) return h % corners_ == 0 ? h + corners_ - 1 : h - 1;
        return corner_places_[h] & ~last_of_face ? h - 1 : h + size(face(h)) - 1;
    }
    std::uint32_t vertex(std::uint32_t h) const { return level_.corner_vertices[h]; }
    // Of all levels' vertices, counted through.
    std::uint32_t control(std::uint32_t h) const { return level_.first_vertex + vertex(h); }
    std::uint8_t flags(std::uint32_t h) const { return level_.vertex_flags[vertex(h)]; }
    // The half-edge on the other side, where the surface goes on smoothly.
    std::uint32_t across(std::uint32_t h) const {
        return level_.sharp[h] ? no_index : level_.opposite[h];
    }

    Fan fan(std::uint32_t corner) const {
        Fan found;
        fan(corner, found);
        return found;
    }
    // Into memory that is there.
    void fan(std::uint32_t corner, Fan& fan) const {
        fan.corners.clear();
        fan.closed = fan.sharp_edge = false;
        std::uint32_t first = corner;
        for (std::uint32_t h = across(corner); h != no_index; h = across(first)) {
            first = next(h);
            if (first == corner) break;
        }
        const bool around = across(first) != no_index;
        fan.corners.push_back(first);
        for (std::uint32_t h = across(previous(first)); h != no_index && h != first;
             h = across(previous(h)))
            fan.corners.push_back(h);
        fan.closed = around;
        if (!around && fan.corners.size() > 1 &&
            level_.opposite[first] == previous(fan.corners.back())) {
            fan.closed = fan.sharp_edge = true;
            if (!(level_.vertex_flags[vertex(first)] &
                  (VertexFlags::dart_rule | VertexFlags::corner_rule)))
                fan.closed = fan.sharp_edge = false;
        }
    }

  private:
    const RefinedLevel& level_;
    std::uint32_t corners_;
    // Of polygons, per half-edge: its face; which of the face's it is, and whether the last one.
    static constexpr std::uint32_t last_of_face = 1U << 15;
    static_assert(max_subdivision_valence < last_of_face);
    std::vector<std::uint32_t> corner_faces_;
    std::vector<std::uint16_t> corner_places_;
};

}  // namespace prep::detail
