// The paper's four targets: what each corner of a triangle brings, and which triangle the texels of
// a pixel name.
//
//   target      x, y, z                                   w
//   position    where the surface is, world               slot, its low 24 bits; -1: nothing
//   normal      unit shading normal, world                slot, its high 8 bits
//   diffuse     reflectance                               1; 0: nothing
//   specular    reflectance along the normal              1; 0: nothing
//
// Both parts of a slot are whole numbers that binary32 has exactly, and no denormal ones.
#pragma once

#include <cstdint>

#include "base/host_device.h"
#include "base/vec.h"
#include "render/rays/camera_body.h"
#include "render/surface/surface.h"

namespace raysheaf {

inline constexpr std::uint32_t kGbufferTargets = 4;

/// A corner, with the values that OpenGL interpolates.
struct GbufferCorner {
  Vec3 from_eye;  ///< the corner, relative to the eye
  Vec3 normal, diffuse, specular;
};

/// The direction of a ray to a triangle with this first corner; exact enough to tell its side.
RAYSHEAF_HD inline Vec3 sight_of_triangle(const CameraFrame& frame, Vec3 first_corner) {
  return frame.orthographic ? frame.forward : first_corner - frame.eye;
}

/// `surface_at(k)`: the surface in corner k, as who sees the triangle meets it.
template <class SurfaceAt>
RAYSHEAF_HD inline void make_gbuffer_corners(const Vec3 (&corner)[3], Vec3 eye,
                                             const SurfaceAt& surface_at, GbufferCorner* out) {
  for (int k = 0; k < 3; ++k) {
    const Surface surface = surface_at(k);
    out[k] = {corner[k] - eye, surface.normal, surface.diffuse, surface.specular};
  }
}

/// `position_w`, `normal_w`: of one pixel.
RAYSHEAF_HD inline std::uint32_t slot_of_texels(float position_w, float normal_w) {
  if (!(position_w >= 0)) return kInvalidId;
  return static_cast<std::uint32_t>(position_w) | static_cast<std::uint32_t>(normal_w) << 24;
}

}  // namespace raysheaf
