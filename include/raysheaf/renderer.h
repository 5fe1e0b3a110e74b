// Pictures of a scene that changes from one to the next.
//
//   raysheaf::Renderer renderer;
//   renderer.show(scene);
//   for (;;) {
//     raysheaf::RenderResult picture = renderer.render(options);
//     scene.instances[3].to_world = ...;
//     renderer.show(scene, {.moved = {3}});
//   }
//
// A frame costs what has changed: spheres of meshes follow their transforms, meshes that keep their
// shape are not bounded again, triangles that stay are not placed again, and the object tree of
// `dual` is refitted where the same triangles have moved.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "raysheaf/context.h"
#include "raysheaf/render.h"
#include "raysheaf/scene_changes.h"

namespace raysheaf {

/// What the scene's changes since the picture before cost. A first picture makes everything.
struct UpdateStatistics {
  std::uint64_t moved_instances = 0;   ///< that have another transform
  std::uint64_t deformed_meshes = 0;   ///< whose vertices moved
  std::uint64_t replaced_meshes = 0;   ///< that are other ones
  std::uint64_t rebound_meshes = 0;    ///< whose minimum ball was computed
  std::uint64_t placed_triangles = 0;  ///< that went to world space
  /// What became of the hierarchy over the triangles: "none" where the frame needed none, "kept",
  /// "refit", "rebuild" or "fine rebuild".
  std::string tree = "none";
  double tree_ms = 0;   ///< within the batches' `hierarchy`
  double bound_ms = 0;  ///< minimum balls
  double place_ms = 0;  ///< triangles to world space
};

/// The JSON object that docs/animation.md describes, on one line.
[[nodiscard]] std::string to_json(const UpdateStatistics& update);

/// Owns the OpenGL context, the hierarchies and all memory that pictures share. Movable, not
/// copyable. One call at a time, from any thread.
class Renderer {
 public:
  Renderer();
  /// On its threads and its device: as `render(context, ...)` of raysheaf/render_on_context.h.
  explicit Renderer(const Context& context);
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  /// The scene from now on, of which nothing is known yet. It is read by each `render`, not copied:
  /// it must stay where it is.
  void show(const SceneDescription& scene);
  /// The scene that is shown already, or a copy of it elsewhere, in which what `changes` names is
  /// another since the last `show`, and nothing else but cameras and lights. Does no work: the next
  /// picture does it. Where that one throws anything but kCancelled, the one after it makes
  /// everything anew.
  void show(const SceneDescription& scene, const SceneChanges& changes);

  /// The picture that `raysheaf::render` gives, bit for bit. Throws as `raysheaf::render` does, and
  /// kWrongState where no scene is shown.
  [[nodiscard]] RenderResult render(const RenderOptions& options = {});
  /// From another point of view than the scene's own; `RenderOptions::camera` does not count.
  [[nodiscard]] RenderResult render(const RenderOptions& options, const Camera& camera);
  /// What the last picture made anew.
  [[nodiscard]] const UpdateStatistics& last_update() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace raysheaf
