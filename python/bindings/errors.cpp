#include "errors.h"

namespace voxshell::python {
namespace {

const char* exception_name(ErrorCode code) {
  switch (code) {
    case ErrorCode::kInvalidArgument:
      return "SettingsError";
    case ErrorCode::kInvalidMesh:
      return "MeshError";
    case ErrorCode::kInvalidPose:
      return "PoseError";
    case ErrorCode::kTooLarge:
      return "MemoryLimitError";
    case ErrorCode::kCancelled:
      break;
  }
  return "VoxshellError";
}

}  // namespace

void raise(const Error& error) {
  const nanobind::object type =
      nanobind::module_::import_("voxshell.errors").attr(exception_name(error.code));
  PyErr_SetString(type.ptr(), error.message.c_str());
  throw nanobind::python_error();
}

}  // namespace voxshell::python
