// Text of many like lines, formatted in blocks on all threads; the blocks go to the file one after
// the other without being joined in memory.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/parallel.h"

namespace prep::detail {

class TextBlocks {
  public:
    explicit TextBlocks(int threads) : threads_(threads) {}  // 0: all cores

    // What is added here comes in order with the lines.
    std::string& text() { return open_; }

    // line(to, i) writes at `to` and returns the end; `room(begin, end)` is the most characters
    // that the lines [begin, end) can take.
    template <class Room, class Line>
    void lines(std::size_t count, const Room& room, const Line& line) {
        constexpr std::size_t grain = 16384;
        close();
        const std::size_t first = blocks_.size();
        blocks_.resize(first + (count + grain - 1) / grain);
        parallel_blocks(count, grain, threads_, [&](std::size_t begin, std::size_t end) {
            Block& block = blocks_[first + begin / grain];
            block.text.reset(new char[room(begin, end)]);  // not set to zero: most stays untouched
            char* to = block.text.get();
            for (std::size_t i = begin; i < end; ++i) to = line(to, i);
            block.size = std::size_t(to - block.text.get());
        });
    }
    template <class Line>
    void short_lines(std::size_t count, std::size_t longest, const Line& line) {
        lines(
            count, [&](std::size_t begin, std::size_t end) { return (end - begin) * longest; },
            line);
    }

    // Valid until the next change.
    std::vector<std::span<const std::byte>> parts() {
        close();
        std::vector<std::span<const std::byte>> parts;
        for (const Block& block : blocks_)
            parts.push_back(std::as_bytes(std::span(block.text.get(), block.size)));
        return parts;
    }

  private:
    const int threads_;
    struct Block {
        std::unique_ptr<char[]> text;
        std::size_t size = 0;
    };

    void close() {
        if (open_.empty()) return;
        Block block;
        block.size = open_.size();
        block.text.reset(new char[block.size]);
        open_.copy(block.text.get(), block.size);
        blocks_.push_back(std::move(block));
        open_.clear();
    }

    std::string open_;
    std::vector<Block> blocks_;
};

}  // namespace prep::detail
