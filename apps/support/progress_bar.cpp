#include "apps/support/progress_bar.h"

#include <fmt/format.h>

#include <algorithm>

#include "apps/support/console.h"
#include "apps/support/table.h"
#include "system/terminal.h"

namespace raysheaf::app {
namespace {

constexpr std::chrono::milliseconds kRedrawEvery{100};
constexpr std::size_t kMostCells = 24, kFewestCells = 6, kStageColumns = 22;

std::string short_time(double seconds) {
  if (seconds < 60) return fmt::format("{:.0f} s", seconds);
  const auto whole = static_cast<std::uint64_t>(std::min(seconds, 3.6e8));
  if (whole < 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
  return fmt::format("{} h {} min", whole / 3600, whole / 60 % 60);
}

}  // namespace

std::string progress_line(std::string_view stage, std::uint64_t done, std::uint64_t total,
                          double elapsed_s, std::size_t columns) {
  done = std::min(done, total);
  const double part = total == 0 ? 0 : static_cast<double>(done) / static_cast<double>(total);
  const std::string name = fmt::format("{:<{}}", stage, kStageColumns);
  std::string numbers =
      fmt::format("{:>3.0f} %  {} of {}", part * 100, short_number(static_cast<double>(done)),
                  short_number(static_cast<double>(total)));
  if (done > 0 && elapsed_s > 0.2) {
    const double rate = static_cast<double>(done) / elapsed_s;
    numbers += fmt::format("  {}/s  {} left", short_number(rate),
                           short_time(static_cast<double>(total - done) / rate));
  }
  // The bar shrinks first, because the numbers say more.
  const std::size_t others = name.size() + numbers.size() + std::string_view(" [] ").size();
  const std::size_t cells = std::min(columns > others ? columns - others : 0, kMostCells);
  if (cells < kFewestCells) return (name + " " + numbers).substr(0, columns);
  const auto filled = static_cast<std::size_t>(part * static_cast<double>(cells));
  const std::string line = fmt::format("{} [{}{}] {}", name, std::string(filled, '#'),
                                       std::string(cells - filled, '.'), numbers);
  return line.substr(0, columns);
}

ProgressBar::ProgressBar(std::FILE* stream, bool wanted)
    : stream_(stream), active_(wanted && system::is_terminal(stream)) {}

void ProgressBar::wipe() {
  if (!drawn_) return;
  drawn_ = false;
  std::fputs("\r\033[K", stream_);
  std::fflush(stream_);
}

void ProgressBar::update(std::string_view stage, std::uint64_t done, std::uint64_t total) {
  if (!active_) return;
  const Clock::time_point now = Clock::now();
  const bool new_stage = stage != stage_;
  if (new_stage) {
    stage_ = stage;
    stage_start_ = now;
  }
  if (drawn_ && now - last_draw_ < kRedrawEvery) return;
  const double elapsed = std::chrono::duration<double>(now - stage_start_).count();
  // One column stays free: a full line would make some terminals wrap.
  const std::size_t columns = std::max<std::size_t>(terminal_columns(stream_), 2) - 1;
  fmt::print(stream_, "\r\033[K{}", progress_line(stage, done, total, elapsed, columns));
  std::fflush(stream_);
  drawn_ = true;
  last_draw_ = now;
}

}  // namespace raysheaf::app
