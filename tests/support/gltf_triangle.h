// A glTF triangle whose buffer and image are separate files.
#pragma once

#include <string>

namespace raysheaf::test {

/// Its corners are in c.bin, its image is "a b.png". The JSON has blanks wherever they are allowed.
inline const std::string kGltfTriangle = R"({"asset": {"version": "2.0"},
    "buffers": [{"uri": "c.bin", "byteLength": 36}], "images": [ { "uri" : "a%20b.png" } ],
    "bufferViews": [{"buffer": 0, "byteLength": 36}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                   "min": [0, 0, 0], "max": [1, 1, 0]}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "nodes": [{"mesh": 0}],
    "scenes": [{"nodes": [0]}]})";

/// The contents of c.bin.
inline std::string gltf_triangle_corners() {
  constexpr float kCorners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  return {reinterpret_cast<const char*>(kCorners), sizeof kCorners};
}

/// A triangle that moves along x from 0 to `x` within some seconds; its numbers are in m.bin.
inline const std::string kMovingGltfTriangle = R"({"asset": {"version": "2.0"},
    "buffers": [{"byteLength": 68, "uri": "m.bin"}],
    "bufferViews": [{"buffer": 0, "byteLength": 68}],
    "accessors": [
      {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
      {"bufferView": 0, "byteOffset": 36, "componentType": 5126, "count": 2, "type": "SCALAR"},
      {"bufferView": 0, "byteOffset": 44, "componentType": 5126, "count": 2, "type": "VEC3"}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
    "nodes": [{"mesh": 0}],
    "animations": [{"name": "Walk", "samplers": [{"input": 1, "output": 2}],
      "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}]}]})";

/// The contents of m.bin.
inline std::string moving_triangle_numbers(float seconds, float x) {
  const float times_and_places[8] = {0, seconds, 0, 0, 0, x, 0, 0};
  return gltf_triangle_corners() +
         std::string(reinterpret_cast<const char*>(times_and_places), sizeof times_and_places);
}

}  // namespace raysheaf::test
