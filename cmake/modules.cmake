# candela_module(NAME LINK libs...): the static library candela_NAME from src/NAME and the folders in it; what is loaded at run time
# (modules/) is not part of it. Its public include folder is src,
# so every include says its module: #include "scene/scene.h".
function(candela_module name)
  cmake_parse_arguments(A "" "" "LINK" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/src/${name}/*.cpp)
  list(FILTER sources EXCLUDE REGEX "/modules/")
  if(NOT sources)
    add_library(candela_${name} INTERFACE)
    target_include_directories(candela_${name} INTERFACE ${CMAKE_SOURCE_DIR}/src ${CMAKE_SOURCE_DIR}/shaders)
    target_link_libraries(candela_${name} INTERFACE ${A_LINK})
    return()
  endif()
  add_library(candela_${name} STATIC ${sources})
  target_include_directories(candela_${name} PUBLIC ${CMAKE_SOURCE_DIR}/src ${CMAKE_SOURCE_DIR}/shaders)
  target_link_libraries(candela_${name} PUBLIC ${A_LINK})
  # One precompiled header for all modules: base makes it.
  if(name STREQUAL "base")
    target_precompile_headers(candela_base PRIVATE ${CMAKE_SOURCE_DIR}/src/base/pch.h)
  else()
    target_precompile_headers(candela_${name} REUSE_FROM candela_base)
  endif()
endfunction()
