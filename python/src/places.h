// Arrays in a device's memory or numpy's, and their streams.
#pragma once

#include <span>
#include <utility>
#include <variant>

#include "core.h"

namespace raysheaf::python {

/// A numpy array, or an array in a device's memory.
template <class Array>
using Anywhere = std::variant<Array, Place>;

template <class Item, class... Arrays>
std::span<Item> items_of(const std::variant<Arrays...>& from) {
  if (const Place* place = std::get_if<Place>(&from))
    return {static_cast<Item*>(place->pointer), place->count};
  const auto& array = std::get<0>(from);
  return {reinterpret_cast<Item*>(array.data()), array.shape(0)};
}

/// The streams of arrays on a device.
struct Streams {
  bool any_place = false;  ///< whether any array is on a device
  void *asked = nullptr, *results = nullptr;
};

/// Null: the array is numpy's.
inline Streams streams_of(const Place* from, const Place* to) {
  Streams streams{from != nullptr || to != nullptr, from != nullptr ? from->stream : nullptr,
                  to != nullptr ? to->stream : nullptr};
  // A null pointer in `streams.asked` would mean CUDA's default stream to the library; no array
  // asked for that one.
  if (streams.asked == nullptr) streams.asked = std::exchange(streams.results, nullptr);
  return streams;
}

}  // namespace raysheaf::python
