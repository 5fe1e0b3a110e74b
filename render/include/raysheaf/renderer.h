// Renders images of a scene that changes between them.
//
//   raysheaf::Renderer renderer;
//   renderer.show(scene);
//   for (;;) {
//     raysheaf::RenderResult image = renderer.render(options);
//     scene.instances[3].to_world = ...;
//     renderer.show(scene, {.moved = {3}});
//   }
//
// An image costs only what has changed: bounding spheres of meshes follow their transforms, meshes
// that keep their shape are not bounded again, triangles that do not move are not transformed
// again, and the object tree of `dual` is refitted for the triangles that have moved.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "raysheaf/context.h"
#include "raysheaf/render.h"
#include "raysheaf/scene_changes.h"

namespace raysheaf {

/// The work that the scene's changes since the previous image caused. The first image computes
/// everything.
struct UpdateStatistics {
  std::uint64_t moved_instances = 0;   ///< with a different transform
  std::uint64_t deformed_meshes = 0;   ///< with moved vertices
  std::uint64_t replaced_meshes = 0;   ///< new meshes
  std::uint64_t rebound_meshes = 0;    ///< whose bounding sphere was computed
  std::uint64_t placed_triangles = 0;  ///< transformed to world space
  /// What happened to the hierarchy over the triangles: "none" if the image needed none, "kept",
  /// "refit", "coarse rebuild", "rebuild" or "fine rebuild".
  std::string tree = "none";
  double tree_ms = 0;   ///< included in the batches' `hierarchy`
  double bound_ms = 0;  ///< bounding spheres of meshes
  double place_ms = 0;  ///< triangles to world space
};

/// The JSON object that docs/animation.md describes, on one line.
[[nodiscard]] std::string to_json(const UpdateStatistics& update);

/// Owns the OpenGL context, the hierarchies and all memory that images share. Movable, not
/// copyable. Any thread may call it, one at a time.
class Renderer {
 public:
  Renderer();
  /// Uses the context's threads and device, as `render(context, ...)` of
  /// raysheaf/render.h.
  explicit Renderer(const Context& context);
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  /// Sets a new scene. Each `render` reads it, without a copy: it must stay at its address.
  void show(const SceneDescription& scene);
  /// Sets the current scene again, or a copy of it at another address, in which since the last
  /// `show` only the things that `changes` names, cameras and lights have changed. Does no work:
  /// the next image does it. If that image throws anything except kCancelled, the one after it
  /// computes everything again.
  void show(const SceneDescription& scene, const SceneChanges& changes);

  /// Returns the image of `raysheaf::render`, bit for bit. Throws as `raysheaf::render` does, and
  /// kWrongState without a scene.
  [[nodiscard]] RenderResult render(const RenderOptions& options = {});
  /// The same with a camera that need not be in the scene; `RenderOptions::camera` is ignored.
  [[nodiscard]] RenderResult render(const RenderOptions& options, const Camera& camera);
  /// The work of the last image.
  [[nodiscard]] const UpdateStatistics& last_update() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace raysheaf
