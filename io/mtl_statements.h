// The statements of MTL text.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "raysheaf/types.h"

namespace raysheaf::io {

/// An image and its options. Without a name, there is none.
struct MtlMap {
  std::string name;
  bool clamp = false;
  char channel = 'm';  ///< -imfchan
  Vec2 scale{1, 1}, offset;
  float bump_multiplier = 1;
  [[nodiscard]] bool is_named() const { return !name.empty(); }
};

/// A material as written, with the defaults of what is not. Colours are linear.
struct MtlMaterial {
  std::string name;
  std::optional<Vec3> diffuse;  ///< Kd
  Vec3 specular, emission, filter;
  float shininess = 1, ior = 1, dissolve = 1, roughness = 0, metallic = 0;
  int illum = 2;
  bool is_invisible = false;  ///< d is 0, and no Tr contradicts it
  MtlMap diffuse_map, emission_map, normal_map, alpha_map, ambient_map;
};

/// Reads keywords in any case. Colours other than `emission` that exceed 2 are divided by 255.
/// Missing components equal the first, and CIE XYZ is converted. `warn` is called for each ignored
/// feature. Throws `Error` with a place like "line 17" for what is no number.
[[nodiscard]] std::vector<MtlMaterial> read_mtl(
    std::string_view text, const std::function<void(const std::string&)>& warn);

}  // namespace raysheaf::io
