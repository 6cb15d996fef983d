#include "formats/assimp/model_files.h"

#include <algorithm>
#include <array>
#include <system_error>

#include "text/lower_case.h"

namespace prep::detail {
namespace {

std::string ending_of(const std::string& name) {
    return lower_case(std::filesystem::path(name).extension().string());
}

// Behind the last slash of either kind.
std::string name_of(const std::string& path) {
    return path.substr(path.find_last_of("/\\") + 1);
}

}  // namespace

class ModelFiles::Handler : public Assimp::DefaultIOSystem {
  public:
    explicit Handler(ModelFiles& files) : files_(files) {}

    bool Exists(const char* name) const override {
        const std::filesystem::path path = place_of(name);
        const bool there = DefaultIOSystem::Exists(path.c_str());
        note(path, there);
        return there;
    }

    Assimp::IOStream* Open(const char* name, const char* mode) override {
        const std::filesystem::path path = place_of(name);
        Assimp::IOStream* const file = DefaultIOSystem::Open(path.c_str(), mode);
        note(path, file != nullptr);
        if (file && std::find(files_.read_.begin(), files_.read_.end(), path) == files_.read_.end())
            files_.read_.push_back(path);
        return file;
    }

  private:
    // operator/ leaves absolute names as they are.
    std::filesystem::path place_of(const char* name) const {
        return files_.model_.parent_path() / name;
    }
    void note(const std::filesystem::path& path, bool there) const {
        (there ? files_.found_ : files_.sought_).insert(path.lexically_normal().string());
    }

    ModelFiles& files_;
};

ModelFiles::ModelFiles(const std::filesystem::path& model) : named_(model) {
    std::error_code ec;
    model_ = std::filesystem::absolute(model, ec);
    if (ec) model_ = model;
}

Assimp::IOSystem* ModelFiles::make_handler() {
    return new Handler(*this);
}

std::vector<std::filesystem::path> ModelFiles::read() const {
    std::vector<std::filesystem::path> out;
    const std::filesystem::path folder = model_.parent_path();
    for (const std::filesystem::path& path : read_) {
        if (path == model_) continue;
        // The rest of an absolute path that begins with the folder.
        const auto [in_folder, rest] =
            std::mismatch(folder.begin(), folder.end(), path.begin(), path.end());
        std::filesystem::path own = path;
        if (in_folder == folder.end()) {
            own = named_.parent_path();
            for (auto part = rest; part != path.end(); ++part) own /= *part;
        }
        out.push_back(std::move(own));
    }
    return out;
}

std::vector<std::string> ModelFiles::missing() const {
    // What a format may have beside it, as Quake's skins and MD5's motions, is sought as well.
    static constexpr std::array<std::string_view, 9> needed = {
        ".lwo", ".skeleton", ".xml", ".x3d", ".3ds", ".obj", ".x", ".b3d", ".irrmesh"};
    std::set<std::string> out;
    for (const std::string& path : sought_) {
        const std::string name = name_of(path), ending = ending_of(name);
        if (std::find(needed.begin(), needed.end(), ending) == needed.end()) continue;
        // "a.skeleton" is sought as "a.skeleton.xml" as well, and files of other folders beside the
        // model.
        const bool again = ending == ".xml" && sought_.contains(path.substr(0, path.size() - 4));
        const std::string beside = (model_.parent_path() / name).lexically_normal().string();
        if (!again && !found_.contains(path) && !found_.contains(path + ".xml") &&
            !found_.contains(beside))
            out.insert(name);
    }
    return {out.begin(), out.end()};
}

std::vector<std::string> ModelFiles::missing_scripts() const {
    const auto is_script = [](const std::string& path) { return ending_of(path) == ".material"; };
    std::vector<std::string> out;
    if (std::any_of(found_.begin(), found_.end(), is_script)) return out;
    for (const std::string& path : sought_)
        if (is_script(path)) out.push_back(name_of(path));
    return out;
}

}  // namespace prep::detail
