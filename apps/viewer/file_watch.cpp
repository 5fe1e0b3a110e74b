#include "file_watch.h"

#include <system_error>
#include <utility>

namespace raysheaf::viewer {
namespace {

constexpr double kLookEverySeconds = 0.5;
constexpr std::size_t kMostFiles = 100;

}  // namespace

std::vector<FileWatch::Stamp> FileWatch::look() const {
  std::vector<Stamp> stamps;
  for (const std::string& file : files_) {
    Stamp& stamp = stamps.emplace_back();
    std::error_code failed;
    const auto time = std::filesystem::last_write_time(file, failed);
    if (failed) continue;
    stamp.time = time;
    const std::uintmax_t bytes = std::filesystem::file_size(file, failed);
    if (!failed) stamp.bytes = bytes;
  }
  return stamps;
}

void FileWatch::watch(const std::vector<std::string>& files) {
  files_ = files;
  if (files_.size() > kMostFiles) files_.resize(kMostFiles);
  read_ = last_ = look();
}

bool FileWatch::changed(double now_s) {
  if (files_.empty() || now_s - looked_s_ < kLookEverySeconds) return false;
  looked_s_ = now_s;
  std::vector<Stamp> now = look();
  const bool is_quiet = now == last_;
  last_ = now;
  // Without its first file there is no scene: its program replaces it just now.
  if (!is_quiet || now == read_ || !now.front().time) return false;
  read_ = std::move(now);
  return true;
}

}  // namespace raysheaf::viewer
