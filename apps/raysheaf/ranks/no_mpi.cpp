// A build without MPI.
#include "ranks/ranks.h"
#include "raysheaf/error.h"

namespace raysheaf::app {

std::shared_ptr<Communicator> open_ranks() {
  throw Error(ErrorCode::kUnsupported,
              std::to_string(launch().size) +
                  " processes were started, but this build cannot share work among them: MPI was "
                  "missing, or switched off, when it was built",
              "mpirun");
}

}  // namespace raysheaf::app
