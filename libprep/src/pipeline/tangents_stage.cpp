// What happens to authored tangents, and how those that are missing are made.
#include "pipeline/array_bytes.h"
#include "pipeline/mesh_preparation.h"
#include "tangents/authored_tangents.h"

namespace prep::detail {
namespace {

constexpr unsigned everywhere = 0;  // no kind of fault: all are replaced

// The corners of parts that have no tangent at all.
std::vector<bool> corners_of_parts_without(const Mesh& mesh) {
    std::vector<bool> has(mesh.parts.size(), false), corners(mesh.corner_count(), false);
    const auto each = [&](const auto& what) {
        for (std::size_t f = 0; f < mesh.face_count(); ++f)
            for (std::uint32_t c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c)
                what(mesh.face_parts[f], c);
    };
    each([&](std::uint32_t part, std::uint32_t c) {
        if (mesh.tangents.indices[c] != no_index) has[part] = true;
    });
    each([&](std::uint32_t part, std::uint32_t c) { corners[c] = !has[part]; });
    return corners;
}

}  // namespace

// A tangent belongs to its normal: where that is not the file's any more, it is computed anew.
// A normal that was only rescaled is the file's.
Result<void> MeshPreparation::prepare_tangents() {
    MeshView view(mesh_, need_.tangent_uv_set);
    if (need_.tangents.needed || !mesh_.tangents.empty())
        mixed_uvs_ = mixed_tangent_uvs(mesh_, need_);
    if (!mixed_uvs_.empty()) view.uv = mixed_uvs_;
    const std::string& reason = need_.tangents.reason;
    if (need_.tangents.needed) {
        if (mesh_.tangents.empty() || options_.tangents == Authored::replace)
            return replace_tangents(view, reason, everywhere);
        if (options_.tangents == Authored::repair)
            return replace_tangents(view, "authored tangents are held against them", 0xff);
        if (normals_made_)
            return replace_tangents(
                view, "the normals changed, so the file's own tangents no longer fit", everywhere);
        return keep_tangents(view, "the file's own tangents are kept");
    }
    const bool untouched =
        options_.request.tangents == Request::Level::never && normal_replaced_.empty();
    const bool unread = options_.request.consumer.exact && !need_.provided.tangents;
    if (!mesh_.tangents.empty() && !normals_made_ && !untouched && !unread)
        return keep_tangents(view, reason);
    log_.skipped("tangents", reason);
    if (normals_made_ && !unread) drop_tangents();
    return {};
}

// But for those that are no frame any more.
Result<void> MeshPreparation::keep_tangents(const MeshView& view, const std::string& reason) {
    constexpr unsigned bad = tangent_unusable | tangent_stale;
    const TangentReview review = review_of(view, nullptr);
    // Without UVs there is no direction to compute.
    const bool lost = view.uv.indices.empty() && review.any(tangent_stale);
    if (!lost && review.any(bad))
        return replace_tangents(view,
                                "some authored tangents are missing, unusable or of normals "
                                "that were replaced",
                                bad);
    log_.skipped("tangents", reason);
    if (lost) {
        drop_tangents();
        return {};
    }
    report_review(review, bad);
    make_unit(mesh_.tangents.values);
    return {};
}

void MeshPreparation::drop_tangents() {
    if (mesh_.tangents.empty()) return;
    add_finding("stale-tangent", Severity::info, mesh_.corner_count(), {},
                "authored tangents were dropped: the normals they belong to changed");
    mesh_.tangents = {};
}

TangentReview MeshPreparation::review_of(const MeshView& view,
                                         const CornerTangents* computed) const {
    TangentReview review = review_tangents(view, mesh_.tangents, computed);
    review.mark_stale(normal_replaced_);
    // The primitives of a document have tangents each by itself: what none of one's has, and
    // nothing calls for, is not written either.
    if (!need_.tangents.needed && mesh_.tied_to_file && options_.document_stays &&
        !mesh_.face_parts.empty() && !mesh_.tangents.empty())
        review.forgive_missing(corners_of_parts_without(mesh_));
    return review;
}

// Everywhere, or where the file's own have one of these faults.
Result<void> MeshPreparation::replace_tangents(const MeshView& view, const std::string& reason,
                                               unsigned replace) {
    TangentOptions tangent_options = options_.tangent;
    tangent_options.threads = options_.threads;
    // Authored tangents may come without UVs or normals: any frame then replaces bad ones.
    TangentInput input(view);
    std::vector<std::uint32_t> none;
    if (input.uv.indices.empty() || input.normals.indices.empty())
        none.assign(view.corner_count(), no_index);
    if (input.uv.indices.empty()) input.uv = {{}, none};
    if (input.normals.indices.empty()) input.normals = {{}, none};
    auto tangents =
        log_.run("tangents", reason, [&] { return corner_tangents(input, tangent_options); });
    if (!tangents) return std::move(tangents).error();
    log_.count_moved("tangents", surface_bytes(view) + array_bytes(view.normals) +
                                     array_bytes(view.uv) + array_bytes(tangents->tangents));
    TangentReview review;
    const bool surgical = replace != everywhere;
    if (surgical) {
        const bool repair = options_.tangents == Authored::repair;
        review = review_of(view, repair ? &*tangents : nullptr);
        report_review(review, replace);
    }
    std::uint64_t fallbacks = 0;
    std::vector<std::uint32_t> places;
    for (const auto& fallback : tangents->fallbacks) {
        if (surgical && !(review.faults[fallback.corner] & replace)) continue;
        ++fallbacks;
        if (places.size() < Finding::max_places) places.push_back(fallback.corner);
    }
    add_finding("tangent-fallback", Severity::info, fallbacks, std::move(places),
                "MikkTSpace defines no tangent at these corners: they got an orthonormal one");
    mesh_.tangents = surgical ? merge_tangents(mesh_.tangents, review, replace, tangents->tangents)
                              : std::move(tangents->tangents);
    tangents_made_ = !surgical;
    return {};
}

void MeshPreparation::report_review(const TangentReview& review, unsigned replaced) {
    struct Kind {
        const char *name, *what, *kept;
    };
    static constexpr Kind kinds[tangent_fault_kinds] = {
        {"missing-tangent", "corners without a tangent got a computed one", ""},
        {"non-finite-tangent", "authored tangents that are not finite were replaced", ""},
        {"zero-tangent", "authored tangents of length zero were replaced", ""},
        {"tangent-sign", "authored tangents whose w is no sign were replaced", ""},
        {"non-unit-tangent", "authored tangents that are not unit were replaced",
         "authored tangents that are not unit were rescaled, their w made 1 or -1"},
        {"non-orthogonal-tangent", "authored tangents out of their normal's plane were replaced",
         "authored tangents are out of their normal's plane: kept, repairing replaces them"},
        {"tangent-against-uvs", "authored tangents that contradict the UVs were replaced", ""},
        {"stale-tangent", "authored tangents whose normals were replaced were replaced too", ""},
    };
    for (unsigned k = 0; k < tangent_fault_kinds; ++k) {
        const char* const text = (replaced >> k & 1u) ? kinds[k].what : kinds[k].kept;
        if (review.counts[k] == 0 || *text == 0) continue;
        std::vector<std::uint32_t> places;
        for (std::uint32_t c = 0; c < review.faults.size(); ++c) {
            if (!(review.faults[c] >> k & 1u)) continue;
            places.push_back(c);
            if (places.size() == Finding::max_places) break;
        }
        add_finding(kinds[k].name, k == 0 ? Severity::info : Severity::warning, review.counts[k],
                    std::move(places), text);
    }
}

}  // namespace prep::detail
