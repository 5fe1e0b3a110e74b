// What the tracer hands to the interface: pictures as they are shown, and what can be asked of
// them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "raysheaf/render.h"
#include "resolution.h"
#include "view_settings.h"

namespace raysheaf::viewer {

/// What the interface knows of a scene: names and numbers. Made once, when it was loaded.
struct SceneFacts {
  std::string name;
  std::uint64_t triangles = 0, meshes = 0, instances = 0, lights = 0;
  Box bounds;
  std::vector<Camera> cameras;  ///< one at least
  std::vector<std::string> mesh_names, instance_names, material_names;
  std::vector<std::vector<std::uint32_t>> materials;  ///< of each mesh, as `Mesh::materials`
  std::vector<std::string> warnings;
  double start_s = 0, end_s = 0;    ///< of what moves, its longest clip; equal where nothing does
  std::vector<double> frame_times;  ///< of a sequence of files
  std::vector<std::string> clips;
  std::vector<double> clip_ends_s;  ///< of each
  double load_ms = 0;

  [[nodiscard]] bool moves() const { return end_s > start_s; }
};
[[nodiscard]] SceneFacts facts_of(const SceneDescription& scene);

struct ViewRequest {
  std::uint64_t number = 0;  ///< grows with each request
  Camera camera;
  ViewSettings settings;
  Size size;
  double time_s = 0;       ///< of what moves
  std::uint32_t clip = 0;  ///< of those that can be played
  bool refine = false;     ///< the camera stands: go on until all samples are there
};

/// Values on the colours of the tests layer.
struct TestScale {
  double low = 0, high = 1;
  bool logarithmic = false;

  /// In [0, 1].
  [[nodiscard]] float at(double value) const;
};
/// Of all positive values; logarithmic where they differ much.
[[nodiscard]] TestScale scale_of(const std::vector<const std::vector<float>*>& tests);

struct PictureSide {
  Image image;
  FrameStatistics statistics;  ///< of one sample: the mean of all
  double tests_a_ray = 0;
};

struct Picture {
  ViewRequest request;
  Size size;
  std::uint32_t samples = 0;
  bool finished = false;             ///< all samples that were asked for are in it
  std::array<PictureSide, 2> sides;  ///< the second one of a split alone
  std::vector<PixelIds> ids;         ///< of the first sample
  std::vector<Vec3> position;
  float exposure = 1;
  TestScale scale;        ///< of the tests layer
  double trace_ms = 0;    ///< of one sample, the mean of all, both sides
  bool given_up = false;  ///< there is no picture: it took too long, and a newer one was asked for
  std::string error;      ///< why there is no picture; empty where there is one
};

/// Counts and times of one sample of so many.
[[nodiscard]] FrameStatistics of_one_sample(FrameStatistics statistics, std::uint32_t samples);

/// A layer as it is shown: `scale` is for the tests, `exposure` for the beauty.
[[nodiscard]] Image layer_image(const RenderResult& result, Layer layer, const TestScale& scale,
                                float exposure);

/// What was clicked at.
struct Pick {
  float x = 0, y = 0;  ///< in the picture, from 0 to 1
  PixelIds ids;
  std::string mesh, instance, material;
  float t = 0;  ///< distance from the eye
  Vec3 position;
};
/// None where nothing is seen at (x, y), or the picture holds nothing.
[[nodiscard]] std::optional<Pick> pick(const Picture& picture, const SceneFacts& facts, float x,
                                       float y);

}  // namespace raysheaf::viewer
