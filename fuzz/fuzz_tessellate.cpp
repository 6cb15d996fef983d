// tessellate() on small hostile meshes with hostile height maps: any topology, UVs, texels, goals.
#include <cmath>
#include <cstdlib>

#include "hostile_mesh.h"
#include "prep/displacement/tessellate.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::Bytes in(data, size);
    prep::TessellateOptions options;
    options.threads = 1;
    options.samples = 200;
    options.triangle_limit = 20000;
    if (const std::uint32_t scheme = in.below(4); scheme < 3)
        options.scheme = prep::SubdivisionScheme(scheme);
    const bool triangles = options.scheme == prep::SubdivisionScheme::loop && in.below(8) != 0;
    if (in.below(4) == 0) options.subdivision.boundary = prep::BoundaryRule(in.below(3));
    options.subdivision.creasing = prep::CreasingMethod(in.below(2));
    const auto length = [&] {
        return in.below(8) ? 0.01 * (1 + in.below(200)) : in.take<double>();
    };
    if (in.below(2)) options.chord_error = length();
    if (in.below(4) == 0) options.edge_length = length();
    if (in.below(4) == 0) {
        options.pixel_error = length();
        options.screens.resize(in.below(3));
        for (prep::ScreenMetric& screen : options.screens) {
            screen.pixels = glm::dvec2(in.below(2000));
            for (glm::dvec4* row : {&screen.x, &screen.y, &screen.w})
                for (int k = 0; k < 4; ++k)
                    (*row)[k] = in.below(16) ? in.below(100) / 25.0 - 2 : in.take<double>();
            screen.near_distance = in.below(8) ? 0.01 * (1 + in.below(50)) : in.take<double>();
        }
    }
    if (in.below(2)) options.max_triangles = in.below(3000);

    prep::Image image;
    image.width = 1 + in.below(6);
    image.height = 1 + in.below(6);
    image.channels = 1 + in.below(2);
    const std::uint32_t kind = in.below(3);
    image.integer_bits = kind == 0 ? 8 : kind == 1 ? 16 : 0;
    for (std::size_t k = 0; k < std::size_t(image.width) * image.height * image.channels; ++k)
        image.pixels.push_back(in.below(16) ? float(in.below(256)) / 255 : in.take<float>());
    prep::HeightMapOptions heights;
    heights.filter = prep::HeightFilter(in.below(2));
    heights.wrap_u = prep::Wrap(in.below(4));
    heights.wrap_v = prep::Wrap(in.below(4));
    heights.channel = in.below(3);
    heights.scale = in.below(8) ? in.below(100) / 50.0 - 1 : in.take<double>();
    heights.sample_spacing = in.below(2)   ? 0
                             : in.below(8) ? 0.02 * in.below(60)
                                           : in.take<double>();
    heights.threads = 1;
    const bool confined = in.below(2) == 1;
    const std::uint32_t sources = in.below(8);  // heights, noise, vectors
    prep::NoiseOptions noise;
    noise.kind = prep::NoiseKind(in.below(2));
    noise.octaves = int(in.below(5));
    noise.frequency = in.below(8) ? 0.5 * in.below(10) : in.take<double>();
    noise.scale = in.below(8) ? 0.1 * in.below(20) : in.take<double>();
    noise.sample_spacing = heights.sample_spacing;

    const prep::Mesh mesh = fuzz::hostile_mesh(in, triangles);
    prep::Displacement displacement;
    if (sources & 1)
        if (const auto map = prep::height_function(image, heights, confined ? &mesh : nullptr, 0,
                                                   options.scheme))
            displacement.height = *map;
    if (sources & 2)
        if (const auto made = prep::noise_function(noise)) displacement.noise = *made;
    if (sources & 4) {
        prep::Image wide = image;
        wide.channels = 3;
        wide.pixels.resize(std::size_t(wide.width) * wide.height * 3, 0.5F);
        const auto axes = prep::VectorAxes(in.below(3));
        displacement.tangent_space = axes != prep::VectorAxes::object;
        if (const auto map = prep::vector_function(wide, {.map = heights, .axes = axes},
                                                   confined ? &mesh : nullptr, 0, options.scheme))
            displacement.vector = *map;
    }
    if (sources != 0) options.displacements.push_back(displacement);
    const auto made = prep::tessellate(mesh, options);
    if (!made) return 0;
    const prep::Mesh& out = made->mesh;
    const prep::TessellationCertificate& c = made->certificate;
    if (made->cage_faces.size() != out.face_count() || c.triangles != out.face_count())
        std::abort();
    for (const std::uint32_t v : out.corner_vertices)
        if (v >= out.vertex_count()) std::abort();
    for (const glm::vec3& p : out.positions)
        if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) std::abort();
    for (const glm::vec3& n : out.normals.values)
        if (!(std::abs(glm::length(n) - 1) < 1e-3F)) std::abort();
    if (!(c.measured <= c.proved)) std::abort();
    if (options.pixel_error && !(c.proved_pixels && *c.proved_pixels >= 0)) std::abort();
    return 0;
}
