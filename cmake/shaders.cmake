# Shader sources are embedded as text, so that the binary needs no folder beside it; --shader-dir reads them from disk instead.
file(GLOB_RECURSE shader_sources CONFIGURE_DEPENDS RELATIVE ${CMAKE_SOURCE_DIR}/shaders
     ${CMAKE_SOURCE_DIR}/shaders/*.vert ${CMAKE_SOURCE_DIR}/shaders/*.frag ${CMAKE_SOURCE_DIR}/shaders/*.comp
     ${CMAKE_SOURCE_DIR}/shaders/*.rgen ${CMAKE_SOURCE_DIR}/shaders/*.rahit ${CMAKE_SOURCE_DIR}/shaders/*.rchit
     ${CMAKE_SOURCE_DIR}/shaders/*.rmiss ${CMAKE_SOURCE_DIR}/shaders/*.glsl ${CMAKE_SOURCE_DIR}/shaders/*.h)
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

# candela_glslang.so compiles GLSL: its archives are inside, so that one file serves every program.
function(candela_glslang_module name)
  add_library(${name} MODULE ${ARGN} ${CMAKE_SOURCE_DIR}/src/glsl/modules/glslang_module.cpp)
  target_include_directories(${name} PRIVATE ${CMAKE_SOURCE_DIR}/src)
  target_link_libraries(${name} PRIVATE glslang SPIRV MachineIndependent GenericCodeGen OGLCompiler OSDependent
                        glslang-default-resource-limits SPIRV-Tools-opt SPIRV-Tools Threads::Threads)
  target_link_options(${name} PRIVATE -Wl,--exclude-libs,ALL)
  set_target_properties(${name} PROPERTIES PREFIX "")
endfunction()

# SPIR-V of the shaders that shaders/built_in.txt names, made by a program of the build that compiles as candela does; it takes from
# the last table what has not changed. A key is of all that goes in, so a shader that was edited since is not found in it.
function(candela_built_in_spirv)
  candela_glslang_module(candela_glslang)
  add_executable(candela_make_spirv ${CMAKE_SOURCE_DIR}/src/glsl/tools/make_spirv.cpp)
  target_link_libraries(candela_make_spirv PRIVATE candela_glsl)
  add_dependencies(candela_make_spirv candela_glslang)
  set(table ${CMAKE_BINARY_DIR}/generated/built_in.spirv)
  add_custom_command(OUTPUT ${table}
    COMMAND candela_make_spirv ${CMAKE_SOURCE_DIR}/shaders/built_in.txt ${table}
    DEPENDS candela_make_spirv ${CMAKE_SOURCE_DIR}/shaders/built_in.txt VERBATIM)
  set(source ${CMAKE_SOURCE_DIR}/src/glsl/tools/built_in_table.cpp)
  add_library(candela_built_in STATIC ${source})
  target_include_directories(candela_built_in PUBLIC ${CMAKE_SOURCE_DIR}/src)
  set_source_files_properties(${source} PROPERTIES OBJECT_DEPENDS ${table}
                              COMPILE_DEFINITIONS CANDELA_SPIRV_TABLE="${table}")
endfunction()
