// Where the text of an OBJ file comes from: memory, or a file read piece by piece, so that its
// bytes are touched by the thread that parses them and are never in memory as a whole.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string_view>
#include <vector>

#include "prep/result.h"

namespace prep::detail {

class ObjSource {
  public:
    virtual ~ObjSource() = default;
    virtual std::size_t size() const = 0;
    // Copies the bytes [begin, end). Thread-safe. False when they cannot be read (any more).
    virtual bool read(std::size_t begin, std::size_t end, char* to) const = 0;
};

class ObjMemory final : public ObjSource {
  public:
    explicit ObjMemory(std::string_view text) : text_(text) {}
    std::size_t size() const override { return text_.size(); }
    bool read(std::size_t begin, std::size_t end, char* to) const override;

  private:
    std::string_view text_;
};

// Not mapped into memory: a file that is cut while it is read would end the process.
class ObjFile final : public ObjSource {
  public:
    ObjFile() = default;
    ~ObjFile() override;
    ObjFile(const ObjFile&) = delete;
    ObjFile& operator=(const ObjFile&) = delete;
    // Errors: io. A pipe or device, whose size is not known, is read whole here.
    Result<void> open(const std::filesystem::path& path);
    std::size_t size() const override { return size_; }
    bool read(std::size_t begin, std::size_t end, char* to) const override;

  private:
    int file_ = -1;
    std::size_t size_ = 0;
    std::vector<std::byte> whole_;
};

}  // namespace prep::detail
