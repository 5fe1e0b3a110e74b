// A build with MPI.
#include "raysheaf/distributed.h"

#include "ranks/ranks.h"

namespace raysheaf::app {

std::shared_ptr<Communicator> open_ranks() {
  return mpi_communicator();
}

}  // namespace raysheaf::app
