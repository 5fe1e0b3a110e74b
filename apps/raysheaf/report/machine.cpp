#include "report/machine.h"

#include <fmt/format.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <ctime>
#include <fstream>
#include <thread>

#include "raysheaf/context.h"
#include "raysheaf/version.h"

namespace raysheaf::app {
namespace {

std::string processor(const utsname& system) {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return system.machine;
}

std::string now() {
  const std::time_t time = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&time, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%d %H:%M UTC", &utc);
  return text;
}

}  // namespace

Machine describe_machine(const Report& report) {
  Machine machine;
  utsname system{};
  uname(&system);
  const FrameStatistics& statistics = report.picture.statistics;
  machine.processor = processor(system);
  machine.cores = std::thread::hardware_concurrency();
  machine.threads = statistics.threads;
  machine.memory_bytes = static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) *
                         static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  machine.simd = simd_target();
  machine.system = fmt::format("{} {} on {}", system.sysname, system.release, system.machine);
  machine.compiler = __VERSION__;
  machine.opengl = statistics.primary;
  machine.version = RAYSHEAF_VERSION;
  machine.date = now();
  return machine;
}

std::vector<std::pair<std::string, std::string>> facts_of(const Machine& m) {
  return {{"raysheaf", m.version},
          {"Made", m.date},
          {"Processor", m.processor},
          {"Threads", fmt::format("{} used, {} there", m.threads, m.cores)},
          {"SIMD", m.simd},
          {"Memory", fmt::format("{:.1f} GiB", static_cast<double>(m.memory_bytes) / (1 << 30))},
          {"First hits", m.opengl},
          {"System", m.system},
          {"Compiler", m.compiler}};
}

}  // namespace raysheaf::app
