#include <atomic>
#include <chrono>

#include "system/files.h"
#include "system/process.h"

namespace raysheaf::system {

std::string unused_name(const std::string& beginning) {
  static std::atomic<unsigned> counter{0};
  // Machines that share a folder may have processes with the same number.
  static const std::string began =
      std::to_string(std::chrono::system_clock::now().time_since_epoch().count());
  // Read for each name: after a fork the number differs, while all other parts are equal.
  const std::string process = std::to_string(process_number());
  return beginning + process + "." + began + "." + std::to_string(counter++);
}

}  // namespace raysheaf::system
