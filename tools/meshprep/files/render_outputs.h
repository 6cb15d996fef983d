// The files of `meshprep render`: the picture and the buffers beside it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "prep/enum_names.h"
#include "prep/image.h"
#include "rast/render.h"

namespace meshprep {

// What can be written beside the colours, at each pixel's first sample.
enum class Buffer : std::uint8_t { depth, id, normal, uv, barycentric, position };
constexpr auto names_of(Buffer) {
    return std::to_array<prep::EnumName<Buffer>>({{"depth", Buffer::depth},
                                                  {"id", Buffer::id},
                                                  {"normal", Buffer::normal},
                                                  {"uv", Buffer::uv},
                                                  {"barycentric", Buffer::barycentric},
                                                  {"position", Buffer::position}});
}

// Digits that a pattern such as "turn.%04d.png" asks for (0: as many as it takes); nothing where
// the name is none.
std::optional<int> pattern_digits(const std::string& name);

// The n-th name of a sequence of `count`: the pattern's, or NAME_000.ENDING with at least three
// digits.
std::filesystem::path sequence_name(const std::filesystem::path& path, std::uint32_t number,
                                    std::uint32_t count);

// Whether a picture of that name keeps linear floats (.exr, .hdr), which no tone curve changes.
bool keeps_float(const std::filesystem::path& path);

// Asks for what the buffers need.
void keep(rast::RenderRequest& request, const std::vector<Buffer>& buffers);

struct OutputOptions {
    std::filesystem::path picture;
    std::vector<Buffer> buffers;
    std::filesystem::path buffer_file;  // empty: a file for each, PICTURE.BUFFER.exr
    prep::RenderChoices choices;        // exposure and tone map
    int threads = 0;
};

// One picture's files, written band by band into a set that appears together.
//
// Channels of buffers: depth: Z (distance along the view's direction in world units, infinite where
// nothing is) and depth (the depth buffer: 1 near, 0 far or nothing); id: triangle and instance
// (32-bit integers, 2^32 − 1 where nothing is); normal: N.X, N.Y, N.Z (world); uv: UV.U, UV.V;
// barycentric: B.X, B.Y, B.Z; position: P.X, P.Y, P.Z (world). Zero where nothing is.
class RenderOutputs {
  public:
    RenderOutputs(prep::ImageFiles& files, OutputOptions options);

    // Errors: those of prep::ImageFiles.
    prep::Result<void> open(const rast::RenderPlan& plan);
    prep::Result<void> write(const rast::Frame& band);
    const std::vector<std::filesystem::path>& paths() const { return paths_; }

  private:
    prep::Result<void> open_file(const std::filesystem::path& path, const rast::RenderPlan& plan,
                                 const std::vector<Buffer>& buffers);

    struct BufferFile {
        std::size_t file = 0;
        std::vector<Buffer> buffers;
        bool integers = false;
    };
    prep::ImageFiles& files_;
    OutputOptions options_;
    rast::View view_;
    bool linear_ = false, alpha_ = false;
    std::size_t picture_ = 0;
    std::vector<BufferFile> buffer_files_;
    std::vector<std::filesystem::path> paths_;
};

}  // namespace meshprep
