#include <algorithm>
#include <bit>

#include "base/bits.h"
#include "object_tree/curve_order.h"
#include "object_tree/object_tree.h"
#include "object_tree/tree_emission.h"
#include "object_tree/tree_kernels.h"
#include "object_tree/tree_scratch.h"

namespace raysheaf {
namespace {

/// For a run of the curve: more leaves than a node has children.
constexpr std::uint32_t kClosed = kBvhWidth + 1;

/// Up to this many triangles become two leaves, regardless of their cells: this fills quads better,
/// at a cost in surface that increases with the number (docs/object.md).
constexpr std::uint32_t kTwoLeaves = 6;

/// Up to this many items of one cell are cut in the order of the source.
constexpr std::uint32_t kFewOfCell = 8;

/// Cuts a sorted run into leaves, and its leaves into clusters, at the highest bit in which keys
/// differ: the cells of an octree, cut along one axis after the other.
class CurveCutter {
 public:
  CurveCutter(const TriangleSource& source, const CurveItems& items, std::uint32_t leaf_triangles,
              const CurveTask& task, const TreeScratch& scratch)
      : source_(source),
        items_(items),
        scratch_(scratch),
        sorted_(scratch.sorted.data() + task.first),
        spare_(scratch.keys.data() + task.first),
        leaf_triangles_(leaf_triangles),
        leaf_(scratch.leaf_sizes.data() + task.first),
        cluster_(scratch.cluster_sizes.data() + task.first) {}

  void cut(CurveTask* task) {
    sort_run(sorted_, spare_, task->count, items_.id_bits);
    std::uint8_t *const leaves = leaf_, *const clusters = cluster_;
    close(cut(0, task->count));
    task->leaf_count = static_cast<std::uint32_t>(leaf_ - leaves);
    task->quad_count = quads_;
    task->cluster_count = static_cast<std::uint32_t>(cluster_ - clusters);
  }

 private:
  /// The number of leaves, or kClosed if they already are in clusters.
  std::uint32_t cut(std::uint32_t begin, std::uint32_t end) {
    if (const std::uint32_t triangles = triangles_of_leaf(begin, end); triangles != 0) {
      *leaf_++ = static_cast<std::uint8_t>(end - begin);
      quads_ += div_ceil(triangles, kQuadTriangles);
      return 1;
    }
    std::uint32_t middle = place_of_cut(begin, end);
    if (items_.joining == Joining::kNone && leaf_triangles_ == kQuadTriangles &&
        end - begin <= kTwoLeaves)
      middle = std::clamp(middle, end - kQuadTriangles, begin + kQuadTriangles);
    const std::uint32_t left = cut(begin, middle);
    // The left part is closed before anything on the right, so that clusters stay in order.
    std::uint8_t* const after_left = cluster_;
    const std::uint32_t right = cut(middle, end);
    if (left + right <= kBvhWidth) return left + right;
    if (left <= kBvhWidth) {
      std::move_backward(after_left, cluster_, cluster_ + 1);
      *after_left = static_cast<std::uint8_t>(left);
      ++cluster_;
    }
    close(right);
    return kClosed;
  }

  /// The number of triangles of these items, or 0 if they do not fit into a leaf; 1 for a leaf that
  /// is joined already.
  [[nodiscard]] std::uint32_t triangles_of_leaf(std::uint32_t begin, std::uint32_t end) const {
    if (items_.joining == Joining::kLeaves) return end - begin == 1 ? 1 : 0;
    if (end - begin > leaf_triangles_) return 0;
    if (items_.joining == Joining::kNone) return end - begin;
    std::uint32_t triangles = end - begin;
    for (std::uint32_t i = begin; i < end; ++i)
      triangles += static_cast<std::uint32_t>(sorted_[i] % (1u << kStripBits));
    return triangles <= leaf_triangles_ ? triangles : 0;
  }

  void close(std::uint32_t leaves) {
    if (leaves <= kBvhWidth) *cluster_++ = static_cast<std::uint8_t>(leaves);
  }

  [[nodiscard]] std::uint64_t differing_keys(std::uint32_t begin, std::uint32_t end) const {
    return (sorted_[begin] ^ sorted_[end - 1]) >> items_.id_bits;
  }
  /// Items of one cell are sorted into finer cells, unless they are few.
  void refine(std::uint32_t begin, std::uint32_t end) {
    if (end - begin <= kFewOfCell || end <= alike_) return;
    std::uint64_t* const items = sorted_ + begin;
    if (refine_keys(Executor::serial(), source_, items_, scratch_, items, end - begin)) {
      sort_run(items, spare_ + begin, end - begin, items_.id_bits);
    } else {
      alike_ = end;
    }
  }

  [[nodiscard]] std::uint32_t place_of_cut(std::uint32_t begin, std::uint32_t end) {
    if (differing_keys(begin, end) == 0) refine(begin, end);
    const std::uint64_t differing = differing_keys(begin, end);
    if (differing == 0) return begin + (end - begin) / 2;
    const auto bit = static_cast<std::uint32_t>(std::bit_width(differing)) - 1 + items_.id_bits;
    std::uint32_t length = end - begin, last_clear = begin;
    while (length > 1) {
      const std::uint32_t half = length / 2;
      last_clear += (sorted_[last_clear + half] >> bit & 1) == 0 ? half : 0;
      length -= half;
    }
    return last_clear + 1;
  }

  const TriangleSource& source_;
  const CurveItems& items_;
  const TreeScratch& scratch_;
  std::uint64_t *sorted_, *spare_;
  std::uint32_t alike_ = 0;  ///< the end of the last items whose centres are equal
  std::uint32_t leaf_triangles_, quads_ = 0;
  std::uint8_t *leaf_, *cluster_;
};

void sort_and_cut(const Executor& executor, const TriangleSource& source, const CurveItems& curve,
                  std::uint32_t leaf_triangles, TreeScratch* scratch) {
  executor.for_each(scratch->tasks.size(), 1, [&](std::size_t t) {
    CurveTask& task = scratch->tasks[t];
    CurveCutter(source, curve, leaf_triangles, task, *scratch).cut(&task);
  });
}

/// Writes the leaves' quads and boxes, and the clusters' boxes.
void write_quads(const Executor& executor, const TriangleSource& source, CurveItems curve,
                 TreeScratch* scratch, ObjectTree* tree) {
  const TriangleRecord* records = scratch->records.size() != 0 ? scratch->records.data() : nullptr;
  executor.for_each(scratch->tasks.size(), 1, [&](std::size_t t) {
    const CurveTask& task = scratch->tasks[t];
    AreaItem* leaf = scratch->leaves.data() + task.first_leaf;
    const LeafItems leaves{scratch->sorted.data() + task.first, curve.id_bits,
                           scratch->leaf_sizes.data() + task.first, task.leaf_count};
    TriangleQuad* const quads = tree->quads.data();
    if (curve.joining == Joining::kLeaves) {
      for (std::uint32_t i = 0; i < task.leaf_count; ++i)
        leaf[i] = scratch->source_leaves[leaves.item(i)];
    } else if (curve.joining == Joining::kStrips) {
      write_leaves_of_strips(source, leaves, task.first_quad, quads, leaf);
    } else {
      write_leaves(source, records, leaves, task.first_quad, quads, leaf);
    }
    for (std::uint32_t c = 0; c < task.cluster_count; ++c) {
      const std::uint32_t size = scratch->cluster_sizes[task.first + c];
      AreaItem cluster = *leaf;
      for (std::uint32_t i = 1; i < size; ++i) {
        cluster.min = min(cluster.min, leaf[i].min);
        cluster.max = max(cluster.max, leaf[i].max);
      }
      cluster.ref = static_cast<std::uint32_t>(leaf - scratch->leaves.data());
      cluster.weight = size;
      scratch->clusters[task.first_cluster + c] = cluster;
      leaf += size;
    }
  });
}

}  // namespace

void build_object_tree(const Executor& executor, const TriangleSource& source, ObjectTree* tree,
                       const TreeOptions& options) {
  TreeScratch& scratch = tree->scratch;
  const Joining joining = source.count == 0 ? Joining::kNone
                          : options.joining ? *options.joining
                                            : joining_of(source);
  const CurveItems curve = bucket_along_curve(executor, source, joining, options, tree);
  tree->triangles = source.count - static_cast<std::uint32_t>(tree->left_out.size());
  scratch.leaf_sizes.resize_uninitialized(scratch.sorted.size());
  scratch.cluster_sizes.resize_uninitialized(scratch.sorted.size());
  sort_and_cut(executor, source, curve, options.leaf_triangles, &scratch);
  std::uint32_t leaves = 0, quads = 0, clusters = 0;
  for (CurveTask& task : scratch.tasks) {
    task.first_leaf = leaves;
    task.first_quad = quads;
    task.first_cluster = clusters;
    leaves += task.leaf_count;
    quads += task.quad_count;
    clusters += task.cluster_count;
  }
  if (curve.joining != Joining::kLeaves) tree->quads.resize_uninitialized(quads);
  scratch.leaves.resize_uninitialized(leaves);
  scratch.clusters.resize_uninitialized(clusters);
  write_quads(executor, source, curve, &scratch, tree);
  build_area_tree(executor, {scratch.clusters.data(), clusters}, {}, &scratch.upper);
  emit_nodes(executor, scratch.upper, {scratch.clusters.data(), clusters},
             {scratch.leaves.data(), leaves}, tree);
  // Makes points of triangles without area.
  if (options.keep_flat && !options.keep_corners)
    static_cast<void>(refit_object_tree(executor, source, MovedTriangles::everything(), tree));
}

}  // namespace raysheaf
