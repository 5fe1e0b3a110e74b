// The values of an accessor, whatever its component type, stride, normalisation and sparseness.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/gltf_model.h"
#include "raysheaf/types.h"

namespace raysheaf::io {

class AccessorReader {
 public:
  /// Reads at most `budget` elements in all, so that a small file whose primitives share one large
  /// accessor cannot fill the memory.
  AccessorReader(const GltfModel& model, std::size_t budget) : model_(model), budget_(budget) {}

  /// `components` floats an element. Throws where the accessor has another shape.
  [[nodiscard]] std::vector<float> floats(int accessor, int components, const std::string& place);
  /// The same of an attribute of `count` vertices; throws too where a number is not finite.
  [[nodiscard]] std::vector<float> attribute(int accessor, int components, std::size_t count,
                                             const std::string& place);
  [[nodiscard]] std::vector<std::uint32_t> indices(int accessor, const std::string& place);
  [[nodiscard]] std::size_t count(int accessor) const {
    return model_.accessors[static_cast<std::size_t>(accessor)].count;
  }

 private:
  const GltfAccessor& charge(int accessor, const std::string& place);
  void apply_sparse(const GltfAccessor& accessor, std::size_t components, const std::string& place,
                    std::vector<float>& values) const;

  const GltfModel& model_;
  std::size_t budget_;
};

/// Throws `Error` where a number is not finite; elements have `width` of them.
void check_finite(const std::vector<float>& values, std::size_t width, const std::string& place);

[[nodiscard]] std::vector<Vec3> as_vec3(const std::vector<float>& values);

}  // namespace raysheaf::io
