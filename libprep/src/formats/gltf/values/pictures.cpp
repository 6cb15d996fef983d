#include "formats/gltf/values/pictures.h"

#include <cstring>
#include <string_view>

namespace prep::detail {
namespace {

// The MIME type by the first bytes, of those that glTF files hold; null for others.
const char* picture_kind(const std::vector<std::byte>& bytes) {
    const auto starts = [&](std::string_view magic, std::size_t at = 0) {
        return bytes.size() >= at + magic.size() &&
               std::memcmp(bytes.data() + at, magic.data(), magic.size()) == 0;
    };
    if (starts("\x89PNG")) return "image/png";
    if (starts("\xff\xd8\xff")) return "image/jpeg";
    if (starts("RIFF") && starts("WEBP", 8)) return "image/webp";
    if (starts("\xabKTX 20\xbb")) return "image/ktx2";
    return nullptr;
}

}  // namespace

void embed_pictures(const std::vector<ImageRef>& images, Json& json, AppendedData& appended,
                    const std::function<void(const std::string&)>& note) {
    const auto list = json.find("images");
    if (list == json.end()) return;
    for (std::size_t i = 0; i < list->size() && i < images.size(); ++i) {
        Json& image = (*list)[i];
        if (!image.contains("uri")) continue;
        const std::vector<std::byte>& bytes = images[i].bytes;
        const char* mime = picture_kind(bytes);
        if (!mime) {
            note("image " + std::to_string(i) +
                 " could not be read: the output still names its file");
            continue;
        }
        const std::string uri = image["uri"].get<std::string>();
        if (!image.contains("name") && !uri.starts_with("data:")) image["name"] = uri;
        image.erase("uri");
        image["mimeType"] = mime;
        image["bufferView"] = appended.add_view(SharedBytes::lent(bytes), 0, 0);
    }
}

}  // namespace prep::detail
