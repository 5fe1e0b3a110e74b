// The data that the tracer passes to the interface: images for display, and the values that can be
// queried from them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "raysheaf/backdrop.h"
#include "raysheaf/render.h"
#include "resolution.h"
#include "view_settings.h"

namespace raysheaf::viewer {

/// Names and numbers of a scene for the interface, collected once when the scene is loaded.
struct SceneFacts {
  std::string name;
  std::uint64_t triangles = 0, meshes = 0, instances = 0, lights = 0;
  Box bounds;
  std::vector<Camera> cameras;  ///< at least one
  std::vector<std::string> mesh_names, instance_names, material_names;
  std::vector<std::vector<std::uint32_t>> materials;  ///< of each mesh, as `Mesh::materials`
  std::vector<std::string> warnings;
  std::vector<std::string> files;               ///< that the scene was read from
  std::optional<std::size_t> automatic_camera;  ///< the camera that was added
  double start_s = 0, end_s = 0;                ///< of the longest clip; equal if nothing moves
  std::vector<double> frame_times;              ///< of a sequence of files
  std::vector<std::string> clips;
  std::vector<double> clip_ends_s;  ///< of each clip
  double load_ms = 0;

  [[nodiscard]] bool moves() const { return end_s > start_s; }
};
[[nodiscard]] SceneFacts facts_of(const SceneDescription& scene);

struct ViewRequest {
  std::uint64_t number = 0;  ///< grows with each request
  Camera camera;
  ViewSettings settings;
  Size size;
  double time_s = 0;         ///< of moving scenes
  std::uint32_t clip = 0;    ///< index of the animation
  bool refine = false;       ///< the camera rests: continue until all samples are done
  bool is_smallest = false;  ///< a smaller image would not be shown: wait for this one
};

/// Maps values to the colours of the tests layer.
struct TestScale {
  double low = 0, high = 1;
  bool logarithmic = false;

  /// In [0, 1].
  [[nodiscard]] float at(double value) const;
};
/// The scale of all positive values; logarithmic if their range is large.
[[nodiscard]] TestScale scale_of(const std::vector<const std::vector<float>*>& tests);

struct PictureSide {
  Image image;
  FrameStatistics statistics;  ///< of one sample: the mean of all samples
  double tests_a_ray = 0;
};

struct Picture {
  ViewRequest request;
  Size size;
  std::uint32_t samples = 0;
  bool finished = false;             ///< it contains all requested samples
  std::array<PictureSide, 2> sides;  ///< the second one exists only in a split
  std::vector<PixelIds> ids;         ///< of the first sample
  std::vector<Vec3> position;
  std::vector<float> depth;  ///< of `position`, ahead of the camera; -1 if nothing is seen
  /// Display value of a white surface in the mean light of the image, linear: the preview's light.
  float light = 1;
  Vec3 sky{0.07f, 0.07f, 0.085f};  ///< mean colour of the pixels that see nothing, sRGB from 0 to 1
  float exposure = 1;
  TestScale scale;        ///< of the tests layer
  double trace_ms = 0;    ///< of one sample: the mean of all samples, both sides
  bool given_up = false;  ///< without an image: it took too long, and a newer one was requested
  std::string error;      ///< why there is no image; otherwise empty
};

/// Divides counts and times by the number of samples.
[[nodiscard]] FrameStatistics of_one_sample(FrameStatistics statistics, std::uint32_t samples);

/// A layer for display: `scale` is for the tests, `exposure` and `backdrop` for the beauty.
[[nodiscard]] Image layer_image(const RenderResult& result, Layer layer, const TestScale& scale,
                                float exposure, const Backdrop* backdrop = nullptr);

/// The depth of each pixel for `Picture::depth`.
[[nodiscard]] std::vector<float> depths_of(const RenderResult& result, const Camera& camera);

/// The surface that was clicked.
struct Pick {
  float x = 0, y = 0;  ///< in the image, from 0 to 1
  PixelIds ids;
  std::string mesh, instance, material;
  float t = 0;  ///< distance from the eye
  Vec3 position;
};
/// Empty if nothing is visible at (x, y), or if the image is empty.
[[nodiscard]] std::optional<Pick> pick(const Picture& picture, const SceneFacts& facts, float x,
                                       float y);

}  // namespace raysheaf::viewer
