// Seeded mutations of real files through the reader's process: whatever they do there, this process
// goes on, with nothing left open, running, allocated or lying about.
//
//     MESHPREP_MUTATIONS=20000 build/dev/tests/prep_contained_mutations_test     # the long run
//     MESHPREP_MUTATIONS_FIRST=12345 MESHPREP_MUTATIONS=1 …                      # one of them
//     again
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <random>
#include <span>

#include "invariants.h"
#include "mesh_files.h"
#include "prep/formats.h"
#include "prep/image.h"
#include "prep/load.h"
#include "sanitized.h"
#include "shared_data.h"

namespace {

namespace fs = std::filesystem;

std::size_t number_from(const char* variable, std::size_t otherwise) {
    const char* const text = std::getenv(variable);
    return text ? std::strtoull(text, nullptr, 10) : otherwise;
}

// Reproducible wherever it runs: mt19937_64 is, the standard's distributions are not.
class Dice {
  public:
    explicit Dice(std::uint64_t seed) : bits_(seed * 0x9e3779b97f4a7c15ULL + 1) {}
    std::size_t below(std::size_t n) { return n == 0 ? 0 : std::size_t(bits_() % n); }

  private:
    std::mt19937_64 bits_;
};

void flip_bits(std::string& text, Dice& dice) {
    for (std::size_t n = 1 + dice.below(8); n > 0; --n)
        text[dice.below(text.size())] ^= char(1 << dice.below(8));
}
void overwrite(std::string& text, Dice& dice) {
    static const std::string odd("\xff\0\x7f\x80 -9\"<{\n", 11);
    for (std::size_t n = 1 + dice.below(6); n > 0; --n)
        text[dice.below(text.size())] = odd[dice.below(odd.size())];
}
void cut_off(std::string& text, Dice& dice) {
    text.resize(1 + dice.below(text.size()));
}
void remove_part(std::string& text, Dice& dice) {
    const std::size_t at = dice.below(text.size());
    text.erase(at, 1 + dice.below(std::min<std::size_t>(text.size() - at, 64)));
}
void repeat_part(std::string& text, Dice& dice) {
    const std::size_t at = dice.below(text.size());
    text.insert(dice.below(text.size()), text.substr(at, 1 + dice.below(256)));
}
// A 32-bit number of binary files: counts and offsets that cannot be.
void set_word(std::string& text, Dice& dice) {
    static const std::uint32_t words[] = {0, 1, 0x7fffffff, 0x80000000, 0xffffffff, 0x10000, 255};
    const std::uint32_t word = words[dice.below(std::size(words))];
    if (text.size() < 4) return;
    const std::size_t at = dice.below(text.size() - 3);
    for (std::size_t k = 0; k < 4; ++k) text[at + k] = char(word >> (8 * k));
}
// The same in text: the digits from somewhere on.
void set_number(std::string& text, Dice& dice) {
    static const char* const numbers[] = {"-1", "0", "4294967295", "99999999999", "1e39", "nan"};
    const std::size_t at = text.find_first_of("0123456789", dice.below(text.size()));
    if (at == std::string::npos) return flip_bits(text, dice);
    const std::size_t end = std::min(text.find_first_not_of("0123456789.", at), text.size());
    text.replace(at, end - at, numbers[dice.below(std::size(numbers))]);
}

std::string mutated(std::string text, std::uint64_t seed) {
    Dice dice(seed);
    void (*const all[])(std::string&, Dice&) = {flip_bits,   overwrite, cut_off,   remove_part,
                                                repeat_part, set_word,  set_number};
    for (std::size_t n = 1 + dice.below(3); n > 0 && !text.empty(); --n)
        all[dice.below(std::size(all))](text, dice);
    return text;
}

std::size_t resident_kilobytes() {
    std::ifstream statm("/proc/self/statm");
    std::size_t all = 0, resident = 0;
    statm >> all >> resident;
    return resident * 4;
}

std::size_t open_files() {
    return std::size_t(std::distance(fs::directory_iterator("/proc/self/fd"), {}));
}

std::vector<fs::path> seeds(const fs::path& shared) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::recursive_directory_iterator(shared / "real_files")) {
        const prep::FileFormat* const format = prep::file_format(entry.path());
        if (entry.is_regular_file() &&
            (entry.path().extension() == ".csm" || (format && format->name == "Assimp")))
            files.push_back(entry.path());
    }
    for (const auto& entry : fs::directory_iterator(test::source_dir() / "fuzz/corpus/om"))
        files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    return files;
}

TEST(ContainedMutations, TheCallerOutlivesThemAll) {
    MESHPREP_REQUIRE_SHARED(shared);
    const std::vector<fs::path> files = seeds(shared);
    ASSERT_GE(files.size(), 14u);
    std::vector<std::string> texts;
    for (const fs::path& file : files) texts.push_back(test::file_text(file));
    const std::size_t first = number_from("MESHPREP_MUTATIONS_FIRST", 0),
                      count = number_from("MESHPREP_MUTATIONS", test::sanitized ? 100 : 300);

    prep::ReaderProcessOptions limits;
    limits.seconds = 5;
    limits.memory = std::uint64_t(1) << 30;
    const test::TempDir dir;
    const fs::path start = fs::current_path();
    fs::current_path(dir.path());  // what a reader leaves behind, it leaves here
    const std::size_t open_before = open_files();
    std::map<std::string, std::size_t> outcomes;
    std::size_t resident = 0;
    {
        prep::LoadOptions options;
        options.reader_process = std::make_shared<prep::ReaderProcess>(limits);
        for (std::size_t i = first; i < first + count; ++i) {
            const std::size_t f = i % files.size();
            SCOPED_TRACE("mutation " + std::to_string(i) + " of " + files[f].filename().string());
            const fs::path path = dir / ("m" + files[f].extension().string());
            test::write_text(path, mutated(texts[f], i));
            const auto scene = prep::load_scene(path, options);
            if (scene) {
                ASSERT_EQ(test::broken_promise(*scene), "");
                ++outcomes["a scene"];
            } else {
                ASSERT_EQ(scene.error().place.rfind("m.", 0) == 0 ||
                              scene.error().place.find(path.string()) != std::string::npos,
                          true)
                    << scene.error().place;
                const std::string& text = scene.error().text;
                const std::size_t crash = text.find(" crashed on the file (");
                ++outcomes[crash != std::string::npos
                               ? text.substr(crash + 22, text.find(')', crash) - crash - 22)
                           : text.find(" by the clock") != std::string::npos  ? "time"
                           : text.find(" MiB of memory") != std::string::npos ? "memory"
                           : scene.error().code == prep::ErrorCode::io        ? "io"
                                                                              : "an error"];
            }
            ASSERT_EQ(dir.names(), std::vector<std::string>{path.filename().string()});
            fs::remove(path);
            if (i == first + std::min<std::size_t>(count / 4, 2000))
                resident = resident_kilobytes();
            if (count > 1000 && i % 1000 == 999) std::printf("%zu\n", i + 1), std::fflush(stdout);
        }
        std::printf("%zu mutations of %zu files, %zu processes:", count, files.size(),
                    options.reader_process->started());
        for (const auto& [what, times] : outcomes) std::printf(" %s %zu", what.c_str(), times);
        std::printf("\nresident %zu kB after the first quarter, %zu kB at the end\n", resident,
                    resident_kilobytes());
    }
    EXPECT_EQ(outcomes["io"], 0u);
    EXPECT_EQ(open_files(), open_before);
    EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1) << "a process is left";
    EXPECT_TRUE(dir.names().empty());
    // What one scene takes and gives back, not what thousands would.
    if (count >= 300) {
        EXPECT_LT(resident_kilobytes(), resident + (64 << 10));
    }
    fs::current_path(start);
}

// Numbers of a header, the first byte the highest or the lowest.
std::string high_first(std::uint32_t value, int bytes) {
    std::string text;
    for (int k = bytes - 1; k >= 0; --k) text += char(value >> (8 * k));
    return text;
}
std::string low_first(std::uint32_t value) {
    const std::string text = high_first(value, 4);
    return {text.rbegin(), text.rend()};
}

// 24 × 16 texels in formats whose decoders run in the reader's process: endings and bytes.
std::vector<std::pair<std::string, std::string>> small_pictures() {
    constexpr std::uint32_t width = 24, height = 16;
    std::string texels;
    for (std::uint32_t k = 0; k < width * height * 3; ++k) texels += char(k * k % 251);
    std::string sgi = high_first(474, 2) + high_first(1, 2) + high_first(3, 2) +
                      high_first(width, 2) + high_first(height, 2) + high_first(3, 2) +
                      high_first(0, 4) + high_first(255, 4);
    sgi.resize(512, '\0');
    std::string dds = "DDS " + low_first(124) + low_first(0x100f) + low_first(height) +
                      low_first(width) + low_first(width * 3);
    dds.resize(76, '\0');
    dds += low_first(32) + low_first(0x40) + low_first(0) + low_first(24) + low_first(0xff0000) +
           low_first(0xff00) + low_first(0xff) + low_first(0) + low_first(0x1000);
    dds.resize(128, '\0');
    const std::string psd = "8BPS" + high_first(1, 2) + std::string(6, '\0') + high_first(3, 2) +
                            high_first(height, 4) + high_first(width, 4) + high_first(8, 2) +
                            high_first(3, 2) + std::string(14, '\0');
    std::string fits;
    for (std::string card : {"SIMPLE  =                    T", "BITPIX  =                    8",
                             "NAXIS   =                    2", "NAXIS1  =                   24",
                             "NAXIS2  =                   16", "END"}) {
        card.resize(80, ' ');
        fits += card;
    }
    fits.resize(2880, ' ');
    std::string plane = texels.substr(0, width * height);
    plane.resize(2880, '\0');
    return {{".sgi", sgi + texels},
            {".dds", dds + texels},
            {".psd", psd + texels},
            {".fits", fits + plane}};
}

// A fifteenth as many, as a decoder that met an error makes way for a new process, which loads some
// 250 libraries: damaged, and decoded from a file or from memory.
TEST(ContainedMutations, PicturesEndNothing) {
    const test::TempDir dir;
    const auto pictures = small_pictures();
    const std::size_t first = number_from("MESHPREP_MUTATIONS_FIRST", 0) / 15,
                      count = std::max<std::size_t>(number_from("MESHPREP_MUTATIONS", 300) / 15, 1);
    prep::ReaderProcessOptions limits;
    limits.seconds = 5;
    limits.memory = std::uint64_t(1) << 30;
    const std::size_t open_before = open_files();
    std::map<std::string, std::size_t> outcomes;
    {
        prep::ImageOptions options;
        options.reader_process = std::make_shared<prep::ReaderProcess>(limits);
        for (const auto& [ending, whole] : pictures) {
            const auto decoded =
                prep::decode_image(std::as_bytes(std::span(whole)), "a" + ending, options);
            ASSERT_TRUE(decoded.has_value()) << prep::to_string(decoded.error());
            EXPECT_EQ(decoded->width, 24u) << ending;
            EXPECT_EQ(decoded->height, 16u) << ending;
        }
        for (std::size_t i = first; i < first + count; ++i) {
            const auto& [ending, whole] = pictures[i % pictures.size()];
            SCOPED_TRACE("mutation " + std::to_string(i) + ", " + ending);
            const std::string text = mutated(whole, i);
            const fs::path path = dir / ("m" + ending);
            test::write_text(path, text);
            const auto decoded =
                i / pictures.size() % 2 == 0
                    ? prep::load_image(path, options)
                    : prep::decode_image(std::as_bytes(std::span(text)), path.string(), options);
            fs::remove(path);
            if (decoded) {
                ASSERT_EQ(decoded->pixels.size(),
                          std::size_t(decoded->width) * decoded->height * decoded->channels);
                ++outcomes["a picture"];
                continue;
            }
            ASSERT_NE(decoded.error().place.find("m" + ending), std::string::npos)
                << prep::to_string(decoded.error());
            const std::string& why = decoded.error().text;
            const std::size_t crash = why.find(" crashed on the file (");
            ++outcomes[crash != std::string::npos
                           ? why.substr(crash + 22, why.find(')', crash) - crash - 22)
                           : "an error"];
        }
        std::printf("%zu mutations of %zu pictures, %zu processes:", count, pictures.size(),
                    options.reader_process->started());
        for (const auto& [what, times] : outcomes) std::printf(" %s %zu", what.c_str(), times);
        std::printf("\n");
    }
    EXPECT_GT(outcomes["a picture"], 0u);
    EXPECT_EQ(open_files(), open_before);
    EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1) << "a process is left";
    EXPECT_TRUE(dir.names().empty());
}

}  // namespace
