// Converts `raysheaf::Error` to the Python exceptions in raysheaf/_errors.py.
#include <exception>

#include "core.h"
#include "raysheaf/error.h"

namespace raysheaf::python {
namespace {

const char* name_of(ErrorCode code) {
  switch (code) {
    case ErrorCode::kInvalidArgument:
      return "invalid_argument";
    case ErrorCode::kInvalidData:
      return "invalid_data";
    case ErrorCode::kUnsupported:
      return "unsupported";
    case ErrorCode::kNotFound:
      return "not_found";
    case ErrorCode::kIo:
      return "io";
    case ErrorCode::kOutOfMemory:
      return "out_of_memory";
    case ErrorCode::kNoGraphics:
      return "no_graphics";
    case ErrorCode::kWrongState:
      return "wrong_state";
    case ErrorCode::kCancelled:
      return "cancelled";
    case ErrorCode::kInternal:
      break;
  }
  return "internal";
}

void raise_in_python(const std::exception_ptr& thrown, void*) {
  try {
    std::rethrow_exception(thrown);
  } catch (const Error& error) {
    const nb::object raised = nb::module_::import_("raysheaf._errors")
                                  .attr("error_of")(name_of(error.code()), error.sentence().c_str(),
                                                    error.place().c_str());
    PyErr_SetObject(raised.type().ptr(), raised.ptr());
  }
}

}  // namespace

void bind_errors(nb::module_&) {
  nb::register_exception_translator(raise_in_python, nullptr);
}

}  // namespace raysheaf::python
