#pragma once
// Compressed parts of a glTF file. An extension is supported if the library that decodes it was
// available at build time.

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

// Replaces compressed parts by views of decoded bytes and accessors of decoded vertices, for the
// extensions of this build. Other parts are unchanged and keep the uncompressed fallback that the
// file may have. `path` names the file in messages. Errors: input.
Result<> decompress(tinygltf::Model& model, const std::string& path);

} // namespace demo
