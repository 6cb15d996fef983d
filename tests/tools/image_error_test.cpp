// `render --image-error`: what is asked, what comes, measured again by other processes from the
// files.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <sstream>

#include "command_runner.h"
#include "hostile_meshes.h"

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
    EXPECT_EQ(c["measured"], 256 * 64 * 64);
    EXPECT_EQ(c["pixels"], 1600000);
    EXPECT_NE(c["scope"].get<std::string>().find("1,048,576 of 1,600,000"), std::string::npos);
}

}  // namespace
