#include "meshprep/output/findings_text.h"

#include <algorithm>

#include "meshprep/output/console.h"
#include "meshprep/output/report_json.h"

namespace meshprep {

std::string places_text(const prep::Finding& finding, std::size_t places) {
    const std::size_t shown = std::min(places, finding.places.size());
    if (shown == 0) return {};
    std::string text(prep::name_of(finding.place_kind));
    if (finding.count > 1)
        text = finding.place_kind == prep::PlaceKind::vertex ? "vertices" : text + "s";
    for (std::size_t i = 0; i < shown; ++i)
        text += (i == 0 ? " " : ", ") + std::to_string(finding.places[i]);
    if (finding.count > shown) text += ", …";
    return text;
}

std::vector<std::string> findings_text(const std::vector<prep::Finding>& findings,
                                       const std::vector<std::string>& mesh_names,
                                       std::size_t places) {
    std::vector<const prep::Finding*> sorted;
    for (const prep::Finding& f : findings) sorted.push_back(&f);
    std::stable_sort(
        sorted.begin(), sorted.end(),
        [](const prep::Finding* a, const prep::Finding* b) { return a->severity > b->severity; });
    std::vector<std::vector<std::string>> rows;
    for (const prep::Finding* f : sorted) {
        std::string text = f->text;
        const std::string where = places_text(*f, places);
        if (!where.empty()) text += " (" + where + ")";
        std::vector<std::string> row = {std::string(prep::name_of(f->severity)),
                                        with_commas(f->count), f->kind};
        if (mesh_names.size() > 1) {
            const std::string name = f->mesh < mesh_names.size() ? mesh_names[f->mesh] : "";
            row.push_back(name.empty() ? "mesh " + std::to_string(f->mesh) : name);
        }
        row.push_back(text);
        rows.push_back(std::move(row));
    }
    return align_table(rows, {false, true, false});
}

std::vector<std::string> repairs_text(const std::vector<prep::RepairStep>& repairs,
                                      const std::vector<std::string>& mesh_names,
                                      std::size_t places) {
    std::vector<std::vector<std::string>> rows;
    for (const prep::RepairStep& r : repairs) {
        prep::Finding where;
        where.count = r.changed;
        where.place_kind = r.place_kind;
        where.places = r.places;
        std::string text = r.text;
        if (const std::string named = places_text(where, places); !named.empty())
            text += " (" + named + ")";
        std::vector<std::string> row = {"repair", r.step, with_commas(r.changed) + " changed",
                                        r.left > 0 ? with_commas(r.left) + " left" : ""};
        if (mesh_names.size() > 1)
            row.push_back(r.mesh < mesh_names.size() && !mesh_names[r.mesh].empty()
                              ? mesh_names[r.mesh]
                              : "mesh " + std::to_string(r.mesh));
        row.push_back(r.changed > 0 || r.left > 0 ? text : "nothing to do");
        rows.push_back(std::move(row));
    }
    return align_table(rows, {false, false, true, true});
}

}  // namespace meshprep
