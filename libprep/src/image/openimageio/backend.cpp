#include "image/image_backend.h"
#include "image/openimageio/backend_parts.h"
#include "image/openimageio/encode_image.h"

// The name carries the version and a hash of the types, so that a library of another build is never
// taken for this one's.
extern "C" __attribute__((visibility("default"))) const prep::detail::ImageBackend*
MESHPREP_IMAGE_BACKEND() {
    static const prep::detail::ImageBackend backend{
        prep::detail::read_picture_file, prep::detail::read_picture_bytes,
        [](const std::filesystem::path& path, const prep::Image& image, prep::PixelType type) {
            return prep::detail::encode_image(path, image, type);
        },
        [](const std::filesystem::path& path, const std::filesystem::path& file,
           const prep::ImageLayout& layout) {
            return prep::detail::open_rows(path, file, layout);
        }};
    return &backend;
}
