#include "parse/parts.h"

#include <algorithm>
#include <filesystem>

#include "apps/support/closest.h"
#include "apps/support/values.h"

namespace raysheaf::app {

void use_groups(CLI::App& app) {
  app.get_help_ptr()->group(kOtherGroup);
  begin_group(app, kOtherGroup);
}

void begin_group(CLI::App& app, const std::string& group) {
  app.option_defaults()->group(group);
}

std::string suggestion(const std::string& text, const std::vector<std::string>& known) {
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t end = std::min(text.find(',', start), text.size());
    const std::string part = text.substr(start, end - start);
    if (std::find(known.begin(), known.end(), part) == known.end())
      return did_you_mean(part, known);
    start = end + 1;
  }
  return "";
}

void add_scene_file(CLI::App& app, std::string& scene, LoadOptions& load, SceneKinds kinds) {
  std::string text = "A scene: a file (" + scene_file_endings_text();
  if (kinds.blocks) text += ", .rsb";
  if (kinds.sequences) text += ", .json";
  text += ")";
  if (kinds.sequences) text += ", a pattern of files with a frame each ('f_*.ply')";
  app.add_option("SCENE", scene,
                 text + (kinds.standard_input ? ", builtin:NAME or - (standard input)"
                         : kinds.sequences    ? ", or builtin:NAME"
                                              : " or builtin:NAME"))
      ->required(!kinds.none);
  app.add_flag("--allow-external", load.allow_external,
               "Let the scene name files outside its folder");
}

void add_preload(CLI::App& app, LoadOptions& load) {
  app.add_flag("--preload", load.preload,
               "Read all files of a sequence before the first frame and keep them in memory");
}

CLI::Option* add_value(CLI::App& app, const std::string& option, const std::string& type,
                       const std::string& text, std::function<void(const std::string&)> parse) {
  return app.add_option_function<std::string>(option, into(std::move(parse), option, type), text)
      ->type_name(type);
}

void add_count(CLI::App& app, const std::string& option, std::uint32_t& value, std::uint32_t low,
               std::uint32_t high, const std::string& text) {
  add_value(app, option, "N", text, [&value, low, high](const std::string& given) {
    value = parse_count(given, low, high);
  });
}

void add_off_switch(CLI::App& app, const std::string& option, bool& value,
                    const std::string& text) {
  app.add_flag_callback(
      option, [&value] { value = false; }, text);
}

void add_threads(CLI::App& app, std::uint32_t& threads, const std::string& text) {
  add_count(app, "--threads", threads, 0, 1024, text);
}

void add_quiet(CLI::App& app, bool& quiet, const std::string& text) {
  app.add_flag("-q,--quiet", quiet, text);
}

void add_data_file(CLI::App& app, const std::string& option, const std::string& type,
                   const std::string& text, std::string& path) {
  add_value(app, option, type, text, [&path](const std::string& given) {
    if (given == "-")
      throw Error(ErrorCode::kInvalidArgument,
                  "standard output has a table, with which this would mix: give a file");
    path = given;
  });
}

void refuse_folder(const std::string& path, const std::string& file) {
  std::error_code failed;
  if (!path.ends_with('/') && !std::filesystem::is_directory(path, failed)) return;
  const std::string slash = path.ends_with('/') ? "" : "/";
  throw CLI::ValidationError(
      "-o", "'" + path + "' is a folder: give a file, such as " + path + slash + file);
}

void refuse_without_effect(const CLI::App& app, const std::string& option, const std::string& why) {
  if (app.count(option) > 0) throw CLI::ValidationError(option, "it has no effect: " + why);
}

}  // namespace raysheaf::app
