// Points on triangles, stored in columns for SIMD kernels: the arithmetic of surface_body.h and
// texture_body.h, operation by operation.
#pragma once

#include <cstddef>
#include <cstdint>

#include "geom/surface_body.h"
#include "render/surface/texture_body.h"

namespace raysheaf {

inline constexpr std::size_t kSurfaceLanes = 16;

/// One value for each lane.
using SurfaceColumn = float[kSurfaceLanes];

/// The data of each lane's triangle and ray, and the results. Unused lanes may hold any finite
/// values.
struct alignas(64) SurfaceColumns {
  SurfaceColumn corner[3][3];                           ///< world: [corner][axis]
  SurfaceColumn origin[3], direction[3], t_min, t_max;  ///< of the ray
  SurfaceColumn incoming[3];                            ///< unit direction of the ray at the hit
  SurfaceColumn normal[3][3];  ///< [corner][axis], the instance's own space
  SurfaceColumn uv[3][2];      ///< [corner][axis], the mesh's own
  // Results of the kernels.
  SurfaceColumn u, v;  ///< weights of the second and third corner
  SurfaceColumn position[3], geometric[3], shading[3], clearance;
  SurfaceColumn color[3];  ///< of a texture
};

/// Sets of lanes, one bit for each.
using LaneBits = std::uint32_t;

/// Lanes of one instance whose triangles have normals.
struct InstanceLanes {
  LaneBits lanes = 0;
  std::uint32_t mesh = 0;  ///< the instance's number
  NormalMap map;
};

/// Computes the weights of the rays' hits, as `intersect_triangle` does; returns the lanes for
/// which binary32 proves the hit.
[[nodiscard]] LaneBits find_weights(SurfaceColumns* columns);

/// Computes `incoming` as `normalized` of `direction`; returns the lanes whose result is valid.
[[nodiscard]] LaneBits find_incoming(SurfaceColumns* columns);

/// `placed_surface` of all lanes: position, clearance, both normals. `instances` lists the lanes
/// with normals of their own, each lane at most once; `mirrored`: lanes of instances that mirror.
/// Returns the lanes whose result is valid, and writes those that see the front into `front`.
[[nodiscard]] LaneBits place_surfaces(const InstanceLanes* instances, std::size_t count,
                                      LaneBits mirrored, SurfaceColumns* columns, LaneBits* front);

/// Red, green and blue of `look_up` at the lanes' places, for all lanes. The slot must have a
/// texture, of at most `kMostColumnTexels`.
void look_up_colors(const TextureTable& table, const PlacedTexture& slot, const float* decode,
                    SurfaceColumns* columns);
/// Prefetches the memory that `look_up_colors` will read.
void prefetch_colors(const TextureTable& table, const PlacedTexture& slot,
                     const SurfaceColumns& columns);
inline constexpr std::uint64_t kMostColumnTexels = std::uint64_t{1} << 28;

}  // namespace raysheaf
