#include "outputs.h"

#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "console.h"
#include "raysheaf/error.h"
#include "raysheaf/io.h"
#include "raysheaf/jpeg.h"
#include "values.h"

namespace raysheaf::app {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& path, const std::string& why) {
  throw Error(ErrorCode::kIo, "cannot write here: " + why, path);
}

[[noreturn]] void refuse_output(const std::string& path, const char* why) {
  throw Error(ErrorCode::kInvalidArgument, std::string("this output is ") + why, path);
}

// Makes a file next to the target and removes it. Only this test gives the right answer for root,
// read-only mounts, quotas and unusual file systems.
void try_beside(const std::string& path, const fs::path& target) {
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  std::string trial = (folder / ".raysheaf-XXXXXX").string();
  const int file = mkstemp(trial.data());
  if (file < 0) refuse(path, std::strerror(errno));
  close(file);
  unlink(trial.c_str());
}

template <class Vector>
std::vector<float> plane(const std::vector<Vector>& values, float Vector::*axis) {
  std::vector<float> numbers;
  numbers.reserve(values.size());
  for (const Vector& value : values) numbers.push_back(value.*axis);
  return numbers;
}

template <class Vector>
void add_layer(std::vector<ExrChannel>& channels, const std::vector<Vector>& values,
               const std::string& prefix, const char* letters) {
  float Vector::*const axes[3] = {&Vector::x, &Vector::y, &Vector::z};
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
  const Gbuffer& targets = result.gbuffer;
  if (!targets.position.empty()) {
    add_layer(channels, targets.position, "gbuffer_position.", "XYZ");
    add_layer(channels, targets.normal, "gbuffer_normal.", "XYZ");
    add_layer(channels, targets.diffuse, "gbuffer_diffuse.", "RGB");
    add_layer(channels, targets.specular, "gbuffer_specular.", "RGB");
  }
  write_exr(result.width, result.height, std::move(channels), path);
}

}  // namespace

void OutputFiles::reads(const std::string& path) {
  const std::string file = file_that_is_read(path);
  if (file.empty()) return;
  const auto output = written_.find(file);
  if (output != written_.end()) refuse_output(output->second, "read, too");
  read_.insert(file);
}

void OutputFiles::reads_scene(const std::string& scene) {
  scene_ = file_that_is_read(scene);
}

void OutputFiles::reads(const std::vector<std::string>& files) {
  for (const std::string& path : files) reads(path);
}

void OutputFiles::claim(const std::string& path) {
  if (path.empty()) return;
  const std::string file = file_of(path);
  if (!written_.try_emplace(file, path).second) refuse_output(path, "written twice");
  if (file == scene_) refuse_output(path, "the scene itself");
  if (read_.contains(file)) refuse_output(path, "read, too");
}

std::string OutputFiles::open(const std::string& path) {
  if (path.empty()) return path;
  claim(path);
  return writable_path(path);
}

std::string OutputFiles::file_that_is_read(const std::string& path) {
  try {
    return path.empty() ? path : file_of(path);
  } catch (const Error&) {
    return "";  // a cycle of links: reading the path reports it
  }
}

std::string OutputFiles::file_of(const std::string& path) {
  const fs::path target = where_links_end(path);
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  const auto [known, is_new] = folders_.try_emplace(folder.string());
  if (is_new) {
    std::error_code failed;
    fs::path whole = fs::absolute(folder, failed);
    if (!failed) whole = fs::weakly_canonical(whole, failed);
    known->second = (failed ? folder : whole).string();
  }
  return (fs::path(known->second) / target.filename()).string();
}

std::string writable_path(const std::string& path) {
  if (path.empty()) refuse(path, "the name is empty");
  std::error_code failed;
  const fs::path target = where_links_end(path);
  const fs::file_status status = fs::status(target, failed);
  if (fs::is_directory(status)) refuse(path, "it is a folder");
  if (fs::exists(status) && !fs::is_regular_file(status)) refuse(path, "it is not a plain file");
  if (target.filename().empty()) refuse(path, "it names a folder");
  try_beside(path, target);
  return target.string();
}

Image shown_picture(const RenderResult& result, const std::optional<Backdrop>& backdrop) {
  return backdrop ? backdrop->picture(result) : tone_mapped(result);
}

void write_picture(const RenderResult& result, const std::string& name, const std::string& path,
                   const std::optional<Backdrop>& backdrop) {
  if (has_ending(name, ".exr")) return write_layers(result, path);
  const Image picture = shown_picture(result, backdrop);
  if (name == kStandardOutput) {
    const std::vector<std::uint8_t> png = encode_png(picture);
    print({reinterpret_cast<const char*>(png.data()), png.size()});
  } else if (has_ending(name, ".jpg") || has_ending(name, ".jpeg")) {
    write_jpeg(picture, path);
  } else {
    write_png(picture, path);
  }
}

}  // namespace raysheaf::app
