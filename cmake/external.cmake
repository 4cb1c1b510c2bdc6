# Libraries that the portable program holds inside: external_NAME is the shared library of the system, and for targets with the
# property CANDELA_STATIC the archive that packaging/static_libraries.sh made, or that Debian has.
set(CANDELA_STATIC_LIBRARIES "" CACHE PATH "What packaging/static_libraries.sh made; with it the target candela_portable can be built")

function(candela_external name shared)  # ARCHIVE...
  add_library(external_${name} INTERFACE)
  if(NOT CANDELA_STATIC_LIBRARIES)
    target_link_libraries(external_${name} INTERFACE ${shared})
    return()
  endif()
  set(archives "")
  foreach(archive IN LISTS ARGN)
    find_library(${name}_${archive} NAMES lib${archive}.a HINTS ${CANDELA_STATIC_LIBRARIES}/lib NO_CACHE REQUIRED)
    list(APPEND archives ${${name}_${archive}})
  endforeach()
  set(static $<BOOL:$<TARGET_PROPERTY:CANDELA_STATIC>>)
  target_link_libraries(external_${name} INTERFACE "$<IF:${static},${archives},${shared}>")
  # Headers and definitions are those of the system in both.
  if(TARGET ${shared})
    target_include_directories(external_${name} SYSTEM INTERFACE $<TARGET_PROPERTY:${shared},INTERFACE_INCLUDE_DIRECTORIES>)
    target_compile_definitions(external_${name} INTERFACE $<TARGET_PROPERTY:${shared},INTERFACE_COMPILE_DEFINITIONS>)
  endif()
endfunction()

candela_external(fmt fmt::fmt fmt)
candela_external(tbb TBB::tbb tbb)
candela_external(openexr OpenEXR::OpenEXR OpenEXR-3_1 IlmThread-3_1 Iex-3_1 Imath-3_1 z)
candela_external(meshoptimizer meshoptimizer::meshoptimizer meshoptimizer)
candela_external(tinygltf tinygltf tinygltf stb)
candela_external(stb stb stb)
