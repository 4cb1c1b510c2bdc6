# Shader sources are embedded as text, so that the binary needs no folder beside it; --shader-dir reads them from disk instead.
file(GLOB_RECURSE shader_sources CONFIGURE_DEPENDS RELATIVE ${CMAKE_SOURCE_DIR}/shaders
     ${CMAKE_SOURCE_DIR}/shaders/*.vert ${CMAKE_SOURCE_DIR}/shaders/*.frag ${CMAKE_SOURCE_DIR}/shaders/*.comp
     ${CMAKE_SOURCE_DIR}/shaders/*.glsl ${CMAKE_SOURCE_DIR}/shaders/*.h)
list(SORT shader_sources)
set(embedded ${CMAKE_BINARY_DIR}/generated/embedded_shaders.cpp)
list(TRANSFORM shader_sources PREPEND ${CMAKE_SOURCE_DIR}/shaders/ OUTPUT_VARIABLE shader_paths)
add_custom_command(OUTPUT ${embedded}
  COMMAND ${CMAKE_COMMAND} -DOUT=${embedded} -DROOT=${CMAKE_SOURCE_DIR}/shaders "-DFILES=${shader_sources}"
          -P ${CMAKE_SOURCE_DIR}/cmake/embed.cmake
  DEPENDS ${shader_paths} ${CMAKE_SOURCE_DIR}/cmake/embed.cmake VERBATIM)
add_library(candela_shaders STATIC ${embedded})
target_include_directories(candela_shaders PUBLIC ${CMAKE_SOURCE_DIR}/src)
if(CANDELA_MUTATE)
  candela_shaders_with_faults(${embedded})
endif()
