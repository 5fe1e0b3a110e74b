#include "apps/support/output_files.h"

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "raysheaf/error.h"
#include "raysheaf/io.h"
#include "system/files.h"

namespace raysheaf::app {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse_path(const std::string& path, const std::string& why) {
  throw Error(ErrorCode::kIo, "cannot write here: " + why, path);
}

[[noreturn]] void refuse_output(const std::string& path, const char* why) {
  throw Error(ErrorCode::kInvalidArgument, std::string("this output is ") + why, path);
}

// Makes a file next to the target and removes it. Only this test gives the right answer for root,
// read-only mounts, quotas and unusual file systems.
void try_beside(const std::string& path, const fs::path& target) {
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  const std::string trial = system::unused_name((folder / ".raysheaf.").string());
  const int file = system::make_file(trial);
  if (file < 0) refuse_path(path, std::strerror(errno));
  static_cast<void>(system::close_file(file));
  system::remove_file(trial);
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
  if (path.empty()) refuse_path(path, "the name is empty");
  std::error_code failed;
  const fs::path target = where_links_end(path);
  const fs::file_status status = fs::status(target, failed);
  if (fs::is_directory(status)) refuse_path(path, "it is a folder");
  if (fs::exists(status) && !fs::is_regular_file(status))
    refuse_path(path, "it is not a plain file");
  if (target.filename().empty()) refuse_path(path, "it names a folder");
  try_beside(path, target);
  return target.string();
}

}  // namespace raysheaf::app
