#include "formats/ply/ply_vertices.h"

#include <atomic>
#include <utility>

#include "base/parallel.h"
#include "formats/ply/ply_records.h"
#include "prep/mesh.h"

namespace prep::detail {

std::optional<PlyVertices::Slot> PlyVertices::slot_of(const std::string& name) {
    static const std::pair<const char*, Slot> names[] = {
        {"x", px},  {"y", py},  {"z", pz},  {"nx", nx}, {"ny", ny},        {"nz", nz},
        {"s", tu},  {"t", tv},  {"u", tu},  {"v", tv},  {"texture_u", tu}, {"texture_v", tv},
        {"tx", tx}, {"ty", ty}, {"tz", tz}, {"tw", tw}};
    for (const auto& [text, slot] : names)
        if (name == text) return slot;
    return std::nullopt;
}

bool PlyVertices::choose(const PlyElement& element) {
    colors_ = PlyColors(element);
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
        const PlyProperty& p = element.properties[i];
        const std::optional<int> channel = colors_.channel(i);
        slots_.push_back(channel  ? std::optional(Slot(red + *channel))
                         : p.list ? std::nullopt
                                  : slot_of(p.name));
        // Of several that mean the same the first counts.
        if (slots_.back() && has_[*slots_.back()]) slots_.back().reset();
        if (!slots_.back()) continue;
        has_[*slots_.back()] = true;
        types_[*slots_.back()] = p.type;
    }
    if (!has_[px] || !has_[py] || !has_[pz]) return false;
    has_normals = has_[nx] && has_[ny] && has_[nz];
    has_colors = colors_.any();
    has_uvs = has_[tu] && has_[tv];
    has_tangents = has_normals && has_[tx] && has_[ty] && has_[tz] && has_[tw];
    for (std::optional<Slot>& slot : slots_) {
        const bool taken =
            slot &&
            (*slot <= pz || (*slot <= nz && has_normals) || (*slot >= red && *slot <= alpha) ||
             (*slot >= tu && *slot <= tv && has_uvs) || (*slot >= tx && has_tangents));
        if (!taken) slot.reset();
    }
    return true;
}

void PlyVertices::make_room(std::size_t count) {
    count_ = count;
    positions_are_floats_ ? float_positions_.resize(count) : positions_.resize(count);
    if (has_normals) normals.resize(count);
    if (has_uvs) uvs.resize(count);
    if (has_tangents) tangents.resize(count);
    if (has_colors) colors.resize(count);
}

void PlyVertices::set(std::size_t vertex, const Row& row) {
    if (positions_are_floats_)
        float_positions_[vertex] = {float(row[px]), float(row[py]), float(row[pz])};
    else
        positions_[vertex] = {row[px], row[py], row[pz]};
    if (has_normals) normals[vertex] = {float(row[nx]), float(row[ny]), float(row[nz])};
    if (has_uvs) uvs[vertex] = {float(row[tu]), float(1.0 - row[tv])};
    if (has_tangents)
        tangents[vertex] = {float(row[tx]), float(row[ty]), float(row[tz]), float(row[tw])};
    if (has_colors) colors[vertex] = colors_.linear({row[red], row[green], row[blue], row[alpha]});
}

bool PlyVertices::read_records(const PlyElement& element, PlyEncoding encoding, int threads,
                               PlyValues& values) {
    const auto records = PlyRecords::of(element, encoding, values.rest());
    if (!records) return false;
    positions_are_floats_ =
        types_[px] == PlyType::f32 && types_[py] == PlyType::f32 && types_[pz] == PlyType::f32;
    make_room(element.count);
    std::vector<std::pair<std::size_t, Slot>> taken;  // property and slot
    for (std::size_t p = 0; p < slots_.size(); ++p)
        if (slots_[p]) taken.push_back({p, *slots_[p]});
    std::atomic<bool> alike = true;
    constexpr std::size_t block = 4096;
    parallel_blocks(element.count, block, threads, [&](std::size_t begin, std::size_t end) {
        if (!alike || !records->alike(begin, end)) {
            alike = false;
            return;
        }
        const std::size_t count = end - begin;
        std::vector<double> columns(taken.size() * count);
        for (std::size_t k = 0; k < taken.size(); ++k)
            records->read(taken[k].first, 0, begin, end, columns.data() + k * count);
        Row row{};
        for (std::size_t i = 0; i < count; ++i) {
            for (std::size_t k = 0; k < taken.size(); ++k)
                row[taken[k].second] = columns[k * count + i];
            set(begin + i, row);
        }
    });
    if (alike) values.skip(records->size());
    return alike;
}

std::uint64_t PlyVertices::read(const PlyElement& element, PlyEncoding encoding, int threads,
                                PlyValues& values) {
    if (read_records(element, encoding, threads, values)) return element.count;
    positions_are_floats_ = false;
    float_positions_ = {};
    make_room(element.count);
    for (std::uint64_t i = 0; i < element.count; ++i) {
        Row row{};
        for (std::size_t p = 0; p < slots_.size(); ++p)
            if (!(slots_[p] ? values.next(element.properties[p].type, row[*slots_[p]])
                            : values.skip(element.properties[p])))
                return i;
        values.end_element();
        set(i, row);
    }
    return element.count;
}

void PlyVertices::move_positions(Mesh& mesh) {
    if (positions_are_floats_)
        mesh.positions = std::move(float_positions_);
    else
        set_positions(mesh, positions_);
}

}  // namespace prep::detail
