# Embeds the test kernels as SPIR-V arrays into test_framegraph_vulkan.
set(kernel_sources ${CMAKE_CURRENT_SOURCE_DIR}/framegraph/vulkan/kernels)
set(kernel_headers ${CMAKE_BINARY_DIR}/generated/test_kernels)
file(MAKE_DIRECTORY ${kernel_headers})
file(GLOB kernels CONFIGURE_DEPENDS ${kernel_sources}/*.comp)
foreach(kernel ${kernels})
  get_filename_component(name ${kernel} NAME_WE)
  add_custom_command(
    OUTPUT ${kernel_headers}/${name}.spv.h
    COMMAND ${DERMIS_GLSLANG} --target-env vulkan1.3 -V --quiet
            --vn ${name}_spirv -o ${kernel_headers}/${name}.spv.h ${kernel}
    DEPENDS ${kernel} ${kernel_sources}/frame.glsl
    COMMENT "Test kernel ${name}" VERBATIM)
  target_sources(test_framegraph_vulkan PRIVATE ${kernel_headers}/${name}.spv.h)
endforeach()
target_include_directories(test_framegraph_vulkan PRIVATE ${kernel_headers})
