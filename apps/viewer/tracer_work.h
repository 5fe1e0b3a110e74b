// What the tracer's thread owns. Not for use by two threads at once.
#pragma once

#include <chrono>
#include <functional>
#include <memory>

#include "tracer.h"

namespace raysheaf::viewer {

/// Whether to give up, asked now and then with the milliseconds since the beginning.
using Unwanted = std::function<bool(double)>;

/// Makes pictures of one scene.
class PictureMaker {
 public:
  using Show = std::function<void(std::shared_ptr<Picture>)>;

  /// Adds a camera and a light where there are none.
  void show(SceneDescription scene);
  [[nodiscard]] bool has_scene() const { return scene_ != nullptr; }
  [[nodiscard]] const SceneDescription& scene() const { return *scene_; }
  /// The scene as `request` lights it.
  [[nodiscard]] SceneDescription lit_copy(const ViewRequest& request) const;

  /// One picture, or where `request.refine` says so one after the other, of ever more samples, to
  /// `shown`. False where it was given up; `shown` may then have had some. Throws `Error`.
  bool make(const ViewRequest& request, const Unwanted& unwanted, const Show& shown);

 private:
  [[nodiscard]] std::vector<Light> lit(const ViewRequest& request) const;
  [[nodiscard]] bool add_sample(const ViewRequest& request, const Unwanted& unwanted);
  [[nodiscard]] RenderResult render_side(const ViewRequest& request, const MethodChoice& choice,
                                         const Camera& camera, const Unwanted& unwanted);
  [[nodiscard]] std::shared_ptr<Picture> picture(const ViewRequest& request);

  std::unique_ptr<SceneDescription> scene_;
  std::vector<Light> lights_;  ///< the scene's own
  Box bounds_;
  Accumulator sides_[2];
  double sample_ms_ = 0;
  float exposure_ = 0;  ///< of the last picture that stood; 0: none yet
};

class Tracer::Work {
 public:
  PictureMaker pictures;

  [[nodiscard]] BundleAnswer answer(const BundleQuestion& question);
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
