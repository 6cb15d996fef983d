// The glTF files of the shared corpus, prepared and written, against the files themselves: both
// read by another program (@gltf-transform), compared value by value.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "gltf_oracle.h"
#include "mesh_files.h"
#include "npm_tools.h"
#include "prep/load.h"
#include "prep/save.h"
#include "shared_data.h"

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Numbers = std::vector<double>;

class Comparison {
  public:
    Comparison(const test::DecodedGltf& before, const test::DecodedGltf& after, bool frames_kept)
        : a_(before), b_(after), frames_kept_(frames_kept) {}

    std::string run() {
        const Json &x = a_.json.at("meshes"), &y = b_.json.at("meshes");
        if (x.size() != y.size()) return "number of meshes";
        for (std::size_t m = 0; m < x.size(); ++m) {
            const Json &p = x[m].at("primitives"), &q = y[m].at("primitives");
            if (p.size() != q.size()) return "number of primitives";
            for (std::size_t i = 0; i < p.size(); ++i) {
                where_ = "mesh " + std::to_string(m) + ", primitive " + std::to_string(i) + ": ";
                primitive(p[i], q[i]);
            }
        }
        where_.clear();
        Json u = a_.json, v = b_.json;
        for (Json* json : {&u, &v}) {
            for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
                // Compression is undone; one that a file of the corpus uses undeclared is declared.
                Json& names = json->at(list);
                for (const char* name : {"KHR_draco_mesh_compression", "EXT_meshopt_compression",
                                         "EXT_undeclared_extension"})
                    names.erase(std::remove(names.begin(), names.end(), Json(name)), names.end());
            }
            for (Json& image : json->at("images")) {  // in the file now, not beside it
                image.erase("uri");
                image.erase("name");
            }
            // How the package stores its defaults.
            for (Json& material : json->at("materials")) material.erase("defaults");
            for (Json& mesh : json->at("meshes"))
                for (Json& p : mesh.at("primitives"))
                    for (const char* key : {"mode", "indices", "attributes", "targets"})
                        p.erase(key);
        }
        same(u, v, "");
        return said_;
    }
    std::size_t values() const { return values_; }

  private:
    void say(const std::string& what) {
        if (said_.empty()) said_ = where_ + what;
    }

    // Members one by one; lists of numbers by what they hold.
    void same(const Json& x, const Json& y, const std::string& path) {
        if (x.is_object() && y.is_object()) {
            if (x.contains("store") && y.contains("store")) {
                const Numbers p = a_.numbers(x), q = b_.numbers(y);
                values_ += p.size();
                if (p != q || x["type"] != y["type"]) say(path);
                return;
            }
            for (const auto& item : x.items()) {
                if (y.contains(item.key()))
                    same(item.value(), y[item.key()], path + "/" + item.key());
                else
                    say("lost: " + path + "/" + item.key());
            }
            for (const auto& item : y.items())
                if (!x.contains(item.key())) say("new: " + path + "/" + item.key());
        } else if (x.is_array() && y.is_array() && x.size() == y.size()) {
            for (std::size_t i = 0; i < x.size(); ++i)
                same(x[i], y[i], path + "/" + std::to_string(i));
        } else if (x != y) {
            say(path + ": " + x.dump() + " became " + y.dump());
        }
    }

    // Vertices in the order in which they are drawn: three to a triangle.
    static std::vector<std::size_t> corners(const test::DecodedGltf& file, const Json& p) {
        std::vector<std::size_t> in, out;
        if (p.at("indices").is_null()) {
            in.resize(p.at("attributes").at("POSITION").at("count").get<std::size_t>());
            for (std::size_t i = 0; i < in.size(); ++i) in[i] = i;
        } else {
            for (const double i : file.numbers(p["indices"])) in.push_back(std::size_t(i));
        }
        const int mode = p.at("mode");
        if (mode < 4) return in;
        for (std::size_t i = 0; i + 2 < in.size(); ++i) {
            if (mode == 4 && i % 3 == 0) out.insert(out.end(), {in[i], in[i + 1], in[i + 2]});
            if (mode == 5) out.insert(out.end(), {in[i], in[i + 1 + i % 2], in[i + 2 - i % 2]});
            if (mode == 6) out.insert(out.end(), {in[i + 1], in[i + 2], in[0]});
        }
        return out;
    }

    void primitive(const Json& x, const Json& y) {
        if (!x.at("attributes").contains("POSITION")) return;
        const int mode = x.at("mode");
        if (y.at("mode") != (mode >= 4 ? 4 : mode)) return say("mode");
        const std::vector<std::size_t> at = corners(a_, x), to = corners(b_, y);
        if (at.size() != to.size())
            return say(std::to_string(at.size()) + " corners became " + std::to_string(to.size()));
        lists(x["attributes"], y["attributes"], at, to, mode >= 4, "");
        if (x["targets"].size() != y["targets"].size()) return say("number of targets");
        for (std::size_t t = 0; t < x["targets"].size(); ++t)
            lists(x["targets"][t], y["targets"][t], at, to, mode >= 4, "target: ");
    }

    void lists(const Json& x, const Json& y, const std::vector<std::size_t>& at,
               const std::vector<std::size_t>& to, bool faces, const std::string& of) {
        const auto of_frame = [](const std::string& name) {
            return name == "NORMAL" || name == "TANGENT";
        };
        for (const auto& item : y.items())
            if (!x.contains(item.key()) && !of_frame(item.key())) say("new: " + of + item.key());
        for (const auto& item : x.items()) {
            if (!y.contains(item.key())) {
                if (item.key() != "TANGENT") say("lost: " + of + item.key());
                continue;
            }
            if (of_frame(item.key()) && faces && !frames_kept_) continue;
            // Unit vectors that were quantised come out as long as they should be.
            const bool direction = faces && of.empty() && of_frame(item.key());
            const Numbers p = a_.numbers(item.value()), q = b_.numbers(y[item.key()]);
            const auto width = item.value().at("width").get<std::size_t>();
            values_ += at.size() * width;
            const bool weights = of.empty() && item.key().starts_with("WEIGHTS_");
            const Numbers sums = weights ? weight_sums(x) : Numbers{};
            for (std::size_t c = 0; c < at.size(); ++c) {
                const double *u = &p[at[c] * width], *v = &q[to[c] * width];
                if (weights && same_weights(u, v, width, sums[at[c]], item.value())) continue;
                if (direction ? same_direction(u, v, width) : std::equal(u, u + width, v)) continue;
                return say(of + item.key() + " of corner " + std::to_string(c));
            }
        }
    }

    Numbers weight_sums(const Json& attributes) const {
        Numbers sums;
        for (const auto& item : attributes.items()) {
            if (!item.key().starts_with("WEIGHTS_")) continue;
            const Numbers set = a_.numbers(item.value());
            sums.resize(set.size() / 4);
            for (std::size_t i = 0; i < set.size(); ++i) sums[i / 4] += set[i];
        }
        return sums;
    }

    // Weights that do not add up to 1 are scaled to do so; integers move by less than a step.
    static bool same_weights(const double* u, const double* v, std::size_t width, double sum,
                             const Json& array) {
        const int type = array.at("componentType");
        const double step = type == 5121 ? 1 / 255.0 : type == 5123 ? 1 / 65535.0 : 1e-6;
        if (std::abs(sum - 1) <= 2e-7) return false;
        for (std::size_t k = 0; k < width; ++k)
            if (std::abs(u[k] / sum - v[k]) >= step) return false;
        return true;
    }

    // Kept, or rescaled where they are not unit. Zero and non-finite ones are not the file's to
    // keep.
    static bool same_direction(const double* u, const double* v, std::size_t width) {
        if (std::equal(u, u + width, v)) return true;
        const double length = std::sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
        if (length == 0 || !std::isfinite(length)) return true;
        for (std::size_t k = 0; k < 3; ++k)
            if (!(std::abs(u[k] / length - v[k]) < 1e-6)) return false;  // ten roundings of floats
        return width < 4 || u[3] == v[3];
    }

    const test::DecodedGltf &a_, &b_;
    bool frames_kept_;
    std::string where_, said_;
    std::size_t values_ = 0;
};

bool is_gltf(const fs::path& path) {
    return path.extension() == ".glb" || path.extension() == ".gltf";
}

std::vector<fs::path> gltf_files(const fs::path& corpus) {
    std::vector<fs::path> out;
    for (const auto& entry : fs::recursive_directory_iterator(corpus))
        if (is_gltf(entry.path())) out.push_back(entry.path());
    std::sort(out.begin(), out.end());
    return out;
}

// Prepares every file in this way and compares what was written. `kept`: whether the files' own
// normals and tangents are.
void compare_all(const prep::PrepareOptions& options, bool kept) {
    MESHPREP_REQUIRE_SHARED(shared);
    MESHPREP_REQUIRE_GLTF_TRANSFORM(modules);
    const test::TempDir dir;
    std::vector<fs::path> files;  // each source, then what was written
    for (const fs::path& file : gltf_files(shared / "corpus")) {
        // Of the validator's own some are broken: what may be refused tests/tools/corpus_test says.
        const bool may_be_refused = file.string().find("gltf-validator") != std::string::npos;
        auto scene = prep::load_scene(file);
        if (!scene && may_be_refused) continue;
        ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
        auto prepared = prep::prepare(*std::move(scene), options);
        ASSERT_TRUE(prepared.has_value()) << file << prep::to_string(prepared.error());
        const fs::path out = dir / (std::to_string(files.size()) + ".glb");
        prep::SaveOptions saving;
        saving.compression = prep::Compression::none;  // Draco puts triangles in another order
        const auto notes = prep::save_scene(*prepared, out, saving);
        if (!notes && may_be_refused) continue;
        ASSERT_TRUE(notes.has_value()) << prep::to_string(notes.error());
        files.push_back(file);
        files.push_back(out);
    }
    const auto decoded = test::decode_gltf(modules, files, dir.path());
    ASSERT_TRUE(decoded.has_value());
    std::size_t compared = 0, values = 0;
    for (std::size_t i = 0; i < files.size(); i += 2) {
        const test::DecodedGltf &before = (*decoded)[i], &after = (*decoded)[i + 1];
        if (before.json.contains("error")) continue;
        ASSERT_FALSE(after.json.contains("error")) << files[i] << after.json["error"];
        Comparison comparison(before, after, kept);
        EXPECT_EQ(comparison.run(), "") << files[i];
        ++compared;
        values += comparison.values();
    }
    std::cout << compared << " files, " << values << " values\n";
    EXPECT_GE(compared, 70u);
    EXPECT_GE(values, 1000000u);
}

TEST(GltfCorpus, WrittenFilesHoldTheValuesOfTheirSources) {
    compare_all({}, true);
}

// Facets of 20° and tangents everywhere: far more vertices, each with the attributes of its own.
TEST(GltfCorpus, SplitVerticesHoldTheValuesOfTheirSources) {
    prep::PrepareOptions options;
    options.request.tangents = prep::Request::Level::always;
    options.normals = options.tangents = prep::Authored::replace;
    options.hard_edges.angle_degrees = 20;
    compare_all(options, false);
}

}  // namespace
