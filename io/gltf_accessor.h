// The values of an accessor, whatever its component type, stride, normalisation and sparseness.
#pragma once

#include <tiny_gltf.h>

#include <cstdint>
#include <string>
#include <vector>

namespace raysheaf::io {

class AccessorReader {
 public:
  /// Reads at most `budget` elements in all, so that a small file whose primitives share one large
  /// accessor cannot fill the memory.
  AccessorReader(const tinygltf::Model& model, std::size_t budget)
      : model_(model), budget_(budget) {}

  /// `components` floats an element. Throws where the accessor has another shape.
  [[nodiscard]] std::vector<float> floats(int accessor, int components, const std::string& place);
  [[nodiscard]] std::vector<std::uint32_t> indices(int accessor, const std::string& place);
  [[nodiscard]] std::size_t count(int accessor) const {
    return model_.accessors[static_cast<std::size_t>(accessor)].count;
  }

 private:
  const tinygltf::Accessor& charge(int accessor, const std::string& place);
  void apply_sparse(const tinygltf::Accessor& accessor, std::size_t components,
                    const std::string& place, std::vector<float>& values) const;

  const tinygltf::Model& model_;
  std::size_t budget_;
};

}  // namespace raysheaf::io
