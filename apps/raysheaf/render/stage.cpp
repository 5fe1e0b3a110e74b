#include "render/stage.h"

#include <set>
#include <utility>

#include "apps/support/console.h"
#include "apps/support/stoppable_sink.h"
#include "ranks/ranks.h"
#include "raysheaf/context.h"
#include "raysheaf/error.h"
#include "render/stream.h"

namespace raysheaf::app {
namespace {

/// Returns the result of `work`. A scene that was valid in its file may become invalid over time:
/// errors then name the file here too, before the place in the scene.
template <class Work>
auto naming_scene(const std::string& name, const Work& work) {
  try {
    return work();
  } catch (const Error& error) {
    const std::string& place = error.place();
    const bool of_scene = error.code() == ErrorCode::kInvalidData &&
                          (place.empty() || place.find('[') != std::string::npos);
    if (!of_scene) throw;
    throw Error(error.code(), error.sentence(), place.empty() ? name : name + ": " + place);
  }
}

class ResidentStage final : public Stage {
 public:
  ResidentStage(const Context& context, std::string name)
      : renderer_(context), name_(std::move(name)) {}

  void show(const SceneDescription& scene, const SceneChanges& changes) override {
    renderer_.show(scene, changes);
  }

  Staged render(const RenderOptions& options, const std::optional<Camera>& camera) override {
    Staged staged;
    staged.picture = naming_scene(name_, [&] {
      return camera ? renderer_.render(options, *camera) : renderer_.render(options);
    });
    staged.update = renderer_.last_update();
    return staged;
  }

 private:
  Renderer renderer_;
  std::string name_;  ///< of the scene
};

class StreamedStage final : public Stage {
 public:
  StreamedStage(const RenderCommand& command, Communicator* ranks, const GeometrySource* blocks,
                StreamCheckpoint* checkpoint)
      : context_({command.device, command.options.threads}),
        file_(blocks),
        name_(command.scene),
        quiet_(command.quiet) {
    stream_.context = &context_;
    stream_.memory_bytes = command.memory_bytes;
    stream_.checkpoint = checkpoint;
    if (ranks == nullptr) return;
    exchange_ = make_hit_exchange(*ranks);
    stream_.exchange = exchange_.get();
    stream_.part = ranks->rank();
    stream_.parts = ranks->size();
  }

  void show(const SceneDescription& scene, const SceneChanges& changes) override {
    if (file_ != nullptr) {
      if (changes.everything) scene_ = scene;
    } else if (!changes.empty()) {
      cut_ = std::make_unique<BlockList>();
      StoppableSink sink(cut_.get());
      scene_ = naming_scene(name_, [&] { return cut_into_blocks(scene, &sink); });
      for (std::size_t i = scene.warnings.size(); i < scene_.warnings.size(); ++i)
        if (told_.insert(scene_.warnings[i]).second && !quiet_)
          tell("warning: " + printable(scene_.warnings[i]));
    }
    scene_.cameras = scene.cameras;
    scene_.lights = scene.lights;
  }

  Staged render(const RenderOptions& options, const std::optional<Camera>& camera) override {
    RenderOptions own = options;
    own.primary = Primary::kTrace;
    if (camera) {
      scene_.cameras = {*camera};
      own.camera.clear();
    }
    Staged staged;
    stream_.statistics = &staged.stream.emplace();
    const GeometrySource& blocks = file_ != nullptr ? *file_ : *cut_;
    staged.picture = raysheaf::render(BlocksInScene(blocks, scene_), own, stream_);
    return staged;
  }

 private:
  Context context_;
  const GeometrySource* file_;
  const std::string name_;  ///< of the scene
  const bool quiet_;
  std::unique_ptr<BlockList> cut_;  ///< of a scene without a block file
  SceneDescription scene_;          ///< without triangles
  std::set<std::string> told_;      ///< warnings of cutting that were reported
  std::unique_ptr<HitExchange> exchange_;
  StreamOptions stream_;
};

}  // namespace

std::unique_ptr<Stage> make_stage(const RenderCommand& command,
                                  const std::shared_ptr<Communicator>& ranks,
                                  const GeometrySource* blocks, StreamCheckpoint* checkpoint) {
  if (is_streamed(command))
    return std::make_unique<StreamedStage>(command, ranks.get(), blocks, checkpoint);
  return std::make_unique<ResidentStage>(context_of(command, ranks), command.scene);
}

SceneChanges seek_for(const RenderCommand& command, Animation& animation, double seconds) {
  const bool moves_there = command.device == Device::kCuda && !is_streamed(command);
  return moves_there ? animation.seek_poses(seconds) : animation.seek(seconds);
}

}  // namespace raysheaf::app
