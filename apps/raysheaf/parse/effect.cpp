#include "parse/commands.h"

#include <algorithm>
#include <array>

#include "apps/support/values.h"
#include "parse/parts.h"
#include "render/frames_command.h"
#include "render/picture.h"

namespace raysheaf::app {
namespace {

/// A setting, and the methods that have it.
struct MethodSetting {
  const char* option;
  std::array<bool, 5> of;  ///< by `Method`
  const char* why;
};

constexpr bool has(const MethodSetting& setting, Method method) {
  return setting.of[static_cast<std::size_t>(method)];
}

constexpr std::array<bool, 5> methods_of(std::initializer_list<Method> list) {
  std::array<bool, 5> of{};
  for (const Method method : list) of[static_cast<std::size_t>(method)] = true;
  return of;
}

constexpr auto kOfHierarchies = methods_of({Method::kRah, Method::kCrsh});
constexpr auto kOfSorters = methods_of({Method::kRah, Method::kCrsh, Method::kGl10});
constexpr auto kOfCounters =
    methods_of({Method::kBrute, Method::kRah, Method::kCrsh, Method::kGl10});
constexpr const char *kHierarchies = "only rah and crsh have it: give --method",
                     *kSorters = "only rah, crsh and gl10 have it: give --method";
constexpr MethodSetting kMethodSettings[] = {
    {"--levels", kOfHierarchies, kHierarchies},
    {"--branching", kOfHierarchies, kHierarchies},
    {"--bound", kOfHierarchies, kHierarchies},
    {"--mesh-culling", kOfHierarchies, kHierarchies},
    {"--key", kOfSorters, kSorters},
    {"--key-bits", kOfSorters, kSorters},
    {"--early-out", kOfCounters, "dual always stops a shadow ray at its first hit"},
};

/// Whether at least one output is an image for display, and not radiance, counts or text.
bool writes_shown_picture(const RenderCommand& command) {
  return std::any_of(command.pictures.begin(), command.pictures.end(),
                     [](const std::string& path) { return !has_ending(path, ".exr"); });
}

}  // namespace

void check_method_settings(const CLI::App& app, const std::vector<Method>& methods) {
  for (const MethodSetting& setting : kMethodSettings) {
    if (std::none_of(methods.begin(), methods.end(), [&](Method m) { return has(setting, m); }))
      refuse_without_effect(app, setting.option, setting.why);
  }
}

void check_effect(const CLI::App& app, const RenderCommand& command) {
  const RenderOptions& options = command.options;
  check_method_settings(app, {options.method});
  if (!wants_frames(command)) refuse_without_effect(app, "--fps", "a single image has no rate");
  const bool writes_any = !command.pictures.empty() || !command.heatmap_path.empty();
  if (writes_any && !writes_shown_picture(command)) {
    const char* const why = "no output is an image for display: give -o with .png or .jpg";
    refuse_without_effect(app, "--exposure", why);
    refuse_without_effect(app, "--background", why);
  }
  if (!options.reflections && !options.refractions)
    refuse_without_effect(app, "--bounces", "no reflections and no refractions are traced");
  if (options.samples == 1) {
    const char* const why = "a single sample goes through centres: give --samples 2 or more";
    if (command.light.size.value_or(0) > 0) refuse_without_effect(app, "--light-size", why);
    if (options.aperture.value_or(0) > 0) refuse_without_effect(app, "--aperture", why);
  }
}

}  // namespace raysheaf::app
