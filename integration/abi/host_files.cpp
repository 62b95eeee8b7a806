#include "integration/abi/host_files.hpp"

#include "framegraph/text/limits.hpp"

#include <fmt/format.h>

namespace dermis::abi {

FileText ask_host(dermis_include_fn include, void* user, std::string_view name) {
  if (include == nullptr) return {"", "", "the host gives no include function"};
  const std::string requested(name);
  dermis_source source = DERMIS_SOURCE_INIT;
  if (include(user, requested.c_str(), &source) != 1) return {"", "", "the host has no such file"};
  if (source.text == nullptr) return {"", "", "the host delivers no text"};
  if (source.length > limits::file_bytes)
    return {"", "",
            fmt::format("the host delivers {} bytes, at most {} are read", source.length,
                        limits::file_bytes)};
  return {source.name != nullptr ? source.name : requested, std::string(source.text, source.length),
          ""};
}

} // namespace dermis::abi
