// Compiles the bodies of packets for the device.
#include "cuda/compile_case.h"
#include "cuda/packet_cases.h"

namespace raysheaf::test {

std::vector<CompiledCase> compiled_packet_cases() {
  return {compiled<PacketBoundCase>("PacketBound"), compiled<PacketPartsCase>("PacketParts"),
          compiled<BvhCase>("Bvh")};
}

}  // namespace raysheaf::test
