// How a batch of rays is answered. A method is a preset of settings of one pipeline; each setting
// may be changed by itself, and every combination gives the same hits, bit for bit.
#pragma once

#include <cstdint>
#include <string_view>

namespace raysheaf {

enum class Method : std::uint8_t {
  kBrute,  ///< every ray with every triangle: ground truth
  kRah,    ///< ray hierarchy over trimmed raster order (Roger, Assarsson, Holzschuch 2007)
  kCrsh,   ///< hashed, compressed, sorted rays, and mesh culling (Reis, Costa, Pereira 2017)
  kGl10,   ///< sorted rays in packets, breadth-first through a BVH (Garanzha & Loop 2010)
  kDual,   ///< bundles of rays against an object hierarchy, planned batch by batch
};

[[nodiscard]] const char* to_string(Method method);
/// Throws `Error` (kInvalidArgument) naming the methods there are.
[[nodiscard]] Method method_from_string(std::string_view name);

/// What rays are sorted by.
enum class RayKey : std::uint8_t {
  kRaster,            ///< nothing: trimmed raster order
  kPixelMorton,       ///< Morton order of the pixels: tiles instead of strips
  kCrsh,              ///< the 32-bit hash of `crsh` (src/rays/hash_body.h)
  kPublished,         ///< the published program's hash as it was coded
  kCorrected,         ///< the same with atan2(y, x)
  kSphericalMorton,   ///< light | azimuth and polar angle, interleaved
  kOctahedralMorton,  ///< light | octahedral map of the direction
  kOctahedralHilbert,
  kEndPointHilbert,  ///< light | where the ray ends in the scene's box
  kFiveMorton,       ///< octahedral direction and origin, five dimensions
  kFiveHilbert,
  kTwoPointMorton,  ///< origin and exit from the scene's box (or end), six dimensions
  kTwoPointHilbert,
};

/// What bounds a bundle of rays.
enum class BundleBound : std::uint8_t {
  kSphereCone,    ///< ball of origins, cone of directions, unbounded
  kFiniteCone,    ///< the same, with the rays' length in the scene
  kShaft,         ///< the hull of a box of origins and a box of ends
  kFrustum,       ///< four planes about a dominant axis, and the box of the bundle
  kShaftAndCone,  ///< a shaft, then a finite cone
};

[[nodiscard]] const char* to_string(RayKey key);
[[nodiscard]] const char* to_string(BundleBound bound);
/// Throw `Error` (kInvalidArgument) naming the ones there are.
[[nodiscard]] RayKey key_from_string(std::string_view name);
[[nodiscard]] BundleBound bound_from_string(std::string_view name);

/// How rays and triangles are brought together.
enum class Traversal : std::uint8_t {
  kBruteForce,    ///< every ray with every triangle
  kRayHierarchy,  ///< a hierarchy over the rays: `bound` to `branching` say which
  kPackets,  ///< packets of at most 256 rays, by their frusta, through a BVH over the triangles
  kDual,     ///< by the plan of each batch: nothing below is used
};

struct MethodSettings {
  Traversal traversal = Traversal::kRayHierarchy;
  RayKey key = RayKey::kCrsh;
  std::uint32_t key_bits = 32;  ///< 32 or 64, where the key comes in both
  BundleBound bound = BundleBound::kSphereCone;
  bool mesh_culling = true;     ///< test mesh spheres before their triangles
  std::uint32_t levels = 2;     ///< of the ray hierarchy, 1 to 8
  std::uint32_t branching = 8;  ///< children a node, 2 to 64
};

[[nodiscard]] MethodSettings method_settings(Method method);

}  // namespace raysheaf
