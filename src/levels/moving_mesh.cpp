#include "levels/moving_mesh.h"

#include <algorithm>
#include <utility>

#include "base/bits.h"
#include "levels/refit_boxes.h"

namespace raysheaf {
namespace {

/// A step is halved where its mixed boxes are larger, by this factor, than they need to be.
constexpr double kLoose = 1.25;
/// Steps between two times.
constexpr std::size_t kMostSteps = 16;
/// Nodes whose leaves are looked at for that.
constexpr std::size_t kSample = 256;

void read_quads(const Executor& executor, const TriangleRun& mesh, const ObjectTree& tree,
                Buffer<TriangleQuad>* to) {
  const TriangleSource source{{&mesh, 1}, mesh.count};
  to->resize_uninitialized(tree.quads.size());
  executor.for_each_block(to->size(), kWorkGrain, [&](std::size_t begin, std::size_t end) {
    TriangleReader reader(source);
    for (std::size_t q = begin; q < end; ++q) {
      TriangleQuad& quad = (*to)[q];
      LoadedTriangle lanes[kQuadTriangles];
      for (std::uint32_t i = 0; i < kQuadTriangles; ++i) {
        quad.id[i] = tree.quads[q].id[i];
        lanes[i] = load_corners(reader.corners(quad.id[i]));
      }
      store_quad(lanes, &quad);
    }
  });
}

/// The box of a leaf.
Box leaf_box(const Mix<TriangleQuad>& quads, const BvhNode& node, std::uint32_t child) {
  const std::uint32_t first = node.first[child];
  const std::uint32_t end = first + div_ceil(std::uint32_t{node.count[child]}, kQuadTriangles);
  Float4 low[3], high[3];
  for (std::uint32_t q = first; q < end; ++q) {
    TriangleQuad room;
    const TriangleQuad& quad = quads.at(q, &room);
    for (int axis = 0; axis < 3; ++axis)
      for (int k = 0; k < 3; ++k) {
        const Float4 corner = load4(quad.vertex[k][axis]);
        const bool is_first = q == first && k == 0;
        low[axis] = is_first ? corner : min(low[axis], corner);
        high[axis] = is_first ? corner : max(high[axis], corner);
      }
  }
  float least[3], most[3];
  for (int axis = 0; axis < 3; ++axis) {
    float lanes[4];
    store4(low[axis], lanes);
    least[axis] = *std::min_element(lanes, lanes + 4);
    store4(high[axis], lanes);
    most[axis] = *std::max_element(lanes, lanes + 4);
  }
  return {{least[0], least[1], least[2]}, {most[0], most[1], most[2]}};
}

}  // namespace

MovingMesh::MovingMesh(const Executor& executor, const PlacedInstance& instance, ObjectTree* tree)
    : tree_(*tree), quads_(instance.times.size - 1) {
  for (std::size_t k = 0; k < quads_.size(); ++k)
    read_quads(executor, instance.mesh(k + 1), tree_, &quads_[k]);
  halve(executor);
  for (const Buffer<BvhNode>& nodes : nodes_) {
    Box box;
    node_box(nodes[0], &box);
    tree->bounds = {min(tree->bounds.min, box.min), max(tree->bounds.max, box.max)};
  }
  const Vec3 most = max(abs(tree->bounds.min), abs(tree->bounds.max));
  error_ = rounded_up(8 * double{kUnitRoundoff} * max_component(most) + 0x1p-140);
  for (std::size_t steps = 1; steps < kMostSteps && is_loose(); steps *= 2) halve(executor);
}

Mix<TriangleQuad> MovingMesh::quads_at(double time) const {
  const auto before = static_cast<std::size_t>(time);
  const double part = time - static_cast<double>(before);
  return {quads_of(before), quads_of(before + (part == 0 ? 0 : 1)), part};
}

MeshInstant MovingMesh::at(float time) const {
  MeshInstant at;
  at.instant = Instant(time, quads_.size() + 1);
  at.error = error_;
  at.quads = {quads_of(at.instant.before), quads_of(at.instant.after), at.instant.part};
  const std::size_t steps = nodes_.size() / quads_.size();
  const Instant within(at.instant.part, steps + 1);
  const std::size_t first = at.instant.before * steps;
  at.nodes = {nodes_of(first + within.before), nodes_of(first + within.after), within.part};
  return at;
}

/// Whether mixed boxes are much larger than need be.
bool MovingMesh::is_loose() const {
  const std::size_t stride = tree_.nodes.size() / kSample + 1;
  const double per_time = static_cast<double>(quads_.size()) / static_cast<double>(nodes_.size());
  for (std::size_t step = 0; step < nodes_.size(); ++step) {
    const Mix<BvhNode> nodes(nodes_of(step), nodes_of(step + 1), 0.5);
    const Mix<TriangleQuad> quads = quads_at((static_cast<double>(step) + 0.5) * per_time);
    double mixed = 0, tight = 0;
    for (std::size_t n = 0; n < tree_.nodes.size(); n += stride) {
      BvhNode room;
      const BvhNode& node = nodes.at(n, &room);
      for (std::uint32_t c = 0; c < node.children; ++c) {
        if (!node.is_leaf(c)) continue;
        mixed += half_area(node.box(c));
        tight += half_area(leaf_box(quads, node, c));
      }
    }
    if (mixed > kLoose * tight) return true;
  }
  return false;
}

/// Doubles the steps; without any, there is one to each time.
void MovingMesh::halve(const Executor& executor) {
  std::vector<Buffer<BvhNode>> finer(std::max(quads_.size(), 2 * nodes_.size()));
  const double per_time = static_cast<double>(quads_.size()) / static_cast<double>(finer.size());
  for (std::size_t step = 1; step <= finer.size(); ++step) {
    Buffer<BvhNode>& nodes = finer[step - 1];
    if (!nodes_.empty() && step % 2 == 0) {
      nodes = std::move(nodes_[step / 2 - 1]);
      continue;
    }
    const Mix<TriangleQuad> quads = quads_at(static_cast<double>(step) * per_time);
    nodes.resize_uninitialized(tree_.nodes.size());
    std::copy(tree_.nodes.begin(), tree_.nodes.end(), nodes.begin());
    refit_boxes(executor, View<BvhNode>(nodes), [&](const BvhNode& node, std::uint32_t child) {
      return leaf_box(quads, node, child);
    });
  }
  nodes_ = std::move(finer);
}

std::size_t MovingMesh::memory_bytes() const {
  std::size_t bytes = 0;
  for (const Buffer<TriangleQuad>& quads : quads_) bytes += quads.capacity_bytes();
  for (const Buffer<BvhNode>& nodes : nodes_) bytes += nodes.capacity_bytes();
  return bytes;
}

}  // namespace raysheaf
