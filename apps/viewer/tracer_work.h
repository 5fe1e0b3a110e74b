// What the tracer's thread owns. Not for use by two threads at once.
#pragma once

#include <chrono>
#include <functional>
#include <memory>

#include "raysheaf/renderer.h"
#include "tracer.h"

namespace raysheaf::viewer {

/// Whether to give up, asked now and then with the milliseconds since the beginning.
using Unwanted = std::function<bool(double)>;

/// Makes pictures of one scene at any time, under other lights and from other places than its own.
class PictureMaker {
 public:
  using Show = std::function<void(std::shared_ptr<Picture>)>;

  /// Adds a camera and a light where there are none.
  void show(std::unique_ptr<Animation> animation);
  [[nodiscard]] bool has_scene() const { return animation_ != nullptr; }
  [[nodiscard]] const SceneDescription& scene() const { return animation_->scene(); }
  [[nodiscard]] SceneFacts facts();
  /// The scene at the time of `request`, as it lights it.
  [[nodiscard]] SceneDescription posed_copy(const ViewRequest& request);

  /// One picture, or where `request.refine` says so one after the other, of ever more samples, to
  /// `shown`. False where it was given up; `shown` may then have had some. Throws `Error`.
  bool make(const ViewRequest& request, const Unwanted& unwanted, const Show& shown);

 private:
  void pose(const ViewRequest& request);
  [[nodiscard]] RenderResult render_side(RenderOptions options, const Camera& camera);
  void refine(const ViewRequest& request, RenderOptions left, const Show& shown);
  void refine_split(const ViewRequest& request, RenderOptions left, RenderOptions right,
                    const Show& shown);
  /// `right`: null without a split.
  [[nodiscard]] std::shared_ptr<Picture> picture(const ViewRequest& request,
                                                 const RenderResult& left,
                                                 const RenderResult* right);

  std::unique_ptr<Animation> animation_;
  Renderer renderer_;
  std::vector<Light> lights_;  ///< the scene's own, as its animation left them
  double time_s_ = 0;
  std::uint32_t clip_ = 0;
  Box bounds_;
  bool rasters_ = true;  ///< there is an OpenGL for first hits
  float exposure_ = 0;   ///< of the last picture that stood; 0: none yet
};

class Tracer::Work {
 public:
  PictureMaker pictures;

  /// None where there is no scene yet, or the pixel has no ray. Throws as `Laboratory` does.
  [[nodiscard]] std::optional<RayBundle> bundle(const BundleQuestion& question);
  void forget_bundles() { laboratory_.reset(); }

 private:
  std::unique_ptr<Laboratory> laboratory_;
  BundleQuestion asked_;  ///< what `laboratory_` was made for
};

class Watch {
 public:
  [[nodiscard]] double ms() const {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_)
        .count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace raysheaf::viewer
