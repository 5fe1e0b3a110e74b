// Triangles cut into blocks as `cut_into_blocks` cuts them, where there are more than memory should
// hold: they lie in files.
//
//   all ─► as many as they are blocks' worth on the left of a plane │ the others ─► again, until
//   what is left may be held ─► cut_into_blocks
//
// A plane is a rank along the longest side of the box of centres, so that where triangles go
// depends on their order by (coordinate, number) alone. It is found by counting leading bits of
// that order.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "raysheaf/pack.h"

namespace raysheaf::io {

/// Of one mesh in one instance, which stays where it is.
struct OuterTriangle {
  std::uint32_t prim_id = 0;
  std::array<std::uint32_t, 3> vertex{};  ///< of the mesh
  std::array<Vec3, 3> corner{};
};

/// Triangles in a file without a name: written once, then read from the beginning any number of
/// times. Throws `Error` (kIo).
class OuterTriangles {
 public:
  /// In the folder of `beside`.
  explicit OuterTriangles(const std::string& beside);
  OuterTriangles(const OuterTriangles&) = delete;
  OuterTriangles& operator=(const OuterTriangles&) = delete;
  ~OuterTriangles();

  void add(const OuterTriangle& triangle);
  [[nodiscard]] std::uint64_t size() const { return size_; }
  /// Of centres, times three; and of corners.
  [[nodiscard]] const Box& centers() const { return centers_; }
  [[nodiscard]] const Box& corners() const { return corners_; }

  /// Calls `body(triangle)` for each, in the order in which they came.
  template <class Body>
  void for_each(const Body& body) {
    flush();
    for (std::uint64_t at = 0; at < size_; at += some_.size()) {
      read(at);
      for (const OuterTriangle& triangle : some_) body(triangle);
    }
    some_.clear();
  }

 private:
  void flush();
  void read(std::uint64_t first);

  std::string place_;
  int file_ = -1;
  std::uint64_t size_ = 0;
  std::vector<OuterTriangle> some_;  // on their way
  Box centers_, corners_;
};

/// As `cut_into_blocks`. `scene`: with one mesh without vertices and triangles, and its instance.
[[nodiscard]] SceneDescription cut_outer(std::unique_ptr<OuterTriangles> triangles,
                                         SceneDescription scene, BlockSink* sink,
                                         const PackOptions& options);

}  // namespace raysheaf::io
