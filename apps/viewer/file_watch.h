// Notices that files have changed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace raysheaf::viewer {

class FileWatch {
 public:
  /// Forgets other files. Only some of very many files are watched.
  void watch(const std::vector<std::string>& files);
  /// Whether a file differs from when it was last read, and all of them have been the same for the
  /// time between two looks: a program that is still writing gets its time. Looks twice a second;
  /// other calls return false.
  [[nodiscard]] bool changed(double now_s);

 private:
  struct Stamp {
    std::optional<std::filesystem::file_time_type> time;  ///< none: there is no such file
    std::uintmax_t bytes = 0;
    bool operator==(const Stamp&) const = default;
  };
  [[nodiscard]] std::vector<Stamp> look() const;

  std::vector<std::string> files_;
  std::vector<Stamp> read_, last_;
  double looked_s_ = 0;
};

}  // namespace raysheaf::viewer
