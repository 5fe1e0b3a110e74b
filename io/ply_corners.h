// Splits vertices whose faces have texture coordinates or colours of their own.
#pragma once

#include <cstdint>
#include <cstring>
#include <vector>

#include "io/corner_normals.h"
#include "raysheaf/error.h"

namespace raysheaf::io {

/// Finds or makes the copy of a vertex that has given texture coordinates and a given colour. The
/// first ones requested for a vertex are stored in the vertex itself. Only the newest few copies
/// are searched, so that many copies cost memory but not time. `Numbers` is as for
/// `VertexSplitter`.
template <class AnyMesh, class Numbers>
class CornerSplitter {
 public:
  /// The values that a face's corner has; null if the faces do not have them.
  struct Own {
    const Vec2* uv = nullptr;
    const Vec3* color = nullptr;
  };

  /// The arrays must be empty and belong to the caller.
  CornerSplitter(AnyMesh& mesh, Numbers& newest, Numbers& previous)
      : mesh_(mesh), newest_(newest), previous_(previous) {}

  /// Call it after reading the vertices and before the first face. The flags say which of the two
  /// values faces have.
  void begin(bool has_uvs, bool has_colors) {
    const auto count = mesh_.positions.size();
    newest_.resize(count, kInvalidId);
    previous_.resize(count, kInvalidId);
    if (has_uvs) mesh_.uvs.resize(count, Vec2{});
    if (has_colors) mesh_.colors.resize(count, Vec3{});
  }

  /// Calls `copied` with the index of a vertex before appending its copy.
  template <class Copied>
  std::uint32_t vertex_with(std::uint32_t vertex, const Own& own, const Copied& copied) {
    if (newest_[vertex] == kInvalidId) {
      put(newest_, vertex, vertex);
      set(vertex, own);
      return vertex;
    }
    std::uint32_t copy = newest_[vertex];
    for (int step = 0; step < kSearched && copy != kInvalidId; ++step, copy = previous_[copy])
      if (has(copy, own)) return copy;
    copied(vertex);
    return append_copy(vertex, own);
  }

 private:
  static constexpr int kSearched = 8;

  template <class T>
  static bool same(const T& a, const T& b) {
    return std::memcmp(&a, &b, sizeof a) == 0;
  }
  [[nodiscard]] bool has(std::uint32_t vertex, const Own& own) const {
    return (own.uv == nullptr || same(Vec2(mesh_.uvs[vertex]), *own.uv)) &&
           (own.color == nullptr || same(Vec3(mesh_.colors[vertex]), *own.color));
  }
  void set(std::uint32_t vertex, const Own& own) {
    if (own.uv != nullptr) put(mesh_.uvs, vertex, *own.uv);
    if (own.color != nullptr) put(mesh_.colors, vertex, *own.color);
  }
  std::uint32_t append_copy(std::uint32_t vertex, const Own& own) {
    if (mesh_.positions.size() >= kInvalidId)
      throw Error(ErrorCode::kOutOfMemory, "the mesh needs more than 2^32 vertices", mesh_.name);
    const auto copy = static_cast<std::uint32_t>(mesh_.positions.size());
    repeat(mesh_.positions, vertex);
    repeat(mesh_.normals, vertex);
    repeat(mesh_.uvs, vertex);
    repeat(mesh_.colors, vertex);
    previous_.push_back(newest_[vertex]);
    put(newest_, vertex, copy);
    set(copy, own);
    return copy;
  }

  AnyMesh& mesh_;
  Numbers& newest_;
  Numbers& previous_;
};

}  // namespace raysheaf::io
