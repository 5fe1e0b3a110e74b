#include "outputs.h"

#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "raysheaf/error.h"
#include "raysheaf/io.h"
#include "values.h"

namespace raysheaf::app {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& path, const std::string& why) {
  throw Error(ErrorCode::kIo, "cannot write here: " + why, path);
}

// Makes a file beside the target and takes it away: the one question that root, read-only mounts,
// quotas and odd file systems all answer truthfully.
void try_beside(const std::string& path, const fs::path& target) {
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  std::string trial = (folder / ".raysheaf-XXXXXX").string();
  const int file = mkstemp(trial.data());
  if (file < 0) refuse(path, std::strerror(errno));
  close(file);
  unlink(trial.c_str());
}

std::vector<float> plane(const std::vector<Vec3>& values, float Vec3::*axis) {
  std::vector<float> numbers;
  numbers.reserve(values.size());
  for (const Vec3& value : values) numbers.push_back(value.*axis);
  return numbers;
}

void add_layer(std::vector<ExrChannel>& channels, const std::vector<Vec3>& values,
               const std::string& prefix, const char* letters) {
  float Vec3::*const axes[3] = {&Vec3::x, &Vec3::y, &Vec3::z};
  for (int i = 0; i < 3; ++i) {
    channels.push_back({prefix + letters[i], plane(values, axes[i])});
  }
}

void write_layers(const RenderResult& result, const std::string& path) {
  std::vector<ExrChannel> channels;
  add_layer(channels, result.beauty, "", "RGB");
  add_layer(channels, result.position, "position.", "XYZ");
  add_layer(channels, result.normal, "normal.", "XYZ");
  add_layer(channels, result.albedo, "albedo.", "RGB");
  add_layer(channels, result.specular, "specular.", "RGB");
  channels.push_back({"shadow.V", result.shadow});
  if (!result.tests.empty()) channels.push_back({"tests.V", result.tests});
  write_exr(result.width, result.height, std::move(channels), path);
}

}  // namespace

void refuse_scene_as_output(const std::string& scene, const std::string& output) {
  std::error_code ignored;
  if (fs::equivalent(scene, output, ignored)) {
    throw Error(ErrorCode::kInvalidArgument, "this output is the scene itself", output);
  }
}

std::string writable_path(const std::string& path) {
  if (path.empty()) refuse(path, "the name is empty");
  std::error_code failed;
  fs::path target = path;
  if (fs::is_symlink(target, failed)) {
    target = fs::weakly_canonical(target, failed);
    if (failed) refuse(path, failed.message());
  }
  const fs::file_status status = fs::status(target, failed);
  if (fs::is_directory(status)) refuse(path, "it is a folder");
  if (fs::exists(status) && !fs::is_regular_file(status)) refuse(path, "it is not a plain file");
  if (target.filename().empty()) refuse(path, "it names a folder");
  try_beside(path, target);
  return target.string();
}

void write_picture(const RenderResult& result, const std::string& name, const std::string& path) {
  if (has_ending(name, ".exr")) {
    write_layers(result, path);
  } else {
    write_png(tone_mapped(result), path);
  }
}

}  // namespace raysheaf::app
