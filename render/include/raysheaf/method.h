// The methods that answer a batch of rays. A method is a preset of settings of one pipeline; each
// setting can be changed separately, and every combination gives the same hits, bit for bit.
#pragma once

#include <cstdint>
#include <iterator>
#include <optional>
#include <string_view>

namespace raysheaf {

enum class Method : std::uint8_t {
  kBrute,  ///< every ray with every triangle: ground truth
  kRah,    ///< ray hierarchy over trimmed raster order (Roger, Assarsson, Holzschuch 2007)
  kCrsh,   ///< hashed, compressed, sorted rays, and mesh culling (Reis, Costa, Pereira 2017)
  kGl10,   ///< sorted rays in packets, breadth-first through a BVH (Garanzha & Loop 2010)
  kDual,   ///< bundles of rays against an object hierarchy; a plan for each batch
};

[[nodiscard]] const char* to_string(Method method);
/// Throws `Error` (kInvalidArgument) naming the valid methods.
[[nodiscard]] Method method_from_string(std::string_view name);

/// The sort key of rays.
enum class RayKey : std::uint8_t {
  kRaster,            ///< none: trimmed raster order
  kPixelMorton,       ///< Morton order of the pixels: square tiles instead of strips
  kCrsh,              ///< the 32-bit hash of `crsh` (render/rays/hash_body.h)
  kPublished,         ///< the hash as coded in the published program
  kCorrected,         ///< the same with atan2(y, x)
  kSphericalMorton,   ///< light | azimuth and polar angle, interleaved
  kOctahedralMorton,  ///< light | octahedral map of the direction
  kOctahedralHilbert,
  kEndPointHilbert,  ///< light | the ray's end point in the scene's box
  kFiveMorton,       ///< octahedral direction and origin, five dimensions
  kFiveHilbert,
  kTwoPointMorton,  ///< origin and exit from the scene's box (or end), six dimensions
  kTwoPointHilbert,
  kCount,  ///< how many there are; no key
};
inline constexpr auto kRayKeyCount = static_cast<std::size_t>(RayKey::kCount);

/// The cell whose place on a curve is the key.
enum class KeyCell : std::uint8_t {
  kNone,                ///< there is no curve: raster order, or a hash
  kPixel,               ///< column and row of the pixel
  kSpherical,           ///< azimuth and polar angle of the direction
  kOctahedral,          ///< the octahedral map of the direction
  kEnd,                 ///< where the ray ends in the scene's box
  kOctahedralAndStart,  ///< the direction as above, and where the ray starts
  kStartAndEnd,
};

struct RayKeyEntry {
  RayKey key;
  const char* name;  ///< as `--key` has it
  KeyCell cell = KeyCell::kNone;
  std::uint8_t axes = 0;  ///< of the cell
  bool hilbert = false;   ///< the curve is Hilbert's, or else Morton's
};

/// All keys, in the order of `RayKey`: what names, lists and sort keys are read from.
inline constexpr RayKeyEntry kRayKeys[] = {
    {RayKey::kRaster, "raster"},
    {RayKey::kPixelMorton, "pixel-morton", KeyCell::kPixel, 2},
    {RayKey::kCrsh, "crsh"},
    {RayKey::kPublished, "published"},
    {RayKey::kCorrected, "corrected"},
    {RayKey::kSphericalMorton, "spherical-morton", KeyCell::kSpherical, 2},
    {RayKey::kOctahedralMorton, "octahedral-morton", KeyCell::kOctahedral, 2},
    {RayKey::kOctahedralHilbert, "octahedral-hilbert", KeyCell::kOctahedral, 2, true},
    {RayKey::kEndPointHilbert, "end-point-hilbert", KeyCell::kEnd, 3, true},
    {RayKey::kFiveMorton, "five-morton", KeyCell::kOctahedralAndStart, 5},
    {RayKey::kFiveHilbert, "five-hilbert", KeyCell::kOctahedralAndStart, 5, true},
    {RayKey::kTwoPointMorton, "two-point-morton", KeyCell::kStartAndEnd, 6},
    {RayKey::kTwoPointHilbert, "two-point-hilbert", KeyCell::kStartAndEnd, 6, true},
};
static_assert(std::size(kRayKeys) == kRayKeyCount, "a key has no entry");
static_assert(
    [] {
      for (std::size_t i = 0; i < kRayKeyCount; ++i)
        if (kRayKeys[i].key != static_cast<RayKey>(i)) return false;
      return true;
    }(),
    "the entries are not in the order of the keys");

[[nodiscard]] constexpr const RayKeyEntry& entry_of(RayKey key) {
  return kRayKeys[static_cast<std::size_t>(key)];
}

/// The bounding volume of a bundle of rays.
enum class BundleBound : std::uint8_t {
  kSphereCone,    ///< sphere of origins, cone of directions, unbounded
  kFiniteCone,    ///< sphere and cone, bounded by the rays' length in the scene
  kShaft,         ///< convex hull of a box of origins and a box of ends
  kFrustum,       ///< four planes about a dominant axis, and the box of the bundle
  kShaftAndCone,  ///< a shaft, then a finite cone
};

[[nodiscard]] const char* to_string(RayKey key);
[[nodiscard]] const char* to_string(BundleBound bound);
/// Throw `Error` (kInvalidArgument) naming the valid names.
[[nodiscard]] RayKey key_from_string(std::string_view name);
[[nodiscard]] BundleBound bound_from_string(std::string_view name);

/// How rays are tested with triangles.
enum class Traversal : std::uint8_t {
  kBruteForce,    ///< every ray with every triangle
  kRayHierarchy,  ///< a hierarchy over the rays, with the settings `bound` to `branching`
  kPackets,  ///< packets of at most 256 rays, by their frusta, through a BVH over the triangles
  kDual,     ///< by the plan of each batch; the settings below are not used
};

struct MethodSettings {
  Traversal traversal = Traversal::kRayHierarchy;
  RayKey key = RayKey::kCrsh;
  std::uint32_t key_bits = 32;  ///< 32 or 64, for keys that have both widths
  BundleBound bound = BundleBound::kSphereCone;
  bool mesh_culling = true;     ///< test mesh spheres before their triangles
  std::uint32_t levels = 2;     ///< of the ray hierarchy, 1 to 8
  std::uint32_t branching = 8;  ///< children per node, 2 to 64
};

/// A method, and settings in place of its own: `gl10` uses only `key` and `key_bits`, `brute` and
/// `dual` none of them.
struct MethodChoice {
  Method method = Method::kDual;
  std::optional<RayKey> key = {};  ///< none, here and below: the method's own
  std::uint32_t key_bits = 32;
  std::uint32_t levels = 2, branching = 8;
  std::optional<BundleBound> bound = {};
  std::optional<bool> mesh_culling = {};

  bool operator==(const MethodChoice&) const = default;
};

[[nodiscard]] MethodSettings method_settings(const MethodChoice& choice);
[[nodiscard]] MethodSettings method_settings(Method method);

}  // namespace raysheaf
