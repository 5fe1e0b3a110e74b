// Primary rays of a whole image.
#pragma once

#include <vector>

#include "render/rays/camera_body.h"

namespace raysheaf {

/// `camera_ray` of any pixel, bit for bit; values shared by the pixels of a column or a row are
/// computed once.
class CameraRays {
 public:
  CameraRays() = default;
  explicit CameraRays(const CameraFrame& frame) : frame_(frame) {
    columns_.reserve(frame.width);
    for (std::uint32_t x = 0; x < frame.width; ++x) columns_.push_back(column_right(frame, x));
    rows_.reserve(frame.height);
    for (std::uint32_t y = 0; y < frame.height; ++y) rows_.push_back(row_up(frame, y));
  }

  [[nodiscard]] const CameraFrame& frame() const { return frame_; }
  [[nodiscard]] Ray at(std::uint32_t x, std::uint32_t y) const {
    return camera_ray(frame_, x, y, columns_[x] - rows_[y]);
  }

 private:
  CameraFrame frame_;
  std::vector<Vec3> columns_, rows_;
};

}  // namespace raysheaf
