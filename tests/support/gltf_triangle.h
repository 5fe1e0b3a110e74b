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

/// One that moves along x from 0 to `x` in so many seconds; its numbers are in m.bin.
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

/// What m.bin has.
inline std::string moving_triangle_numbers(float seconds, float x) {
  const float times_and_places[8] = {0, seconds, 0, 0, 0, x, 0, 0};
  return gltf_triangle_corners() +
         std::string(reinterpret_cast<const char*>(times_and_places), sizeof times_and_places);
}

}  // namespace raysheaf::test
