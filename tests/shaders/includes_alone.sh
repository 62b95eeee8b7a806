#!/bin/sh
# Checks that every GLSL include compiles alone and depends on nothing that its includer defines: no
# bindings, no macros, no functions. The kernels of shaders/sap still share bindings by name.
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
    restir/scene.glsl | restir/surfaces.glsl | separable/separable_pass.glsl) ;;
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
  declares_functions "$2" || grep -nE '^[a-zA-Z_0-9]+ [a-z_0-9]+\([^)]*\);' "$1/$2" || true
}

failed=0 checked=0
for file in "$shaders"/*/*.glsl; do
  name=${file#"$shaders"/}
  case $name in sap/*) continue ;; esac
  why=$(dependence "$shaders" "$name")
  [ -z "$why" ] || { echo "$name depends on its includer: $why"; failed=1; }
  checked=$((checked + 1))
done
[ $checked -ge 20 ] || { echo "only $checked includes found in $shaders"; failed=1; }

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
expect_found macro '#ifdef INCLUDERS_MACRO'"
"'#endif'
exit $failed
