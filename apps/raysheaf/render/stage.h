// Renders scenes whose triangles are in memory, or in blocks that stream past the rays.
#pragma once

#include <memory>
#include <optional>

#include "options.h"
#include "raysheaf/animation.h"
#include "raysheaf/block_file.h"
#include "raysheaf/distributed.h"
#include "raysheaf/renderer.h"
#include "raysheaf/stream.h"

namespace raysheaf::app {

/// An image, and statistics about it.
struct Staged {
  RenderResult picture;
  std::optional<UpdateStatistics> update;  ///< of a scene in memory
  std::optional<StreamStatistics> stream;  ///< of a streamed scene
};

class Stage {
 public:
  Stage() = default;
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;
  virtual ~Stage() = default;

  /// As `Renderer::show`, but cameras and lights are those of each call.
  void show(const SceneDescription& scene) {
    SceneChanges all;
    all.everything = true;
    show(scene, all);
  }
  virtual void show(const SceneDescription& scene, const SceneChanges& changes) = 0;
  /// As `Renderer::render`; without `camera`, the scene's own camera is used.
  [[nodiscard]] virtual Staged render(const RenderOptions& options,
                                      const std::optional<Camera>& camera) = 0;
};

/// `ranks`: the processes that share each image; null for a single process. `blocks`: the blocks of
/// a file, which the shown scenes describe; null if those contain their triangles, which are then
/// cut into blocks again after every change. `checkpoint`: of a streamed image, may be null. All of
/// them must outlive the result.
[[nodiscard]] std::unique_ptr<Stage> make_stage(const RenderCommand& command,
                                                const std::shared_ptr<Communicator>& ranks,
                                                const GeometrySource* blocks,
                                                StreamCheckpoint* checkpoint);

/// Brings the animation to a time, for the stage of the command: vertices that a device moves by
/// itself are left to it.
[[nodiscard]] SceneChanges seek_for(const RenderCommand& command, Animation& animation,
                                    double seconds);

}  // namespace raysheaf::app
