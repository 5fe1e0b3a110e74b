// Solids and surfaces that are added to a mesh. All except `add_quad`, `add_surface` and open
// lathes and sweeps are closed. Texture coordinates are in metres unless stated otherwise.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "scenes/builder.h"
#include "scenes/outline.h"

namespace raysheaf::builtin {

/// A flat parallelogram whose front shows `cross(u, v)`; its texture coordinates range from (0, 1)
/// at `corner` to (1, 0) opposite, times `uv_scale`.
void add_quad(MeshBuilder& builder, Vec3 corner, Vec3 u, Vec3 v, Vec2 uv_scale = {1, 1});

/// Twelve triangles. The texture's u axis is along the longest edge.
void add_box(MeshBuilder& builder, Vec3 min, Vec3 max);

/// A box whose edges and corners are rounded in `steps` steps. 44 triangles for one step.
void add_rounded_box(MeshBuilder& builder, Vec3 min, Vec3 max, float radius, int steps = 1);

/// Turns a profile of (radius, height) about the y axis. The outside is on the right along the
/// profile; corners sharper than 40 degrees stay sharp. Texture coordinates: turns, metres.
void add_lathe(MeshBuilder& builder, std::span<const Vec2> profile, int segments);

/// `2 * segments * (rings - 1)` triangles.
void add_sphere(MeshBuilder& builder, Vec3 center, float radius, int segments, int rings);

/// Along y, with both discs.
void add_cylinder(MeshBuilder& builder, Vec3 bottom, float radius, float height, int segments);

/// The image of the unit square. The front shows `cross(df/du, df/dv)`. With `closed_u` the last
/// column is the first. Texture coordinates: (u, v).
void add_surface(MeshBuilder& builder, int columns, int rows,
                 const std::function<Vec3(float, float)>& f, bool closed_u = false);

/// The positions of a swept outline: in the x-y plane of each frame, which advances along its +z.
using Path = std::vector<Affine>;

enum class Ends { kOpen, kCapped, kJoined };

/// Moves a counter-clockwise outline along a path. Caps need a convex outline. Corners of the
/// outline sharper than 40 degrees stay sharp; along the path it is smooth.
void add_sweep(MeshBuilder& builder, std::span<const Vec2> outline, const Path& path,
               Ends ends = Ends::kCapped);

/// A convex outline in the x-y plane, from z = 0 to `depth`.
void add_prism(MeshBuilder& builder, std::span<const Vec2> outline, float depth);

/// A round rod along points; the radius changes linearly from the first to the last.
void add_tube(MeshBuilder& builder, std::span<const Vec3> points, float first_radius,
              float last_radius, int sides);

/// Four mitred mouldings around a rectangle of `width` by `height`, on z = 0 and centred at the
/// origin. The outline is (distance from the rectangle's edge, height above the wall), clockwise.
void add_moulding(MeshBuilder& builder, float width, float height, std::span<const Vec2> outline);

/// Points of a circle's arc about the z axis, in degrees.
[[nodiscard]] std::vector<Vec3> arc(Vec3 center, float radius, float from, float to, int steps);

/// Frames along points that turn as little as possible (parallel transport).
[[nodiscard]] Path path_along(std::span<const Vec3> points);

}  // namespace raysheaf::builtin
