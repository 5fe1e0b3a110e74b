// The processes of an MPI run. The separate library raysheaf::mpi exists if raysheaf was built with
// MPI: only programs that link it need MPI; others link raysheaf::raysheaf.
#pragma once

#include <memory>

#include "raysheaf/distributed.h"

namespace raysheaf {

/// The processes of MPI_COMM_WORLD. Starts MPI if the program has not, and then finalizes it when
/// the communicator is destroyed, which all processes do after their last collective call. Calls
/// MPI only on the caller's thread (MPI_THREAD_FUNNELED is enough). Errors of MPI itself abort the
/// run, unless the program sets a different error handler.
[[nodiscard]] std::shared_ptr<Communicator> mpi_communicator();

/// The processes of another communicator, passed as the result of MPI_Comm_c2f so that this header
/// does not need mpi.h. Collective over them. The program starts and finalizes MPI.
[[nodiscard]] std::shared_ptr<Communicator> mpi_communicator(int communicator);

}  // namespace raysheaf
