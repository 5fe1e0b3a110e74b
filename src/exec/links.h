// Copies that overlap a device's own work, so that computing, copying and the program's next steps
// run in parallel. Every device has two classes, made from it and outlived by it:
//
//   Device::Uplink     from the host, on a stream of its own
//
//     the program    room │ fills it │ send ─┐
//     the uplink                          [ copy ]──────┐
//     the device     [ earlier work ]            see ─► [ work ] ─► done_with
//
//     room(stage, bytes) -> place   returns host memory that the device accesses directly; waits
//                                   until the previous copy from there is done
//     send(stage, to, bytes)        copies the room's first bytes to `to`, on the device, after
//                                   all work that was queued before `done_with`
//     see(stage)                    the device's work queued from now on comes after the copy
//     done_with(stage)              all work that reads the copy has been queued
//
//   Device::Downlink   to the host, in the order of the device's work
//
//     ask(stage, from, bytes)       requests the content at this point of the device's queue
//     wait(stage) -> place          returns the bytes, which are valid until the next `ask`
//
// `to` must have been allocated before the last wait for the device. A link's destructor waits for
// pending copies.
#pragma once

#include <cstdint>

#include "raysheaf/error.h"

namespace raysheaf {

/// Checks that `send`, `see` and `done_with` are called in this order, and throws otherwise.
class UplinkTurns {
 public:
  void send(const char* stage) { go(kFree, kSent, stage); }
  void see(const char* stage) { go(kSent, kSeen, stage); }
  void done_with(const char* stage) { go(kSeen, kFree, stage); }

 private:
  enum Turn : std::uint8_t { kFree, kSent, kSeen };

  void go(Turn from, Turn to, const char* stage) {
    if (turn_ != from)
      throw Error(ErrorCode::kInternal, "the functions of an uplink were called in the wrong order",
                  stage);
    turn_ = to;
  }

  Turn turn_ = kFree;
};

}  // namespace raysheaf
