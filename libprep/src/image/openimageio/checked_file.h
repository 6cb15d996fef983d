// A file under a picture's writer. Several of OpenImageIO's writers (2.4: BMP, TGA, WebP) do
// not look whether their bytes arrive, and JPEG's ends the process when they do not; this one
// remembers.
#pragma once

#include <OpenImageIO/filesystem.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <string>
#include <utility>

namespace prep::detail {

class CheckedFile final : public OIIO::Filesystem::IOProxy {
  public:
    explicit CheckedFile(const std::string& path)
        : IOProxy(path, Write), file_(std::fopen(path.c_str(), "wb")) {
        if (!file_) fail();
    }
    ~CheckedFile() override {
        if (file_) std::fclose(file_);
    }
    CheckedFile(const CheckedFile&) = delete;
    CheckedFile& operator=(const CheckedFile&) = delete;

    // Not "file": writers cast what calls itself so to OpenImageIO's own class.
    const char* proxytype() const override { return "checked"; }
    bool seek(std::int64_t offset) override {
        m_pos = offset;
        if (file_ && ::fseeko(file_, offset, SEEK_SET) == 0) return true;
        fail();
        return false;
    }
    std::size_t write(const void* bytes, std::size_t count) override {
        if (!file_ || count == 0) return 0;
        const std::size_t done = std::fwrite(bytes, 1, count, file_);
        if (done != count) fail();
        m_pos += std::int64_t(done);
        size_ = std::max(size_, std::size_t(m_pos));
        return done;
    }
    std::size_t pwrite(const void* bytes, std::size_t count, std::int64_t offset) override {
        const std::int64_t back = m_pos;
        const std::size_t done = seek(offset) ? write(bytes, count) : 0;
        return seek(back) ? done : 0;
    }
    std::size_t size() const override { return size_; }

    // After the writer is done with it. What went wrong first; empty where nothing did.
    std::string finish() {
        if (file_ && std::fclose(std::exchange(file_, nullptr)) != 0) fail();
        return problem_;
    }

  private:
    void fail() {
        if (problem_.empty()) problem_ = std::strerror(errno);
    }

    std::FILE* file_;
    std::size_t size_ = 0;
    std::string problem_;
};

}  // namespace prep::detail
