// All settings of the viewer, as one table of names and values, which its settings file, its
// scripts and its interface share.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "camera_rig.h"
#include "raysheaf/backdrop.h"
#include "raysheaf/context.h"
#include "raysheaf/lab.h"
#include "raysheaf/render.h"

namespace raysheaf::viewer {

/// The layer that is shown.
enum class Layer : std::uint8_t { kBeauty, kTests, kNormal, kAlbedo, kShadow, kIds };

struct ViewSettings {
  MethodChoice left;                  ///< of the whole image without a split
  MethodChoice right{Method::kCrsh};  ///< of the right side of a split
  bool split = false;
  float divider = 0.5f;  ///< position of the split, as a part of the window's width
  Device device = Device::kCpu;
  std::uint32_t threads = 0;
  std::uint32_t bounces = 2;
  bool shadows = true, reflections = true, refractions = true, early_out = false;
  float light = 1;         ///< factor on all lights
  bool headlight = false;  ///< adds a light at the camera
  float exposure = 0;      ///< in stops, added to the automatic one
  Layer layer = Layer::kBeauty;
  bool bundle = false;  ///< draw the bundle under the cursor
  LabRays bundle_rays = LabRays::kShadow;
  bool bar = true, panel = false, plots = false, help = false;
  /// The image while the camera moves.
  enum class Moving : std::uint8_t { kPreview, kTrace };
  Moving moving = Moving::kPreview;
  bool wireframe = false, grid = false, axes = false;
  std::optional<Rgba> background;  ///< behind the scene, instead of the sky
  bool reload = true;              ///< read the scene again when one of its files changes
  enum class MiddleDrag : std::uint8_t { kPan, kOrbit };
  MiddleDrag middle_drag = MiddleDrag::kPan;
  std::uint32_t samples = 64;    ///< number at which refinement stops
  std::uint32_t answer_ms = 50;  ///< goal for the time of an image while the camera moves
  UpAxis up = UpAxis::kY;
  float speed = 1;  ///< of flying, in quarters of the scene's size per second
  std::uint32_t width = 1280, height = 800;  ///< of the window, in its own units

  bool operator==(const ViewSettings&) const = default;
};

/// A setting: its name, its value as text, and how text is parsed.
struct SettingField {
  std::string name, what;
  /// The words that it takes; empty for a number.
  std::vector<std::string> words;
  std::function<std::string(const ViewSettings&)> get;
  /// Throws `Error` (kInvalidArgument, place: the name) for an invalid value.
  std::function<void(ViewSettings&, const std::string&)> set;
};

[[nodiscard]] const std::vector<SettingField>& setting_fields();
/// Null for an unknown name.
[[nodiscard]] const SettingField* find_setting(const std::string& name);

/// The options for rendering a side of the image; the caller adds camera, size and scene.
[[nodiscard]] RenderOptions render_options(const ViewSettings& settings,
                                           const MethodChoice& choice);

/// Whether the settings lead to the same image, whatever its overlays and panels.
[[nodiscard]] bool same_picture(const ViewSettings& a, const ViewSettings& b);

}  // namespace raysheaf::viewer
