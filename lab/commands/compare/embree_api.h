// The part of Embree's C interface that the comparison calls, of Embree 3 and of Embree 4. Both are
// loaded while the program runs, so no header of either is needed to compile it.
//
// Layouts and values are those of libraries with one level of instances, the default.
#pragma once

#include <sys/types.h>

#include <array>
#include <cstddef>
#include <cstdint>

namespace raysheaf::app::embree {

using Device = struct DeviceTag*;
using Scene = struct SceneTag*;
using Geometry = struct GeometryTag*;

inline constexpr std::uint32_t kInvalid = ~0u;

enum class Quality : int { kLow = 0, kMedium = 1, kHigh = 2, kRefit = 3 };
enum class SceneFlag : int { kNone = 0, kDynamic = 1 };
enum class Buffer : int { kIndex = 0, kVertex = 1 };
enum class Format : int { kUint3 = 0x5003, kFloat3 = 0x9003, kFloat3x4RowMajor = 0x9134 };
enum class GeometryType : int { kTriangle = 0, kInstance = 121 };
enum class DeviceProperty : int { kVersion = 0 };
enum class Failure : int { kNone = 0, kOutOfMemory = 4 };

/// N rays; N = 1 is also the layout of a single ray.
template <std::size_t N>
struct alignas(N == 1 ? 16 : 4 * N) Rays {
  std::array<float, N> origin_x, origin_y, origin_z, t_near;
  std::array<float, N> direction_x, direction_y, direction_z, time;
  std::array<float, N> t_far;
  std::array<std::uint32_t, N> mask, id, flags;
};

/// Embree 4.3 and later end with `instance_prim_id`; earlier versions never touch it.
template <std::size_t N>
struct alignas(N == 1 ? 16 : 4 * N) Hits {
  std::array<float, N> normal_x, normal_y, normal_z, u, v;
  std::array<std::uint32_t, N> prim_id, geom_id, instance_id, instance_prim_id;
};

template <std::size_t N>
struct RayHits {
  Rays<N> ray;
  Hits<N> hit;
};

/// The context of a query of Embree 3.
struct Context {
  std::uint32_t flags = 0;
  void* filter = nullptr;
  std::uint32_t instance_id = kInvalid;
  float min_width_factor = 0;  ///< only in builds with this feature
};
inline constexpr std::uint32_t kContextCoherent = 1;

/// The arguments of a query of Embree 4.
struct Arguments {
  std::uint32_t flags = 0;
  std::uint32_t features = ~0u;
  void* context = nullptr;
  void* filter = nullptr;
  void* callback = nullptr;    ///< intersects user geometry
  float min_width_factor = 0;  ///< only in builds with this feature
};
inline constexpr std::uint32_t kArgumentsCoherent = 1u << 16;

/// rtcIntersect… with `RayHits`, rtcOccluded… with `Rays`: the same symbols with the parameters of
/// one version or the other.
template <template <std::size_t> class Query>
struct Queries {
  void (*one_3)(Scene, Context*, Query<1>*) = nullptr;
  void (*eight_3)(const int* valid, Scene, Context*, Query<8>*) = nullptr;
  void (*sixteen_3)(const int* valid, Scene, Context*, Query<16>*) = nullptr;
  void (*stream_3)(Scene, Context*, Query<16>*, unsigned width, unsigned count,
                   std::size_t stride_bytes) = nullptr;
  void (*one_4)(Scene, Query<1>*, Arguments*) = nullptr;
  void (*eight_4)(const int* valid, Scene, Query<8>*, Arguments*) = nullptr;
  void (*sixteen_4)(const int* valid, Scene, Query<16>*, Arguments*) = nullptr;
};

struct Api {
  Device (*new_device)(const char* settings) = nullptr;
  void (*release_device)(Device) = nullptr;
  ssize_t (*device_property)(Device, DeviceProperty) = nullptr;
  void (*set_error_function)(Device, void (*)(void* self, Failure, const char*),
                             void* self) = nullptr;
  void (*set_memory_function)(Device, bool (*)(void* self, ssize_t bytes, bool after),
                              void* self) = nullptr;

  Scene (*new_scene)(Device) = nullptr;
  void (*release_scene)(Scene) = nullptr;
  void (*set_scene_quality)(Scene, Quality) = nullptr;
  void (*set_scene_flags)(Scene, SceneFlag) = nullptr;
  void (*attach)(Scene, Geometry, unsigned id) = nullptr;
  void (*commit_scene)(Scene) = nullptr;

  Geometry (*new_geometry)(Device, GeometryType) = nullptr;
  void (*release_geometry)(Geometry) = nullptr;
  void (*set_geometry_quality)(Geometry, Quality) = nullptr;
  void (*share_buffer)(Geometry, Buffer, unsigned slot, Format, const void* data,
                       std::size_t offset_bytes, std::size_t stride_bytes,
                       std::size_t count) = nullptr;
  void (*set_instanced_scene)(Geometry, Scene) = nullptr;
  void (*set_transform)(Geometry, unsigned time_step, Format, const void* matrix) = nullptr;
  void (*commit_geometry)(Geometry) = nullptr;

  Queries<RayHits> intersect;
  Queries<Rays> occluded;

  /// 3 or 4, known once a device exists.
  int major_version = 0;
};

}  // namespace raysheaf::app::embree
