#include "scene_input.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string_view>
#include <vector>

#include "apps/support/console.h"
#include "system/files.h"

namespace raysheaf::app {
namespace {

constexpr const char* kStandardInput = "standard input";
constexpr std::size_t kMostBytes = 0xffffffff;

std::string all_of(std::FILE* stream, const std::string& name) {
  std::string all;
  std::vector<char> part(std::size_t{1} << 16);
  while (true) {
    const std::size_t count = std::fread(part.data(), 1, part.size(), stream);
    if (count == 0) break;
    all.append(part.data(), count);
    if (all.size() > kMostBytes)
      throw Error(ErrorCode::kUnsupported, "has more than 4 GiB: give a file", name);
  }
  stop_if_interrupted();
  if (std::ferror(stream) != 0)
    throw Error(ErrorCode::kIo, std::string("cannot be read: ") + std::strerror(errno), name);
  return all;
}

std::string all_of_pipe(const std::string& path) {
  const auto close = [](std::FILE* file) { std::fclose(file); };
  const std::unique_ptr<std::FILE, decltype(close)> file(std::fopen(path.c_str(), "rb"), close);
  stop_if_interrupted();
  if (file == nullptr)
    throw Error(ErrorCode::kIo, std::string("cannot be read: ") + std::strerror(errno), path);
  return all_of(file.get(), path);
}

/// A binary STL has 84 bytes, of which the last four count its triangles, and 50 for each triangle.
bool is_binary_stl(std::string_view bytes) {
  constexpr std::size_t kHead = 84, kTriangle = 50;
  if (bytes.size() < kHead) return false;
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + kHead - 4, sizeof count);
  return bytes.size() == kHead + kTriangle * count;
}

/// The file name ending for this content.
std::string ending_for(std::string_view bytes, const std::string& name) {
  constexpr std::size_t kLookedAt = 4096;
  if (is_binary_stl(bytes)) return ".stl";
  if (bytes.starts_with("glTF")) return ".glb";
  std::string_view text = bytes.substr(0, kLookedAt);
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  const auto first = std::find_if(text.begin(), text.end(), [](char c) {
    return std::isspace(static_cast<unsigned char>(c)) == 0;
  });
  text.remove_prefix(static_cast<std::size_t>(first - text.begin()));
  if (text.starts_with("{")) return ".gltf";
  if (text.starts_with("ply\n") || text.starts_with("ply\r")) return ".ply";
  if (text.starts_with("solid")) return ".stl";
  if (text.find('\0') == text.npos) return ".obj";
  throw Error(ErrorCode::kInvalidData, "is none of glTF, OBJ, PLY and STL", name);
}

}  // namespace

SceneInput::SceneInput(std::string* scene) {
  std::error_code failed;
  const bool is_pipe = std::filesystem::is_fifo(*scene, failed);
  if (*scene != "-" && !is_pipe) return;
  name_ = is_pipe ? *scene : kStandardInput;
  const std::string bytes = is_pipe ? all_of_pipe(*scene) : all_of(stdin, name_);
  if (bytes.empty()) throw Error(ErrorCode::kInvalidData, "is empty", name_);
  const std::string name = (is_pipe ? "pipe" : "standard-input") + ending_for(bytes, name_);
  namespace fs = std::filesystem;
  folder_ = system::make_temporary_folder();
  if (folder_.empty())
    throw Error(ErrorCode::kIo, std::string("cannot be kept: ") + std::strerror(errno), name_);
  file_ = (fs::path(folder_) / name).string();
  std::ofstream file(file_, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (file.fail()) {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
    throw Error(ErrorCode::kIo, "cannot be kept in " + folder_, name_);
  }
  *scene = file_;
}

SceneInput::~SceneInput() {
  std::error_code ignored;
  if (!folder_.empty()) std::filesystem::remove_all(folder_, ignored);
}

Error SceneInput::named(const Error& error) const {
  std::string place = error.place();
  const std::size_t at = place.find(file_);
  if (at != place.npos) place.replace(at, file_.size(), name_);
  return Error(error.code(), error.sentence(), place);
}

}  // namespace raysheaf::app
