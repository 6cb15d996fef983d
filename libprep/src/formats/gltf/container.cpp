#include <algorithm>
#include <cstring>
#include <map>
#include <string_view>

#include "formats/gltf/document.h"
#include "prep/files.h"
#include "text/line_ends.h"
#include "text/percent_encoding.h"

namespace prep::detail {
namespace {

// Deeper JSON than any writer makes; the parser and our own walks recurse.
constexpr std::size_t max_json_depth = 512;

// A key is looked for among all members of its object, so that an object costs the square of its
// size. This many comparisons (one object of 28,000 members, or many smaller ones) take about a
// second.
constexpr std::uint64_t max_key_comparisons = 400'000'000;

// What the parser must not be given. Brackets and colons are counted outside strings; whether the
// text is JSON is the parser's business.
Result<void> check_json_size(std::string_view text, const std::string& name) {
    std::vector<std::uint64_t> members;  // of the open objects and arrays
    std::uint64_t comparisons = 0;
    bool quoted = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (quoted) {
            if (c == '\\') ++i;
            quoted = c != '"';
        } else if (c == '"') {
            quoted = true;
        } else if (c == '{' || c == '[') {
            members.push_back(0);
            if (members.size() > max_json_depth)
                return Error{
                    ErrorCode::limit,
                    "the JSON is nested more than " + std::to_string(max_json_depth) + " deep",
                    name};
        } else if ((c == '}' || c == ']') && !members.empty()) {
            members.pop_back();
        } else if (c == ':' && !members.empty()) {
            comparisons += members.back()++;
            if (comparisons > max_key_comparisons)
                return Error{ErrorCode::limit, "the JSON has objects of too many members", name};
        }
    }
    return {};
}

std::uint32_t u32(std::span<const std::byte> bytes, std::size_t at) {
    std::uint32_t value;
    std::memcpy(&value, bytes.data() + at, 4);
    return value;
}

// Without the library's own name for its message.
std::string parser_message(const std::string& text) {
    const std::size_t end = text.starts_with('[') ? text.find("] ") : std::string::npos;
    return end == std::string::npos ? text : text.substr(end + 2);
}

struct Container {
    bool binary_file = false;
    std::string_view json;
    std::optional<SharedBytes> binary;
    bool uneven = false;  // a chunk whose length is not a multiple of 4
};

Result<Container> open_glb(const SharedBytes& bytes, const std::string& name) {
    const auto fail = [&](const std::string& text, std::size_t at) {
        return Error{ErrorCode::syntax, text, name + ", byte " + std::to_string(at)};
    };
    if (bytes.size() < 12) return fail("the file is shorter than a GLB header", 0);
    if (u32(bytes, 4) != 2)
        return Error{ErrorCode::unsupported,
                     "GLB version " + std::to_string(u32(bytes, 4)) + "; only 2 is read", name};
    const std::uint32_t length = u32(bytes, 8);
    if (length < 20)
        return fail("the header announces " + std::to_string(length) +
                        " bytes, fewer than its own 12 and a chunk header",
                    8);
    if (length > bytes.size())
        return fail("the header announces " + std::to_string(length) + " bytes, the file has " +
                        std::to_string(bytes.size()),
                    8);
    constexpr std::uint32_t json_type = 0x4e4f534a, binary_type = 0x004e4942;
    Container container;
    container.binary_file = true;
    bool json = false;
    std::size_t at = 12;
    for (int chunk = 0; at + 8 <= length; ++chunk) {
        const std::uint32_t size = u32(bytes, at), type = u32(bytes, at + 4);
        if (size > length - at - 8)
            return fail("a chunk of " + std::to_string(size) + " bytes, but only " +
                            std::to_string(length - at - 8) + " are left",
                        at);
        const SharedBytes content = bytes.part(at + 8, size);
        if (chunk == 0) {
            if (type != json_type) return fail("the first chunk must be JSON", at);
            container.json = {reinterpret_cast<const char*>(content.data()), content.size()};
            json = true;
        } else if (type == json_type) {
            return fail("a second JSON chunk", at);
        } else if (type == binary_type) {
            if (chunk != 1)
                return fail("the BIN chunk must be the second one, and the only one", at);
            container.binary = content;
        }
        at += 8 + size;
        if (size % 4 != 0) {
            container.uneven = true;
            // What writers of such files do is not settled: padding is there where it makes the
            // next chunk one of a known type.
            const std::size_t padded = (at + 3) / 4 * 4;
            const auto known = [&](std::size_t header) {
                return header + 8 <= length && u32(bytes, header + 4) == binary_type;
            };
            if ((!known(at) && known(padded)) || padded == length) at = padded;
        }
    }
    if (at != length) return fail("the file ends inside a chunk header", at);
    if (!json) return fail("there is no JSON chunk", 12);
    return container;
}

bool base64_decode(std::string_view text, std::vector<std::byte>& out) {
    std::uint32_t bits = 0;
    int have = 0;
    while (!text.empty() && text.back() == '=') text.remove_suffix(1);
    out.reserve(text.size() * 3 / 4);
    for (const char c : text) {
        int value;
        if (c >= 'A' && c <= 'Z')
            value = c - 'A';
        else if (c >= 'a' && c <= 'z')
            value = c - 'a' + 26;
        else if (c >= '0' && c <= '9')
            value = c - '0' + 52;
        else if (c == '+' || c == '-')
            value = 62;
        else if (c == '/' || c == '_')
            value = 63;
        else if (c == '\n' || c == '\r' || c == ' ')
            continue;
        else
            return false;
        bits = bits << 6 | std::uint32_t(value);
        if ((have += 6) >= 8) out.push_back(std::byte(bits >> (have -= 8)));
    }
    return true;
}

// What stands before the first ':' of an absolute URI; empty for relative ones.
std::string_view scheme_of(std::string_view uri) {
    const std::size_t colon = uri.find(':');
    if (colon == std::string_view::npos || uri.substr(0, colon).find('/') != std::string_view::npos)
        return {};
    return uri.substr(0, colon + 1);
}

}  // namespace

Result<std::vector<std::byte>> resolve_uri(const GltfDocument& document, const std::string& uri,
                                           const std::string& pointer) {
    const auto fail = [&](ErrorCode code, std::string text) {
        return Error{code, std::move(text), document.place(pointer)};
    };
    const std::string_view scheme = scheme_of(uri);
    if (scheme == "data:") {
        const std::size_t comma = uri.find(',');
        std::vector<std::byte> bytes;
        if (comma == std::string::npos || !uri.substr(0, comma).ends_with(";base64") ||
            !base64_decode(std::string_view(uri).substr(comma + 1), bytes))
            return fail(ErrorCode::syntax, "expected a base64 data URI");
        return bytes;
    }
    if (scheme == ":") return fail(ErrorCode::syntax, "this is no URI: its scheme is empty");
    const std::filesystem::path relative = percent_decoded(uri);
    if (!scheme.empty() || relative.is_absolute() || relative.empty())
        return fail(ErrorCode::unsupported,
                    "only data: and relative URIs are read, found '" + uri.substr(0, 60) + "'");
    if (document.directory.empty())
        return fail(ErrorCode::io, "'" + relative.string() +
                                       "' stands beside a document that did not come from a file");
    std::error_code ignored;
    const std::filesystem::path path = document.directory / relative;
    if (std::filesystem::exists(path, ignored) && !std::filesystem::is_regular_file(path, ignored))
        return fail(ErrorCode::io, "'" + relative.string() + "' is no regular file");
    auto bytes = read_file(path);
    if (!bytes)
        return fail(bytes.error().code, "'" + relative.string() + "': " + bytes.error().text);
    return bytes;
}

std::string file_of_uri(const GltfDocument& document, const std::string& uri) {
    if (uri.starts_with("data:") || document.directory.empty()) return {};
    std::error_code ignored;
    return std::filesystem::weakly_canonical(document.directory / percent_decoded(uri), ignored)
        .string();
}

std::vector<std::filesystem::path> files_of_buffers(const GltfDocument& document) {
    std::vector<std::filesystem::path> files;
    const auto list = document.json.find("buffers");
    if (list == document.json.end() || !list->is_array()) return files;
    for (const Json& buffer : *list) {
        if (!buffer.is_object() || !buffer.contains("uri") || !buffer["uri"].is_string()) continue;
        const auto uri = buffer["uri"].get<std::string>();
        if (!uri.starts_with("data:")) files.push_back(document.directory / percent_decoded(uri));
    }
    return files;
}

namespace {

Result<void> load_buffers(GltfDocument& document, const std::optional<SharedBytes>& bin) {
    const auto list = top_array(document, "buffers");
    if (!list) return list.error();
    std::map<std::string, SharedBytes> files;  // buffers may be parts of one
    for (std::size_t b = 0; b < (*list)->size(); ++b) {
        const Json& buffer = (**list)[b];
        const std::string pointer = "/buffers/" + std::to_string(b);
        const auto length = whole_member(document, buffer, "byteLength", pointer, 1,
                                         std::uint64_t(1) << 40, std::nullopt);
        if (!length) return length.error();
        Result<SharedBytes> bytes = SharedBytes();
        if (buffer.contains("uri")) {
            if (!buffer["uri"].is_string())
                return Error{ErrorCode::invalid, "expected a string",
                             document.place(pointer + "/uri")};
            const auto& uri = buffer["uri"].get_ref<const std::string&>();
            const std::string file = file_of_uri(document, uri);
            const auto known = files.find(file);
            if (known != files.end()) {
                bytes = known->second;
            } else {
                auto found = resolve_uri(document, uri, pointer + "/uri");
                if (!found && found.error().code == ErrorCode::syntax)
                    return std::move(found).error();
                if (found) {
                    document.input_bytes += found->size();
                    bytes = SharedBytes(*std::move(found));
                    if (!file.empty()) files.emplace(file, *bytes);
                } else {
                    bytes = std::move(found).error();
                }
            }
        } else if (b == 0 && bin) {
            // What stands beside the chunk stays in memory with it, unless it is the most of the
            // file.
            bytes = bin->size() < document.input_bytes / 2
                        ? SharedBytes(std::vector<std::byte>(bin->begin(), bin->end()))
                        : *bin;
        } else {
            bytes = Error{ErrorCode::invalid,
                          "the buffer has neither a uri nor a BIN chunk to be found in",
                          document.place(pointer)};
        }
        if (bytes && bytes->size() < *length)
            return Error{ErrorCode::invalid,
                         "byteLength is " + std::to_string(*length) + ", but there are only " +
                             std::to_string(bytes->size()) + " bytes",
                         document.place(pointer + "/byteLength")};
        if (bytes) bytes = bytes->part(0, *length);
        document.buffers.push_back(std::move(bytes));
    }
    return {};
}

// A version is two numbers; 2.0 is what there is, and later 2.x promise that a reader of 2.0 gets
// along unless minVersion says otherwise.
Result<void> check_version(const GltfDocument& document) {
    const auto asset = document.json.find("asset");
    if (asset == document.json.end() || !asset->is_object() || !asset->contains("version"))
        return Error{ErrorCode::invalid, "a glTF file needs asset.version",
                     document.place("/asset")};
    for (const char* key : {"version", "minVersion"}) {
        if (!asset->contains(key)) continue;
        const std::string place = document.place(std::string("/asset/") + key);
        if (!(*asset)[key].is_string())
            return Error{ErrorCode::invalid, "expected a string", place};
        const std::string version = (*asset)[key].get<std::string>();
        const std::size_t dot = version.find('.');
        const auto digits = [](std::string_view text) {
            return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
        };
        if (dot == std::string::npos || !digits(std::string_view(version).substr(0, dot)) ||
            !digits(std::string_view(version).substr(dot + 1)))
            return Error{ErrorCode::invalid,
                         "expected two numbers with a dot between them, found '" +
                             version.substr(0, 40) + "'",
                         place};
        const bool fits =
            std::string_view(key) == "version" ? version.starts_with("2.") : version == "2.0";
        if (!fits)
            return Error{ErrorCode::unsupported,
                         "glTF version '" + version.substr(0, 40) + "'; only 2.0 is read", place};
    }
    return {};
}

}  // namespace

Result<GltfDocument> open_gltf(const SharedBytes& bytes, const GltfOptions& options) {
    GltfDocument document;
    document.name = options.name;
    document.directory = options.directory;
    document.texture_directories = options.texture_directories;
    document.input_bytes = bytes.size();
    Container container;
    if (bytes.size() >= 4 && std::memcmp(bytes.data(), "glTF", 4) == 0) {
        auto opened = open_glb(bytes, options.name);
        if (!opened) return std::move(opened).error();
        container = *opened;
        if (container.uneven)
            document.warnings.push_back(options.name + ": a chunk's length is not a multiple of 4");
        if (const std::size_t length = u32(bytes, 8); length < bytes.size())
            document.warnings.push_back(
                options.name + ": " + std::to_string(bytes.size() - length) +
                " bytes stand behind the end that the header announces: left out");
    } else {
        container.json =
            without_byte_order_mark({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    }
    if (auto done = check_json_size(container.json, options.name); !done)
        return std::move(done).error();
    try {
        document.json = Json::parse(container.json);
    } catch (const Json::exception& e) {
        return Error{ErrorCode::syntax,
                     (container.binary_file ? "not JSON: " : "neither GLB nor JSON: ") +
                         parser_message(e.what()),
                     options.name};
    }
    if (!document.json.is_object())
        return Error{ErrorCode::invalid, "expected a JSON object", document.place("")};
    if (auto done = check_version(document); !done) return std::move(done).error();
    if (auto done = load_buffers(document, container.binary); !done) return std::move(done).error();
    return document;
}

Result<const Json*> top_array(const GltfDocument& document, const char* key) {
    static const Json empty = Json::array();
    const auto it = document.json.find(key);
    if (it == document.json.end()) return &empty;
    const std::string pointer = std::string("/") + key;
    if (!it->is_array())
        return Error{ErrorCode::invalid, "expected an array", document.place(pointer)};
    for (std::size_t i = 0; i < it->size(); ++i)
        if (!(*it)[i].is_object())
            return Error{ErrorCode::invalid, "expected an object",
                         document.place(pointer + "/" + std::to_string(i))};
    return &*it;
}

namespace {

Result<std::uint64_t> whole_value(const GltfDocument& document, const Json& value,
                                  const std::string& pointer, std::uint64_t low,
                                  std::uint64_t high) {
    double number = -1;
    if (value.is_number_unsigned()) {
        const std::uint64_t whole = value.get<std::uint64_t>();
        if (whole >= low && whole <= high) return whole;
    } else if (value.is_number_float()) {
        number = value.get<double>();
        if (number >= double(low) && number <= double(high) &&
            number == double(std::uint64_t(number)))
            return std::uint64_t(number);
    }
    return Error{
        ErrorCode::invalid,
        "expected a whole number from " + std::to_string(low) + " to " + std::to_string(high) +
            ", found " +
            (value.is_structured() ? std::string(value.type_name()) : value.dump().substr(0, 40)),
        document.place(pointer)};
}

template <class T>
Result<void> read_list(const GltfDocument& document, const Json& object, const char* key,
                       const std::string& pointer, std::span<T> out) {
    const auto it = object.find(key);
    if (it == object.end()) return {};
    const std::string place = pointer + "/" + key;
    if (out.size() == 1) {
        if (!it->is_number()) return document.bad(place, "expected a number");
        out[0] = it->get<T>();
        return {};
    }
    if (!it->is_array() || it->size() != out.size())
        return document.bad(place, "expected " + std::to_string(out.size()) + " numbers");
    for (std::size_t i = 0; i < out.size(); ++i) {
        if (!(*it)[i].is_number())
            return document.bad(place + "/" + std::to_string(i), "expected a number");
        out[i] = (*it)[i].get<T>();
    }
    return {};
}

}  // namespace

std::string name_of(const Json& object) {
    const auto it = object.find("name");
    return it != object.end() && it->is_string() ? it->get<std::string>() : std::string();
}

const Json* extension_of(const Json& object, const char* name) {
    const auto all = object.find("extensions");
    if (all == object.end() || !all->is_object()) return nullptr;
    const auto it = all->find(name);
    return it != all->end() && it->is_object() ? &*it : nullptr;
}

Result<void> read_numbers(const GltfDocument& document, const Json& object, const char* key,
                          const std::string& pointer, std::span<double> out) {
    return read_list(document, object, key, pointer, out);
}

Result<void> read_numbers(const GltfDocument& document, const Json& object, const char* key,
                          const std::string& pointer, std::span<float> out) {
    return read_list(document, object, key, pointer, out);
}

Result<std::uint64_t> whole_member(const GltfDocument& document, const Json& object,
                                   const char* key, const std::string& pointer, std::uint64_t low,
                                   std::uint64_t high, std::optional<std::uint64_t> otherwise) {
    const auto it = object.find(key);
    if (it != object.end())
        return whole_value(document, *it, pointer + "/" + pointer_key(key), low, high);
    if (otherwise) return *otherwise;
    return Error{ErrorCode::invalid, "the member is missing",
                 document.place(pointer + "/" + pointer_key(key))};
}

Result<std::uint32_t> index_value(const GltfDocument& document, const Json& value,
                                  const std::string& pointer, std::size_t size) {
    if (size == 0)
        return Error{ErrorCode::invalid, "an index into a list that is empty or absent",
                     document.place(pointer)};
    const auto index = whole_value(document, value, pointer, 0, size - 1);
    if (!index && value.is_number())
        return Error{
            ErrorCode::invalid,
            "the list has " + std::to_string(size) + " entries: there is no number " + value.dump(),
            document.place(pointer)};
    if (!index) return index.error();
    return std::uint32_t(*index);
}

Result<std::uint32_t> index_member(const GltfDocument& document, const Json& object,
                                   const char* key, const std::string& pointer, std::size_t size) {
    const auto it = object.find(key);
    if (it == object.end()) return no_index;
    return index_value(document, *it, pointer + "/" + pointer_key(key), size);
}

}  // namespace prep::detail
