#!/bin/sh
# Checks that the public header compiles on its own, without warnings, in every supported C and C++
# standard.
# usage: header_compiles.sh SOURCE_DIR
set -eu
include="$1/integration/include"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

cat > "$scratch/alone.c" <<'EOF'
#include <dermis/dermis.h>
#include <dermis/dermis.h>
size_t use(void);
size_t use(void) {
  dermis_context_desc context_desc = DERMIS_CONTEXT_DESC_INIT;
  dermis_graph_desc graph_desc = DERMIS_GRAPH_DESC_INIT;
  dermis_image_binding binding = DERMIS_IMAGE_BINDING_INIT;
  dermis_source source = DERMIS_SOURCE_INIT;
  dermis_profile profile = DERMIS_PROFILE_INIT;
  dermis_slot_format slot_format = DERMIS_SLOT_FORMAT_INIT;
  dermis_message message = DERMIS_MESSAGE_INIT;
  dermis_requirement requirement = DERMIS_REQUIREMENT_INIT;
  dermis_slot slot = DERMIS_SLOT_INIT;
  dermis_memory memory = DERMIS_MEMORY_INIT;
  dermis_pass_timing timing = DERMIS_PASS_TIMING_INIT;
  dermis_frame frame = DERMIS_FRAME_INIT;
  dermis_budget budget = DERMIS_BUDGET_INIT;
  dermis_forecast_desc forecast_desc = DERMIS_FORECAST_DESC_INIT;
  dermis_outcome outcome = DERMIS_OUTCOME_INIT;
  dermis_frame_report report = DERMIS_FRAME_REPORT_INIT;
  dermis_frame_statistics statistics = DERMIS_FRAME_STATISTICS_INIT;
  dermis_port port = DERMIS_PORT_INIT;
  dermis_pass_setting setting = DERMIS_PASS_SETTING_INIT;
  dermis_pass_port pass_port = DERMIS_PASS_PORT_INIT;
  dermis_pass_call call = DERMIS_PASS_CALL_INIT;
  dermis_pass_type kind = DERMIS_PASS_TYPE_INIT;
  return context_desc.struct_size + graph_desc.struct_size + binding.struct_size +
         source.struct_size + profile.struct_size + slot_format.struct_size + message.struct_size +
         requirement.struct_size + slot.struct_size + memory.struct_size + timing.struct_size +
         frame.struct_size + budget.struct_size + report.struct_size + statistics.struct_size +
         port.struct_size + setting.struct_size + pass_port.struct_size + call.struct_size +
         kind.struct_size + forecast_desc.struct_size + outcome.struct_size;
}
EOF
cp "$scratch/alone.c" "$scratch/alone.cpp"
sed 's|<dermis/dermis.h>|<dermis/choice.h>|' "$scratch/alone.c" > "$scratch/choice_first.c"
{ echo '#include <vulkan/vulkan.h>'; cat "$scratch/alone.c"; } > "$scratch/after_vulkan.c"
{
  echo '#define VK_NO_PROTOTYPES'
  cat "$scratch/alone.c"
  echo '#include <volk.h>'
} > "$scratch/with_volk.c"

failed=0
check() { # compiler standard file
  if ! "$1" "-std=$2" -pedantic -Wall -Wextra -Werror -fsyntax-only -I"$include" "$3" \
       > "$scratch/out" 2>&1; then
    echo "$1 -std=$2 $(basename "$3"):"
    cat "$scratch/out"
    failed=1
  fi
}
checked=0
for compiler in gcc clang; do
  command -v $compiler > /dev/null || continue
  for standard in c99 c11 c17; do
    for file in alone.c choice_first.c after_vulkan.c with_volk.c; do
      check $compiler $standard "$scratch/$file"
    done
  done
  checked=1
done
for compiler in g++ clang++; do
  command -v $compiler > /dev/null || continue
  for standard in c++11 c++14 c++17 c++20; do check $compiler $standard "$scratch/alone.cpp"; done
done
# Other targets, only with clang and this machine's Vulkan headers.
if command -v clang > /dev/null; then
  for target in aarch64-linux-gnu riscv64-linux-gnu armv7-linux-gnueabihf i686-linux-gnu \
    x86_64-w64-mingw32; do
    if ! clang --target=$target -std=c11 -ffreestanding -nostdlibinc -idirafter /usr/include \
         -Wall -Wextra -Werror -fsyntax-only -I"$include" "$scratch/alone.c" \
         > "$scratch/out" 2>&1; then
      echo "$target:"
      cat "$scratch/out"
      failed=1
    fi
  done
fi
[ $checked = 1 ] || { echo "no C compiler found"; exit 1; }
exit $failed
