// LDR-FLIP against what the published evaluator says of the same pictures.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>

#include "cost/measure/flip.h"
#include "prep/files.h"
#include "prep/image.h"
#include "shared_data.h"

namespace {

using cost::Pixels;

Pixels picture_at(const std::filesystem::path& path) {
    const auto image = prep::load_image(path);
    EXPECT_TRUE(image) << path;
    Pixels out{image->width, image->height, 3, {}};
    for (std::uint32_t y = 0; y < image->height; ++y)
        for (std::uint32_t x = 0; x < image->width; ++x)
            for (std::size_t c = 0; c < 3; ++c) out.values.push_back(double(image->at(x, y)[c]));
    return out;
}

Pixels plain(double r, double g, double b) {
    Pixels p{24, 18, 3, {}};
    for (int i = 0; i < 24 * 18; ++i) p.values.insert(p.values.end(), {r, g, b});
    return p;
}

// Means to 1e-3 and pixels to 5e-3, as the golden data's page asks; equal pictures exactly 0.
TEST(CostFlip, AgreesWithThePublishedEvaluator) {
    MESHPREP_REQUIRE_SHARED(shared);
    const std::filesystem::path dir = shared / "golden/flip";
    std::ifstream list(dir / "values.tsv");
    if (!list) GTEST_SKIP() << "the golden values of FLIP are not in the shared test data";
    std::string line;
    std::getline(list, line);
    int rows = 0;
    while (std::getline(list, line)) {
        std::istringstream words(line);
        std::string reference, test;
        double width = 0, height = 0, ppd = 0, mean = 0, largest = 0;
        words >> reference >> test >> width >> height >> ppd >> mean >> largest;
        SCOPED_TRACE(test);
        const auto flip = cost::flip(picture_at(dir / (reference + ".png")),
                                     picture_at(dir / (test + ".png")), ppd);
        ASSERT_EQ(flip.errors.size(), std::size_t(width * height));
        EXPECT_NEAR(flip.mean, mean, 1e-3);
        EXPECT_NEAR(flip.largest, largest, 5e-3);
        if (reference == test) {
            EXPECT_EQ(flip.largest, 0.0);
            ++rows;
            continue;
        }
        const auto bytes = prep::read_file(dir / (test + ".f32"));
        ASSERT_TRUE(bytes);
        ASSERT_EQ(bytes->size(), flip.errors.size() * 4);
        double worst = 0;
        for (std::size_t i = 0; i < flip.errors.size(); ++i) {
            float golden = 0;
            std::memcpy(&golden, bytes->data() + 4 * i, 4);
            worst = std::max(worst, std::abs(double(golden) - flip.errors[i]));
        }
        EXPECT_LE(worst, 5e-3);
        ++rows;
    }
    EXPECT_EQ(rows, 23);
}

TEST(CostFlip, EqualPicturesAreExactlyEqualAndTheOrderDoesNotMatter) {
    const Pixels a = plain(0.2, 0.7, 0.4), b = plain(0.25, 0.7, 0.4);
    EXPECT_EQ(cost::flip(a, a).largest, 0.0);
    EXPECT_EQ(cost::flip(a, b).errors, cost::flip(b, a).errors);
    EXPECT_GT(cost::flip(a, b).mean, 0.0);
}

// The two colours that are furthest apart, per the paper, have error 1 where there are no edges.
TEST(CostFlip, GreenAgainstBlueIsTheLargestDifference) {
    EXPECT_NEAR(cost::flip(plain(0, 1, 0), plain(0, 0, 1)).mean, 1.0, 1e-9);
}

TEST(CostFlip, MoreOfADifferenceIsMore) {
    const Pixels a = plain(0.5, 0.5, 0.5);
    double last = 0;
    for (const double d : {0.01, 0.02, 0.05, 0.1, 0.3}) {
        const double now = cost::flip(a, plain(0.5 + d, 0.5, 0.5)).mean;
        EXPECT_GT(now, last);
        last = now;
    }
}

}  // namespace
