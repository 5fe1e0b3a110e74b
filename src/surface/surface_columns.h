// Points on triangles in columns, for as many at a time as SIMD kernels take: the arithmetic of
// surface_body.h and texture_body.h, operation by operation.
#pragma once

#include <cstddef>
#include <cstdint>

#include "surface/surface_body.h"
#include "surface/texture_body.h"

namespace raysheaf {

inline constexpr std::size_t kSurfaceLanes = 16;

/// A value for each lane.
using SurfaceColumn = float[kSurfaceLanes];

/// What is known of each lane's triangle and ray, and what follows from it. Unused lanes hold
/// anything that is finite.
struct alignas(64) SurfaceColumns {
  SurfaceColumn corner[3][3];                           ///< world: [corner][axis]
  SurfaceColumn origin[3], direction[3], t_min, t_max;  ///< of the ray
  SurfaceColumn incoming[3];                            ///< unit, where the ray arrives
  SurfaceColumn normal[3][3];  ///< [corner][axis], the instance's own space
  SurfaceColumn uv[3][2];      ///< [corner][axis], the mesh's own
  // Found by the kernels.
  SurfaceColumn u, v;  ///< weights of the second and third corner
  SurfaceColumn position[3], geometric[3], shading[3], clearance;
  SurfaceColumn color[3];  ///< of a texture
};

/// Sets of lanes, a bit each.
using LaneBits = std::uint32_t;

/// Lanes of one instance whose triangles have normals.
struct InstanceLanes {
  LaneBits lanes = 0;
  std::uint32_t mesh = 0;  ///< its number
  NormalMap map;
};

/// The weights where rays meet their triangles, by `intersect_triangle`; returns the lanes where
/// binary32 settles it that they do.
[[nodiscard]] LaneBits find_weights(SurfaceColumns* columns);

/// `incoming` as `normalized` has `direction`; returns the lanes that are right.
[[nodiscard]] LaneBits find_incoming(SurfaceColumns* columns);

/// `placed_surface` of all lanes: position, clearance, both normals. `instances` have the lanes
/// with normals of their own, which no two share; `mirrored`: lanes of instances that mirror.
/// Returns the lanes that are right, and puts those that see the front into `front`.
[[nodiscard]] LaneBits place_surfaces(const InstanceLanes* instances, std::size_t count,
                                      LaneBits mirrored, SurfaceColumns* columns, LaneBits* front);

/// Red, green and blue of `look_up` at the lanes' places, for all lanes. The slot has a texture, of
/// at most `kMostColumnTexels`.
void look_up_colors(const TextureTable& table, const PlacedTexture& slot, const float* decode,
                    SurfaceColumns* columns);
/// Has the memory that it will read fetched meanwhile.
void prefetch_colors(const TextureTable& table, const PlacedTexture& slot,
                     const SurfaceColumns& columns);
inline constexpr std::uint64_t kMostColumnTexels = std::uint64_t{1} << 28;

}  // namespace raysheaf
