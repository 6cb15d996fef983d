// The command's `diff`, on small pictures and meshes whose differences are worked out by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "command_runner.h"
#include "prep/image.h"

namespace {

using nlohmann::json;
using test::run_here;
using test::TempDir;

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float nan = std::numeric_limits<float>::quiet_NaN();

std::string save_floats(const TempDir& dir, const std::string& name, std::vector<float> values) {
    const prep::Image image{std::uint32_t(values.size()), 1, 1, std::move(values), false};
    EXPECT_TRUE(prep::save_image(dir / name, image, prep::PixelType::f32));
    return (dir / name).string();
}

std::string save_integers(const TempDir& dir, const std::string& name,
                          const std::vector<std::uint32_t>& values) {
    prep::ImageFiles files;
    prep::ImageLayout layout{std::uint32_t(values.size()), 1,      {"id"},
                             prep::PixelType::f32,         {true}, false};
    const auto file = files.open(dir / name, layout);
    EXPECT_TRUE(file && files.write_rows(*file, values) && files.commit());
    return (dir / name).string();
}

json part(const test::Ran& ran) {
    const json document = ran.json();
    return document.contains("differences") ? document["differences"][0] : json();
}

TEST(DiffPictures, AValueThatIsInfiniteInOneAloneIsInfinitelyFar) {
    const TempDir dir;
    const std::string a = save_floats(dir, "a.exr", {1, infinity, 2, nan, -infinity, 4, nan});
    const std::string b = save_floats(dir, "b.exr", {1, 3, infinity, 5, infinity, 3.5, infinity});
    const test::Ran words = run_here({"diff", a, b});
    EXPECT_EQ(words.exit_code, 0);
    EXPECT_NE(words.out.find("largest infinite at (1, 0): 5 values"), std::string::npos)
        << words.out;
    // Of the two finite values, one differs by 1/2.
    EXPECT_NE(words.out.find("RMSE 0.353553"), std::string::npos) << words.out;
    const test::Ran ran = run_here({"diff", a, b, "--tolerance", "1e30", "--json"});
    EXPECT_EQ(ran.exit_code, 1);
    const json found = part(ran);
    EXPECT_EQ(found["infinite"], 5) << ran.out;
    EXPECT_EQ(found["different"], 6);
    for (const char* key : {"largest", "rmse", "mean", "psnr"})
        EXPECT_TRUE(found[key].is_null()) << key;
    EXPECT_EQ(found["worst"], json::array({1, 0}));
}

TEST(DiffPictures, EqualInfinitiesAndNaNAreEqual) {
    const TempDir dir;
    const std::string a = save_floats(dir, "a.exr", {infinity, -infinity, nan, 1});
    const std::string b = save_floats(dir, "b.exr", {infinity, -infinity, nan, 1});
    const test::Ran ran = run_here({"diff", a, b, "--tolerance", "0", "--json"});
    EXPECT_EQ(ran.exit_code, 0);
    EXPECT_EQ(part(ran)["different"], 0);
    EXPECT_EQ(part(ran)["infinite"], 0);
    EXPECT_EQ(part(ran)["largest"], 0.0);
}

TEST(DiffPictures, IntegersAreTheSameOrNot) {
    const TempDir dir;
    // Neighbours that are one number in float, and at either end of 32 bits.
    const std::string a = save_integers(dir, "a.exr", {0, 7, 16777216, 4294967295u, 2147483648u});
    const std::string b = save_integers(dir, "b.exr", {1, 7, 16777217, 4294967294u, 2147483648u});
    const test::Ran same = run_here({"diff", a, a, "--tolerance", "0"});
    EXPECT_EQ(same.exit_code, 0);
    EXPECT_NE(same.out.find("identical: 5 pixels"), std::string::npos) << same.out;
    const test::Ran ran = run_here({"diff", a, b, "--tolerance", "1e30", "--json"});
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_EQ(part(ran)["different"], 3) << ran.out;
    EXPECT_EQ(part(ran)["different_integers"], 3);
    EXPECT_TRUE(part(ran)["rmse"].is_null());
    const test::Ran words = run_here({"diff", a, b});
    EXPECT_NE(words.out.find("integers differ in 3 pixels"), std::string::npos) << words.out;
    EXPECT_EQ(words.out.find("RMSE"), std::string::npos) << words.out;
    const test::Ran mixed =
        run_here({"diff", a, save_floats(dir, "c.exr", {0, 7, 16777216, 0, 0})});
    EXPECT_EQ(mixed.exit_code, 1);
    EXPECT_NE(mixed.err.find("integers in one picture"), std::string::npos) << mixed.err;
}

TEST(DiffPictures, ChannelsOfManyAreComparedByTheirNames) {
    const TempDir dir;
    const auto save = [&](const std::string& name, const std::vector<std::string>& channels,
                          const std::vector<float>& values) {
        prep::ImageFiles files;
        const prep::ImageLayout layout{1, 1, channels, prep::PixelType::f32, {}, false};
        const auto file = files.open(dir / name, layout);
        EXPECT_TRUE(file && files.write_rows(*file, values) && files.commit());
        return (dir / name).string();
    };
    const std::vector<std::string> names = {"Z", "a.X", "a.Y", "b.X", "b.Y", "c.X"};
    const std::string a = save("a.exr", names, {1, 2, 3, 4, 5, 6});
    const std::string b = save("b.exr", {"c.X", "b.Y", "b.X", "a.Y", "a.X", "Z"},
                               {6, 5, 4, 3, 2, 1});  // the same in another order
    EXPECT_NE(run_here({"diff", a, b}).out.find("identical: 1 pixel"), std::string::npos);
    const std::string c = save("c.exr", names, {1, 2, 3, 4, 5, 6.5f});
    const test::Ran ran = run_here({"diff", a, c, "--json"});
    EXPECT_EQ(part(ran)["different"], 1) << ran.out;
    EXPECT_NEAR(part(ran)["largest"].get<double>(), 0.5, 1e-6);
    EXPECT_NEAR(part(ran)["rmse"].get<double>(), std::sqrt(0.25 / 6), 1e-6);
    const std::string d =
        save("d.exr", {"Z", "a.X", "a.Y", "b.X", "b.Y", "d.X"}, {1, 2, 3, 4, 5, 6});
    const test::Ran other = run_here({"diff", a, d});
    EXPECT_EQ(other.exit_code, 1);
    EXPECT_NE(other.err.find("'d.X' is in one of them alone"), std::string::npos) << other.err;
}

TEST(DiffPictures, AlphaThatOneLacksCountsAsOne) {
    const TempDir dir;
    const auto save = [&](const std::string& name, std::uint32_t channels,
                          std::vector<float> values) {
        EXPECT_TRUE(prep::save_image(dir / name, {1, 1, channels, std::move(values), true}));
        return (dir / name).string();
    };
    const float half = 128 / 255.0f;
    const std::string rgb = save("rgb.png", 3, {1, 1, 1}), grey = save("grey.png", 1, {1});
    for (const std::string& other :
         {save("clear.png", 4, {1, 1, 1, half}), save("greyclear.png", 2, {1, half})})
        for (const std::string& opaque : {rgb, grey}) {
            const test::Ran ran = run_here({"diff", opaque, other, "--json"});
            EXPECT_EQ(part(ran)["different"], 1) << ran.out;
            EXPECT_NEAR(part(ran)["largest"].get<double>(), 127 / 255.0, 1e-6);
            EXPECT_EQ(part(run_here({"diff", other, opaque, "--json"})), part(ran));
        }
    const std::string opaque = save("opaque.png", 4, {1, 1, 1, 1});
    EXPECT_EQ(run_here({"diff", rgb, opaque, "--tolerance", "0"}).exit_code, 0);
    EXPECT_EQ(run_here({"diff", grey, opaque, "--tolerance", "0"}).exit_code, 0);
    EXPECT_EQ(run_here({"diff", grey, save("red.png", 3, {1, 0, 0}), "--tolerance", "0"}).exit_code,
              1);
}

// Two triangles whose normals lean by these angles, in degrees, corner by corner.
std::string leaning(const std::vector<double>& degrees) {
    std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 0 0\nv 6 0 0\nv 5 1 0\n";
    for (const double angle : degrees) {
        const double radians = angle * 3.14159265358979 / 180;
        text += "vn " + std::to_string(std::sin(radians)) + " 0 " +
                std::to_string(std::cos(radians)) + "\n";
    }
    return text + "f 1//1 2//2 3//3\nf 4//4 5//5 6//6\n";
}

TEST(DiffMeshes, MedianAndPercentileOfFewCorners) {
    const TempDir dir;
    test::write_text(dir / "a.obj", leaning({0, 0, 0, 0, 0, 0}));
    test::write_text(dir / "b.obj", leaning({0, 30, 10, 180, 0, 30}));
    const std::string a = (dir / "a.obj").string(), b = (dir / "b.obj").string();
    const test::Ran ran = run_here({"diff", "--normals", a, b, "--json"});
    const json degrees = part(ran)["degrees"];
    // Of 0, 0, 10, 30, 30, 180: between 10 and 30; ⌈0.99 · 6⌉ = 6, the last.
    EXPECT_NEAR(degrees["median"].get<double>(), 20, 1e-3) << ran.out;
    EXPECT_NEAR(degrees["p99"].get<double>(), 180, 1e-3);
    const test::Ran words = run_here({"diff", "--normals", a, b});
    EXPECT_NE(words.out.find("median 20, 99 % 180, largest 180"), std::string::npos) << words.out;
}

}  // namespace
