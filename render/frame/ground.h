// The shadow on a ground (`RenderOptions::ground`): darkens the background of a finished image.
//
// The plane is lit twice with the samples and the lights of the image, with shadows and without.
// Only samples that do not see the scene, but the plane, count:
//
//   background  ── * ──►  image                luminance with shadows
//                  ▲                   r  =  ───────────────────────────
//                  r                           luminance without shadows
//
// Rays that meet the scene or leave it know nothing of the plane, so the rest of the image keeps
// its bits.
#pragma once

#include "exec/executor.h"
#include "raysheaf/render.h"
#include "render/frame/frame.h"

namespace raysheaf {

/// The ground with its height. `bounds`: of the scene; throws `Error` (kInvalidData, place
/// "ground") if it has no extent.
[[nodiscard]] Ground placed_ground(Ground ground, const Box& bounds);

/// The options with which the ground of an image is lit: on the CPU, by rays, by `dual`.
[[nodiscard]] RenderOptions ground_options(const RenderOptions& of_image,
                                           const RenderResult& image);

/// Darkens `image`, and sets its `ground`. `input`: that of the image, with `ground_options` and a
/// geometry for these. `ground`: with its height.
void add_ground(const Executor& executor, const FrameInput& input, const Ground& ground,
                RenderResult* image);

}  // namespace raysheaf
