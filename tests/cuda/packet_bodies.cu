// Compiles the bodies of packets, and what loops are made of, for the device.
#include "cuda/compile_case.h"
#include "cuda/exec_cases.h"
#include "cuda/packet_cases.h"

namespace raysheaf::test {

std::vector<CompiledCase> compiled_packet_cases() {
  return {compiled<PacketBoundCase>("PacketBound"),
          compiled<PacketPartsCase>("PacketParts"),
          compiled<PacketLeafCase>("PacketLeaf"),
          compiled<PacketCutCase>("PacketCut"),
          compiled<BvhCase>("Bvh"),
          compiled<LaunchCase>("Launch")};
}

}  // namespace raysheaf::test
