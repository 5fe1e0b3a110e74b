// Kinds of options that the commands share.
#pragma once

#include <CLI/CLI.hpp>

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "raysheaf/error.h"
#include "raysheaf/io.h"
#include "raysheaf/render.h"

namespace raysheaf::app {

/// Turns an Error of values.h into CLI11's, which adds the option's name.
template <typename Parse>
std::function<void(const std::string&)> into(Parse parse, std::string option) {
  return [parse, option = std::move(option)](const std::string& text) {
    try {
      parse(text);
    } catch (const Error& error) {
      throw CLI::ValidationError(option, error.sentence());
    }
  };
}

/// What a command takes besides scenes that are read whole and stand still.
struct SceneKinds {
  bool blocks = false, sequences = false, standard_input = false;
};
void add_scene_file(CLI::App& app, std::string& scene, LoadOptions& load, SceneKinds kinds);

/// Of commands that show what moves.
void add_preload(CLI::App& app, LoadOptions& load);

void add_value(CLI::App& app, const std::string& option, const std::string& type,
               const std::string& text, std::function<void(const std::string&)> parse);

void add_count(CLI::App& app, const std::string& option, std::uint32_t& value, std::uint32_t low,
               std::uint32_t high, const std::string& text);

/// An option that may be given more than once; repeated values count once.
template <typename Value, typename Parse>
void add_words(CLI::App& app, const std::string& option, const std::string& text,
               const std::string& type, std::vector<Value>& values, Parse parse) {
  app.add_option_function<std::vector<std::string>>(
         option,
         [&values, option, parse](const std::vector<std::string>& names) {
           for (const std::string& name : names) {
             into(
                 [&](const std::string& given) {
                   const Value value = parse(given);
                   if (std::find(values.begin(), values.end(), value) == values.end())
                     values.push_back(value);
                 },
                 option)(name);
           }
         },
         text)
      ->type_name(type)
      ->allow_extra_args(false);
}

void add_off_switch(CLI::App& app, const std::string& option, bool& value, const std::string& text);

// Pieces of `render` that other commands take too (parse.cpp).

/// Size, camera, exposure, ambient light.
void add_view(CLI::App& app, RenderOptions& options);
/// Where there was no --size, 0 by 0: the camera's own.
void shape_as_camera(const CLI::App& app, RenderOptions* options);
/// Bounces, which rays there are, and how first hits are found.
void add_rays(CLI::App& app, RenderOptions& options);
/// What the methods but for `dual` are set by, and threads.
void add_settings(CLI::App& app, RenderOptions& options);

}  // namespace raysheaf::app
