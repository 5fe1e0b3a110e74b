// Meshes that may be larger than memory.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "io/outer_array.h"
#include "raysheaf/block_file.h"

namespace raysheaf::io {

/// Loaders throw this if the file must be read whole.
struct NeedsWholeFile {};

/// The columns of all meshes, one mesh after the other.
struct OuterColumns {
  /// Keeps a fraction of `triangles_at_once` elements of each column in memory.
  explicit OuterColumns(const PackOptions& options)
      : OuterColumns(options.beside, options.triangles_at_once / 4) {}
  OuterColumns(const std::string& beside, std::size_t held)
      : positions(beside, held),
        normals(beside, held),
        uvs(beside, held),
        second_uvs(beside, held),
        colors(beside, held),
        alphas(beside, held),
        triangles(beside, held),
        materials(beside, held) {}
  void rest() {
    positions.rest(), normals.rest(), uvs.rest(), second_uvs.rest();
    colors.rest(), alphas.rest();
    triangles.rest(), materials.rest();
  }

  OuterArray<Vec3> positions, normals;
  OuterArray<Vec2> uvs, second_uvs;
  OuterArray<Vec3> colors;
  OuterArray<float> alphas;
  OuterArray<std::array<std::uint32_t, 3>> triangles;
  OuterArray<std::uint32_t> materials;
};

/// The part of a column that belongs to one mesh. It can grow while the mesh is the last one.
template <class T>
class OuterColumn {
 public:
  explicit OuterColumn(OuterArray<T>* all) : all_(all), first_(all->size()) {}

  [[nodiscard]] std::uint64_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] T operator[](std::uint64_t i) const { return (*all_)[first_ + i]; }
  void set(std::uint64_t i, const T& value) { all_->set(first_ + i, value); }
  void push_back(const T& value) {
    all_->push_back(value);
    ++size_;
  }
  void resize(std::uint64_t size, const T& value = {}) {
    while (size_ < size) push_back(value);
    size_ = size;
  }

 private:
  OuterArray<T>* all_;
  std::uint64_t first_, size_ = 0;
};

/// Like `Mesh`, column by column. A normal of length zero is missing.
struct OuterMesh {
  explicit OuterMesh(OuterColumns* all)
      : positions(&all->positions),
        normals(&all->normals),
        uvs(&all->uvs),
        second_uvs(&all->second_uvs),
        colors(&all->colors),
        alphas(&all->alphas),
        triangles(&all->triangles),
        materials(&all->materials) {}

  std::string name;
  OuterColumn<Vec3> positions, normals;
  OuterColumn<Vec2> uvs, second_uvs;
  OuterColumn<Vec3> colors;
  OuterColumn<float> alphas;  ///< stays empty: streamed surfaces are opaque
  OuterColumn<std::array<std::uint32_t, 3>> triangles;
  OuterColumn<std::uint32_t> materials;
};

/// A scene whose meshes have only names, and the data of these meshes.
struct OuterScene {
  SceneDescription rest;
  std::unique_ptr<OuterColumns> columns;
  std::vector<OuterMesh> meshes;
};

/// Like `add_missing_normals` in io/normals.h, in memory that does not grow with the mesh: corners
/// are sorted by position in files. docs/stream.md gives the number of bytes per triangle.
void add_missing_normals(OuterMesh& mesh, const PackOptions& options);

}  // namespace raysheaf::io
