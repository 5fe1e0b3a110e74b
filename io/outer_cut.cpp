#include "io/outer_cut.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "io/file.h"

namespace raysheaf::io {
namespace {

/// That are read and written at once: 1.7 MB.
constexpr std::size_t kTrianglesAtOnce = 1u << 15;
constexpr std::uint32_t kDigitBits = 16;

/// As a transform that changes nothing gives it: without -0.
Vec3 placed_still(Vec3 p) {
  return {p.x + 0.0f, p.y + 0.0f, p.z + 0.0f};
}

Vec3 center_of(const OuterTriangle& t) {
  const auto& [a, b, c] = t.corner;
  const auto sum = [](float x, float y, float z) { return (x + 0.0f) + (y + 0.0f) + (z + 0.0f); };
  return {sum(a.x, b.x, c.x), sum(a.y, b.y, c.y), sum(a.z, b.z, c.z)};
}

void enlarge_box(Box* box, Vec3 p) {
  box->min = {std::min(box->min.x, p.x), std::min(box->min.y, p.y), std::min(box->min.z, p.z)};
  box->max = {std::max(box->max.x, p.x), std::max(box->max.y, p.y), std::max(box->max.z, p.z)};
}

/// The axis along which centres are farthest apart.
int longest_axis(const Box& box) {
  const float x = box.max.x - box.min.x, y = box.max.y - box.min.y, z = box.max.z - box.min.z;
  return x >= y && x >= z ? 0 : y >= z ? 1 : 2;
}

/// Floats as words in the same order; the two zeros are one.
std::uint32_t order_word(float x) {
  x += 0.0f;
  std::uint32_t bits = 0;
  std::memcpy(&bits, &x, sizeof bits);
  return (bits & 0x80000000u) != 0 ? ~bits : bits | 0x80000000u;
}

/// All different.
std::uint64_t order_of(const OuterTriangle& triangle, int axis) {
  const Vec3 center = center_of(triangle);
  const float x = axis == 0 ? center.x : axis == 1 ? center.y : center.z;
  return std::uint64_t{order_word(x)} << 32 | triangle.prim_id;
}

/// The order before which there are `rank` triangles. Holds `at_once` orders.
std::uint64_t order_at(OuterTriangles& triangles, int axis, std::uint64_t rank,
                       std::uint64_t at_once) {
  std::uint64_t prefix = 0, within = triangles.size();
  std::uint32_t known = 0;  // leading bits, which are those of `prefix`
  const auto has_prefix = [&](std::uint64_t order) {
    return known == 0 || order >> (64 - known) == prefix;
  };
  while (within > at_once) {
    std::vector<std::uint64_t> counts(std::size_t{1} << kDigitBits);
    const std::uint32_t shift = 64 - known - kDigitBits;
    triangles.for_each([&](const OuterTriangle& triangle) {
      const std::uint64_t order = order_of(triangle, axis);
      if (has_prefix(order)) ++counts[order >> shift & (counts.size() - 1)];
    });
    std::uint64_t digit = 0;
    for (; rank >= counts[digit]; ++digit) rank -= counts[digit];
    within = counts[digit];
    prefix = prefix << kDigitBits | digit;
    known += kDigitBits;
  }
  std::vector<std::uint64_t> orders;
  orders.reserve(within);
  triangles.for_each([&](const OuterTriangle& triangle) {
    const std::uint64_t order = order_of(triangle, axis);
    if (has_prefix(order)) orders.push_back(order);
  });
  const auto at = orders.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(orders.begin(), at, orders.end());
  return *at;
}

/// Blocks of a part of a mesh, whose numbers become those of the whole.
class PartSink : public BlockSink {
 public:
  PartSink(BlockSink* to, const std::vector<OuterTriangle>& triangles)
      : to_(*to), triangles_(triangles) {}
  void add(const TriangleBlock& block, const BlockShading& shading) override {
    block_ = block;
    for (std::uint32_t& id : block_.prim_ids) id = triangles_[id].prim_id;
    to_.add(block_, shading);
  }

 private:
  BlockSink& to_;
  const std::vector<OuterTriangle>& triangles_;
  TriangleBlock block_;
};

class OuterCutter {
 public:
  OuterCutter(const SceneDescription& scene, BlockSink* sink, const PackOptions& options)
      : scene_(scene), sink_(*sink), options_(options) {}

  void cut(std::unique_ptr<OuterTriangles> triangles) {
    const std::uint64_t count = triangles->size();
    const std::uint64_t held = std::max(options_.triangles_at_once, options_.triangles_a_block);
    if (count <= held) return cut_held(std::move(triangles));
    const std::uint64_t most = options_.triangles_a_block, pieces = (count + most - 1) / most;
    const int axis = longest_axis(triangles->centers());
    const std::uint64_t rank = count * (pieces / 2) / pieces;
    const std::uint64_t plane = order_at(*triangles, axis, rank, held);
    auto left = std::make_unique<OuterTriangles>(options_.beside);
    auto right = std::make_unique<OuterTriangles>(options_.beside);
    triangles->for_each([&](const OuterTriangle& triangle) {
      (order_of(triangle, axis) < plane ? left : right)->add(triangle);
    });
    triangles.reset();
    cut(std::move(left));
    cut(std::move(right));
  }

 private:
  /// Numbers of triangles and vertices ascend as they did, so that nothing that looks at their
  /// order sees a difference.
  void cut_held(std::unique_ptr<OuterTriangles> from) {
    std::vector<OuterTriangle> triangles;
    triangles.reserve(from->size());
    from->for_each([&](const OuterTriangle& triangle) { triangles.push_back(triangle); });
    from.reset();
    std::sort(triangles.begin(), triangles.end(),
              [](const auto& a, const auto& b) { return a.prim_id < b.prim_id; });
    PartSink sink(&sink_, triangles);
    const SceneDescription part = part_of_mesh(triangles);
    static_cast<void>(cut_into_blocks(part, &sink, options_.triangles_a_block));
  }

  [[nodiscard]] SceneDescription part_of_mesh(const std::vector<OuterTriangle>& triangles) const {
    SceneDescription part;
    part.materials = scene_.materials;
    part.cameras.emplace_back();
    part.instances = scene_.instances;
    Mesh& mesh = part.meshes.emplace_back();
    mesh.materials = scene_.meshes[0].materials;
    std::vector<std::uint32_t> vertices;
    vertices.reserve(3 * triangles.size());
    for (const OuterTriangle& triangle : triangles)
      vertices.insert(vertices.end(), triangle.vertex.begin(), triangle.vertex.end());
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    mesh.positions.resize(vertices.size());
    mesh.triangles.reserve(triangles.size());
    for (const OuterTriangle& triangle : triangles) {
      auto& corners = mesh.triangles.emplace_back();
      for (std::size_t k = 0; k < 3; ++k) {
        const auto at = std::lower_bound(vertices.begin(), vertices.end(), triangle.vertex[k]);
        corners[k] = static_cast<std::uint32_t>(at - vertices.begin());
        mesh.positions[corners[k]] = triangle.corner[k];
      }
    }
    return part;
  }

  const SceneDescription& scene_;
  BlockSink& sink_;
  const PackOptions& options_;
};

}  // namespace

OuterTriangles::OuterTriangles(const std::string& beside) : place_(temporary_name(beside)) {
  some_.reserve(kTrianglesAtOnce);
  file_ = ::open(place_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (file_ < 0) throw system_error("written", place_, errno);
  ::unlink(place_.c_str());
}

OuterTriangles::~OuterTriangles() {
  if (file_ >= 0) ::close(file_);
}

void OuterTriangles::add(const OuterTriangle& triangle) {
  some_.push_back(triangle);
  ++size_;
  enlarge_box(&centers_, center_of(triangle));
  for (const Vec3 corner : triangle.corner) enlarge_box(&corners_, placed_still(corner));
  if (some_.size() == kTrianglesAtOnce) flush();
}

void OuterTriangles::flush() {
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(some_.data());
  for (std::size_t left = some_.size() * sizeof(OuterTriangle); left > 0;) {
    const ssize_t written = ::write(file_, bytes, left);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) throw system_error("written", place_, errno);
    bytes += written;
    left -= static_cast<std::size_t>(written);
  }
  some_.clear();
}

void OuterTriangles::read(std::uint64_t first) {
  some_.resize(std::min<std::uint64_t>(kTrianglesAtOnce, size_ - first));
  auto* const bytes = reinterpret_cast<std::uint8_t*>(some_.data());
  const std::size_t size = some_.size() * sizeof(OuterTriangle);
  for (std::size_t done = 0; done < size;) {
    const auto at = static_cast<off_t>(first * sizeof(OuterTriangle) + done);
    const ssize_t got = ::pread(file_, bytes + done, size - done, at);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw system_error("read", place_, errno);
    if (got == 0) throw Error(ErrorCode::kIo, "became shorter while it was read", place_);
    done += static_cast<std::size_t>(got);
  }
}

SceneDescription cut_outer(std::unique_ptr<OuterTriangles> triangles, SceneDescription scene,
                           BlockSink* sink, const PackOptions& options) {
  const Box box = triangles->corners();
  OuterCutter(scene, sink, options).cut(std::move(triangles));
  // What cameras and lights are made from is the box alone.
  Mesh& mesh = scene.meshes[0];
  mesh.positions = {box.min, box.max};
  mesh.triangles = {{0, 1, 1}};
  add_missing_camera_and_light(scene);
  mesh = Mesh{mesh.name, {}, {}, {}, {}, {}};
  return scene;
}

}  // namespace raysheaf::io
