// Folders and the scene files in them, for the open dialog.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace raysheaf::viewer {

class FileBrowser {
 public:
  struct Entry {
    std::string name;
    bool is_folder = false;
    std::uint64_t bytes = 0;
  };

  /// Begins in this folder, or in the current one if it cannot be read.
  explicit FileBrowser(const std::string& folder);

  [[nodiscard]] const std::string& folder() const { return folder_; }
  /// The parent folder as "..", the folders, then the files that `load_animation` reads, by name.
  /// Hidden ones are left out.
  [[nodiscard]] const std::vector<Entry>& entries() const { return entries_; }
  [[nodiscard]] std::size_t selected() const { return selected_; }
  /// Why the last folder was not entered; otherwise empty.
  [[nodiscard]] const std::string& sentence() const { return sentence_; }

  /// Moves the selection.
  void move(int entries);
  /// Enters a folder; returns the path of a file.
  [[nodiscard]] std::optional<std::string> choose(std::size_t entry);
  /// Enters the parent folder.
  void leave();

 private:
  bool enter(const std::string& folder);

  std::string folder_, sentence_;
  std::vector<Entry> entries_;
  std::size_t selected_ = 0;
};

}  // namespace raysheaf::viewer
