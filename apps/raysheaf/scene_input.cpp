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
#include <string_view>
#include <vector>

#include "apps/support/console.h"

namespace raysheaf::app {
namespace {

constexpr const char* kStandardInput = "standard input";
constexpr std::size_t kMostBytes = 0xffffffff;

std::string all_of_standard_input() {
  std::string all;
  std::vector<char> part(std::size_t{1} << 16);
  while (true) {
    const std::size_t count = std::fread(part.data(), 1, part.size(), stdin);
    if (count == 0) break;
    all.append(part.data(), count);
    if (all.size() > kMostBytes)
      throw Error(ErrorCode::kUnsupported, "has more than 4 GiB: give a file", kStandardInput);
  }
  stop_if_interrupted();
  if (std::ferror(stdin) != 0)
    throw Error(ErrorCode::kIo, std::string("cannot be read: ") + std::strerror(errno),
                kStandardInput);
  return all;
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
std::string ending_for(std::string_view bytes) {
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
  throw Error(ErrorCode::kInvalidData, "is none of glTF, OBJ, PLY and STL", kStandardInput);
}

}  // namespace

SceneInput::SceneInput(std::string* scene) {
  if (*scene != "-") return;
  const std::string bytes = all_of_standard_input();
  if (bytes.empty()) throw Error(ErrorCode::kInvalidData, "is empty", kStandardInput);
  const std::string name = "standard-input" + ending_for(bytes);
  namespace fs = std::filesystem;
  std::string folder = (fs::temp_directory_path() / "raysheaf-XXXXXX").string();
  if (mkdtemp(folder.data()) == nullptr)
    throw Error(ErrorCode::kIo, std::string("cannot be kept: ") + std::strerror(errno),
                kStandardInput);
  folder_ = folder;
  file_ = (fs::path(folder) / name).string();
  std::ofstream file(file_, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (file.fail()) {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
    throw Error(ErrorCode::kIo, "cannot be kept in " + folder_, kStandardInput);
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
  if (at != place.npos) place.replace(at, file_.size(), kStandardInput);
  return Error(error.code(), error.sentence(), place);
}

}  // namespace raysheaf::app
