// step_prices [ROUNDS]: what the steps of a picture cost each, as the table of
// tools/meshprep/output/step_costs.cpp. Two pictures that differ by the step are drawn in turn on
// one thread; the price is the median of the differences of processor time, over what was counted
// more of.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

#include "prep/image.h"
#include "rast/render.h"

namespace {

using rast::Counters;

double processor_ns() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return double(now.tv_sec) * 1e9 + double(now.tv_nsec);
}

// A sheet of n by n quads that fills the picture, bent so that normals differ.
prep::PreparedScene sheet(std::uint32_t n, const prep::Material& material) {
    prep::VertexMesh mesh;
    mesh.uvs.emplace_back();
    for (std::uint32_t j = 0; j <= n; ++j)
        for (std::uint32_t i = 0; i <= n; ++i) {
            const float u = float(i) / float(n), v = float(j) / float(n);
            mesh.positions.emplace_back(4 * u - 2, 4 * v - 2, 0);
            mesh.normals.push_back(glm::normalize(glm::vec3(u - 0.5f, v - 0.5f, 1)));
            mesh.tangents.emplace_back(1, 0, 0, 1);
            mesh.uvs[0].emplace_back(3 * u, 3 * v);
        }
    for (std::uint32_t j = 0; j < n; ++j)
        for (std::uint32_t i = 0; i < n; ++i) {
            const std::uint32_t a = j * (n + 1) + i, b = a + n + 1;
            mesh.indices.insert(mesh.indices.end(), {a, a + 1, b + 1, a, b + 1, b});
        }
    mesh.ranges = {{0, 2 * n * n, 0, prep::no_index}};
    prep::PreparedScene scene;
    scene.scene.meshes.resize(1);
    scene.scene.materials.push_back(material);
    prep::Node node;
    node.mesh = 0;
    scene.scene.nodes.push_back(node);
    scene.meshes.push_back(std::move(mesh));
    // Noise of 256 texels a side.
    prep::Image noise;
    noise.width = noise.height = 256;
    noise.channels = 3;
    std::uint32_t state = 1;
    for (std::uint32_t k = 0; k < noise.width * noise.height; ++k)
        for (const float least : {0.25f, 0.25f, 0.75f}) {
            state = state * 1664525u + 1013904223u;
            noise.pixels.push_back(least + float(state >> 24) / 1024);
        }
    prep::ImageRef image;
    image.name = "noise.png";
    image.bytes = *prep::encode_png(noise);
    scene.scene.images.push_back(image);
    prep::Texture texture;
    texture.image = 0;
    scene.scene.textures.push_back(texture);
    return scene;
}

rast::RenderRequest request_of(int lights) {
    rast::RenderRequest request;
    request.width = request.height = 512;
    request.threads = 1;
    rast::View view;
    view.perspective = false;
    view.half_height = 1.5;
    view.world_to_view[3] = glm::dvec4(0, 0, -5, 1);
    view.zfar = 10;
    request.view = view;
    request.lights.emplace();
    for (int l = 0; l < lights; ++l) {
        rast::LightInstance light;
        light.direction = glm::normalize(glm::dvec3(0.1 * l, 0.2, -1));
        light.color = glm::vec3(0.2f);
        request.lights->push_back(light);
    }
    return request;
}

class Side {
  public:
    Side(prep::PreparedScene scene, const rast::RenderRequest& request)
        : scene_(std::move(scene)), renderer_(scene_), plan_(*rast::plan(scene_, request)) {
        draw();  // reads what there is to be read
    }
    Side(const Side&) = delete;
    double draw() {
        const double start = processor_ns();
        if (const auto done = renderer_.render(plan_, frame_); !done) {
            std::fprintf(stderr, "step_prices: %s\n", to_string(done.error()).c_str());
            std::exit(1);
        }
        return processor_ns() - start;
    }
    const Counters& counters() const { return frame_.counters; }

  private:
    prep::PreparedScene scene_;
    rast::SceneRenderer renderer_;
    rast::RenderPlan plan_;
    rast::Frame frame_;
};

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

int rounds = 41;

// `known`: nanoseconds of the difference that other steps take.
double price(const char* step, Side with, Side without, std::uint64_t Counters::*count,
             double known = 0) {
    std::vector<double> apart;
    for (int r = 0; r < rounds; ++r) {
        const double a = with.draw(), b = without.draw();
        apart.push_back(a - b);
    }
    double more = double(with.counters().*count) - double(without.counters().*count);
    if (more == 0) more = double(with.counters().*count);  // each takes longer
    const double each = more > 0 ? (median(apart) - known) / more : 0;
    std::printf("%-18s %8.3f ns each, of %.0f\n", step, each, more);
    return each;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc > 1) rounds = std::max(std::atoi(argv[1]), 1);
    prep::Material matte, shiny, bare, mapped, bent;
    matte.specular = glm::vec3(0);
    bare.unlit = true;
    mapped = bare;
    mapped.diffuse_map.texture = 0;
    bent = matte;
    bent.normal_map.texture = 0;
    price("lights", {sheet(1, matte), request_of(5)}, {sheet(1, matte), request_of(1)},
          &Counters::light_points);
    price("highlights", {sheet(1, shiny), request_of(4)}, {sheet(1, matte), request_of(4)},
          &Counters::highlight_points);
    const double sample = price("textures", {sheet(1, mapped), request_of(1)},
                                {sheet(1, bare), request_of(1)}, &Counters::texture_samples);
    price("normal maps", {sheet(1, bent), request_of(1)}, {sheet(1, matte), request_of(1)},
          &Counters::normal_map_points, sample * 512 * 512);
    rast::RenderRequest blank = request_of(1);
    blank.keep_color = false;
    blank.keep_depth = true;
    rast::RenderRequest colored = request_of(1);
    colored.keep_depth = true;
    price("shading", {sheet(1, bare), colored}, {sheet(1, bare), blank}, &Counters::pixels_shaded);
    // Under three lights more, of vertices that are lit in both.
    rast::RenderRequest one = request_of(1), four = request_of(4);
    one.shading = four.shading = rast::Shading::gouraud;
    price("vertex lighting", {sheet(200, shiny), four}, {sheet(200, shiny), one},
          &Counters::vertices_lit);
    rast::RenderRequest sampled = blank;
    sampled.samples = 16;
    price("multisampling", {sheet(64, bare), sampled}, {sheet(64, bare), blank},
          &Counters::sample_points);
}
