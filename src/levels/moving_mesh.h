// A mesh whose vertices move: its tree at later times, with the same nodes and leaves.
//
//   time     0       1/4      1/2      3/4      1
//   boxes   tree     [.]      [.]      [.]     [.]     at steps, more than times where it pays
//   quads   tree              [.]              [.]     at the times of the positions
//
// A ray meets boxes and corners that are mixed for its time, in binary32. With u = 2^-24 and h the
// largest coordinate of all times, a corner of scene/motion.h is within 1.01 u h of the straight
// line between its positions. A number that is mixed in binary32, by weights that are rounded, is
// wrong by 3.01 u h. So mixed corners differ from those by 4.02 u h; mixed boxes hold them if they
// grow by 3.01 u h for the boxes at steps, 3.01 u h for mixing these, and 1.01 u h for corners. The
// bound that is used, `error`, is 8 u h + 2^-140.
#pragma once

#include <algorithm>
#include <vector>

#include "exec/executor.h"
#include "object_tree/object_tree.h"
#include "object_tree/triangle_reader.h"
#include "scene/motion.h"
#include "scene/placed_runs.h"

namespace raysheaf {

/// Two arrays, and how much of each is in what lies between.
template <class T>
struct Mix {
  const T *before = nullptr, *after = nullptr;  ///< the same: nothing is mixed
  Float4 of_before = all4(1), of_after = all4(0);

  Mix() = default;
  explicit Mix(const T* only) : before(only), after(only) {}
  Mix(const T* first, const T* second, double part)
      : before(first),
        after(second),
        of_before(all4(static_cast<float>(1 - part))),
        of_after(all4(static_cast<float>(part))) {}

  /// Four numbers of an element. The weights are not 0, so that what is infinite stays so.
  [[nodiscard]] Float4 four(const float* a, const float* b) const {
    return of_before * load4(a) + of_after * load4(b);
  }
  /// An element, in place or in `room`.
  [[nodiscard]] const T& at(std::size_t number, T* room) const {
    if (before == after) return before[number];
    fill(before[number], after[number], room);
    return *room;
  }

 private:
  void fill(const BvhNode& a, const BvhNode& b, BvhNode* room) const {
    for (int row = 0; row < 6; ++row)
      for (std::size_t g = 0; g < kBvhWidth; g += 4)
        store4(four(a.bound[row] + g, b.bound[row] + g), room->bound[row] + g);
    std::copy_n(a.first, kBvhWidth, room->first);
    std::copy_n(a.count, kBvhWidth, room->count);
    room->children = a.children;
  }
  void fill(const TriangleQuad& a, const TriangleQuad& b, TriangleQuad* room) const {
    for (int k = 0; k < 3; ++k)
      for (int axis = 0; axis < 3; ++axis)
        store4(four(a.vertex[k][axis], b.vertex[k][axis]), room->vertex[k][axis]);
    QuadExtents(*room).store_reach(room);
  }
};

/// A mesh at a time. Mixed quads have no numbers of triangles.
struct MeshInstant {
  Mix<BvhNode> nodes;
  Mix<TriangleQuad> quads;
  Instant instant{0, 1};  ///< between the times of the quads
  float error = 0;        ///< by which boxes and corners that are mixed may be wrong
};

class MovingMesh {
 public:
  /// The mesh of an instance with times; `tree` is that of the first, and must outlive it. Its
  /// bounds become those of all times. O(triangles) for each step.
  MovingMesh(const Executor& executor, const PlacedInstance& instance, ObjectTree* tree);

  [[nodiscard]] MeshInstant at(float time) const;
  /// By which what is mixed may be wrong.
  [[nodiscard]] float error() const { return error_; }
  /// Calls `body(nodes)` for nodes from one time to another, which is not earlier. Boxes that hold
  /// those of two that follow each other, and grow by `error`, hold the mesh in between.
  template <class Body>
  void for_each_step(float begin, float end, const Body& body) const {
    const auto steps = static_cast<double>(nodes_.size());
    body(at(begin).nodes);
    for (auto k = static_cast<std::size_t>(begin * steps) + 1; static_cast<double>(k) < end * steps;
         ++k)
      body(Mix<BvhNode>(nodes_of(k)));
    body(at(end).nodes);
  }
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  [[nodiscard]] const BvhNode* nodes_of(std::size_t step) const {
    return step == 0 ? tree_.nodes.data() : nodes_[step - 1].data();
  }
  [[nodiscard]] const TriangleQuad* quads_of(std::size_t time) const {
    return time == 0 ? tree_.quads.data() : quads_[time - 1].data();
  }
  [[nodiscard]] Mix<TriangleQuad> quads_at(double time) const;
  [[nodiscard]] bool is_loose() const;
  void halve(const Executor& executor);

  const ObjectTree& tree_;
  std::vector<Buffer<TriangleQuad>> quads_;  ///< at the times after the first
  std::vector<Buffer<BvhNode>> nodes_;       ///< at the steps after the first
  float error_ = 0;
};

}  // namespace raysheaf
