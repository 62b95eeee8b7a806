#!/bin/sh
# Checks that every GLSL include compiles alone and depends on nothing that its includer defines: no
# bindings, no macros, and no functions except those that `declares_functions` lists.
# usage: includes_alone.sh GLSLANG SHADERS GENERATED
#   GLSLANG: path of glslangValidator; SHADERS: folder of the kernels; GENERATED: folder of the
#   generated includes
set -eu
glslang=$1 shaders=$2 generated=$3
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# GLSL cannot pass a buffer to a function, so these declare functions that read the buffers or the
# images of a kernel, which defines them.
declares_functions() {
  case $1 in
    restir/scene.glsl | restir/surfaces.glsl) ;;
    separable/pixel_scatter.glsl | separable/separable_at_pixel.glsl) ;;
    # These read a buffer, or one of several images that a number selects.
    common/probed_tile.glsl) ;;
    sap/sap_tiles.glsl | sap/sap_samples.glsl | sap/tile_region.glsl | sap/sap_window.glsl) ;;
    # The setting of all passes of a pyramid; a constant.
    sap/sap_storage.glsl) ;;
    # The kernel owns the arrays of texels, whose sizes depend on its levels, and writes its images.
    sap/sap_children.glsl | sap/sap_tile_children.glsl | sap/sap_pixel_block.glsl) ;;
    sap/sap_up.glsl | sap/sap_neighbours.glsl | sap/sap_climb.glsl | sap/sap_down_layers.glsl) ;;
    # The kernel chooses the order of sums: sap_ordered_sums.glsl or sap_row_sums.glsl.
    sap/sap_down.glsl) ;;
    *) false ;;
  esac
}

# Prints why an include depends on its includer; prints nothing if it compiles without one.
dependence() { # FOLDER NAME
  printf '%s\n' '#version 460' '#extension GL_GOOGLE_include_directive : require' \
    "#include \"$2\"" 'void main() {}' > "$scratch/alone.comp"
  "$glslang" --target-env vulkan1.2 -V --quiet -I"$1" -I"$shaders" -I"$generated" \
    -o "$scratch/alone.spv" "$scratch/alone.comp" > "$scratch/out" 2>&1 ||
    grep ERROR "$scratch/out" | head -n 1
  grep -nE '^ *# *(if|ifdef|ifndef|elif)\b' "$1/$2" |
    grep -vE '#ifndef DERMIS_[A-Z_]+_GLSL$' || true
  declares_functions "$2" || # declarations may have several lines
    tr '\n' ' ' < "$1/$2" | grep -oE '\b[a-zA-Z_0-9]+ [a-z_0-9]+\([a-zA-Z_0-9, ]*\);' |
    grep -vE '^(return|else) ' || true
}

failed=0 checked=0
for file in "$shaders"/*/*.glsl; do
  name=${file#"$shaders"/}
  why=$(dependence "$shaders" "$name")
  [ -z "$why" ] || { echo "$name depends on its includer: $why"; failed=1; }
  checked=$((checked + 1))
done
[ $checked -ge 60 ] || { echo "only $checked includes found in $shaders"; failed=1; }

# The check itself finds each kind of dependence.
mkdir "$scratch/offenders"
expect_found() { # NAME LINE
  printf '#ifndef DERMIS_OFFENDER_GLSL\n#define DERMIS_OFFENDER_GLSL\n%s\n#endif\n' "$2" \
    > "$scratch/offenders/$1.glsl"
  [ -n "$(dependence "$scratch/offenders" "$1.glsl")" ] ||
    { echo "a dependence on a $1 is not found"; failed=1; }
}
expect_found setting 'int twice() { return 2 * settings.samples; }'
expect_found binding 'vec4 texel() { return imageLoad(light_image, ivec2(0)); }'
expect_found function 'int twice(int x) { return 2 * includers_function(x); }'
expect_found declaration 'int includers_function(int x);'
expect_found long_declaration 'vec4 includers_function(ivec2 address,'"
"'                        int layer);'
expect_found macro '#ifdef INCLUDERS_MACRO'"
"'#endif'
exit $failed
