// Clears resources that later passes write only in part.

#include "passes/common/signatures/signatures.hpp"

namespace dermis::subsurface {

namespace {
constexpr Port ports[] = {{"target", Usage::clear, false, "", "an image or buffer, whole", {}}};
} // namespace

const PassType clear_type{
    .name = "clear",
    .shader = "",
    .doc = "Fills an image or buffer with zeros. No kernel.",
    .ports = ports,
    .settings = {},
    .dispatch = DispatchShape::none,
    .side_effects = false,
};

} // namespace dermis::subsurface
