// A fixture with an empty folder for pictures, of its own for every test and process.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <iterator>
#include <string>

namespace test {

class ImageFolder : public ::testing::Test {
  protected:
    void SetUp() override {
        const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
        dir_ = std::filesystem::temp_directory_path() /
               ("meshprep-" + std::to_string(::getpid()) + "-" + info->name());
        std::filesystem::remove_all(dir_);
        std::filesystem::create_directories(dir_);
    }
    void TearDown() override { std::filesystem::remove_all(dir_); }
    std::size_t files() const {
        using Iterator = std::filesystem::directory_iterator;
        return std::size_t(std::distance(Iterator(dir_), Iterator()));
    }
    std::filesystem::path dir_;
};

}  // namespace test
