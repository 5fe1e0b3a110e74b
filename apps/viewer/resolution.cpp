#include "resolution.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace raysheaf::viewer {
namespace {

constexpr double kStep = 1.25;
constexpr double kLeastScale = 0.25;
constexpr double kLeastSide = 32;
/// The weight of a new measurement; a slower one counts more, so that only one response is late and
/// not two.
constexpr double kBetter = 0.25, kWorse = 0.7;

constexpr std::array<float, 5> kPreviewParts = {1, 0.75f, 0.5f, 0.375f, 0.25f};
/// An input that arrives just after a frame has begun waits for this frame and for the next one:
/// two frames of the longest time are below 50 ms.
constexpr double kLongFrameMs = 20, kFrameGoalMs = 15, kHopelessMs = 120;
constexpr int kFramesBeforeGrowth = 20;

}  // namespace

void Resolution::took(std::uint64_t pixels, double ms) {
  if (pixels == 0 || !(ms >= 0)) return;
  const auto n = static_cast<double>(pixels);
  // The slope between two sizes gives the fixed part; a single size would not.
  const double ratio = last_pixels_ > 0 ? n / last_pixels_ : 1;
  if (ratio > 1.5 || ratio < 1 / 1.5) {
    const double slope = std::max(0.0, (ms - last_ms_) / (n - last_pixels_));
    const double fixed = std::clamp(ms - slope * n, 0.0, 0.9 * ms);
    fixed_ms_ += 0.3 * (fixed - fixed_ms_);
  }
  last_pixels_ = n;
  last_ms_ = ms;
  const double rest = std::max(ms - fixed_ms_, 0.05 * ms) / n;
  const double weight = rest > pixel_ms_ ? kWorse : kBetter;
  pixel_ms_ = known_ ? pixel_ms_ + weight * (rest - pixel_ms_) : rest;
  fixed_ms_ = std::min(fixed_ms_, ms);
  known_ = true;
}

double Resolution::expected_ms(std::uint64_t pixels) const {
  return known_ ? fixed_ms_ + pixel_ms_ * static_cast<double>(pixels) : 0;
}

Size Resolution::size_for(Size window, double goal_ms) {
  if (window.pixels() == 0) return {1, 1};
  if (known_) {
    const double room = std::max(goal_ms - fixed_ms_, 0.1 * goal_ms);
    const double pixels = room / std::max(pixel_ms_, 1e-12);
    const double wanted = std::sqrt(pixels / static_cast<double>(window.pixels()));
    if (wanted < scale_) scale_ = wanted;
    if (wanted > scale_ * kStep) scale_ = std::min(wanted, scale_ * kStep);
  }
  scale_ = std::clamp(scale_, kLeastScale, 1.0);
  const auto side = [this](std::uint32_t whole) {
    const double scaled = std::max(std::round(whole * scale_), kLeastSide);
    return static_cast<std::uint32_t>(std::min<double>(scaled, whole));
  };
  return {side(window.width), side(window.height)};
}

float PreviewResolution::part() const {
  return kPreviewParts[step_];
}

void PreviewResolution::took(double ms) {
  if (!(ms >= 0)) return;
  mean_ms_ = frames_ == 0 ? ms : mean_ms_ + 0.25 * (ms - mean_ms_);
  ++frames_;
  const bool smallest = step_ + 1 == kPreviewParts.size();
  slow_frames_ = smallest && ms > kHopelessMs ? slow_frames_ + 1 : 0;
  if (mean_ms_ > kLongFrameMs && !smallest) {
    ++step_;
    frames_ = 0;
  } else if (step_ > 0 && frames_ >= kFramesBeforeGrowth) {
    // As if the whole time were spent on pixels.
    const float larger = kPreviewParts[step_ - 1] / part();
    if (mean_ms_ * static_cast<double>(larger * larger) > kFrameGoalMs) return;
    --step_;
    frames_ = 0;
  }
}

}  // namespace raysheaf::viewer
