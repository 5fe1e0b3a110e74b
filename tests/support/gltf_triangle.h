// A triangle as glTF whose buffer and picture are files of their own.
#pragma once

#include <string>

namespace raysheaf::test {

/// Its corners are in c.bin, its picture is "a b.png". Blanks stand where JSON lets them.
inline const std::string kGltfTriangle = R"({"asset": {"version": "2.0"},
    "buffers": [{"uri": "c.bin", "byteLength": 36}], "images": [ { "uri" : "a%20b.png" } ],
    "bufferViews": [{"buffer": 0, "byteLength": 36}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                   "min": [0, 0, 0], "max": [1, 1, 0]}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "nodes": [{"mesh": 0}],
    "scenes": [{"nodes": [0]}]})";

/// What c.bin has.
inline std::string gltf_triangle_corners() {
  constexpr float kCorners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  return {reinterpret_cast<const char*>(kCorners), sizeof kCorners};
}

}  // namespace raysheaf::test
