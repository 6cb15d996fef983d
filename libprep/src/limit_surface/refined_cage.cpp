#include "limit_surface/refined_cage.h"

#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/topologyRefinerFactory.h>

#include <algorithm>
#include <cmath>

#include "limit_surface/far_levels.h"
#include "limit_surface/scheme_pieces.h"

namespace Osd = OpenSubdiv::OPENSUBDIV_VERSION;
using prep::detail::SurfaceCage;

namespace prep::detail {
namespace {

// What the refiner refines, of a face-varying channel too.
const SurfaceCage& refined_mesh(const SurfaceCage& cage) {
    return cage.channel_of ? *cage.channel_of : cage;
}

}  // namespace
}  // namespace prep::detail

namespace OpenSubdiv::OPENSUBDIV_VERSION::Far {

template <>
bool TopologyRefinerFactory<SurfaceCage>::resizeComponentTopology(TopologyRefiner& refiner,
                                                                  const SurfaceCage& channel) {
    const SurfaceCage& cage = prep::detail::refined_mesh(channel);
    setNumBaseVertices(refiner, int(cage.vertex_count));
    setNumBaseFaces(refiner, int(cage.face_count()));
    for (std::uint32_t f = 0; f < cage.face_count(); ++f)
        setNumBaseFaceVertices(refiner, int(f), int(cage.face_size(f)));
    return true;
}

template <>
bool TopologyRefinerFactory<SurfaceCage>::assignComponentTopology(TopologyRefiner& refiner,
                                                                  const SurfaceCage& channel) {
    const SurfaceCage& cage = prep::detail::refined_mesh(channel);
    for (std::uint32_t f = 0; f < cage.face_count(); ++f) {
        IndexArray vertices = getBaseFaceVertices(refiner, int(f));
        for (std::uint32_t c = 0; c < cage.face_size(f); ++c)
            vertices[int(c)] = int(cage.corner_vertices[cage.face_offsets[f] + c]);
    }
    return true;
}

template <>
bool TopologyRefinerFactory<SurfaceCage>::assignComponentTags(TopologyRefiner& refiner,
                                                              const SurfaceCage& channel) {
    const SurfaceCage& cage = prep::detail::refined_mesh(channel);
    const auto clamped = [](float sharpness) {
        return std::min(sharpness, prep::detail::infinitely_sharp);
    };
    for (const prep::EdgeMark& mark : cage.creases) {
        if (mark.v0 == mark.v1) continue;
        const Index edge = findBaseEdge(refiner, int(mark.v0), int(mark.v1));
        if (IndexIsValid(edge)) setBaseEdgeSharpness(refiner, edge, clamped(mark.sharpness));
    }
    for (const prep::VertexMark& mark : cage.corners)
        setBaseVertexSharpness(refiner, int(mark.vertex), clamped(mark.sharpness));
    return true;
}

template <>
bool TopologyRefinerFactory<SurfaceCage>::assignFaceVaryingTopology(TopologyRefiner& refiner,
                                                                    const SurfaceCage& cage) {
    if (!cage.channel_of) return true;
    Sdc::Options rule;
    rule.SetFVarLinearInterpolation(Sdc::Options::FVarLinearInterpolation(int(cage.rule)));
    const int channel = createBaseFVarChannel(refiner, int(cage.vertex_count), rule);
    for (std::uint32_t f = 0; f < cage.face_count(); ++f) {
        IndexArray values = getBaseFaceFVarValues(refiner, int(f), channel);
        for (std::uint32_t c = 0; c < cage.face_size(f); ++c)
            values[int(c)] = int(cage.corner_vertices[cage.face_offsets[f] + c]);
    }
    return true;
}

template <>
void TopologyRefinerFactory<SurfaceCage>::reportInvalidTopology(TopologyError, const char*,
                                                                const SurfaceCage&) {}

}  // namespace OpenSubdiv::OPENSUBDIV_VERSION::Far

namespace prep::detail {
namespace Far = Osd::Far;
namespace Sdc = Osd::Sdc;

// The cage's base and what is cut deep; and, where that is not all, what is cut once.
struct RefinedCage::Rules {
    std::unique_ptr<Far::TopologyRefiner> refiner, shallow;
    bool channel = false;             // values are those of channel 0
    std::uint32_t deep_vertices = 0;  // of level 1: the refiner's, before those of `shallow`
};

namespace {

Sdc::SchemeType scheme_type(const SurfaceCage& cage) {
    return cage.scheme == SubdivisionScheme::loop ? Sdc::SCHEME_LOOP
           : cage.linear                          ? Sdc::SCHEME_BILINEAR
                                                  : Sdc::SCHEME_CATMARK;
}

// Borders without a rule get one here: a hole would leave the rings beside it incomplete, and what
// is inside does not depend on it. has_surface tells which faces are holes.
Sdc::Options refiner_options(const SurfaceCage& cage) {
    Sdc::Options options;
    options.SetVtxBoundaryInterpolation(cage.boundary == BoundaryRule::edge_and_corner
                                            ? Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER
                                            : Sdc::Options::VTX_BOUNDARY_EDGE_ONLY);
    options.SetCreasingMethod(cage.creasing == CreasingMethod::chaikin
                                  ? Sdc::Options::CREASE_CHAIKIN
                                  : Sdc::Options::CREASE_UNIFORM);
    options.SetTriangleSubdivision(cage.smooth_triangles ? Sdc::Options::TRI_SUB_SMOOTH
                                                         : Sdc::Options::TRI_SUB_CATMARK);
    return options;
}

// Levels until no sharpness is left, and two for extraordinary vertices to stand alone.
int isolation_level(const FarLevel& base) {
    float sharpest = 0;
    const auto consider = [&](float s) {
        if (s < infinitely_sharp) sharpest = std::max(sharpest, s);
    };
    for (int e = 0; e < base.GetNumEdges(); ++e) consider(base.GetEdgeSharpness(e));
    for (int v = 0; v < base.GetNumVertices(); ++v) consider(base.GetVertexSharpness(v));
    return std::clamp(int(std::ceil(sharpest)) + 1, 2, 12);
}

// Triangles or quads that semi-sharp edges have to be cut into until their sharpness is used up, at
// most: a crease that goes on alike over both of its ends is a patch for catmark's uniform creases.
// Of a channel as such it is one beside faces that are not cut alone.
double faces_of_creases(const SurfaceCage& cage, const FarLevel& base,
                        const std::vector<int>& deep_and_beside) {
    const bool patches = cage.scheme == SubdivisionScheme::catmark &&
                         cage.creasing == CreasingMethod::uniform && !cage.channel_of;
    const auto goes_on = [&](int v, float sharpness) {
        int alike = 0;
        for (const int e : base.GetVertexEdges(v)) alike += base.GetEdgeSharpness(e) == sharpness;
        return alike == 2;
    };
    std::vector<std::uint8_t> at_cut(std::size_t(base.GetNumEdges()), 0);
    for (const int f : deep_and_beside)
        for (const int e : base.GetFaceEdges(f)) at_cut[std::size_t(e)] = 1;
    double faces = 0;
    for (int e = 0; e < base.GetNumEdges(); ++e) {
        const float sharpness = base.GetEdgeSharpness(e);
        if (!at_cut[std::size_t(e)] || sharpness <= 0 || sharpness >= infinitely_sharp) continue;
        const auto ends = base.GetEdgeVertices(e);
        if (patches && goes_on(ends[0], sharpness) && goes_on(ends[1], sharpness)) continue;
        faces += 12 * std::exp2(std::ceil(double(sharpness)));
    }
    return faces;
}
// At some 280 bytes a face with all that is made of it: 19 GB, of the 24 GiB that meshes of 50
// million triangles are to be made in.
constexpr double most_crease_faces = 1 << 26;

template <class Pieces>
std::vector<PieceKind> kinds_of(const RefinedLevel& level, bool linear) {
    const LevelFaces faces(level, Pieces::corners);
    PieceKinds<Pieces> kinds(faces, linear);
    std::vector<PieceKind> all(level.first_child.size());
    for (std::uint32_t f = 0; f < all.size(); ++f) all[f] = kinds.of(f);
    return all;
}

// The faces that have to be cut. Around vertices of n-gons, or where something is semi-sharp, once
// is not enough: `deep`, and with them the faces beside them, whose rings they need.
struct FacesToCut {
    std::vector<int> all, deep_and_beside;
    std::vector<std::uint8_t> deep;  // per face
    bool any_shallow = false;
};
FacesToCut faces_to_cut(const RefinedLevel& base, const std::vector<PieceKind>& kinds,
                        std::uint32_t corners) {
    FacesToCut cut;
    const auto begin = [&](std::uint32_t f) { return base.face_offsets[f]; };
    const auto marked = [&](std::uint32_t f, const std::vector<std::uint8_t>& vertices) {
        bool found = false;
        for (std::uint32_t c = begin(f); c < begin(f + 1); ++c)
            found |= vertices[base.corner_vertices[c]] != 0;
        return found;
    };
    const auto mark = [&](std::uint32_t f, std::vector<std::uint8_t>& vertices) {
        for (std::uint32_t c = begin(f); c < begin(f + 1); ++c)
            vertices[base.corner_vertices[c]] = 1;
    };
    std::vector<std::uint8_t> odd(base.vertex_count), beside(base.vertex_count);
    for (std::uint32_t v = 0; v < base.vertex_count; ++v)
        odd[v] = (base.vertex_flags[v] & VertexFlags::semi_sharp) != 0;
    for (std::uint32_t f = 0; f < kinds.size(); ++f)
        if (begin(f + 1) - begin(f) != corners) mark(f, odd);
    cut.deep.assign(kinds.size(), 0);
    for (std::uint32_t f = 0; f < kinds.size(); ++f) {
        if (kinds[f].kind != Piece::none) continue;
        cut.all.push_back(int(f));
        cut.deep[f] = marked(f, odd);
        cut.any_shallow |= !cut.deep[f];
        if (cut.deep[f]) mark(f, beside);
    }
    for (const int f : cut.all)
        if (marked(std::uint32_t(f), beside)) cut.deep_and_beside.push_back(f);
    return cut;
}

// Per face of the cage: holes have none, nor has what is at a border that the rule leaves out.
std::vector<std::uint8_t> faces_with_surface(const SurfaceCage& cage, const FarLevel& base) {
    std::vector<std::uint8_t> has(cage.face_count(), 1);
    for (std::uint32_t f = 0; f < cage.face_count(); ++f) {
        if (!cage.holes.empty() && cage.holes[f]) has[f] = 0;
        if (cage.boundary != BoundaryRule::none || cage.linear) continue;
        for (std::uint32_t c = cage.face_offsets[f]; c < cage.face_offsets[f + 1]; ++c)
            if (base.IsVertexBoundary(int(cage.corner_vertices[c]))) has[f] = 0;
    }
    return has;
}

// `uniform`: the creases' method, without Chaikin's averages; `channel`: of a channel as such.
void refine_faces(Far::TopologyRefiner& refiner, int level, const std::vector<int>& faces,
                  bool uniform, bool channel) {
    if (faces.empty()) return;
    Far::TopologyRefiner::AdaptiveOptions options(level);
    // By Chaikin's averages the halves of an edge differ: a vertex may be smooth levels before its
    // neighbours are, and its other faces have to come along. Of a channel as such, seams may part
    // what is one crease to the mesh.
    options.SetSecondaryLevel(uniform && !channel ? 2 : unsigned(level));
    options.useInfSharpPatch = true;
    options.considerFVarChannels = channel;
    options.useSingleCreasePatch = uniform && !channel;
    refiner.RefineAdaptive(options, {faces.data(), int(faces.size())});
}

// What was cut, and by which refiner.
struct CutLevels {
    const Far::TopologyRefiner& refiner;
    const Far::TopologyRefiner* shallow;  // or none
    const FacesToCut& cut;
    bool triangles, channel;

    // `sharp`: of the level above, where it is a channel's; then of this.
    RefinedLevel copied(const Far::TopologyRefiner& from, int l, SharpValues& sharp) const {
        RefinedLevel level = copied_level(from.GetLevel(l), l, triangles);
        if (!channel) return level;
        sharp = sharp_children(from.GetLevel(l - 1), from.GetLevel(l), sharp, triangles ? 3 : 4);
        take_values(from.GetLevel(l), sharp, level);
        return level;
    }
};

// All below level 0, which is there; faces that the shallow refiner has cut come after the others.
// Returns how many vertices of level 1 are before those of the shallow one. Error: more vertices
// than indices name.
Result<std::uint32_t> copy_levels(const CutLevels& cuts, SharpValues sharp,
                                  std::vector<RefinedLevel>& levels) {
    std::uint32_t before_shallow = 0;
    for (int l = 1; l < cuts.refiner.GetNumLevels(); ++l) {
        SharpValues of_shallow = sharp;
        RefinedLevel level = cuts.copied(cuts.refiner, l, sharp);
        RefinedLevel more;
        const bool two = l == 1 && cuts.shallow;
        if (two) more = cuts.copied(*cuts.shallow, l, of_shallow);
        RefinedLevel& above = levels.back();
        const std::uint64_t first = std::uint64_t(above.first_vertex) + above.vertex_count;
        if (const std::uint64_t all = first + level.vertex_count + more.vertex_count;
            all >= no_index)
            return Error{ErrorCode::limit,
                         "the refined cage would have more than " + std::to_string(all) +
                             " vertices; 32-bit indices name " + std::to_string(no_index - 1) +
                             ": subdivide parts of the mesh on their own",
                         ""};
        level.first_vertex = std::uint32_t(first);
        const FarLevel& before = cuts.refiner.GetLevel(l - 1);
        for (int f = 0; f < before.GetNumFaces(); ++f)
            above.first_child[std::size_t(f)] = first_child(before, f);
        if (two) {
            const auto faces = std::uint32_t(level.first_child.size());
            for (const int f : cuts.cut.all)
                if (const std::uint32_t child = first_child(cuts.shallow->GetLevel(0), f);
                    !cuts.cut.deep[std::size_t(f)])
                    above.first_child[std::size_t(f)] = child == no_index ? child : faces + child;
            before_shallow = level.vertex_count;
            append(level, more);
        }
        levels.push_back(std::move(level));
    }
    return before_shallow;
}

// Numbers as Far's refiner wants them.
struct NumberRow {
    double* numbers;
    std::uint32_t width;
    void Clear() { std::fill_n(numbers, width, 0.0); }
    void AddWithWeight(const NumberRow& other, double weight) {
        for (std::uint32_t k = 0; k < width; ++k) numbers[k] += weight * other.numbers[k];
    }
};
struct NumberRows {
    double* numbers;
    std::uint32_t width;
    NumberRow operator[](int i) const { return {numbers + std::size_t(i) * width, width}; }
};

struct SparseRow {
    SparseValue* value;
    void Clear() { value->terms.clear(); }
    void AddWithWeight(const SparseRow& other, double weight) {
        if (weight == 0) return;
        std::vector<std::pair<std::uint32_t, double>> sum;
        const auto &a = value->terms, &b = other.value->terms;
        sum.reserve(a.size() + b.size());
        std::size_t i = 0, j = 0;
        while (i < a.size() || j < b.size()) {
            if (j == b.size() || (i < a.size() && a[i].first < b[j].first)) {
                sum.push_back(a[i++]);
            } else if (i == a.size() || b[j].first < a[i].first) {
                sum.emplace_back(b[j].first, weight * b[j].second);
                ++j;
            } else {
                sum.emplace_back(a[i].first, a[i].second + weight * b[j].second);
                ++i, ++j;
            }
        }
        value->terms = std::move(sum);
    }
};
struct SparseRows {
    SparseValue* values;
    SparseRow operator[](int i) const { return {values + i}; }
};

}  // namespace

RefinedCage::RefinedCage() = default;
RefinedCage::RefinedCage(RefinedCage&&) noexcept = default;
RefinedCage& RefinedCage::operator=(RefinedCage&&) noexcept = default;
RefinedCage::~RefinedCage() = default;

Result<RefinedCage> RefinedCage::make(const SurfaceCage& cage) {
    using Factory = Far::TopologyRefinerFactory<SurfaceCage>;
    const Error not_taken{ErrorCode::invalid,
                          "the cage's topology cannot be refined: check the mesh (inspect)", ""};
    RefinedCage refined;
    refined.corners_per_face = cage.corners_per_face();
    refined.linear = cage.linear;
    refined.rules_ = std::make_unique<Rules>();
    auto& refiner = refined.rules_->refiner;
    if (cage.face_count() == 0) {
        refined.levels.resize(1);
        refined.levels[0].face_offsets.assign(1, 0);
        refined.levels[0].vertex_count = cage.vertex_count;
        return refined;
    }
    const SurfaceCage& mesh = refined_mesh(cage);
    refiner.reset(Factory::Create(cage, {scheme_type(mesh), refiner_options(mesh)}));
    if (!refiner) return not_taken;
    const bool triangles = cage.scheme == SubdivisionScheme::loop;
    const FarLevel& base = refiner->GetLevel(0);
    refined.edge_count = std::uint32_t(base.GetNumEdges());
    refined.has_surface = faces_with_surface(cage, base);
    const bool channel = refined.rules_->channel = cage.channel_of != nullptr;
    SharpValues sharp(channel ? cage.vertex_count : 0);
    for (const VertexMark& mark : cage.corners)
        if (channel && mark.sharpness >= infinitely_sharp) sharp[mark.vertex] = 1;
    refined.levels.push_back(copied_level(base, 0, triangles));
    if (channel) take_values(base, sharp, refined.levels[0]);
    refined.base_kinds = triangles ? kinds_of<TrianglePieces>(refined.levels[0], cage.linear)
                                   : kinds_of<QuadPieces>(refined.levels[0], cage.linear);
    const FacesToCut cut =
        faces_to_cut(refined.levels[0], refined.base_kinds, refined.corners_per_face);
    if (const double faces = cage.linear ? 0 : faces_of_creases(cage, base, cut.deep_and_beside);
        faces > most_crease_faces) {
        if (channel) {
            SurfaceCage own = cage;
            own.channel_of = nullptr;
            Result<RefinedCage> by_seams = make(own);
            if (by_seams) by_seams->approximate_seams = true;
            return by_seams;
        }
        return Error{ErrorCode::limit,
                     "the semi-sharp creases would be cut into some " +
                         std::to_string(std::uint64_t(faces)) + " faces; the limit is " +
                         std::to_string(std::uint64_t(most_crease_faces)) +
                         ": use fewer, lower or infinite (10) sharpnesses",
                     ""};
    }
    const auto refine = [&](Far::TopologyRefiner& one, int level, const std::vector<int>& faces) {
        refine_faces(one, level, faces, cage.creasing == CreasingMethod::uniform, channel);
    };
    auto& shallow = refined.rules_->shallow;
    const bool any_deep = !cut.deep_and_beside.empty();
    if (cut.any_shallow && any_deep) {
        shallow.reset(Factory::Create(*refiner));
        if (!shallow) return not_taken;
        refine(*shallow, 1, cut.all);
    }
    const int deep_level = cage.linear ? 1 : isolation_level(base);
    refine(*refiner, any_deep ? deep_level : 1, any_deep ? cut.deep_and_beside : cut.all);
    if (!cage.linear &&
        !(can_be_summed(*refiner, triangles) && (!shallow || can_be_summed(*shallow, triangles))))
        return Error{ErrorCode::invalid,
                     "faces that use a vertex twice fold the cage so that it cannot be refined: "
                     "remove them first (--repair)",
                     ""};
    const CutLevels cuts{*refiner, shallow.get(), cut, triangles, channel};
    const Result<std::uint32_t> deep = copy_levels(cuts, std::move(sharp), refined.levels);
    if (!deep) return deep.error();
    refined.rules_->deep_vertices = *deep;
    return refined;
}

std::uint32_t RefinedCage::total_vertices() const {
    return levels.back().first_vertex + levels.back().vertex_count;
}

RefinedValues RefinedCage::refine(std::span<const double> cage_values, std::uint32_t width) const {
    RefinedValues values;
    values.width = width;
    values.numbers.resize(std::size_t(total_vertices()) * width);
    std::copy(cage_values.begin(), cage_values.end(), values.numbers.begin());
    if (!rules_->refiner) return values;
    const Far::PrimvarRefinerReal<double> refiner(*rules_->refiner);
    for (std::size_t l = 1; l < levels.size(); ++l) {
        const NumberRows from{
            values.numbers.data() + std::size_t(levels[l - 1].first_vertex) * width, width};
        NumberRows to{values.numbers.data() + std::size_t(levels[l].first_vertex) * width, width};
        const auto interpolate = [&](const Far::PrimvarRefinerReal<double>& rules,
                                     NumberRows& out) {
            rules_->channel ? rules.InterpolateFaceVarying(int(l), from, out, 0)
                            : rules.Interpolate(int(l), from, out);
        };
        interpolate(refiner, to);
        if (l > 1 || !rules_->shallow) continue;
        NumberRows after{to.numbers + std::size_t(rules_->deep_vertices) * width, width};
        interpolate(Far::PrimvarRefinerReal<double>(*rules_->shallow), after);
    }
    return values;
}

std::vector<SparseValue> RefinedCage::refine(std::vector<SparseValue> values) const {
    values.resize(total_vertices());
    if (!rules_->refiner) return values;
    const Far::PrimvarRefinerReal<double> refiner(*rules_->refiner);
    for (std::size_t l = 1; l < levels.size(); ++l) {
        const SparseRows from{values.data() + levels[l - 1].first_vertex};
        SparseRows to{values.data() + levels[l].first_vertex};
        refiner.Interpolate(int(l), from, to);
        if (l > 1 || !rules_->shallow) continue;
        SparseRows after{to.values + rules_->deep_vertices};
        Far::PrimvarRefinerReal<double>(*rules_->shallow).Interpolate(1, from, after);
    }
    return values;
}

float RefinedCage::vertex_sharpness(std::uint32_t vertex) const {
    return rules_->refiner->GetLevel(0).GetVertexSharpness(int(vertex));
}

float RefinedCage::edge_sharpness(std::uint32_t half_edge) const {
    return rules_->refiner->GetLevel(0).GetEdgeSharpness(int(levels[0].edges[half_edge]));
}

bool RefinedCage::is_manifold(std::uint32_t vertex) const {
    return !rules_->refiner->GetLevel(0).IsVertexNonManifold(int(vertex));
}

void RefinedCage::corners_around(std::uint32_t vertex, std::vector<std::uint32_t>& corners) const {
    const FarLevel& base = rules_->refiner->GetLevel(0);
    const auto faces = base.GetVertexFaces(int(vertex));
    const auto places = base.GetVertexFaceLocalIndices(int(vertex));
    corners.clear();
    for (int k = 0; k < faces.size(); ++k)
        corners.push_back(levels[0].face_offsets[std::size_t(faces[k])] + places[k]);
}

void RefinedCage::forget_rules() {
    rules_->shallow.reset();  // it shares the other's base
    rules_->refiner.reset();
}

}  // namespace prep::detail
