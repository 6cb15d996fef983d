// Makes the samples again: generate_samples DIR writes them under DIR; generate_samples --check DIR
// compares instead, byte for byte, and exits 1 where a file is missing or differs.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string_view>

#include "generator/sample_files.h"

namespace {

bool write(const std::filesystem::path& path, const std::string& bytes) {
    std::error_code ec;
    std::filesystem::create_directories(path.parent_path(), ec);
    std::ofstream file(path, std::ios::binary | std::ios::trunc);
    file.write(bytes.data(), std::streamsize(bytes.size()));
    file.close();
    if (!file) std::fprintf(stderr, "generate_samples: cannot write %s\n", path.c_str());
    return bool(file);
}

bool same(const std::filesystem::path& path, const std::string& bytes) {
    std::ifstream file(path, std::ios::binary);
    if (!file) {
        std::fprintf(stderr, "%s: missing\n", path.c_str());
        return false;
    }
    const std::string found{std::istreambuf_iterator<char>(file), {}};
    if (found == bytes) return true;
    std::size_t at = 0;
    while (at < found.size() && at < bytes.size() && found[at] == bytes[at]) ++at;
    std::fprintf(stderr, "%s: differs from byte %zu on (%zu bytes found, %zu made)\n", path.c_str(),
                 at, found.size(), bytes.size());
    return false;
}

}  // namespace

int main(int argc, char** argv) {
    const bool check = argc == 3 && std::string_view(argv[1]) == "--check";
    if (!check && (argc != 2 || argv[1][0] == '-')) {
        std::fprintf(stderr, "usage: generate_samples [--check] DIR\n");
        return 2;
    }
    const std::filesystem::path folder = argv[argc - 1];
    bool good = true;
    for (auto* make : {samples::machine_part, samples::octopus, samples::shield, samples::room})
        for (const samples::File& file : make()) {
            const std::filesystem::path path = folder / file.name;
            good = (check ? same(path, file.bytes) : write(path, file.bytes)) && good;
        }
    return good ? 0 : 1;
}
