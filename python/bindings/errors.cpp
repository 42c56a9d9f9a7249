#include "errors.h"

#include <exception>
#include <new>
#include <stdexcept>
#include <string_view>

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
    case ErrorCode::kCanceled:
      break;
  }
  return "VoxshellError";
}

/// Sets Python's error indicator.
void set_exception(const char* name, std::string_view text) {
  const nanobind::object type = nanobind::module_::import_("voxshell.errors").attr(name);
  // The name of a file may be any bytes.
  const auto message = nanobind::steal(
      PyUnicode_DecodeUTF8(text.data(), static_cast<Py_ssize_t>(text.size()), "replace"));
  if (message) PyErr_SetObject(type.ptr(), message.ptr());
}

}  // namespace

void raise(const Error& error) {
  set_exception(exception_name(error.code), error.message);
  throw nanobind::python_error();
}

void translate_exceptions() {
  nanobind::register_exception_translator([](const std::exception_ptr& thrown, void*) {
    try {
      std::rethrow_exception(thrown);
    } catch (const std::bad_alloc&) {
      set_exception("MemoryLimitError",
                    "the system gives no more memory; use a coarser model, or smaller batches");
    } catch (const std::length_error&) {
      set_exception("MemoryLimitError", "an array would be larger than memory can be");
    } catch (const std::out_of_range& error) {
      set_exception("SettingsError", error.what());
    }
  });
}

}  // namespace voxshell::python
