// How long input waits for its answer on the screen.
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
  /// The least value that `part` of all are not above; 0 where there are none.
  [[nodiscard]] double percentile(double part) const;
  [[nodiscard]] double largest() const { return percentile(1); }
  /// A line of figures, then a bar a class of 5 ms.
  [[nodiscard]] std::string histogram() const;

 private:
  std::vector<double> all_;
};

}  // namespace raysheaf::viewer
