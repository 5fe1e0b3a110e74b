// The data of the tracer's thread. Only one thread may use it.
#pragma once

#include <chrono>
#include <functional>
#include <memory>

#include "raysheaf/backdrop.h"
#include "raysheaf/renderer.h"
#include "tracer.h"

namespace raysheaf::viewer {

/// Whether to give up; called from time to time with the milliseconds since the beginning.
using Unwanted = std::function<bool(double)>;

/// Makes images of one scene at any time, with lights and viewpoints that may differ from its own.
class PictureMaker {
 public:
  using Show = std::function<void(std::shared_ptr<Picture>)>;

  /// Adds a camera and a light if there are none.
  void show(std::unique_ptr<Animation> animation);
  [[nodiscard]] bool has_scene() const { return animation_ != nullptr; }
  [[nodiscard]] const SceneDescription& scene() const { return animation_->scene(); }
  [[nodiscard]] SceneFacts facts();
  /// The scene as it is posed, for OpenGL.
  [[nodiscard]] std::shared_ptr<const PreviewMesh> mesh();
  /// The same at the time of `request`; null if the last one that was made has this time.
  [[nodiscard]] std::shared_ptr<const PreviewMesh> new_mesh(const ViewRequest& request);
  /// The scene at the time of `request`, with its lights.
  [[nodiscard]] SceneDescription posed_copy(const ViewRequest& request);

  /// The exposure that an image of `request` has although its own would differ, because only the
  /// time has changed since the exposure was chosen: an animation does not flicker, nor does it
  /// change its brightness where it is stopped.
  [[nodiscard]] std::optional<float> kept_exposure(const ViewRequest& request) const;
  /// Gives all images this exposure, until another scene is shown.
  void fix_exposure(float exposure);

  /// Passes one image to `shown`, or with `request.refine` a series of images with growing numbers
  /// of samples. Returns false if it was given up; `shown` may have been called before that. Throws
  /// `Error`.
  bool make(const ViewRequest& request, const Unwanted& unwanted, const Show& shown);

 private:
  void pose(const ViewRequest& request);
  [[nodiscard]] RenderResult render_side(RenderOptions options, const Camera& camera);
  static std::function<bool(const RenderResult&)> watched(const ViewRequest& request,
                                                          std::optional<Backdrop>& backdrop,
                                                          RenderOptions* options);
  void refine(const ViewRequest& request, RenderOptions left, const Show& shown);
  void refine_split(const ViewRequest& request, RenderOptions left, RenderOptions right,
                    const Show& shown);
  /// `right`: null without a split.
  [[nodiscard]] std::shared_ptr<Picture> picture(const ViewRequest& request,
                                                 const RenderResult& left,
                                                 const RenderResult* right);

  std::unique_ptr<Animation> animation_;
  Renderer renderer_;
  std::vector<Light> lights_;  ///< the scene's own lights, as its animation left them
  double time_s_ = 0;
  std::uint32_t clip_ = 0;
  Box bounds_;
  std::optional<std::size_t> automatic_camera_;
  bool rasters_ = true;          ///< OpenGL is available for primary visibility
  float exposure_ = 0;           ///< of the last image at rest; 0: none yet
  ViewRequest exposed_;          ///< the request that `exposure_` was chosen for
  bool keeps_exposure_ = false;  ///< for the image that is made
  bool fixed_exposure_ = false;
  std::optional<Backdrop> left_backdrop_, right_backdrop_;
  double mesh_time_s_ = 0;
  std::uint32_t mesh_clip_ = 0;
};

class Tracer::Work {
 public:
  PictureMaker pictures;

  /// Empty without a scene, or if the pixel has no ray. Throws as `Laboratory` does.
  [[nodiscard]] std::optional<RayBundle> bundle(const BundleQuestion& question);
  void forget_bundles() { laboratory_.reset(); }

 private:
  std::unique_ptr<Laboratory> laboratory_;
  BundleQuestion asked_;  ///< the question that `laboratory_` was made for
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
