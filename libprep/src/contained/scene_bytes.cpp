#include "contained/scene_bytes.h"

#include "contained/bytes.h"
#include "model/scene_promises.h"

namespace prep::detail {

std::vector<std::byte> scene_bytes(const Scene& scene) {
    ByteWriter writer;
    writer(scene);
    return writer.take();
}

Result<Scene> scene_of_bytes(std::span<const std::byte> bytes) {
    ByteReader reader(bytes);
    Scene scene;
    reader(scene);
    if (!reader.good() || !reader.at_end())
        return Error{ErrorCode::invalid, "the bytes are no scene", ""};
    if (const char* const broken = broken_promise(scene))
        return Error{ErrorCode::invalid, std::string(broken) + " of the scene is out of range", ""};
    return scene;
}

}  // namespace prep::detail
