#include "object_tree/bvh.h"

#include <algorithm>

#include "exec/scan.h"
#include "object_tree/bvh_build_body.h"

namespace raysheaf {
namespace {

/// Adds what another task has counted.
void add(const BvhBins& other, BvhBins* bins) {
  for (std::uint32_t b = 0; b < kBvhBins; ++b) {
    include(&bins->box[b], other.box[b].min, other.box[b].max);
    bins->count[b] += other.count[b];
  }
}

class Builder {
 public:
  Builder(const Executor& executor, const TriangleView& triangles)
      : executor_(executor), items_(triangles.count), moved_(triangles.count) {
    executor_.for_each(items_.size(), kCopyGrain, [&](std::size_t i) {
      const auto corner = [&](int k) { return triangles.corner(i, k); };
      items_[i] = bvh_item(static_cast<std::uint32_t>(i), corner(0), corner(1), corner(2));
    });
  }

  Bvh build() {
    Bvh bvh;
    if (items_.empty()) return bvh;
    bvh.level_starts = {0};
    std::vector<BvhRun> level{measured(0, static_cast<std::uint32_t>(items_.size()))};
    while (!level.empty()) level = build_level(level, &bvh);
    bvh.triangles.resize(items_.size());
    executor_.for_each(items_.size(), kCopyGrain,
                       [&](std::size_t i) { bvh.triangles[i] = items_[i].id; });
    return bvh;
  }

 private:
  /// Builds one node per run; returns their children that are not leaves, as the runs of the next
  /// level.
  std::vector<BvhRun> build_level(const std::vector<BvhRun>& level, Bvh* bvh) {
    const std::uint32_t first = bvh->level_starts.back();
    bvh->nodes.resize(first + level.size());
    bvh->level_starts.push_back(static_cast<std::uint32_t>(bvh->nodes.size()));
    std::vector<BvhOpening> openings(level.size());
    std::vector<std::uint32_t> places(level.size());
    executor_.for_each(level.size(), 1, [&](std::size_t i) {
      open(level[i], &openings[i]);
      places[i] = openings[i].nodes();
    });
    std::vector<BvhRun> next(exclusive_scan(executor_, places, places));
    executor_.for_each(level.size(), 1, [&](std::size_t i) {
      BvhNode* node = &bvh->nodes[first + i];
      node->children = openings[i].children;
      std::uint32_t place = places[i];
      for (std::uint32_t c = 0; c < node->children; ++c) {
        const BvhRun& run = openings[i].child[c];
        const bool leaf = run.is_leaf();
        write_child(run, leaf ? run.first : bvh->level_starts.back() + place, c, node);
        if (!leaf) next[place++] = run;
      }
    });
    for (std::uint32_t n = first; n < bvh->nodes.size(); ++n)
      for (const std::uint8_t count : bvh->nodes[n].count) bvh->leaf_count += count != 0 ? 1 : 0;
    return next;
  }

  /// Splits a run into up to kBvhWidth.
  void open(const BvhRun& whole, BvhOpening* opening) {
    opening->child[0] = whole;
    for (std::uint32_t c = opening->widest(); c != kInvalidId; c = opening->widest()) {
      const BvhRun run = opening->child[c];
      const std::uint32_t left = split(run);
      opening->child[opening->children++] = measured(run.first + left, run.count - left);
      opening->child[c] = measured(run.first, left);
    }
  }

  /// Moves the items of the left part to the front; returns how many, never none or all.
  std::uint32_t split(const BvhRun& run) {
    const BvhBinning binning(run.centers);
    const std::uint32_t cut = cheapest_cut(fill_bins(run, binning));
    if (cut == 0) return run.count / 2;
    const BvhItem* from = items_.data() + run.first;
    BvhItem* to = moved_.data() + run.first;
    const auto is_right = [&](std::size_t i) { return binning.bin_of(from[i]) >= cut; };
    const FlagCounts counts = count_flags(executor_, run.count, is_right);
    const std::uint32_t left = run.count - counts.total;
    for_each_scanned(executor_, counts, run.count, is_right,
                     [&](std::size_t i, bool right, std::uint32_t s) {
                       to[right ? left + s - 1 : i - s] = from[i];
                     });
    for_each_block(run.first, run.count, [&](std::size_t begin, std::size_t end, std::size_t) {
      std::copy(moved_.begin() + static_cast<std::ptrdiff_t>(begin),
                moved_.begin() + static_cast<std::ptrdiff_t>(end),
                items_.begin() + static_cast<std::ptrdiff_t>(begin));
    });
    return left;
  }

  BvhBins fill_bins(const BvhRun& run, const BvhBinning& binning) {
    std::vector<BvhBins> parts(div_ceil(run.count, kScanBlock));
    for_each_block(run.first, run.count, [&](std::size_t begin, std::size_t end, std::size_t b) {
      for (std::size_t i = begin; i < end; ++i) {
        const std::uint32_t n = binning.bin_of(items_[i]);
        include(&parts[b].box[n], items_[i].min, items_[i].max);
        ++parts[b].count[n];
      }
    });
    for (std::size_t b = 1; b < parts.size(); ++b) add(parts[b], &parts[0]);
    return parts[0];
  }

  /// The run with its boxes.
  BvhRun measured(std::uint32_t first, std::uint32_t count) {
    std::vector<BvhRun> parts(div_ceil(count, kScanBlock));
    for_each_block(first, count, [&](std::size_t begin, std::size_t end, std::size_t b) {
      for (std::size_t i = begin; i < end; ++i) {
        include(&parts[b].box, items_[i].min, items_[i].max);
        include(&parts[b].centers, items_[i].center(), items_[i].center());
      }
    });
    for (std::size_t b = 1; b < parts.size(); ++b) {
      include(&parts[0].box, parts[b].box.min, parts[b].box.max);
      include(&parts[0].centers, parts[b].centers.min, parts[b].centers.max);
    }
    parts[0].first = first;
    parts[0].count = count;
    return parts[0];
  }

  /// Calls `body(begin, end, block)` for the blocks of a run, whose borders do not depend on the
  /// number of threads.
  template <class Body>
  void for_each_block(std::uint32_t first, std::uint32_t count, const Body& body) {
    executor_.for_each(div_ceil(count, kScanBlock), 1, [&](std::size_t block) {
      const std::size_t begin = block * kScanBlock;
      body(first + begin, first + std::min<std::size_t>(begin + kScanBlock, count), block);
    });
  }

  const Executor& executor_;
  std::vector<BvhItem> items_, moved_;
};

}  // namespace

Bvh build_bvh(const Executor& executor, const TriangleView& triangles) {
  return Builder(executor, triangles).build();
}

}  // namespace raysheaf
