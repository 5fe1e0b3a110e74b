// Where the results of a query go. For sources that include a device.
#pragma once

#include "base/view.h"
#include "exec/device.h"

namespace raysheaf {

/// Where the device writes the results for `out`: there, or to a buffer of its own.
template <class Device, class T>
T* landing_on(Device& device, const char* stage, View<T> out, DeviceBuffer<T>* buffer) {
  if (device.is_device_memory(out.data, stage)) return out.data;
  buffer->resize_uninitialized(stage, out.size);
  return buffer->data();
}

/// Orders the query after the caller's earlier work. `query` has `stream` and `results_stream`.
template <class Device, class Query>
void wait_for_streams(Device& device, const Query& query) {
  device.wait_for("rays", query.stream);
  if (query.results_stream != nullptr) device.wait_for("hits", query.results_stream);
}

}  // namespace raysheaf
