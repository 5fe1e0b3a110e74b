// Reads accessor values of any component type, stride, normalisation and sparseness.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "io/gltf_model.h"
#include "raysheaf/types.h"

namespace raysheaf::io {

class AccessorReader {
 public:
  /// Accessors may expand to `budget` bytes in total, so that a small file whose primitives share
  /// one large accessor cannot exhaust the memory.
  AccessorReader(const GltfModel& model, std::size_t budget) : model_(model), budget_(budget) {}

  /// Subtracts other data made from the file from the budget, before it is allocated. Throws
  /// `Error` (kOutOfMemory) if the budget does not suffice.
  void charge(std::size_t count, std::size_t bytes_each, const std::string& place);

  /// `components` floats per element. Throws if the accessor has another shape.
  [[nodiscard]] std::vector<float> floats(int accessor, int components, const std::string& place);
  /// The same for an attribute of `count` vertices. Also throws if a number is not finite.
  [[nodiscard]] std::vector<float> attribute(int accessor, int components, std::size_t count,
                                             const std::string& place);
  /// Calls `body(numbers)` for each vertex of an attribute. Keeps a window of it in memory, or all
  /// of a sparse attribute. Throws `NeedsWholeFile` for a sparse one whose buffer is in a file.
  template <class Body>
  void each_vertex(int accessor, int components, std::size_t count, const std::string& place,
                   const Body& body) {
    const GltfAccessor& source = attribute_of(accessor, components, count, place);
    const auto width = static_cast<std::size_t>(components);
    const std::size_t window = source.sparse ? count : kWindow;
    for (std::size_t first = 0; first < count; first += window) {
      const std::vector<float> some =
          finite_window(source, first, std::min(window, count - first), place);
      for (std::size_t i = 0; i < some.size(); i += width) body(&some[i]);
    }
  }
  /// Validates an index accessor, which `each_index` may then read any number of times.
  [[nodiscard]] const GltfAccessor& indices(int accessor, const std::string& place);
  /// Calls `body(i, index)` for each index.
  template <class Body>
  void each_index(const GltfAccessor& indices, const Body& body) const {
    for (std::size_t first = 0; first < indices.count; first += kWindow) {
      const std::vector<std::uint32_t> some =
          index_window(indices, first, std::min(kWindow, indices.count - first));
      for (std::size_t i = 0; i < some.size(); ++i) body(first + i, some[i]);
    }
  }
  [[nodiscard]] std::size_t count(int accessor) const {
    return model_.accessors[static_cast<std::size_t>(accessor)].count;
  }
  [[nodiscard]] std::size_t components(int accessor) const {
    return model_.accessors[static_cast<std::size_t>(accessor)].components;
  }

 private:
  static constexpr std::size_t kWindow = std::size_t{1} << 14;

  const GltfAccessor& charged(int accessor, const std::string& place);
  const GltfAccessor& floats_of(int accessor, int components, const std::string& place);
  const GltfAccessor& attribute_of(int accessor, int components, std::size_t count,
                                   const std::string& place);
  [[nodiscard]] std::vector<float> window(const GltfAccessor& accessor, std::size_t first,
                                          std::size_t count, const std::string& place) const;
  [[nodiscard]] std::vector<float> finite_window(const GltfAccessor& accessor, std::size_t first,
                                                 std::size_t count, const std::string& place) const;
  [[nodiscard]] std::vector<std::uint32_t> index_window(const GltfAccessor& accessor,
                                                        std::size_t first, std::size_t count) const;
  void apply_sparse(const GltfAccessor& accessor, const std::string& place,
                    std::vector<float>& values) const;

  const GltfModel& model_;
  std::size_t budget_;
};

/// Throws `Error` if a number is not finite. Elements have `width` numbers; the first one of
/// `values` has the index `first`.
void check_finite(const std::vector<float>& values, std::size_t width, const std::string& place,
                  std::size_t first = 0);

[[nodiscard]] std::vector<Vec3> as_vec3(const std::vector<float>& values);

}  // namespace raysheaf::io
