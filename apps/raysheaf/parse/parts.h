// Kinds of options that several commands have.
#pragma once

#include <CLI/CLI.hpp>

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "raysheaf/error.h"
#include "raysheaf/io.h"
#include "raysheaf/render.h"
#include "text/describe.h"

namespace raysheaf::app {

/// Names of groups of options in the help; "Other" is the last one.
inline constexpr const char *kCommonGroup = "Common", *kOutputGroup = "Output",
                            *kCameraGroup = "Camera", *kLightGroup = "Light",
                            *kMethodGroup = "Method", *kAnimationGroup = "Animation",
                            *kStreamingGroup = "Streaming", *kProcessesGroup = "Processes",
                            *kCasesGroup = "Cases", *kMeasurementGroup = "Measurement",
                            *kOtherGroup = "Other";

/// Gives `app` groups of options: its help flag, and every option that is added before the first
/// `begin_group`, belong to "Other".
void use_groups(CLI::App& app);
/// Options that are added to `app` from here on belong to `group`.
void begin_group(CLI::App& app, const std::string& group);

/// "; did you mean 'WORD'?" for the first part of `text`, between commas, that is not known.
[[nodiscard]] std::string suggestion(const std::string& text,
                                     const std::vector<std::string>& known);

/// Turns an Error of values.h into CLI11's, which adds the option's name, and suggests one of the
/// words that the option takes; `type` is the option's.
template <typename Parse>
std::function<void(const std::string&)> into(Parse parse, const std::string& option,
                                             const std::string& type) {
  return [parse, option, known = known_words(option, type)](const std::string& text) {
    try {
      parse(text);
    } catch (const Error& error) {
      throw CLI::ValidationError(option, error.sentence() + suggestion(text, known));
    }
  };
}

/// Kinds of scenes that a command takes, in addition to files that are read whole and do not move.
struct SceneKinds {
  bool blocks = false, sequences = false, standard_input = false;
  bool none = false;  ///< the command needs no scene
};
void add_scene_file(CLI::App& app, std::string& scene, LoadOptions& load, SceneKinds kinds);

/// --preload, for commands that show moving scenes.
void add_preload(CLI::App& app, LoadOptions& load);

CLI::Option* add_value(CLI::App& app, const std::string& option, const std::string& type,
                       const std::string& text, std::function<void(const std::string&)> parse);

void add_count(CLI::App& app, const std::string& option, std::uint32_t& value, std::uint32_t low,
               std::uint32_t high, const std::string& text);

/// An option that may be given more than once; repeated values count once.
template <typename Value, typename Parse>
void add_words(CLI::App& app, const std::string& option, const std::string& text,
               const std::string& type, std::vector<Value>& values, Parse parse) {
  app.add_option_function<std::vector<std::string>>(
         option,
         [&values, option, type, parse](const std::vector<std::string>& names) {
           for (const std::string& name : names) {
             into(
                 [&](const std::string& given) {
                   const Value value = parse(given);
                   if (std::find(values.begin(), values.end(), value) == values.end())
                     values.push_back(value);
                 },
                 option, type)(name);
           }
         },
         text)
      ->type_name(type)
      ->allow_extra_args(false);
}

void add_off_switch(CLI::App& app, const std::string& option, bool& value, const std::string& text);

/// --threads, whose default is 0.
void add_threads(CLI::App& app, std::uint32_t& threads,
                 const std::string& text = "Threads, up to 1024; 0 uses all cores [0]");
/// -q, which turns the progress bar off.
void add_quiet(CLI::App& app, bool& quiet, const std::string& text = "Show no progress bar");

/// A file of what a command prints as a table on standard output: refuses "-".
void add_data_file(CLI::App& app, const std::string& option, const std::string& type,
                   const std::string& text, std::string& path);
/// Throws CLI11's error for -o if `path` is a folder; `file` is an example of a file in it.
void refuse_folder(const std::string& path, const std::string& file);
/// Throws CLI11's error for an option that changes nothing, if it is given.
void refuse_without_effect(const CLI::App& app, const std::string& option, const std::string& why);

// Options that `render` shares with other commands (parse.cpp).

void add_size(CLI::App& app, RenderOptions& options);
void add_exposure(CLI::App& app, RenderOptions& options);
/// --camera, a camera of the scene.
void add_camera(CLI::App& app, RenderOptions& options);
/// Without --size: makes the size 0 by 0, which stands for the aspect ratio of the camera.
void shape_as_camera(const CLI::App& app, RenderOptions* options);
/// Ambient light, bounces, and which kinds of rays are traced.
void add_rays(CLI::App& app, RenderOptions& options);
/// Primary visibility, the settings of all methods except `dual`, and threads.
void add_settings(CLI::App& app, RenderOptions& options);

}  // namespace raysheaf::app
