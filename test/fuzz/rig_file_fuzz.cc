// Rig files: any bytes either parse to a valid rig, or give a one-line message.
#include "rigel/problems/io/rig_file.h"
#include "rigel/test/fuzz/fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using rigel::fuzz::Require;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  rigel::RigFile file;
  std::string error;
  if (!rigel::ParseRigFile(text, "fuzz", &file, &error)) {
    rigel::fuzz::RequireMessage(error);
    return 0;
  }
  Require(file.rig.IsValid(&error), "what was read is valid: " + error);
  Require(file.camera_names.size() == file.rig.cameras.size(), "each camera has a name");
  return 0;
}
