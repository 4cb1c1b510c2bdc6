# What --version --json says of the build. Two small files, compiled into the program alone, so that a commit links it anew and
# compiles nothing else.
set(build_info_libraries "")
foreach(library "CLI11;${CLI11_VERSION}" "fmt;${fmt_VERSION}" "meshoptimizer;${meshoptimizer_VERSION}"
                "nlohmann-json;${nlohmann_json_VERSION}" "oneTBB;${TBB_VERSION}" "OpenEXR;${OpenEXR_VERSION}"
                "Vulkan-Headers;${Vulkan_VERSION}")
  list(GET library 0 name)
  list(GET library 1 version)
  string(APPEND build_info_libraries "{\"${name}\", \"${version}\"}, ")
endforeach()
# Those whose versions only their headers hold.
foreach(library "libdeflate;LIBDEFLATE_VERSION_;libdeflate.h;MAJOR MINOR" "zstd;ZSTD_VERSION_;zstd.h;MAJOR MINOR RELEASE"
                "glm;GLM_VERSION_;glm/detail/setup.hpp;MAJOR MINOR PATCH REVISION" "glslang;GLSLANG_VERSION_;glslang/build_info.h;MAJOR MINOR PATCH")
  list(GET library 0 name)
  list(GET library 1 prefix)
  list(GET library 2 header)
  list(GET library 3 parts)
  find_file(${name}_version_header ${header} NO_CACHE)
  if(${name}_version_header)
    set(version "")
    separate_arguments(parts)
    foreach(part IN LISTS parts)
      file(STRINGS ${${name}_version_header} line REGEX "define[ \t]+${prefix}${part}[ \t]+[0-9]+" LIMIT_COUNT 1)
      string(REGEX REPLACE ".*${prefix}${part}[ \t]+([0-9]+).*" "\\1" number "${line}")
      list(APPEND version ${number})
    endforeach()
    list(JOIN version "." version)
    string(APPEND build_info_libraries "{\"${name}\", \"${version}\"}, ")
  endif()
endforeach()
foreach(flag "sanitizers;CANDELA_ASAN" "faults;CANDELA_MUTATE")
  list(GET flag 0 name)
  list(GET flag 1 option)
  set(build_info_${name} false)
  if(${option})
    set(build_info_${name} true)
  endif()
endforeach()
configure_file(cmake/build_info.cpp.in generated/build_info.cpp @ONLY)

set(source_version_file ${CMAKE_BINARY_DIR}/generated/source_version.cpp)
add_custom_target(candela_source_version BYPRODUCTS ${source_version_file}
  COMMAND ${CMAKE_COMMAND} -DROOT=${CMAKE_SOURCE_DIR} -DOUT=${source_version_file} -P ${CMAKE_SOURCE_DIR}/cmake/source_version.cmake VERBATIM)

# What candela_cli says of the build, in whatever links it.
function(candela_build_info name linked)
  target_sources(${name} PRIVATE ${CMAKE_BINARY_DIR}/generated/build_info.cpp ${source_version_file})
  add_dependencies(${name} candela_source_version)
  target_compile_definitions(${name} PRIVATE CANDELA_LIBRARIES_LINKED="${linked}")
endfunction()

# candela_program(NAME shared|static): the program; its libraries shared, or inside it.
function(candela_program name linked)
  add_executable(${name} src/main.cpp)
  candela_build_info(${name} ${linked})
  target_link_libraries(${name} PRIVATE candela_cli)
endfunction()
