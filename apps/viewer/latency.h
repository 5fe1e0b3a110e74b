// The time from input to its response on the screen.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace raysheaf::viewer {

class Latency {
 public:
  void add(double ms) { all_.push_back(ms); }
  void clear() { all_.clear(); }
  [[nodiscard]] std::size_t count() const { return all_.size(); }
  /// The smallest value that is not below `part` of all values; 0 without values.
  [[nodiscard]] double percentile(double part) const;
  [[nodiscard]] double largest() const { return percentile(1); }
  /// A line of figures, then a bar for each class of 5 ms.
  [[nodiscard]] std::string histogram() const;

 private:
  std::vector<double> all_;
};

}  // namespace raysheaf::viewer
