#include <algorithm>
#include <cstring>
#include <string_view>

#include "gltf_document.h"

namespace prep::detail {
namespace {

// Deeper JSON than any writer makes; the parser and our own walks recurse.
constexpr int max_json_depth = 512;

bool too_deep(std::string_view text) {
    int depth = 0;
    bool quoted = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (quoted) {
            if (c == '\\') ++i;
            quoted = c != '"';
        } else if (c == '"') {
            quoted = true;
        } else if (c == '{' || c == '[') {
            if (++depth > max_json_depth) return true;
        } else if (c == '}' || c == ']') {
            --depth;
        }
    }
    return false;
}

std::uint32_t u32(std::span<const std::byte> bytes, std::size_t at) {
    std::uint32_t value;
    std::memcpy(&value, bytes.data() + at, 4);
    return value;
}

struct Container {
    std::string_view json;
    std::optional<std::span<const std::byte>> binary;
};

Result<Container> open_glb(std::span<const std::byte> bytes, const std::string& name) {
    const auto fail = [&](const std::string& text, std::size_t at) {
        return Error{ErrorCode::syntax, text, name + ", byte " + std::to_string(at)};
    };
    if (bytes.size() < 12) return fail("the file is shorter than a GLB header", 0);
    if (u32(bytes, 4) != 2)
        return Error{ErrorCode::unsupported,
                     "GLB version " + std::to_string(u32(bytes, 4)) + "; only 2 is read", name};
    const std::uint32_t length = u32(bytes, 8);
    if (length > bytes.size())
        return fail("the header announces " + std::to_string(length) + " bytes, the file has " +
                        std::to_string(bytes.size()),
                    8);
    Container container;
    bool json = false;
    std::size_t at = 12;
    for (int chunk = 0; at + 8 <= length; ++chunk) {
        const std::uint32_t size = u32(bytes, at), type = u32(bytes, at + 4);
        if (size > length - at - 8)
            return fail("a chunk of " + std::to_string(size) + " bytes goes beyond the file's end",
                        at);
        if (size % 4 != 0) return fail("a chunk's length is not a multiple of 4", at);
        const std::span<const std::byte> content = bytes.subspan(at + 8, size);
        constexpr std::uint32_t json_type = 0x4e4f534a, binary_type = 0x004e4942;
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
    }
    if (at != length) return fail("the file ends inside a chunk header", at);
    if (!json) return fail("there is no JSON chunk", 12);
    return container;
}

// "%20" and friends; URIs of glTF are relative and percent-encoded.
std::string percent_decoded(const std::string& uri) {
    const auto digit = [](char c) {
        return c >= '0' && c <= '9'   ? c - '0'
               : c >= 'a' && c <= 'f' ? c - 'a' + 10
               : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                      : -1;
    };
    std::string out;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        if (uri[i] == '%' && i + 2 < uri.size() && digit(uri[i + 1]) >= 0 &&
            digit(uri[i + 2]) >= 0) {
            out += char(digit(uri[i + 1]) * 16 + digit(uri[i + 2]));
            i += 2;
        } else {
            out += uri[i];
        }
    }
    return out;
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

}  // namespace

// Bytes behind a URI: data: or a file that lies below the document's folder.
Result<std::vector<std::byte>> resolve_uri(const GltfDocument& document, const std::string& uri,
                                           const std::string& pointer) {
    if (uri.starts_with("data:")) {
        const std::size_t comma = uri.find(',');
        std::vector<std::byte> bytes;
        if (comma == std::string::npos ||
            uri.substr(0, comma).find(";base64") == std::string::npos ||
            !base64_decode(std::string_view(uri).substr(comma + 1), bytes))
            return Error{ErrorCode::syntax, "expected a base64 data URI", document.place(pointer)};
        return bytes;
    }
    const std::filesystem::path relative = percent_decoded(uri);
    const std::size_t colon = uri.find(':');
    if (relative.is_absolute() || (colon != std::string::npos && colon > 1 && colon < 12))
        return Error{ErrorCode::unsupported,
                     "only data: and relative URIs are read, found " + uri.substr(0, 60),
                     document.place(pointer)};
    auto bytes = read_file(document.directory / relative);
    if (!bytes) {
        Error error = std::move(bytes).error();
        error.text = "'" + relative.string() + "': " + error.text;
        error.place = document.place(pointer);
        return error;
    }
    return bytes;
}

namespace {

Result<void> load_buffers(GltfDocument& document,
                          const std::optional<std::span<const std::byte>>& bin) {
    const auto list = top_array(document, "buffers");
    if (!list) return list.error();
    for (std::size_t b = 0; b < (*list)->size(); ++b) {
        const Json& buffer = (**list)[b];
        const std::string pointer = "/buffers/" + std::to_string(b);
        const auto length = whole_member(document, buffer, "byteLength", pointer, 1,
                                         std::uint64_t(1) << 40, std::nullopt);
        if (!length) return length.error();
        const bool fallback = buffer.contains("extensions") && buffer["extensions"].is_object() &&
                              buffer["extensions"].contains("EXT_meshopt_compression") &&
                              !buffer.contains("uri");
        std::vector<std::byte> bytes;
        if (buffer.contains("uri")) {
            if (!buffer["uri"].is_string())
                return Error{ErrorCode::invalid, "expected a string",
                             document.place(pointer + "/uri")};
            auto loaded = resolve_uri(document, buffer["uri"].get<std::string>(), pointer + "/uri");
            if (!loaded) return std::move(loaded).error();
            bytes = *std::move(loaded);
        } else if (b == 0 && bin) {
            bytes.assign(bin->begin(), bin->end());
        } else if (!fallback) {
            return Error{ErrorCode::invalid,
                         "the buffer has neither a uri nor a BIN chunk to be found in",
                         document.place(pointer)};
        }
        if (!fallback && bytes.size() < *length)
            return Error{ErrorCode::invalid,
                         "byteLength is " + std::to_string(*length) + ", but there are only " +
                             std::to_string(bytes.size()) + " bytes",
                         document.place(pointer + "/byteLength")};
        bytes.resize(std::min<std::size_t>(bytes.size(), *length));
        document.buffers.push_back(std::move(bytes));
    }
    return {};
}

}  // namespace

Result<GltfDocument> open_gltf(std::span<const std::byte> bytes, const GltfOptions& options) {
    GltfDocument document;
    document.name = options.name;
    document.directory = options.directory;
    Container container;
    if (bytes.size() >= 4 && std::memcmp(bytes.data(), "glTF", 4) == 0) {
        auto opened = open_glb(bytes, options.name);
        if (!opened) return std::move(opened).error();
        container = *opened;
    } else {
        container.json = {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
        if (container.json.starts_with("\xef\xbb\xbf")) container.json.remove_prefix(3);
    }
    if (too_deep(container.json))
        return Error{ErrorCode::limit,
                     "the JSON is nested more than " + std::to_string(max_json_depth) + " deep",
                     options.name};
    try {
        document.json = Json::parse(container.json);
    } catch (const Json::exception& e) {
        return Error{ErrorCode::syntax, std::string("not JSON: ") + e.what(), options.name};
    }
    if (!document.json.is_object())
        return Error{ErrorCode::invalid, "expected a JSON object", document.place("")};
    const auto asset = document.json.find("asset");
    if (asset == document.json.end() || !asset->is_object() || !asset->contains("version") ||
        !(*asset)["version"].is_string())
        return Error{ErrorCode::invalid, "a glTF file needs asset.version",
                     document.place("/asset")};
    const std::string version = (*asset)["version"].get<std::string>();
    if (!version.starts_with("2."))
        return Error{ErrorCode::unsupported, "glTF version '" + version + "'; only 2.x is read",
                     document.place("/asset/version")};
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

Result<std::uint64_t> whole_member(const GltfDocument& document, const Json& object,
                                   const char* key, const std::string& pointer, std::uint64_t low,
                                   std::uint64_t high, std::optional<std::uint64_t> otherwise) {
    const std::string place = document.place(pointer + "/" + key);
    const auto it = object.find(key);
    if (it == object.end()) {
        if (otherwise) return *otherwise;
        return Error{ErrorCode::invalid, "the member is missing", place};
    }
    double value = -1;
    if (it->is_number_unsigned()) {
        const std::uint64_t whole = it->get<std::uint64_t>();
        if (whole >= low && whole <= high) return whole;
        value = double(whole);
    } else if (it->is_number()) {
        value = it->get<double>();
        if (value >= double(low) && value <= double(high) && value == double(std::uint64_t(value)))
            return std::uint64_t(value);
    }
    return Error{ErrorCode::invalid,
                 "expected a whole number from " + std::to_string(low) + " to " +
                     std::to_string(high) + ", found " + it->dump().substr(0, 40),
                 place};
}

Result<std::uint32_t> index_member(const GltfDocument& document, const Json& object,
                                   const char* key, const std::string& pointer, std::size_t size) {
    if (!object.contains(key)) return no_index;
    if (size == 0)
        return Error{ErrorCode::invalid, "an index into a list that is empty",
                     document.place(pointer + "/" + key)};
    const auto value = whole_member(document, object, key, pointer, 0, size - 1, std::nullopt);
    if (!value) return value.error();
    return std::uint32_t(*value);
}

}  // namespace prep::detail
