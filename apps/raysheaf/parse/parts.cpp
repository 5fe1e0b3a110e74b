#include "parse/parts.h"

#include "values.h"

namespace raysheaf::app {

void add_scene_file(CLI::App& app, std::string& scene, LoadOptions& load, SceneKinds kinds) {
  std::string text = "A file (" + scene_file_endings_text();
  if (kinds.blocks) text += ", .rsb";
  if (kinds.sequences) text += ", .json";
  text += ")";
  if (kinds.sequences) text += ", a pattern of files that are frames ('f_*.ply'),";
  app.add_option("SCENE", scene,
                 text + (kinds.standard_input ? ", builtin:NAME or - (standard input)"
                                              : " or builtin:NAME"))
      ->required();
  app.add_flag("--allow-external", load.allow_external,
               "The scene may name files outside its folder");
}

void add_preload(CLI::App& app, LoadOptions& load) {
  app.add_flag("--preload", load.preload,
               "Read all files of a sequence before the first frame, and keep what they hold");
}

void add_value(CLI::App& app, const std::string& option, const std::string& type,
               const std::string& text, std::function<void(const std::string&)> parse) {
  app.add_option_function<std::string>(option, into(std::move(parse), option), text)
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

}  // namespace raysheaf::app
