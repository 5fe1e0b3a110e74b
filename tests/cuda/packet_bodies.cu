// Compiles the device functions of packets and the building blocks of loops.
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
