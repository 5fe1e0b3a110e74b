#include "emulated/emulated_links.h"

#include <new>
#include <utility>

namespace raysheaf {
namespace {

void make_room(const char* stage, std::size_t bytes, std::vector<std::byte>* room) {
  try {
    if (room->size() < bytes) room->resize(bytes);
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::kOutOfMemory, "there is not enough memory", stage);
  }
}

}  // namespace

std::byte* EmulatedUplink::room(const char* stage, std::size_t bytes) {
  arrive(stage);
  make_room(stage, bytes, &room_);
  return room_.data();
}

void EmulatedUplink::send(const char* stage, void* to, std::size_t bytes) {
  turns_.send(stage);
  to_ = to;
  bytes_ = bytes;
}

void EmulatedUplink::see(const char* stage) {
  turns_.see(stage);
  arrive(stage);
}

void EmulatedUplink::arrive(const char* stage) {
  void* const to = std::exchange(to_, nullptr);
  if (to != nullptr) device_.copy(stage, to, room_.data(), bytes_);
}

void EmulatedDownlink::ask(const char* stage, const void* from, std::size_t bytes) {
  make_room(stage, bytes, &room_);
  device_.copy(stage, room_.data(), from, bytes);
}

}  // namespace raysheaf
