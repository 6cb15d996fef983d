// Which pixels a rectangle covers whose edges run exactly through pixel centres: those on its left
// and top edges and none on the others, at every size, so that neighbours share none.
#include "reference_shading.h"

namespace {

using namespace test;

TEST(PixelEdges, OfRectanglesThroughCentresBelongToTheLeftAndTheTop) {
    constexpr std::uint32_t extent = 200;
    rast::RenderRequest request;
    request.width = request.height = extent;
    request.view = test::flat_view(extent / 2.0);  // one unit is a pixel
    prep::Material material = white();
    material.unlit = true;
    struct Box {
        std::uint32_t x0, y0, x1, y1;
    };
    // From a pixel to many tiles; wide and flat; beyond the picture.
    for (const Box& box : {Box{10, 20, 11, 21}, Box{3, 5, 9, 8}, Box{20, 60, 45, 70},
                           Box{30, 30, 94, 94}, Box{1, 2, 190, 6}, Box{7, 1, 10, 199},
                           Box{63, 64, 129, 128}, Box{5, 11, 181, 173}, Box{64, 0, 500, 400}})
        for (const bool turned : {false, true}) {
            prep::VertexMesh mesh;
            const auto corner = [&](std::uint32_t x, std::uint32_t y) {
                mesh.positions.push_back(
                    {float(x) + 0.5f - extent / 2.0f, extent / 2.0f - 0.5f - float(y), 0});
            };
            corner(box.x0, box.y1);
            corner(box.x1, box.y1);
            corner(box.x1, box.y0);
            corner(box.x0, box.y0);
            mesh.indices = {0, 1, 2, 0, 2, 3};
            if (turned) mesh.indices = {0, 1, 3, 1, 2, 3};
            const prep::PreparedScene scene = test::scene_of(mesh, material);
            for (const prep::SimdLevel level : every_level()) {
                request.simd = level;
                const rast::Frame frame = test::draw(scene, request);
                for (std::uint32_t y = 0; y < extent; ++y)
                    for (std::uint32_t x = 0; x < extent; ++x)
                        ASSERT_EQ(drawn(frame, x, y),
                                  x >= box.x0 && x < box.x1 && y >= box.y0 && y < box.y1)
                            << x << " " << y << " of " << box.x1 - box.x0 << "x" << box.y1 - box.y0
                            << ", " << prep::to_string(level);
            }
        }
}

}  // namespace
