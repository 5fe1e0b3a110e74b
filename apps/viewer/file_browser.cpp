#include "file_browser.h"

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "raysheaf/io.h"

namespace raysheaf::viewer {
namespace {

namespace fs = std::filesystem;

constexpr const char* kParent = "..";
constexpr std::size_t kMostEntries = 10000;

bool is_scene_name(const fs::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const auto known = scene_file_endings();
  return ending == ".json" || std::find(known.begin(), known.end(), ending) != known.end();
}

std::optional<FileBrowser::Entry> entry_of(const fs::directory_entry& found) {
  FileBrowser::Entry entry{found.path().filename().string(), false, 0};
  if (entry.name.starts_with('.')) return std::nullopt;
  std::error_code failed;
  entry.is_folder = found.is_directory(failed);
  if (entry.is_folder) return entry;
  if (!found.is_regular_file(failed) || !is_scene_name(found.path())) return std::nullopt;
  const std::uintmax_t bytes = found.file_size(failed);
  if (!failed) entry.bytes = bytes;
  return entry;
}

}  // namespace

FileBrowser::FileBrowser(const std::string& folder) {
  std::error_code failed;
  const fs::path whole = fs::absolute(folder.empty() ? fs::path(".") : fs::path(folder), failed);
  if (!failed && enter(whole.lexically_normal().string())) return;
  sentence_.clear();
  const fs::path here = fs::current_path(failed);
  if (failed || !enter(here.string())) (void)enter("/");
}

bool FileBrowser::enter(const std::string& folder) {
  std::error_code failed;
  fs::directory_iterator at(folder, failed);
  std::vector<Entry> entries;
  for (; !failed && at != fs::directory_iterator() && entries.size() < kMostEntries;
       at.increment(failed)) {
    if (auto entry = entry_of(*at)) entries.push_back(*std::move(entry));
  }
  if (failed) {
    sentence_ = folder + ": " + failed.message();
    return false;
  }
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    return a.is_folder != b.is_folder ? a.is_folder : a.name < b.name;
  });
  folder_ = fs::path(folder).lexically_normal().string();
  if (folder_.size() > 1 && folder_.ends_with('/')) folder_.pop_back();
  if (folder_ != "/") entries.insert(entries.begin(), {kParent, true, 0});
  entries_ = std::move(entries);
  selected_ = entries_.size() > 1 && folder_ != "/" ? 1 : 0;
  sentence_.clear();
  return true;
}

void FileBrowser::move(int entries) {
  if (entries_.empty()) return;
  const auto last = static_cast<std::ptrdiff_t>(entries_.size()) - 1;
  const auto wanted = static_cast<std::ptrdiff_t>(selected_) + entries;
  selected_ = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(wanted, 0, last));
}

std::optional<std::string> FileBrowser::choose(std::size_t entry) {
  if (entry >= entries_.size()) return std::nullopt;
  selected_ = entry;
  const Entry chosen = entries_[entry];
  if (chosen.name == kParent) {
    leave();
    return std::nullopt;
  }
  const std::string path = (fs::path(folder_) / chosen.name).string();
  if (!chosen.is_folder) return path;
  (void)enter(path);
  return std::nullopt;
}

void FileBrowser::leave() {
  const fs::path left = folder_;
  if (!enter(left.parent_path().string())) return;
  const std::string name = left.filename().string();
  for (std::size_t i = 0; i < entries_.size(); ++i)
    if (entries_[i].name == name) selected_ = i;
}

}  // namespace raysheaf::viewer
