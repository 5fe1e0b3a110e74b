// Copies that go on beside a device's own work, so that what is computed, what is copied and what
// the program does next overlap. Every device has two classes, made from it and outlived by it:
//
//   Device::Uplink     from the host, on a stream of its own
//
//     the program    room │ fills it │ send ─┐
//     the uplink                          [ copy ]──────┐
//     the device     [ earlier work ]            see ─► [ work ] ─► done_with
//
//     room(stage, bytes) -> place   in memory of the host that the device reads by itself; waits
//                                   until what was sent from there has left it
//     send(stage, to, bytes)        the first bytes of the room go to `to`, on the device, once all
//                                   that was asked for before `done_with` is done
//     see(stage)                    what the device is asked for from now on comes after the copy
//     done_with(stage)              all that looks at the copy has been asked for
//
//   Device::Downlink   to the host, in the order of the device's work
//
//     ask(stage, from, bytes)       what is there when the device's work gets here
//     wait(stage) -> place          the bytes, until the next `ask`
//
// `to` was allocated before the device was waited for last. What was asked for may still be under
// way when a link goes: it waits.
#pragma once

#include <cstdint>

#include "raysheaf/error.h"

namespace raysheaf {

/// `send`, `see` and `done_with` come by turns: throws where they do not.
class UplinkTurns {
 public:
  void send(const char* stage) { go(kFree, kSent, stage); }
  void see(const char* stage) { go(kSent, kSeen, stage); }
  void done_with(const char* stage) { go(kSeen, kFree, stage); }

 private:
  enum Turn : std::uint8_t { kFree, kSent, kSeen };

  void go(Turn from, Turn to, const char* stage) {
    if (turn_ != from) throw Error(ErrorCode::kInternal, "an uplink was used out of turn", stage);
    turn_ = to;
  }

  Turn turn_ = kFree;
};

}  // namespace raysheaf
