#include "io/file.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "io/file_parts.h"
#include "raysheaf/error.h"
#include "raysheaf/io.h"
#include "system/files.h"
#include "system/paths.h"

namespace raysheaf {
namespace io {
namespace {

namespace fs = std::filesystem;

/// Returns 0, or the errno of the step that failed.
int write_in_place(const std::string& path, std::span<const std::uint8_t> bytes) {
  const int file = system::open_file(path, system::Access::kWrite);
  if (file < 0) return errno;
  int failure = 0;
  while (!bytes.empty() && failure == 0) {
    const std::int64_t written = system::write_next(file, bytes);
    if (written < 0)
      failure = errno;
    else
      bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return system::close_file(file) || failure != 0 ? failure : errno;
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  const int lower = std::tolower(static_cast<unsigned char>(c));
  return lower >= 'a' && lower <= 'f' ? lower - 'a' + 10 : -1;
}

std::string decode_percent(const std::string& text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool escaped = text[i] == '%' && i + 2 < text.size() && hex_digit(text[i + 1]) >= 0 &&
                         hex_digit(text[i + 2]) >= 0;
    if (escaped) {
      result += static_cast<char>(hex_digit(text[i + 1]) * 16 + hex_digit(text[i + 2]));
      i += 2;
    } else {
      result += text[i];
    }
  }
  return result;
}

bool is_no_name(const std::string& name) {
  return name.empty() || name.find('\0') != std::string::npos ||
         name.find(':') != std::string::npos;
}

bool climbs_out(const fs::path& path) {
  return std::any_of(path.begin(), path.end(), [](const fs::path& part) { return part == ".."; });
}

}  // namespace

Error system_error(const std::string& verb, const std::string& place, int error) {
  return {ErrorCode::kIo, "cannot be " + verb + ": " + std::strerror(error), place};
}

std::string temporary_name(const std::string& path) {
  const std::string name = system::unused_name(".raysheaf.") + ".part";
  return system::text_of(system::path_of(path).parent_path() / name);
}

Bytes read_file(const std::string& path) {
  const FileReader file(path);
  if (file.size() > kMaxFileBytes)
    throw Error(ErrorCode::kOutOfMemory, "is larger than 4 GiB, the most that is read", path);
  Bytes bytes(file.size());
  file.read(0, bytes, path);
  if (file.was_changed()) throw Error(ErrorCode::kIo, "was changed while it was read", path);
  return bytes;
}

bool file_exists(const std::string& path) {
  std::error_code error;
  return fs::is_regular_file(system::path_of(path), error);
}

void write_file(const std::string& path, std::span<const std::uint8_t> bytes) {
  std::error_code error;
  const fs::file_status status = fs::status(system::path_of(path), error);
  if (fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status)) {
    // The path is a device or a pipe, which a rename would replace by a file.
    if (const int failure = write_in_place(path, bytes))
      throw system_error("written", path, failure);
    return;
  }
  FileWriter file(path);
  file.append(bytes);
  file.finish();
}

std::string ending_of(const std::string& path) {
  std::string ending = system::text_of(system::path_of(path).extension());
  if (!ending.empty()) ending.erase(0, 1);
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

std::string folder_of(const std::string& path) {
  const std::string folder = system::text_of(system::path_of(path).parent_path());
  return folder.empty() ? "." : folder;
}

std::string stem_of(const std::string& path) {
  return system::text_of(system::path_of(path).stem());
}

std::vector<std::string> files_of(const SceneFile& file) {
  std::vector<std::string> files{file.path};
  if (file.names != nullptr) files.insert(files.end(), file.names->begin(), file.names->end());
  return files;
}

std::string resolve(const SceneFile& from, const std::string& uri, bool is_uri,
                    const std::string& place) {
  std::string name = is_uri ? decode_percent(uri) : uri;
  const auto joined = [&] {
    return system::text_of(system::path_of(folder_of(from.path)) / system::path_of(name));
  };
  const bool turned = is_uri && name.find('\\') != name.npos && !file_exists(joined());
  if (turned) std::replace(name.begin(), name.end(), '\\', '/');
  const fs::path path = system::path_of(name);
  const bool leaves = is_no_name(name) || system::has_special_name(path) ||
                      (path.has_root_path() && (is_uri || !from.allow_external)) ||
                      (climbs_out(path) && !from.allow_external);
  if (leaves) {
    throw Error(ErrorCode::kUnsupported,
                "\"" + uri.substr(0, 200) + "\" does not stay inside the file's folder", place);
  }
  if (turned && from.turned != nullptr) from.turned->insert(uri);
  std::string resolved = joined();
  if (from.names != nullptr) from.names->insert(resolved);
  return resolved;
}

}  // namespace io

std::string where_links_end(const std::string& path) {
  constexpr int kMostLinks = 40;  // Linux follows as many
  std::filesystem::path target = system::path_of(path);
  std::error_code error;
  for (int i = 0; std::filesystem::is_symlink(std::filesystem::symlink_status(target, error));
       ++i) {
    if (i == kMostLinks) throw io::system_error("written", path, ELOOP);
    const std::filesystem::path next = std::filesystem::read_symlink(target, error);
    if (error) throw io::system_error("written", path, error.value());
    target = next.is_absolute() ? next : target.parent_path() / next;
  }
  return system::text_of(target);
}

void write_text(const std::string& text, const std::string& path) {
  io::write_file(path, io::as_bytes(text));
}

}  // namespace raysheaf
