#include "meshprep/files/render_outputs.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>

#include "meshprep/files/file_list.h"

namespace meshprep {
namespace {

using prep::Result;

// Where "%d" or "%04d" stands in a name.
struct Pattern {
    std::size_t at = 0, length = 0;
    int digits = 0;
};
std::optional<Pattern> find_pattern(const std::string& name) {
    for (std::size_t at = name.find('%'); at != std::string::npos; at = name.find('%', at + 1)) {
        std::size_t end = at + 1;
        while (end < name.size() && end < at + 3 && name[end] >= '0' && name[end] <= '9') ++end;
        if (end >= name.size() || name[end] != 'd') continue;
        return Pattern{at, end + 1 - at, end == at + 1 ? 0 : std::stoi(name.substr(at + 1))};
    }
    return std::nullopt;
}

std::vector<std::string> channels_of(Buffer buffer) {
    switch (buffer) {
        case Buffer::depth:
            return {"Z", "depth"};
        case Buffer::id:
            return {"triangle", "instance"};
        case Buffer::normal:
            return {"N.X", "N.Y", "N.Z"};
        case Buffer::uv:
            return {"UV.U", "UV.V"};
        case Buffer::barycentric:
            return {"B.X", "B.Y", "B.Z"};
        case Buffer::position:
            break;
    }
    return {"P.X", "P.Y", "P.Z"};
}

// Distance along the view's direction for a value of the depth buffer: projection() turned round.
class Distance {
  public:
    explicit Distance(const rast::View& view) : perspective_(view.perspective) {
        const glm::dmat4 p = rast::projection(view, 1);
        slope_ = p[2][2];
        offset_ = p[3][2];
    }
    float operator()(float depth) const {
        const double d = double(depth);
        if (!perspective_) return float((offset_ - d) / slope_);
        return float(offset_ / (d + slope_));
    }

  private:
    bool perspective_;
    double slope_ = 0, offset_ = 0;
};

template <class T>
void put(std::vector<T>& row, float value) {
    if constexpr (std::is_same_v<T, float>)
        row.push_back(value);
    else
        row.push_back(std::bit_cast<std::uint32_t>(value));
}

template <class T>
void put_buffer(std::vector<T>& row, const rast::Frame& band, const rast::View& view,
                const Distance& distance, Buffer buffer, std::size_t i) {
    const auto put3 = [&row](const glm::vec3& v) {
        for (int k = 0; k < 3; ++k) put(row, v[k]);
    };
    switch (buffer) {
        case Buffer::depth:
            // Depth 0 is also that of a surface on the far plane.
            put(row, band.instance[i] != prep::no_index ? distance(band.depth[i]) : HUGE_VALF);
            put(row, band.depth[i]);
            return;
        case Buffer::id:
            if constexpr (!std::is_same_v<T, float>) {
                row.push_back(band.triangle[i]);
                row.push_back(band.instance[i]);
            }
            return;
        case Buffer::normal:
            return put3(band.normal[i]);
        case Buffer::uv:
            put(row, band.uv[i].x);
            put(row, band.uv[i].y);
            return;
        case Buffer::barycentric:
            return put3(band.barycentric[i]);
        case Buffer::position:
            return put3(band.instance[i] == prep::no_index
                            ? glm::vec3(0)
                            : glm::vec3(view.eye() + glm::dvec3(band.position[i])));
    }
}

}  // namespace

bool keeps_float(const std::filesystem::path& path) {
    const std::string ending = lower_ending(path);
    return ending == "exr" || ending == "hdr";
}

std::optional<int> pattern_digits(const std::string& name) {
    const std::optional<Pattern> pattern = find_pattern(name);
    return pattern ? std::optional<int>(pattern->digits) : std::nullopt;
}

std::filesystem::path sequence_name(const std::filesystem::path& path, std::uint32_t number,
                                    std::uint32_t count) {
    const std::string name = path.filename().string();
    if (const std::optional<Pattern> pattern = find_pattern(name))
        return path.parent_path() /
               (name.substr(0, pattern->at) + fmt::format("{:0{}}", number, pattern->digits) +
                name.substr(pattern->at + pattern->length));
    const std::size_t digits = std::max<std::size_t>(3, std::to_string(count - 1).size());
    return path.parent_path() / (path.stem().string() + fmt::format("_{:0{}}", number, digits) +
                                 path.extension().string());
}

void keep(rast::RenderRequest& request, const std::vector<Buffer>& buffers) {
    for (const Buffer buffer : buffers) {
        request.keep_depth |= buffer == Buffer::depth;
        // Ids say where something is: positions are counted from the eye, and depth 0 may be one.
        request.keep_ids |=
            buffer == Buffer::id || buffer == Buffer::position || buffer == Buffer::depth;
        request.keep_normals |= buffer == Buffer::normal;
        request.keep_uvs |= buffer == Buffer::uv;
        request.keep_barycentrics |= buffer == Buffer::barycentric;
        request.keep_positions |= buffer == Buffer::position;
    }
}

RenderOutputs::RenderOutputs(prep::ImageFiles& files, OutputOptions options)
    : files_(files), options_(std::move(options)), linear_(keeps_float(options_.picture)) {}

Result<void> RenderOutputs::open(const rast::RenderPlan& plan) {
    view_ = plan.view;
    prep::ImageLayout layout;
    layout.width = plan.request.crop ? plan.request.crop->width : plan.request.width;
    layout.height = plan.request.crop ? plan.request.crop->height : plan.request.height;
    layout.channels = {"R", "G", "B"};
    alpha_ = linear_ && lower_ending(options_.picture) != "hdr";  // which holds three channels
    if (alpha_) layout.channels.push_back("A");
    layout.type = linear_ ? prep::PixelType::f32 : prep::PixelType::u8;
    layout.srgb = !linear_;
    const Result<std::size_t> picture = files_.open(options_.picture, layout);
    if (!picture) return picture.error();
    picture_ = *picture;
    paths_.push_back(options_.picture);
    if (options_.buffers.empty()) return {};
    if (!options_.buffer_file.empty())
        return open_file(options_.buffer_file, plan, options_.buffers);
    for (const Buffer buffer : options_.buffers) {
        std::filesystem::path path = options_.picture;
        path.replace_extension(std::string(prep::name_of(buffer)) + ".exr");
        if (Result<void> opened = open_file(path, plan, {buffer}); !opened) return opened;
    }
    return {};
}

Result<void> RenderOutputs::open_file(const std::filesystem::path& path,
                                      const rast::RenderPlan& plan,
                                      const std::vector<Buffer>& buffers) {
    BufferFile out;
    out.buffers = buffers;
    prep::ImageLayout layout;
    layout.width = plan.request.crop ? plan.request.crop->width : plan.request.width;
    layout.height = plan.request.crop ? plan.request.crop->height : plan.request.height;
    layout.type = prep::PixelType::f32;
    for (const Buffer buffer : buffers)
        for (const std::string& channel : channels_of(buffer)) {
            layout.channels.push_back(channel);
            layout.integer.push_back(buffer == Buffer::id);
            out.integers |= buffer == Buffer::id;
        }
    if (!out.integers) layout.integer.clear();
    const Result<std::size_t> file = files_.open(path, layout);
    if (!file) return file.error();
    out.file = *file;
    buffer_files_.push_back(std::move(out));
    paths_.push_back(path);
    return {};
}

Result<void> RenderOutputs::write(const rast::Frame& band) {
    std::vector<float> floats;
    if (linear_) {
        floats.reserve(band.color.size() * 4);
        const float e = options_.choices.exposure;
        for (const glm::vec4& c : band.color) {
            for (const float v : {c.r * e, c.g * e, c.b * e}) floats.push_back(v);
            if (alpha_) floats.push_back(c.a);
        }
    } else {
        floats = rast::to_srgb(band, options_.choices, options_.threads).pixels;
    }
    if (Result<void> written = files_.write_rows(picture_, floats); !written) return written;
    const Distance distance(view_);
    for (const BufferFile& out : buffer_files_) {
        floats.clear();
        std::vector<std::uint32_t> words;
        for (std::size_t i = 0; i < std::size_t(band.width) * band.height; ++i)
            for (const Buffer buffer : out.buffers) {
                if (out.integers)
                    put_buffer(words, band, view_, distance, buffer, i);
                else
                    put_buffer(floats, band, view_, distance, buffer, i);
            }
        Result<void> written =
            out.integers ? files_.write_rows(out.file, words) : files_.write_rows(out.file, floats);
        if (!written) return written;
    }
    return {};
}

}  // namespace meshprep
