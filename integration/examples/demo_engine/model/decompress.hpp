#pragma once
// Compressed parts of a glTF file. Each extension is read where the library that decodes it was there when
// this was built.

#include "integration/examples/demo_engine/result.hpp"

#include <tiny_gltf.h>

#include <string>

namespace demo {

inline constexpr const char* meshopt_extension = "EXT_meshopt_compression";
inline constexpr const char* draco_extension = "KHR_draco_mesh_compression";
#ifdef DEMO_MESHOPT
inline constexpr bool reads_meshopt = true;
#else
inline constexpr bool reads_meshopt = false;
#endif
#ifdef DEMO_DRACO
inline constexpr bool reads_draco = true;
#else
inline constexpr bool reads_draco = false;
#endif

// Puts views of decoded bytes, and accessors of decoded vertices, in the place of compressed ones, as far as
// this build reads them; others stay as they are, with the uncompressed bytes that the file may have beside
// them. `path` names the file in messages. Errors: input.
Result<> decompress(tinygltf::Model& model, const std::string& path);

} // namespace demo
