#include "meshprep/files/input_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <map>
#include <memory>
#include <mutex>
#include <utility>

#include "meshprep/files/archive.h"
#include "meshprep/files/file_list.h"
#include "prep/files.h"
#include "prep/formats.h"

namespace meshprep {
namespace {

namespace fs = std::filesystem;
using prep::Error;
using prep::ErrorCode;
using prep::Result;

constexpr const char* standard_input = "standard input";

std::vector<std::byte> head_of(const fs::path& path) {
    std::array<char, 512> head{};
    std::ifstream in(path, std::ios::binary);
    in.read(head.data(), std::streamsize(head.size()));
    const auto* const bytes = reinterpret_cast<const std::byte*>(head.data());
    return {bytes, bytes + in.gcount()};
}

// The ending for what starts so, with its dot; empty: nobody knows.
std::string ending_of(const std::vector<std::byte>& head) {
    const std::string_view text(reinterpret_cast<const char*>(head.data()), head.size());
    const prep::FileFormat* const format = prep::file_format_of_bytes(text);
    if (!format) return {};
    if (format->name == "glTF") return text.starts_with("glTF") ? ".glb" : ".gltf";
    return std::string(format->endings.front());
}

// Formats of other libraries may be archives themselves.
const char* packed_as(const fs::path& path) {
    const prep::FileFormat* const format = prep::file_format(path);
    if (!format || format->name == "Assimp") return nullptr;
    const std::vector<std::byte> head = head_of(path);
    return is_gzip(head) ? "gz" : is_zip(head) ? "zip" : nullptr;
}

bool in_a_name(char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '/' ||
           c == '.' || c == '_' || c == '-';
}

// All that comes from `from`, which `place` names. What never ends would fill the disk.
Result<void> spool(int from, const std::string& place, const fs::path& to, std::uint64_t most) {
    constexpr const char* not_kept = "cannot be kept in the directory for temporary files: ";
    int fd = ::open(to.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    const auto failed = [&](const char* what) {
        const Error error{ErrorCode::io, std::string(what) + std::strerror(errno), place};
        if (fd >= 0) ::close(fd);
        return error;
    };
    if (fd < 0) return failed(not_kept);
    std::vector<char> buffer(std::size_t(1) << 20);
    std::uint64_t all = 0;
    for (;;) {
        const ssize_t got = ::read(from, buffer.data(), buffer.size());
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) return failed("cannot be read: ");
        if (got == 0) break;
        all += std::uint64_t(got);
        if (all > most) {
            ::close(fd);
            return Error{ErrorCode::limit,
                         "more than " + std::to_string(most) + " bytes came; give it as a file",
                         place};
        }
        for (ssize_t done = 0; done < got;) {
            const ssize_t n = ::write(fd, buffer.data() + done, std::size_t(got - done));
            if (n < 0 && errno == EINTR) continue;
            if (n <= 0) return failed(not_kept);
            done += n;
        }
    }
    // File systems of networks may say only now that something was not written.
    if (::close(std::exchange(fd, -1)) != 0) return failed(not_kept);
    return {};
}

// Links to what lies in `from`: one each, for a directory of more files is no model's.
void link_all(const fs::path& from, const fs::path& to) {
    constexpr std::size_t most = 20000;
    std::size_t count = 0;
    std::error_code ec;
    for (fs::directory_iterator it(from, ec), end; !ec && it != end && count < most;
         it.increment(ec), ++count) {
        std::error_code taken;  // what is there already has its name
        fs::create_symlink(it->path(), to / it->path().filename(), taken);
    }
}

// These name no other files.
bool stands_alone(const fs::path& file) {
    const std::string ending = lower_ending(file);
    return ending == "stl" || ending == "off" || ending == "om";
}

// "/dev/fd/63" has none.
bool has_neighbours(const fs::path& file) {
    std::error_code ec;
    return !is_standard_stream(file) && !is_of_descriptors(fs::absolute(file, ec).parent_path());
}

// Never `directory` itself: where Ctrl-C has removed it, it stays removed.
Result<fs::path> make_place(const fs::path& directory) {
    const fs::path above = directory / "above", place = above / "here";
    std::error_code ec;
    fs::create_directory(above, ec);
    if (!ec) fs::create_directory(place, ec);
    if (ec) return Error{ErrorCode::io, "cannot be made: " + ec.message(), place.string()};
    return place;
}

}  // namespace

struct SiblingLinks::Folder {
    PrivateDirectory directory;
    fs::path place;
};

struct SiblingLinks::State {
    std::mutex mutex;
    std::map<fs::path, std::shared_ptr<const Folder>> folders;
};

SiblingLinks::SiblingLinks() : state_(std::make_unique<State>()) {}
SiblingLinks::~SiblingLinks() = default;

Result<std::shared_ptr<const SiblingLinks::Folder>> SiblingLinks::of(const fs::path& folder) {
    const std::lock_guard lock(state_->mutex);
    std::shared_ptr<const Folder>& known = state_->folders[folder];
    if (known) return known;
    Result<PrivateDirectory> made = PrivateDirectory::make();
    if (!made) return made.error();
    const Result<fs::path> place = make_place(made->path());
    if (!place) return place.error();
    link_all(folder, *place);
    link_all(folder.parent_path(), place->parent_path());
    known = std::make_shared<const Folder>(Folder{*std::move(made), *place});
    return known;
}

Result<InputFile> InputFile::open(const fs::path& named, const std::string& format,
                                  SiblingLinks* links, const StreamLimits& limits) {
    InputFile input;
    input.named_ = input.path_ = named;
    Result<void> done;
    if (const Result<void> there = require_file(named); !is_standard_stream(named) && !there) {
        return there.error();
    } else if (is_stream(named)) {
        done = input.read_stream(format, limits);
    } else if (is_packed(named)) {
        done = input.unpack(named, format, links);
    } else if (const char* const packed = packed_as(named); packed) {
        return Error{ErrorCode::syntax,
                     std::string("this is a ") + packed +
                         " file, whatever its ending says; end its name with ." + packed,
                     named.string()};
    } else if (!format.empty() && lower_ending(named) != format) {
        done = input.link_with_siblings(named, named.stem().string() + "." + format);
    }
    input.label_directories();
    if (!done) return input.relabelled(done.error());
    // Some readers name a file without its directory. What has no ending may be any word.
    if (input.path_ != named && input.path_.has_extension()) {
        const std::string shown = input.relabelled(input.path_.string());
        input.labels_.emplace_back(input.path_.filename().string(), shown);
    }
    return input;
}

Result<fs::path> InputFile::directory() {
    if (!directory_) {
        Result<PrivateDirectory> made = PrivateDirectory::make();
        if (!made) return made.error();
        directory_ = std::make_shared<PrivateDirectory>(*std::move(made));
        const Result<fs::path> place = make_place(directory_->path());
        if (!place) return place.error();
        place_ = *place;
    }
    return place_;
}

// Whatever else lies in directories of random names is the input's: what a file names and nobody
// has is said, and written, the same way in every run.
void InputFile::label_directories() {
    if (!directory_) return;
    for (fs::path at : {place_, shared_ ? shared_->parent_path() : place_})
        for (int up = 0; up < 3; ++up, at = at.parent_path())
            labels_.emplace_back(at.string(), place());
}

// Beside what is in the private directory, links to what lies beside the file, and above it to what
// lies above: materials and pictures are found as if the file were there. The directory is deep
// enough that "../textures" is never a neighbour of other users' temporary files.
Result<void> InputFile::link_with_siblings(const fs::path& file, const std::string& name) {
    const Result<fs::path> made = directory();
    if (!made) return made.error();
    std::error_code ec;
    const fs::path folder = fs::absolute(file, ec).parent_path();
    path_ = *made / name;
    if (!fs::exists(path_, ec)) fs::create_symlink(fs::absolute(file, ec), path_, ec);
    if (ec) return Error{ErrorCode::io, "cannot be linked to: " + ec.message(), file.string()};
    labels_.emplace_back(path_.string(), file.string());
    labels_.emplace_back(made->string(), folder.string());
    labels_.emplace_back(made->parent_path().string(), folder.parent_path().string());
    if (stands_alone(name)) return {};
    link_all(folder, *made);
    link_all(folder.parent_path(), made->parent_path());
    return {};
}

// Puts the unpacked file among the links that all inputs of its folder share. False where something
// of its name lies there, or the file system has no hard links: it then gets links of its own.
bool InputFile::share_links(const fs::path& file, SiblingLinks& links) {
    std::error_code ec;
    const fs::path folder = fs::absolute(file, ec).parent_path();
    const auto made = links.of(folder);
    if (!made) return false;
    const std::shared_ptr<const SiblingLinks::Folder> kept = *made;
    const fs::path to = kept->place / path_.filename();
    fs::create_hard_link(path_, to, ec);  // never over what is there
    if (ec) return false;
    shared_ = std::shared_ptr<const fs::path>(new fs::path(to), [kept](const fs::path* name) {
        std::error_code ignored;
        fs::remove(*name, ignored);
        delete name;
    });
    path_ = to;
    labels_.emplace_back(to.string(), file.string());
    labels_.emplace_back(kept->place.string(), folder.string());
    labels_.emplace_back(kept->place.parent_path().string(), folder.parent_path().string());
    return true;
}

std::string InputFile::place() const {
    return is_standard_stream(named_) ? std::string(standard_input) : named_.string();
}

// A named pipe is read like standard input, but has a name and what lies beside it.
Result<void> InputFile::read_stream(const std::string& format, const StreamLimits& limits) {
    const Result<fs::path> made = directory();
    if (!made) return made.error();
    const bool standard = is_standard_stream(named_);
    const fs::path spooled = *made / (standard ? "stdin" : "piped");
    labels_.emplace_back(spooled.string(), place());
    const int fd = standard ? STDIN_FILENO : ::open(named_.c_str(), O_RDONLY | O_CLOEXEC);
    if (fd < 0)
        return Error{ErrorCode::io, std::string("cannot be opened: ") + std::strerror(errno),
                     place()};
    const Result<void> read = spool(fd, place(), spooled, limits.most);
    if (!standard) ::close(fd);
    if (!read) return read;
    const std::vector<std::byte> head = head_of(spooled);
    if (head.empty())
        return Error{ErrorCode::syntax, "is empty; is the program before the pipe at fault?",
                     place()};
    if (is_zip(head) || is_gzip(head)) return unpack(spooled, format, nullptr);
    std::string ending = "." + (format.empty() ? lower_ending(named_) : format);
    if (!prep::file_format("x" + ending) && format.empty()) ending = ending_of(head);
    if (ending.empty())
        return Error{ErrorCode::unsupported,
                     "its first bytes tell no format; say it with --input-format, as in "
                     "--input-format fbx",
                     place()};
    std::error_code ec;
    path_ = *made / ((standard ? "stdin" : named_.stem().string()) + ending);
    fs::rename(spooled, path_, ec);
    if (ec) return Error{ErrorCode::io, "cannot be renamed: " + ec.message(), place()};
    labels_.insert(labels_.begin(), {path_.string(), place()});
    if (!has_neighbours(named_)) return {};
    const fs::path to_load = path_;
    if (Result<void> linked = link_with_siblings(named_, path_.filename().string()); !linked)
        return linked;
    path_ = to_load;
    return {};
}

Result<void> InputFile::unpack(const fs::path& data, const std::string& format,
                               SiblingLinks* links) {
    const Result<fs::path> made = directory();
    if (!made) return made.error();
    const std::vector<std::byte> head = head_of(data);
    if (head.empty()) return Error{ErrorCode::syntax, "the file is empty", place()};
    if (!is_zip(head) && (is_gzip(head) || lower_ending(named_) != "zip"))
        return unpack_gzip_file(data, format, links);
    // In a directory of its own, whose name a message can do without.
    const fs::path inside = *made / "unpacked";
    labels_.emplace_back(inside.string(), place());
    const Result<std::vector<std::string>> names = unpack_zip(data, inside);
    return names ? choose_mesh(*names) : Result<void>(names.error());
}

Result<void> InputFile::unpack_gzip_file(const fs::path& data, const std::string& format,
                                         SiblingLinks* links) {
    const bool standard = is_standard_stream(named_);
    const fs::path inner = standard                       ? fs::path("stdin")
                           : lower_ending(named_) == "gz" ? named_.stem()
                                                          : named_.filename();
    const fs::path unpacked = place_ / ("unpacked-" + inner.filename().string());
    labels_.emplace_back(unpacked.string(), place());
    const Result<std::uint64_t> left = unpack_gzip(data, unpacked);
    if (!left) return left.error();
    if (*left > 0)
        warnings_.push_back("behind the packed file are " + std::to_string(*left) +
                            (*left == 1 ? " byte" : " bytes") + " of something else: left out");
    const std::vector<std::byte> head = head_of(unpacked);
    if (head.empty())
        return Error{ErrorCode::syntax, "the file that is packed in it is empty", place()};
    if (is_gzip(head))
        return Error{ErrorCode::unsupported,
                     "a gzip file is packed in this one; unpack it once, with gunzip", place()};
    std::string ending = "." + (format.empty() ? lower_ending(inner) : format);
    if (ending == "." || (format.empty() && !prep::file_format("x" + ending)))
        if (const std::string told = ending_of(head); !told.empty()) ending = told;
    // Under its own name, among what lies beside the packed file.
    std::error_code ec;
    path_ = place_ / (inner.stem().string() + (ending == "." ? "" : ending));
    fs::rename(unpacked, path_, ec);
    if (ec) return Error{ErrorCode::io, "cannot be renamed: " + ec.message(), named_.string()};
    if (!has_neighbours(named_)) {
        labels_.insert(labels_.begin(), {path_.string(), place()});
        return {};
    }
    if (links && !stands_alone(path_) && share_links(named_, *links)) return {};
    const fs::path to_load = path_;
    if (Result<void> linked = link_with_siblings(named_, path_.filename().string()); !linked)
        return linked;
    path_ = to_load;
    return {};
}

namespace {

// By the key that all have; it stands at the beginning of what people write.
bool is_scene_file(const fs::path& file) {
    if (lower_ending(file) != "json") return false;
    std::string begin(std::size_t(64) << 10, '\0');
    std::ifstream in(file, std::ios::binary);
    in.read(begin.data(), std::streamsize(begin.size()));
    begin.resize(std::size_t(in.gcount()));
    return begin.find("\"meshprep\"") != std::string::npos;
}

}  // namespace

Result<void> InputFile::choose_mesh(const std::vector<std::string>& names) {
    std::vector<std::string> meshes;
    for (const std::string& name : names)
        if (holds_mesh(name) && !is_packed(name)) meshes.push_back(name);
    if (meshes.empty()) {
        const bool scene = std::any_of(names.begin(), names.end(), [](const std::string& name) {
            return lower_ending(name) == "json";
        });
        return Error{ErrorCode::invalid,
                     "the archive holds no mesh file among its " + std::to_string(names.size()) +
                         (names.size() == 1 ? " file" : " files") +
                         (scene ? "; a scene file is read where it is unpacked"
                                : "; read are " + input_endings_text()),
                     place()};
    }
    if (meshes.size() > 1) {
        std::string list;
        constexpr std::size_t most = 8;
        for (std::size_t n = 0; n < meshes.size() && n < most; ++n)
            list += (n == 0 ? "" : ", ") + meshes[n];
        if (meshes.size() > most) list += ", …";
        return Error{ErrorCode::invalid,
                     "the archive holds " + std::to_string(meshes.size()) + " mesh files (" + list +
                         "), and one is read; unpack it and name those you mean",
                     place()};
    }
    path_ = place_ / "unpacked" / meshes[0];
    for (const std::string& name : names)
        if (is_scene_file(place_ / "unpacked" / name))
            warnings_.push_back("'" + name + "' in the archive was not looked at: a scene file " +
                                "is read where it is unpacked");
    return {};
}

std::optional<fs::path> InputFile::source() const {
    return is_stream(named_) ? std::nullopt : std::optional(named_);
}

bool InputFile::passing(const fs::path& file) const {
    if (!directory_) return false;
    std::error_code ec;
    const fs::path real = fs::weakly_canonical(file, ec);
    if (shared_ && real == fs::weakly_canonical(*shared_, ec)) return true;
    const fs::path relative = real.lexically_relative(fs::weakly_canonical(directory_->path(), ec));
    return !relative.empty() && *relative.begin() != "..";
}

std::string InputFile::relabelled(std::string text) const {
    // In one pass: what a label stands for may hold another label.
    std::string out;
    for (std::size_t at = 0; at < text.size();) {
        const auto fits = [&](const auto& label) {
            if (text.compare(at, label.first.size(), label.first) != 0) return false;
            // A bare name is one only where no longer name holds it.
            const std::size_t end = at + label.first.size();
            return label.first.find('/') != std::string::npos ||
                   ((at == 0 || !in_a_name(text[at - 1])) &&
                    (end == text.size() || !in_a_name(text[end])));
        };
        const auto label = std::find_if(labels_.begin(), labels_.end(), fits);
        if (label == labels_.end()) {
            out += text[at++];
        } else {
            out += label->second;
            at += label->first.size();
        }
    }
    return out;
}

Error InputFile::relabelled(Error error) const {
    // Readers name the file without its directory, "a.obj:4"; in a batch there may be several.
    std::string place = relabelled(std::move(error.place));
    const std::string name = named_.filename().string();
    if (named_.has_parent_path() && place.starts_with(name) &&
        (place.size() == name.size() ||
         std::string_view(":#,").find(place[name.size()]) != std::string_view::npos))
        place.replace(0, name.size(), named_.string());
    // What is about a mesh of a file, where there may be others with one of that name.
    if (place.starts_with("mesh '")) place = named_.string() + ": " + place;
    return {error.code, relabelled(std::move(error.text)), std::move(place)};
}

fs::path InputFile::settled(const fs::path& file) const {
    fs::path shown = relabelled(file.string());
    std::error_code ec;
    return !fs::exists(file, ec) || fs::equivalent(file, shown, ec) ? shown : file;
}

void InputFile::settle(prep::Scene& scene) const {
    if (!directory_) return;
    scene.source = named_;
    for (std::string& text : scene.warnings) text = relabelled(std::move(text));
    for (std::string& text : scene.remarks) text = relabelled(std::move(text));
    scene.warnings.insert(scene.warnings.begin(), warnings_.begin(), warnings_.end());
    // Pictures that are put together share their sources.
    std::map<const prep::ImageRef*, std::shared_ptr<const prep::ImageRef>> embedded;
    std::vector<std::shared_ptr<const prep::ImageRef>> alive;
    const auto embed = [&](const auto& self, prep::ImageRef& image) -> void {
        for (prep::PackedChannel& channel : image.channels) {
            if (!channel.source) continue;
            auto& known = embedded[channel.source.get()];
            if (!known) {
                prep::ImageRef copy = *channel.source;
                self(self, copy);
                known = std::make_shared<const prep::ImageRef>(std::move(copy));
                alive.push_back(channel.source);  // its address stands for it
            }
            channel.source = known;
        }
        image.read_from = passing(image.read_from) ? fs::path() : settled(image.read_from);
        if (image.path.empty()) return;
        if (image.bytes.empty() && passing(image.path)) {
            // Where it cannot be read it is missing as it would be elsewhere.
            if (auto bytes = prep::read_file(image.path)) image.bytes = *std::move(bytes);
            if (image.name.empty()) image.name = image.path.filename().string();
        }
        image.path =
            image.bytes.empty() ? settled(image.path) : fs::path(relabelled(image.path.string()));
    };
    for (prep::ImageRef& image : scene.images) embed(embed, image);
    std::erase_if(scene.libraries, [this](const fs::path& path) { return passing(path); });
    for (fs::path& library : scene.libraries) library = settled(library);
}

}  // namespace meshprep
