// `render --image-error`: what is asked, what comes, measured again by other processes from the
// files.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <sstream>

#include "command_runner.h"
#include "hostile_meshes.h"
#include "meshprep/budgets/render_budget.h"
#include "prep/load.h"
#include "prep/prepare.h"

namespace {

using nlohmann::json;
using test::run_command;
using test::run_here;
using test::TempDir;
using test::write_text;

class ImageError : public ::testing::Test {
  protected:
    ImageError() {
        write_text(dir_ / "ball.obj", test::sphere_obj(14, 7));
        write_text(dir_ / "cube.obj", test::cube_obj());
        // A checkered floor that reaches far, and needles.
        std::string floor = "v -50 0 -90\nv 50 0 -90\nv 50 0 5\nv -50 0 5\nf 4 3 2 1\n";
        write_text(dir_ / "floor.obj", floor);
        std::string comb;
        for (int i = 0; i < 40; ++i) {
            const std::string x = std::to_string(i * 0.05 - 1), y = std::to_string(i * 0.05 - 0.99);
            comb += "v " + x + " -1 0\nv " + y + " -1 0\nv " + x + " 1 0\nf " +
                    std::to_string(3 * i + 1) + " " + std::to_string(3 * i + 2) + " " +
                    std::to_string(3 * i + 3) + "\n";
        }
        write_text(dir_ / "comb.obj", comb);
        test::write_hostile_meshes(dir_ / "");
    }
    std::string at(const std::string& name) const { return (dir_ / name).string(); }

    // Draws within `levels`; the certificate, held against files that other processes write.
    void request(const std::string& mesh, const std::string& levels, int code,
                 const std::vector<std::string>& more = {}) {
        SCOPED_TRACE(mesh + " " + levels);
        const std::string number = std::to_string(requests_++);
        std::vector<std::string> words = {"render",       at(mesh),
                                          "-o",           at(number + ".png"),
                                          "--size=96x72", "--image-error",
                                          levels,         "--json",
                                          "--threads",    requests_ % 2 == 0 ? "1" : "2"};
        words.insert(words.end(), more.begin(), more.end());
        const test::Ran ran = run_here(words);
        ASSERT_EQ(ran.exit_code, code) << ran.err;
        const json c = ran.json()["certificate"];
        ASSERT_TRUE(c.is_object()) << ran.out;
        const double asked = std::stod(levels), achieved = c["achieved"].get<double>();
        EXPECT_EQ(c["met"].get<bool>(), code == 0);
        EXPECT_EQ(achieved <= asked, code == 0);
        // Nothing cheaper does it, and of all that fail the best is taken.
        for (const json& tried : c["tried"])
            if (tried["setting"] != c["chosen"]["setting"]) {
                EXPECT_GE(tried["levels"].get<double>(), code == 0 ? asked : achieved);
            }
        EXPECT_EQ(c["measured"], c["pixels"]);
        // The printed command, as a shell runs it: the same bytes.
        std::string again = c["command"].get<std::string>();
        ASSERT_EQ(again.rfind("meshprep render ", 0), 0u) << again;
        ASSERT_EQ(again.find("image-error"), std::string::npos) << again;
        const std::string drawn = test::file_text(dir_ / (number + ".png"));
        std::filesystem::rename(dir_ / (number + ".png"), dir_ / (number + "-first.png"));
        // On the other number of threads.
        std::vector<std::string> parts = words_of(again.substr(again.find(' ') + 1));
        parts.insert(parts.end(), {"--threads", requests_ % 2 == 0 ? "1" : "2"});
        const test::Ran repeated = run_here(parts);
        ASSERT_EQ(repeated.exit_code, 0) << again << repeated.err;
        EXPECT_EQ(test::file_text(dir_ / (number + ".png")), drawn) << again;
        // The truth and the difference, by others: equal but for the rounding of a square root.
        const json apart =
            run_command({"diff", at(number + ".png"), truth_of(mesh, more), "--json"})
                .json()["differences"][0];
        // `diff` sees bytes as floats of 24 bits.
        EXPECT_NEAR(apart["rmse"].get<double>() * 255, achieved, 1e-4);
    }

    // As a shell takes them.
    static std::vector<std::string> words_of(const std::string& command) {
        const test::Ran shell = test::run_program(
            "/bin/sh", {"-c", "for word in " + command + "; do printf '%s\\n' \"$word\"; done"});
        EXPECT_EQ(shell.exit_code, 0) << command;
        std::vector<std::string> words;
        std::istringstream lines(shell.out);
        for (std::string line; std::getline(lines, line);) words.push_back(line);
        return words;
    }

    // One for all requests that have it: what is asked does not change it.
    std::string truth_of(const std::string& mesh, const std::vector<std::string>& more) {
        std::vector<std::string> words = {"render",        at(mesh), "--size=96x72",
                                          "--supersample", "16",     "--quiet"};
        words.insert(words.end(), more.begin(), more.end());
        const auto [known, fresh] =
            truths_.try_emplace(words, at("truth" + std::to_string(truths_.size()) + ".png"));
        if (fresh) {
            words.insert(words.end(), {"-o", known->second});
            EXPECT_EQ(run_command(words).exit_code, 0);
        }
        return known->second;
    }

    TempDir dir_;
    std::map<std::vector<std::string>, std::string> truths_;
    int requests_ = 0;
};

// 40 requests: 20 that can be met, 8 that cannot, 4 that ask for nothing, 4 hostile meshes, 4 that
// are none.
TEST_F(ImageError, OfFortyRequestsAllAreMetThatCanBe) {
    for (const char* const mesh : {"ball.obj", "cube.obj", "floor.obj", "comb.obj"}) {
        for (const char* const levels : {"12", "6", "4.5", "3.5", "2.8"}) request(mesh, levels, 0);
        for (const char* const levels : {"0", "0.01"}) request(mesh, levels, 1);
        request(mesh, "255", 0);
    }
    for (const char* const mesh : {"nan.obj", "flat.obj", "far.obj", "twice.obj"})
        request(mesh, "5", 0);
    EXPECT_EQ(requests_, 36);
    const std::vector<std::vector<std::string>> none = {{"--image-error", "-1"},
                                                        {"--image-error", "nan"},
                                                        {"--image-error", "fine"},
                                                        {"--image-error", "1", "--samples", "4"}};
    for (const auto& more : none) {
        std::vector<std::string> words = {"render", at("ball.obj"), "-o", at("x.png")};
        words.insert(words.end(), more.begin(), more.end());
        EXPECT_EQ(run_here(words).exit_code, 2);
    }
    EXPECT_FALSE(std::filesystem::exists(dir_ / "x.png"));
}

TEST_F(ImageError, WhatElseWasGivenStandsInTheCommand) {
    request("ball.obj", "4", 0,
            {"--light=-30,20", "--light=60,10,0.5", "--ambient", "0.2", "--shading", "phong",
             "--camera=10,-20"});
    request("ball.obj", "4", 0, {"--exposure", "auto", "--background", "0.2,0.1,0"});
    request("comb.obj", "6", 0, {"--no-textures", "--crop", "8,8,40x30"});
}

// Of a large picture 256 squares are measured, and that is said.
TEST_F(ImageError, OfLargePicturesSquaresAreMeasured) {
    const test::Ran ran = run_here({"render", at("comb.obj"), "-o", at("big.png"), "--size",
                                    "2000x800", "--image-error", "30", "--json"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const json c = ran.json()["certificate"];
    EXPECT_EQ(c["measured"], 12 * 21 * 64 * 64);  // more rows would overlap
    EXPECT_EQ(c["pixels"], 1600000);
    EXPECT_NE(c["scope"].get<std::string>().find("1,032,192 of 1,600,000"), std::string::npos);
}

// Nothing is finer than a picture of the largest size but half its sides.
TEST_F(ImageError, WithoutAFinerPictureNothingIsSaid) {
    for (const std::vector<std::string>& more : std::vector<std::vector<std::string>>{
             {"--size", "16385x16"}, {"--size", "16x32768", "--crop", "0,0,16x16"}}) {
        std::vector<std::string> words = {"render",    at("ball.obj"),  "-o",
                                          at("x.png"), "--image-error", "255"};
        words.insert(words.end(), more.begin(), more.end());
        const test::Ran ran = run_here(words);
        EXPECT_EQ(ran.exit_code, 1);
        EXPECT_NE(ran.err.find("twice as fine"), std::string::npos) << ran.err;
        EXPECT_FALSE(std::filesystem::exists(dir_ / "x.png"));
    }
    const test::Ran ran = run_here({"render", at("ball.obj"), "-o", at("x.png"), "--image-error",
                                    "255", "--size", "16384x16", "--json"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_EQ(ran.json()["certificate"]["truth_supersample"], 2);
}

// The search itself, and what it plans.
struct Searched {
    meshprep::ImageCertificate certificate;
    std::vector<std::pair<std::size_t, rast::RenderRequest>> planned;
};
Searched search(const prep::PreparedScene& scene, const rast::RenderRequest& request,
                const std::vector<rast::View>& views, double levels) {
    Searched out;
    rast::SceneRenderer renderer(scene);
    const auto plan_for = [&](const rast::RenderRequest& r, std::size_t view) {
        out.planned.emplace_back(view, r);
        rast::RenderRequest seen = r;
        seen.view = views[view];
        return rast::plan(scene, seen);
    };
    const auto chosen =
        meshprep::choose_sampling(renderer, request, views.size(), plan_for, levels);
    EXPECT_TRUE(chosen) << to_string(chosen.error());
    if (chosen) out.certificate = *chosen;
    return out;
}
prep::PreparedScene prepared(const std::filesystem::path& file) {
    auto scene = prep::load_scene(file);
    EXPECT_TRUE(scene);
    auto prepared = prep::prepare(std::move(*scene));
    EXPECT_TRUE(prepared);
    return std::move(*prepared);
}

// Each pixel at most once, and as many as are told.
TEST_F(ImageError, SquaresDoNotOverlap) {
    const prep::PreparedScene scene = prepared(dir_ / "cube.obj");
    for (const glm::uvec2 size : {glm::uvec2(100, 12000),
                                  {12000, 100},
                                  {64, 16384},
                                  {1024, 1100},
                                  {1000, 1500},
                                  {4000, 300}}) {
        rast::RenderRequest request;
        request.width = size.x;
        request.height = size.y;
        const Searched found = search(scene, request, {rast::orbit_view(scene)}, 255);
        std::vector<bool> seen(std::size_t(size.x) * size.y, false);
        std::size_t pixels = 0;
        for (const auto& [view, r] : found.planned) {
            if (r.supersample > 1) continue;
            if (r.samples > 1) break;
            ASSERT_TRUE(r.crop.has_value());
            for (std::uint32_t y = r.crop->y; y < r.crop->y + r.crop->height; ++y)
                for (std::uint32_t x = r.crop->x; x < r.crop->x + r.crop->width; ++x) {
                    ASSERT_FALSE(seen[std::size_t(y) * size.x + x]) << x << " " << y;
                    seen[std::size_t(y) * size.x + x] = true;
                    ++pixels;
                }
        }
        EXPECT_EQ(found.certificate.measured, pixels);
        EXPECT_GT(pixels, std::min(seen.size(), std::size_t(1) << 20) * 7 / 10);
        // To the last row and column, where there is more than one of squares.
        if (size.y > 128) {
            EXPECT_TRUE(std::find(seen.end() - size.x, seen.end(), true) != seen.end());
        }
    }
}

// Of several views, what each of them alone says, the worst; and one view after the other, so that
// their pictures need not all be there at once.
TEST_F(ImageError, ViewsAreMeasuredOneByOne) {
    const prep::PreparedScene scene = prepared(dir_ / "comb.obj");
    rast::RenderRequest request;
    request.width = 48;
    request.height = 36;
    std::vector<rast::View> views;
    for (const double azimuth : {85.0, 0.0, 40.0})
        views.push_back(rast::orbit_view(scene, {.azimuth_degrees = azimuth}));
    std::vector<double> worst(meshprep::sampling_rungs().size(), 0);
    for (const rast::View& view : views) {
        const auto tried = search(scene, request, {view}, 0).certificate.tried;
        ASSERT_EQ(tried.size(), worst.size());
        for (std::size_t n = 0; n < worst.size(); ++n)
            worst[n] = std::max(worst[n], tried[n].levels);
    }
    for (const double levels : {0.0, worst[8] * 1.01, worst[5] * 1.01, worst[2] * 1.01, 255.0}) {
        const Searched found = search(scene, request, views, levels);
        std::size_t first = 0;
        while (first < worst.size() && worst[first] > levels) ++first;
        const auto& tried = found.certificate.tried;
        ASSERT_EQ(tried.size(), std::min(first + 1, worst.size())) << levels;
        for (std::size_t n = 0; n < tried.size(); ++n) EXPECT_EQ(tried[n].levels, worst[n]);
        EXPECT_EQ(found.certificate.met, first < worst.size());
        ASSERT_EQ(found.certificate.next.has_value(), first + 1 < worst.size());
        if (found.certificate.next) {
            EXPECT_EQ(found.certificate.next->levels, worst[first + 1]);
        }
        // Nothing of a view is drawn but next to its own truth.
        std::size_t truth = views.size();
        for (const auto& [view, r] : found.planned) {
            if (r.supersample == found.certificate.truth) truth = view;
            EXPECT_EQ(view, truth);
        }
    }
}

}  // namespace
