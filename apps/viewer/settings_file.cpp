#include "settings_file.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "raysheaf/error.h"
#include "raysheaf/io.h"

namespace raysheaf::viewer {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kLargestFile = 1 << 16;

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr ? value : "";
}

/// Throws `Error` whose place is the line.
void read_line(const std::string& line, int number, const std::string& path,
               ViewSettings& settings) {
  const std::string place = path + ":" + std::to_string(number);
  std::istringstream words(line);
  std::string name, value, more;
  if (!(words >> name) || name.starts_with('#')) return;
  const SettingField* field = find_setting(name);
  if (field == nullptr)
    throw Error(ErrorCode::kInvalidData, "'" + name + "' is not a setting", place);
  if (!(words >> value) || words >> more)
    throw Error(ErrorCode::kInvalidData, "'" + name + "' takes one value", place);
  try {
    field->set(settings, value);
  } catch (const Error& error) {
    throw Error(ErrorCode::kInvalidData, name + " " + error.sentence(), place);
  }
}

}  // namespace

std::string default_settings_path() {
  const std::string config = variable("XDG_CONFIG_HOME"), home = variable("HOME");
  // The XDG specification declares relative paths invalid.
  if (fs::path(config).is_absolute()) return (fs::path(config) / "raysheaf" / "view").string();
  if (home.empty()) return "";
  return (fs::path(home) / ".config" / "raysheaf" / "view").string();
}

LoadedSettings load_settings(const std::string& path) {
  LoadedSettings loaded;
  std::error_code failed;
  if (path.empty() || !fs::exists(path, failed)) return loaded;
  try {
    if (!fs::is_regular_file(path, failed) || fs::file_size(path, failed) > kLargestFile || failed)
      throw Error(ErrorCode::kIo, "this is not a settings file", path);
    std::ifstream file(path);
    if (!file) throw Error(ErrorCode::kIo, "cannot be read", path);
    int number = 0;
    for (std::string line; std::getline(file, line);)
      read_line(line, ++number, path, loaded.settings);
  } catch (const Error& error) {
    return {{}, std::string("settings are ignored: ") + error.what()};
  }
  return loaded;
}

void save_settings(const ViewSettings& settings, const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  std::error_code failed;
  if (!folder.empty()) fs::create_directories(folder, failed);
  if (failed) throw Error(ErrorCode::kIo, "cannot be made: " + failed.message(), folder.string());
  std::string text =
      "# raysheaf view: one setting per line. Delete this file to restore the defaults.\n";
  for (const SettingField& field : setting_fields())
    text += field.name + " " + field.get(settings) + "\n";
  write_text(text, path);
}

}  // namespace raysheaf::viewer
