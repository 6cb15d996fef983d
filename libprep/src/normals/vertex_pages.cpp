#include "normals/vertex_pages.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <utility>

#include "base/parallel.h"
#include "normals/vertex_sums.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;
using Extent = PageUse::Extent;

// A block that spans more pages than that is looked at vertex by vertex; and so is each where a
// range comes to more than twice the pages that neighbours in order need.
constexpr Index most_pages_spanned = 256;
constexpr std::size_t enough_pages = 1024;
// Among so many runs of pages before it a vertex' own is looked for.
constexpr std::size_t looked_back = 8;
// More runs of pages than one for so many triangles: scattered.
constexpr std::size_t triangles_of_run = 4;

Extent extent_of(std::span<const Index> vertices) {
    Index first = std::numeric_limits<Index>::max(), last = 0;
    for (const Index v : vertices) {
        first = std::min(first, v);
        last = std::max(last, v);
    }
    return {first, last};
}

// Runs of pages that a range uses; they may overlap.
class Runs {
  public:
    void add(const Extent& pages) {
        const std::size_t first = runs_.size() - std::min(runs_.size(), looked_back);
        for (std::size_t i = runs_.size(); i-- > first;) {
            Extent& run = runs_[i];
            if (pages.first < run.first || pages.first > run.last + 1) continue;
            run.last = std::max(run.last, pages.last);
            return;
        }
        runs_.push_back(pages);
    }
    std::size_t size() const { return runs_.size(); }

    // Each page once.
    std::vector<Index> pages() {
        std::sort(runs_.begin(), runs_.end(),
                  [](const Extent& a, const Extent& b) { return a.first < b.first; });
        std::vector<Index> result;
        std::size_t next = 0;
        for (const Extent& run : runs_) {
            for (std::size_t page = std::max<std::size_t>(next, run.first); page <= run.last;
                 ++page)
                result.push_back(Index(page));
            next = std::max<std::size_t>(next, std::size_t(run.last) + 1);
        }
        return result;
    }

  private:
    std::vector<Extent> runs_;
};

// The pages of a range of triangles, ascending; empty where they are too many. A block that spans
// more than `spanned` pages is looked at vertex by vertex.
std::vector<Index> pages_of(std::span<const Index> vertices, std::span<const Extent> blocks,
                            Index spanned) {
    Runs runs;
    for (std::size_t b = 0; b < blocks.size(); ++b) {
        const Extent pages = {Index(blocks[b].first / page_vertices),
                              Index(blocks[b].last / page_vertices)};
        if (pages.last - pages.first <= spanned) {
            runs.add(pages);
        } else {
            const std::size_t first = 3 * block_triangles * b;
            const std::size_t size = std::min(3 * block_triangles, vertices.size() - first);
            for (const Index v : vertices.subspan(first, size))
                runs.add({Index(v / page_vertices), Index(v / page_vertices)});
        }
        if (runs.size() > range_triangles / triangles_of_run) return {};
    }
    return runs.pages();
}

// Writes the owners; how many pages are kept by ranges that share them.
std::size_t find_owners(PageUse& use, std::size_t count) {
    use.owners.assign((count + page_vertices - 1) / page_vertices, PageUse::unused);
    for (std::size_t r = 0; r < use.ranges.size(); ++r)
        for (const Index page : use.ranges[r])
            use.owners[page] = use.owners[page] == PageUse::unused ? Index(r) : PageUse::shared;
    std::size_t copies = 0;
    for (const std::vector<Index>& pages : use.ranges)
        for (const Index page : pages) copies += use.owners[page] == PageUse::shared;
    return copies;
}

}  // namespace

PageUse find_page_use(std::span<const Index> vertices, std::size_t count, int threads) {
    const std::size_t triangles = vertices.size() / 3;
    PageUse use;
    use.blocks.resize((triangles + block_triangles - 1) / block_triangles);
    use.ranges.resize((triangles + range_triangles - 1) / range_triangles);
    std::atomic<bool> scattered = false;
    parallel_blocks(triangles, range_triangles, threads, [&](std::size_t begin, std::size_t end) {
        const auto range = vertices.subspan(3 * begin, 3 * (end - begin));
        const auto blocks = std::span(use.blocks)
                                .subspan(begin / block_triangles,
                                         (end - begin + block_triangles - 1) / block_triangles);
        for (std::size_t b = 0; b < blocks.size(); ++b) {
            const std::size_t first = 3 * block_triangles * b;
            blocks[b] = extent_of(
                range.subspan(first, std::min(3 * block_triangles, range.size() - first)));
        }
        if (scattered) return;
        std::vector<Index> pages = pages_of(range, blocks, most_pages_spanned);
        if (pages.size() > enough_pages) pages = pages_of(range, blocks, 0);
        if (pages.empty() || pages.size() > most_pages_of_range)
            scattered = true;
        else
            use.ranges[begin / range_triangles] = std::move(pages);
    });
    for (const Extent& block : use.blocks) use.last_vertex = std::max(use.last_vertex, block.last);
    use.scattered = scattered;
    if (scattered || use.last_vertex >= count) return use;
    use.scattered = find_owners(use, count) * page_vertices > most_copied_vertices(vertices.size());
    return use;
}

}  // namespace prep::detail
