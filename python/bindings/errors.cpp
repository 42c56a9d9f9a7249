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
    case ErrorCode::kInvalidFile:
      return "ModelFileError";
    case ErrorCode::kFileAccess:
      return "FileAccessError";
    case ErrorCode::kCancelled:
      break;
  }
  return "VoxshellError";
}

}  // namespace

void raise(const Error& error) {
  const nanobind::object type =
      nanobind::module_::import_("voxshell.errors").attr(exception_name(error.code));
  // The name of a file may be of any bytes.
  const auto message = nanobind::steal(PyUnicode_DecodeUTF8(
      error.message.data(), static_cast<Py_ssize_t>(error.message.size()), "replace"));
  if (message) PyErr_SetObject(type.ptr(), message.ptr());
  throw nanobind::python_error();
}

}  // namespace voxshell::python
