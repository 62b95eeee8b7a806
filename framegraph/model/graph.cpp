#include "framegraph/model/graph.hpp"

#include <utility>

namespace dermis {

void Graph::bind(PassDeclaration& pass, PortSide side, const PortBinding& binding, SourceLocation where) {
  if (pass.read_count + pass.write_count == 0) pass.first_binding = static_cast<uint32_t>(bindings.size());
  ++(side == PortSide::read ? pass.read_count : pass.write_count);
  parts |= !binding.part.whole();
  bindings.push_back(binding);
  binding_places.push_back(std::move(where));
}

} // namespace dermis
