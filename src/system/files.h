// Files of the operating system, by number. A call that fails returns -1, false or nothing, and
// sets errno. Calls that a signal interrupts are repeated.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

namespace raysheaf::system {

enum class Access : std::uint8_t { kRead, kWrite, kUpdate };

/// Opens an existing file. Neither waits for the other end of a pipe nor passes the file to child
/// processes. On Windows, others may meanwhile read, write and rename the file.
[[nodiscard]] int open_file(const std::string& path, Access access);
/// Opens a file for updates; makes it if it does not exist.
[[nodiscard]] int open_or_make_file(const std::string& path);
/// Makes a new file, for writing; fails with EEXIST if the name is taken.
[[nodiscard]] int make_file(const std::string& path);
/// Makes a file for writing that has no name: unless `give_name` gives it one, the system removes
/// it however the program ends. -1 if the system or the file system has no such files (Windows).
[[nodiscard]] int make_file_without_name(const std::string& folder);
/// Gives such a file a name that is not taken.
[[nodiscard]] bool give_name(int file, const std::string& path);
/// Makes a file for updates that disappears when it is closed, and that only this user may read.
/// `path` is its name where it needs one.
[[nodiscard]] int make_scratch_file(const std::string& path);
[[nodiscard]] bool close_file(int file);

/// Facts about a file.
struct FileState {
  enum class Kind : std::uint8_t { kRegular, kFolder, kOther };
  Kind kind = Kind::kOther;
  std::uint64_t bytes = 0;
  std::int64_t written_ns = 0;           ///< when it was written to last
  std::uint64_t volume = 0, number = 0;  ///< the same for two names of one file, and only then
  unsigned permissions = 0;              ///< for `set_permissions`; 0 on Windows
};
[[nodiscard]] std::optional<FileState> state_of(int file);
[[nodiscard]] std::optional<FileState> state_of(const std::string& path);
void set_permissions(int file, unsigned permissions);

/// Read or write some bytes at `offset` and return how many; 0 at the end of the file.
[[nodiscard]] std::int64_t read_some(int file, std::uint64_t offset, std::span<std::uint8_t> out);
[[nodiscard]] std::int64_t write_some(int file, std::uint64_t offset,
                                      std::span<const std::uint8_t> bytes);
/// Writes to a device or a pipe, which have no offsets.
[[nodiscard]] std::int64_t write_next(int file, std::span<const std::uint8_t> bytes);
[[nodiscard]] bool resize_file(int file, std::uint64_t bytes);

/// Renames a file over another, which stays whole for those who have it open; on Windows it fails
/// while another program has the old file open.
[[nodiscard]] bool replace_file(const std::string& from, const std::string& to);
bool remove_file(const std::string& path);
/// `beginning` with an ending that no other call returns, here, in another process or on another
/// machine.
[[nodiscard]] std::string unused_name(const std::string& beginning);
/// Makes a folder among the system's temporary files that only this user may read; empty if that
/// fails.
[[nodiscard]] std::string make_temporary_folder();
/// Whether this user may make files in the folder. On Windows: whether it is a folder.
[[nodiscard]] bool can_make_files_in(const std::string& folder);
/// Calls `take` with the names in a folder, in no order; with none if there is no such folder.
void for_each_name(const std::string& folder, const std::function<void(const char*)>& take);

}  // namespace raysheaf::system
