#include "framegraph/model/graph.hpp"

#include <utility>

namespace dermis {

std::string_view type_name(ResourceType type) {
  return type == ResourceType::image    ? "image"
         : type == ResourceType::buffer ? "buffer"
                                        : "acceleration_structure";
}

std::string_view type_phrase(ResourceType type) {
  return type == ResourceType::image    ? "an image"
         : type == ResourceType::buffer ? "a buffer"
                                        : "an acceleration structure";
}

void Graph::bind(PassDeclaration& pass, PortSide side, const PortBinding& binding,
                 SourceLocation where) {
  if (pass.read_count + pass.write_count == 0)
    pass.first_binding = static_cast<uint32_t>(bindings.size());
  ++(side == PortSide::read ? pass.read_count : pass.write_count);
  names_ranges |= !binding.range.whole();
  bindings.push_back(binding);
  binding_places.push_back(std::move(where));
}

} // namespace dermis
