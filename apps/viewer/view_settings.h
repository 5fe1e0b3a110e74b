// Everything that a viewer remembers, as one table of names and values: its settings file, its
// scripts and its interface all go through it.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "camera_rig.h"
#include "raysheaf/context.h"
#include "raysheaf/lab.h"
#include "raysheaf/render.h"

namespace raysheaf::viewer {

/// What the picture shows.
enum class Layer : std::uint8_t { kBeauty, kTests, kNormal, kAlbedo, kShadow, kIds };

/// Settings of how rays are traced: those of one side of a split.
struct MethodChoice {
  Method method = Method::kDual;
  std::optional<RayKey> key;
  std::uint32_t key_bits = 32;
  std::uint32_t levels = 2, branching = 8;
  std::optional<BundleBound> bound;
  std::optional<bool> mesh_culling;

  bool operator==(const MethodChoice&) const = default;
  [[nodiscard]] static MethodChoice of(Method method) {
    MethodChoice choice;
    choice.method = method;
    return choice;
  }
};

struct ViewSettings {
  MethodChoice left;  ///< of the whole picture, where it is not split
  MethodChoice right = MethodChoice::of(Method::kCrsh);  ///< of a split's right side
  bool split = false;
  float divider = 0.5f;  ///< where the split is, of the window's width
  Device device = Device::kCpu;
  std::uint32_t threads = 0;
  std::uint32_t bounces = 2;
  bool shadows = true, reflections = true, refractions = true, early_out = false;
  float light = 1;         ///< factor on all lights
  bool headlight = false;  ///< one more light, where the camera is
  float exposure = 0;      ///< in stops, beside the automatic one
  Layer layer = Layer::kBeauty;
  bool bundle = false;  ///< draw the bundle under the cursor
  LabRays bundle_rays = LabRays::kShadow;
  bool panel = true, plots = true, help = false;
  std::uint32_t samples = 64;    ///< at which refinement stops
  std::uint32_t answer_ms = 50;  ///< a picture should take, while the camera moves
  UpAxis up = UpAxis::kY;
  float speed = 1;  ///< of flying, in quarters of the scene's size a second
  std::uint32_t width = 1280, height = 800;  ///< of the window, in its own units

  bool operator==(const ViewSettings&) const = default;
};

/// A name, its value as text, and how it is read.
struct SettingField {
  std::string name, what;
  /// The words that it takes; empty: a number.
  std::vector<std::string> words;
  std::function<std::string(const ViewSettings&)> get;
  /// Throws `Error` (kInvalidArgument, place: the name) for a text that is none of its values.
  std::function<void(ViewSettings&, const std::string&)> set;
};

[[nodiscard]] const std::vector<SettingField>& setting_fields();
/// Null where there is none.
[[nodiscard]] const SettingField* find_setting(const std::string& name);

/// What a side of the picture is rendered with; camera, size and scene are the caller's.
[[nodiscard]] RenderOptions render_options(const ViewSettings& settings,
                                           const MethodChoice& choice);
/// The same as the laboratory takes it.
[[nodiscard]] MethodSettings method_settings_of(const MethodChoice& choice);

/// Whether pictures of the two differ, or only what is drawn over them and beside them.
[[nodiscard]] bool same_picture(const ViewSettings& a, const ViewSettings& b);

}  // namespace raysheaf::viewer
