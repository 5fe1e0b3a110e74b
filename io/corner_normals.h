// The steps of `add_missing_normals`, shared by meshes in memory and meshes in files.
#pragma once

#include <cstring>
#include <span>
#include <vector>

#include "io/linear.h"
#include "io/normals.h"
#include "raysheaf/error.h"

namespace raysheaf::io {

/// The face's normal with twice the area as its length; zero for a degenerate face.
inline Double3 face_normal(Vec3 a, Vec3 b, Vec3 c) {
  return cross(widen(b) - widen(a), widen(c) - widen(a));
}

/// The normals of the corners at one position, from the normals of their faces and their smoothing
/// (see `add_missing_normals`). The run has at most `kMaxFacesAtPosition` faces.
void smooth_run(std::span<const Double3> faces, std::span<const std::uint32_t> smoothing,
                std::span<Vec3> normals);

template <class T>
void put(std::vector<T>& column, std::size_t i, const T& value) {
  column[i] = value;
}
template <class Column, class T>
void put(Column& column, std::size_t i, const T& value) {
  column.set(i, value);
}

/// Appends a copy of element `i`, unless the column is empty.
template <class Column>
void repeat(Column& column, std::uint64_t i) {
  if (column.empty()) return;
  const auto value = column[i];
  column.push_back(value);
}

/// Finds or makes the copy of a vertex that has a given normal. The copies of a vertex form a
/// linked list. Only its newest few entries are searched, so that many copies cost memory but not
/// time.
template <class AnyMesh, class Numbers>
class VertexSplitter {
 public:
  /// `newest` and `previous` must be empty. Afterwards they have an entry for each vertex: the
  /// entry of a copy in `previous` is the copy before it, or the original.
  VertexSplitter(AnyMesh& mesh, Numbers& newest, Numbers& previous)
      : mesh_(mesh), newest_(newest), previous_(previous) {
    newest_.resize(mesh.positions.size(), kInvalidId);
    previous_.resize(mesh.positions.size(), kInvalidId);
  }

  /// Whether `vertex_with` was called for this vertex.
  [[nodiscard]] bool is_settled(std::uint32_t vertex) const {
    return newest_[vertex] != kInvalidId;
  }

  std::uint32_t vertex_with(std::uint32_t vertex, Vec3 normal) {
    if (!is_settled(vertex)) {
      put(newest_, vertex, vertex);
      put(mesh_.normals, vertex, normal);
      return vertex;
    }
    std::uint32_t copy = newest_[vertex];
    for (int step = 0; step < kSearched && copy != kInvalidId; ++step, copy = previous_[copy]) {
      const Vec3 other = mesh_.normals[copy];
      if (std::memcmp(&other, &normal, sizeof normal) == 0) return copy;
    }
    return append_copy(vertex, normal);
  }

 private:
  static constexpr int kSearched = 8;

  std::uint32_t append_copy(std::uint32_t vertex, Vec3 normal) {
    const std::size_t index = mesh_.positions.size();
    if (index >= kInvalidId) {
      throw Error(ErrorCode::kOutOfMemory, "the mesh needs more than 2^32 vertices", mesh_.name);
    }
    const Vec3 position = mesh_.positions[vertex];
    mesh_.positions.push_back(position);
    mesh_.normals.push_back(normal);
    repeat(mesh_.uvs, vertex);
    repeat(mesh_.second_uvs, vertex);
    repeat(mesh_.colors, vertex);
    repeat(mesh_.alphas, vertex);
    const auto copy = static_cast<std::uint32_t>(index);
    previous_.push_back(newest_[vertex]);
    put(newest_, vertex, copy);
    return copy;
  }

  AnyMesh& mesh_;
  Numbers& newest_;
  Numbers& previous_;
};

}  // namespace raysheaf::io
