// What is rendered, wherever its triangles are: in memory, or in blocks that stream past the rays.
#pragma once

#include <memory>
#include <optional>

#include "options.h"
#include "raysheaf/checkpoint.h"
#include "raysheaf/distributed.h"
#include "raysheaf/renderer.h"
#include "raysheaf/stream.h"

namespace raysheaf::app {

/// A picture, and what was made for it.
struct Staged {
  RenderResult picture;
  std::optional<UpdateStatistics> update;  ///< of what is in memory
  std::optional<StreamStatistics> stream;  ///< of what streams
};

class Stage {
 public:
  Stage() = default;
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;
  virtual ~Stage() = default;

  /// As `Renderer::show`, but cameras and lights are those of the call.
  void show(const SceneDescription& scene) {
    SceneChanges all;
    all.everything = true;
    show(scene, all);
  }
  virtual void show(const SceneDescription& scene, const SceneChanges& changes) = 0;
  /// As `Renderer::render`; from the scene's own camera where none is given.
  [[nodiscard]] virtual Staged render(const RenderOptions& options,
                                      const std::optional<Camera>& camera) = 0;
};

/// `ranks`: with whom each picture is shared; null for none. `blocks`: a file's, which the shown
/// scenes describe; null where those have their triangles, and then what streams is cut anew
/// wherever any have changed. `checkpoint`: of a streamed picture, may be null. All outlive it.
[[nodiscard]] std::unique_ptr<Stage> make_stage(const RenderCommand& command,
                                                const std::shared_ptr<Communicator>& ranks,
                                                const GeometrySource* blocks,
                                                StreamCheckpoint* checkpoint);

}  // namespace raysheaf::app
