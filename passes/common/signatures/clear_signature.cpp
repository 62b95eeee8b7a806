// Clears resources that later passes write only in part.

#include "passes/common/signatures/signatures.hpp"

namespace dermis::subsurface {

namespace {
constexpr Port ports[] = {{"target", Usage::clear, false, "", "an image or a buffer, as a whole"}};
} // namespace

const PassType clear_type{
    .name = "clear",
    .shader = "",
    .doc = "Fills an image or a buffer with zeros. Runs no kernel.",
    .ports = ports,
    .settings = {},
    .dispatch = no_dispatch,
};

} // namespace dermis::subsurface
