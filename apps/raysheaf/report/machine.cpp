#include "report/machine.h"

#include <fmt/format.h>

#include <chrono>
#include <thread>

#include "raysheaf/context.h"
#include "raysheaf/version.h"
#include "system/process.h"

namespace raysheaf::app {
namespace {

std::string now() {
  const auto minute = std::chrono::floor<std::chrono::minutes>(std::chrono::system_clock::now());
  const auto day = std::chrono::floor<std::chrono::days>(minute);
  const std::chrono::year_month_day date = day;
  const auto minutes = (minute - day).count();
  return fmt::format("{:04}-{:02}-{:02} {:02}:{:02} UTC", static_cast<int>(date.year()),
                     static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                     minutes / 60, minutes % 60);
}

}  // namespace

Machine describe_machine(const Report& report) {
  Machine machine;
  const FrameStatistics& statistics = report.picture.statistics;
  machine.processor = system::processor_name();
  machine.cores = std::thread::hardware_concurrency();
  machine.threads = statistics.threads;
  machine.memory_bytes = system::memory_bytes();
  machine.simd = simd_target();
  machine.system = system::system_name();
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
