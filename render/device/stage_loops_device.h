// The stages of a frame as loops over its fragments. For sources that include a device. The work
// for an item is in body functions that the CPU's stages also call.
#pragma once

#include "exec/atomic.h"
#include "exec/device.h"
#include "intersect/triangle_body.h"
#include "queries/planned_queries.h"
#include "render/device/frame_stages.h"
#include "render/device/staged_scene.h"
#include "render/rays/camera_body.h"
#include "render/rays/hash_body.h"
#include "render/rays/light_body.h"
#include "render/rays/offset_body.h"
#include "render/rays/scatter_body.h"
#include "render/shade/shade.h"
#include "render/shade/shade_body.h"

namespace raysheaf {

/// An image's sums on a device, for each pixel.
struct DeviceFilm {
  Vec3 *beauty, *position, *normal, *albedo, *specular;
  std::uint32_t *triangle, *faced, *arrived;
};

template <class Device>
void camera_rays_on(Device& device, CameraFrame frame, Box bounds, Ray* rays, std::uint32_t* keys) {
  const std::size_t count = std::size_t{frame.width} * frame.height;
  device.for_each("raygen: camera", count, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const Ray ray = camera_ray(frame, static_cast<std::uint32_t>(i % frame.width),
                               static_cast<std::uint32_t>(i / frame.width));
    rays[i] = ray;
    if (keys != nullptr) keys[i] = bounce_key(bounds, ray.origin, ray.direction);
  });
}

template <class Device>
void triangles_of_hits_on(Device& device, View<const IndexedHit> hits, std::uint32_t* triangles) {
  device.for_each("surfaces: names", hits.size,
                  [=] RAYSHEAF_DEVICE(std::size_t i) { triangles[i] = hits.data[i].triangle; });
}

/// The counterpart of `fetch_fragments` (render/frame/primary.h).
template <class Device>
void first_fragments_on(Device& device, StagedSceneView scene, CameraFrame frame,
                        const std::uint32_t* triangles, View<Fragment> out) {
  device.for_each("surfaces: first", out.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    Fragment f;
    f.pixel = static_cast<std::uint32_t>(i);
    f.triangle = triangles[i];
    const Ray ray = camera_ray(frame, f.pixel % frame.width, f.pixel / frame.width);
    f.incoming = normalized(ray.direction);
    if (f.triangle != kInvalidId) {
      const Vec3* const corner = scene.corners.data + std::uint64_t{3} * f.triangle;
      const Vec2 uv = clamped_barycentrics(ray, corner[0], corner[1], corner[2]);
      f.surface = staged_surface(scene, f.triangle, uv.x, uv.y, f.incoming);
    }
    out.data[i] = f;
  });
}

/// The counterpart of `Film::see`.
template <class Device>
void see_on(Device& device, View<const Fragment> first_hits, bool first, DeviceFilm film) {
  device.for_each("surfaces: film", first_hits.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const Fragment& f = first_hits.data[i];
    if (first) film.triangle[i] = f.triangle;
    if (f.triangle == kInvalidId) return;
    if (first) film.position[i] = f.surface.position;
    film.normal[i] += f.surface.normal;
    film.albedo[i] += f.surface.diffuse + f.surface.specular;
    film.specular[i] += f.surface.specular;
  });
}

/// As `sky_parts` (render/shade/shade.h).
template <class Device>
void sky_parts_on(Device& device, View<const Fragment> fragments, View<const PlacedLight> lights,
                  View<SkyPart> parts) {
  device.for_each("shade: sky", parts.size, [=] RAYSHEAF_DEVICE(std::size_t p) {
    SkyPart part;
    const std::size_t end =
        (p + 1) * kSkyPart < fragments.size ? (p + 1) * kSkyPart : fragments.size;
    for (std::size_t i = p * kSkyPart; i < end; ++i) {
      const Fragment& f = fragments.data[i];
      if (f.triangle == kInvalidId) continue;
      ++part.covered;
      for (std::size_t l = 0; l < lights.size; ++l)
        part.sum += double{unoccluded(f, sample_light(lights.data[l], f.surface.position))};
    }
    parts.data[p] = part;
  });
}

/// `shade_glow`; an environment without radiance counts as none. `going_on` may be null.
template <class Device>
void glow_on(Device& device, View<const Fragment> fragments, const GlowInput& input,
             EnvironmentView environment, Vec3* radiance, std::uint8_t* going_on) {
  device.for_each("shade: glow", fragments.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const Fragment& f = fragments.data[i];
    const bool in_room = input.room.white > 0;
    if (f.triangle == kInvalidId) {
      radiance[i] = environment.radiance != nullptr ? environment_radiance(environment, f.incoming)
                    : in_room && !input.behind      ? studio_radiance(input.room, f.incoming, 0)
                                                    : input.sky;
      if (going_on != nullptr) going_on[i] = 0;
      return;
    }
    const Scattering s = scatter(f);
    const std::uint32_t rays = rays_of(f, s) & input.traced;
    if (going_on != nullptr) going_on[i] = static_cast<std::uint8_t>(rays);
    radiance[i] = glow(f, s, input.sky, rays);
    if (environment.radiance != nullptr) {
      radiance[i] += environment_glow(f, s, environment, rays);
    } else if (in_room) {
      radiance[i] += room_glow(f, s, input.sky, input.room, rays);
    }
  });
}

/// `accumulate` (render/shade/shade.h).
template <class Device>
void deposit_on(Device& device, View<const Fragment> fragments, const Vec3* radiance,
                Vec3* pixels) {
  device.for_each("shade: pixels", fragments.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const std::uint32_t pixel = fragments.data[i].pixel;
    if (i > 0 && fragments.data[i - 1].pixel == pixel) return;
    Vec3 sum = pixels[pixel];
    for (std::size_t j = i; j < fragments.size && fragments.data[j].pixel == pixel; ++j)
      sum += fragments.data[j].weight * radiance[j];
    pixels[pixel] = sum;
  });
}

template <class Device>
void flag_kind_on(Device& device, View<const std::uint8_t> going_on, std::uint32_t bit,
                  std::uint8_t* flags) {
  device.for_each("raygen: bounce", going_on.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    flags[i] = (going_on.data[i] & bit) != 0 ? 1 : 0;
  });
}

/// Rays of one kind, the factor with which their radiance is added to their pixels, and keys or
/// null.
struct BounceRays {
  Ray* rays;
  Vec3* weights;
  std::uint32_t* keys;
};

template <class Device>
void bounce_rays_on(Device& device, View<const Fragment> fragments, View<const std::uint32_t> slots,
                    RayKind kind, Box bounds, BounceRays out) {
  device.for_each("raygen: bounce", slots.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const Fragment& f = fragments.data[slots.data[i]];
    const Bounce b = bounce(f, kind);
    const Vec3 origin = offset_point(f.surface, b.direction, 0);
    out.weights[i] = f.weight * b.part;
    out.rays[i] = {origin, 0, b.direction, std::numeric_limits<float>::infinity()};
    if (out.keys != nullptr) out.keys[i] = bounce_key(bounds, origin, b.direction);
  });
}

/// The arrays of a bounce on a device.
struct Bounced {
  View<const std::uint32_t> slots;
  const Ray* rays;
  const Vec3* weights;
  const IndexedHit* hits;
  std::uint32_t kind;
};

template <class Device>
void arrived_on(Device& device, StagedSceneView scene, View<const Fragment> fragments,
                Bounced bounced, Fragment* out) {
  device.for_each("surfaces: bounce", bounced.slots.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const Fragment& from = fragments.data[bounced.slots.data[i]];
    const IndexedHit hit = bounced.hits[i];
    Fragment f;
    f.weight = bounced.weights[i];
    f.pixel = from.pixel;
    f.path = mixed_seed(from.path, bounced.kind);
    f.incoming = bounced.rays[i].direction;
    f.triangle = hit.triangle;
    if (f.triangle != kInvalidId)
      f.surface = staged_surface(scene, f.triangle, hit.u, hit.v, f.incoming);
    out[i] = f;
  });
}

/// Writes the pixels of `a`, then of `b`, and their places, for sorting.
template <class Device>
void pixels_of_both_on(Device& device, View<const Fragment> a, View<const Fragment> b,
                       std::uint32_t* pixels, std::uint32_t* places) {
  device.for_each("order: fragments", a.size + b.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    pixels[i] = i < a.size ? a.data[i].pixel : b.data[i - a.size].pixel;
    places[i] = static_cast<std::uint32_t>(i);
  });
}

template <class Device>
void merge_on(Device& device, View<const Fragment> a, View<const Fragment> b,
              const std::uint32_t* places, Fragment* out) {
  device.for_each("order: fragments", a.size + b.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const std::size_t from = places[i];
    out[i] = from < a.size ? a.data[from] : b.data[from - a.size];
  });
}

/// The tests of each ray of a batch: an array, or, if that is null, one number for all.
struct RayTests {
  const float* each = nullptr;
  std::uint64_t all = 0;
};

/// Adds the tests to their pixels. `slots`: each ray's fragment, plus the number of fragments times
/// its light, or its pixel if there are no fragments; without slots, the rays are those of the
/// pixels.
template <class Device>
void add_tests_on(Device& device, View<const Fragment> fragments, View<const std::uint32_t> slots,
                  RayTests tests, View<std::uint64_t> pixels) {
  const std::size_t rays = slots.empty() ? pixels.size : slots.size;
  device.for_each("count: pixels", rays, [=] RAYSHEAF_DEVICE(std::size_t i) {
    std::size_t pixel = slots.empty() ? i : slots.data[i];
    if (!fragments.empty()) pixel = fragments.data[pixel % fragments.size].pixel;
    add_to(pixels.data + pixel,
           tests.each != nullptr ? static_cast<std::uint64_t>(tests.each[i]) : tests.all);
  });
}

/// Adds the number of actual hits among `hits` to `*sum`; each thread counts sixty-four.
template <class Device>
void count_found_on(Device& device, View<const IndexedHit> hits, std::uint64_t* sum) {
  device.for_each("count", (hits.size + 63) / 64, [=] RAYSHEAF_DEVICE(std::size_t block) {
    std::uint64_t found = 0;
    for (std::size_t i = 64 * block; i < hits.size && i < 64 * (block + 1); ++i)
      found += hits.data[i].triangle != kInvalidId ? 1 : 0;
    add_to(sum, found);
  });
}
template <class Device>
void occluded_by_hits_on(Device& device, View<const IndexedHit> hits, std::uint8_t* occluded) {
  device.for_each("trace: any hits", hits.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    occluded[i] = hits.data[i].triangle != kInvalidId ? 1 : 0;
  });
}
template <class Device>
void count_occluded_on(Device& device, View<const std::uint8_t> occluded, std::uint64_t* sum) {
  device.for_each("count", (occluded.size + 63) / 64, [=] RAYSHEAF_DEVICE(std::size_t block) {
    std::uint64_t found = 0;
    for (std::size_t i = 64 * block; i < occluded.size && i < 64 * (block + 1); ++i)
      found += occluded.data[i] != 0 ? 1 : 0;
    add_to(sum, found);
  });
}

}  // namespace raysheaf
