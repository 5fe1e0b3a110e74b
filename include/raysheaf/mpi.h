// The processes of an MPI run. In a library of its own, raysheaf::mpi, which is there where
// raysheaf was built with MPI: who links it needs MPI, who does not links raysheaf::raysheaf alone.
#pragma once

#include <memory>

#include "raysheaf/distributed.h"

namespace raysheaf {

/// Those of MPI_COMM_WORLD. Starts MPI where the program has not, and then ends it with the
/// communicator, which all processes let go of after their last collective call. MPI is called on
/// the caller's thread alone (MPI_THREAD_FUNNELED is enough). Failures of MPI itself end the run,
/// as MPI does unless it is told otherwise.
[[nodiscard]] std::shared_ptr<Communicator> mpi_communicator();

/// The same of other processes: `communicator` is what MPI_Comm_c2f gives, so that this header
/// needs no mpi.h. Collective over them. MPI has been started, and is ended by the program.
[[nodiscard]] std::shared_ptr<Communicator> mpi_communicator(int communicator);

}  // namespace raysheaf
