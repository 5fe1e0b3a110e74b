#include "scale/model.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace raysheaf::app {
namespace {

/// Bytes of the colour of a pixel.
constexpr double kPixelBytes = 12;

constexpr double ScaleCost::*kAll[] = {&ScaleCost::decode_s, &ScaleCost::cull_s,
                                       &ScaleCost::trace_s,  &ScaleCost::shading_s,
                                       &ScaleCost::rest_s,   &ScaleCost::bytes};

/// Least squares of relative errors over the columns in `use`, by the normal equations. Returns
/// whether no coefficient is negative.
bool fit(const std::vector<std::array<double, 3>>& rows, const std::vector<double>& values,
         unsigned use, std::array<double, 3>* out) {
  double a[3][4] = {};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double weight = values[i] > 0 ? 1 / (values[i] * values[i]) : 0;
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) a[r][c] += weight * rows[i][r] * rows[i][c];
      a[r][3] += weight * rows[i][r] * values[i];
    }
  }
  for (int r = 0; r < 3; ++r) {
    if ((use >> r & 1) != 0) continue;
    for (int c = 0; c < 4; ++c) a[r][c] = 0;
    for (auto& row : a) row[r] = 0;
    a[r][r] = 1;
  }
  for (int p = 0; p < 3; ++p) {
    if (!(std::fabs(a[p][p]) > 0)) return false;
    for (int r = 0; r < 3; ++r) {
      if (r == p) continue;
      const double factor = a[r][p] / a[p][p];
      for (int c = p; c < 4; ++c) a[r][c] -= factor * a[p][c];
    }
  }
  for (int r = 0; r < 3; ++r) (*out)[static_cast<std::size_t>(r)] = a[r][3] / a[r][r];
  return std::all_of(out->begin(), out->end(),
                     [](double x) { return std::isfinite(x) && x >= -1e-12; });
}

double relative_error(const std::vector<std::array<double, 3>>& rows,
                      const std::vector<double>& values, const std::array<double, 3>& k) {
  double sum = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!(values[i] > 0)) continue;
    const double guess = k[0] * rows[i][0] + k[1] * rows[i][1] + k[2] * rows[i][2];
    sum += (guess / values[i] - 1) * (guess / values[i] - 1);
  }
  return sum;
}

/// The best fit without negative coefficients: there are so few of them that all subsets are tried.
std::array<double, 3> best_fit(const std::vector<std::array<double, 3>>& rows,
                               const std::vector<double>& values) {
  std::array<double, 3> best{}, tried{};
  double least = std::numeric_limits<double>::infinity();
  for (unsigned use = 1; use < 8; ++use) {
    if (!fit(rows, values, use, &tried)) continue;
    const double error = relative_error(rows, values, tried);
    if (error < least * (1 - 1e-9)) least = error, best = tried;
  }
  return best;
}

void decide(ScaleForecast* f) {
  f->total_s = std::max(f->disk_s, f->compute_s) + f->network_s;
  const double most = std::max({f->disk_s, f->compute_s, f->network_s});
  f->bound_by = most == f->disk_s ? "disk" : most == f->compute_s ? "cores" : "network";
}

}  // namespace

ScaleModel::ScaleModel(const std::vector<ScaleSample>& samples) {
  for (std::size_t field = 0; field < kFields; ++field) {
    std::vector<std::array<double, 3>> rows;
    std::vector<double> values;
    for (const ScaleSample& sample : samples) {
      rows.push_back({1, sample.triangles, sample.pixels});
      values.push_back(sample.cost.*kAll[field]);
    }
    fits_[field] = best_fit(rows, values);
  }
}

std::array<double, 3> ScaleModel::coefficients(double ScaleCost::*field) const {
  return fits_[static_cast<std::size_t>(std::find(std::begin(kAll), std::end(kAll), field) -
                                        std::begin(kAll))];
}

ScaleCost ScaleModel::cost(double triangles, double pixels) const {
  ScaleCost cost;
  for (std::size_t field = 0; field < kFields; ++field) {
    const auto& k = fits_[field];
    cost.*kAll[field] = k[0] + k[1] * triangles + k[2] * pixels;
  }
  return cost;
}

double serial_part(double core_s, double seconds, double cores) {
  if (!(cores > 1) || !(core_s > 0)) return 0;
  return std::clamp((seconds / core_s - 1 / cores) / (1 - 1 / cores), 0.0, 1.0);
}

ScaleForecast forecast_geometry(const ScaleModel& model, double triangles, double pixels,
                                double batches, const ScaleMachines& machines) {
  const double ranks = machines.ranks;
  const ScaleCost own = model.cost(triangles / ranks, pixels), all = model.cost(triangles, pixels);
  ScaleForecast f;
  // The ranks share the blocks, but each of them lights all hits and reads their shading data.
  f.disk_s = own.bytes / machines.disk_bytes_s;
  f.compute_s =
      clock_seconds(own.decode_s + own.cull_s + own.trace_s + all.shading_s + all.rest_s, machines);
  if (machines.ranks > 1)
    f.network_s =
        batches * (2 * pixels * kHitBytes * (ranks - 1) / ranks / machines.network_bytes_s +
                   2 * (ranks - 1) * machines.latency_s);
  decide(&f);
  return f;
}

ScaleForecast forecast_rays(const ScaleModel& model, double triangles, double pixels,
                            double sharing, const ScaleMachines& machines) {
  const double part = 1.0 / machines.ranks;
  const double read = std::pow(part, sharing);
  const ScaleCost own = model.cost(triangles * read, pixels * part);
  ScaleForecast f;
  f.disk_s = own.bytes / machines.disk_bytes_s;
  f.compute_s = clock_seconds(own.core_s(), machines);
  if (machines.ranks > 1)
    f.network_s = pixels * kPixelBytes / machines.network_bytes_s + machines.latency_s;
  decide(&f);
  return f;
}

}  // namespace raysheaf::app
