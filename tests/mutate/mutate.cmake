# The variant of the program and of its tests that holds deliberate faults (docs/building/testing.md). generate.py copies the sources that
# hold faults into the build folder, where each faulty place is a choice at run time; those copies take the originals' place.
find_package(Python3 REQUIRED COMPONENTS Interpreter)
set(mutated ${CMAKE_BINARY_DIR}/mutated)
set(CANDELA_MUTATE_SHADERS "" CACHE FILEPATH "A file of tests/mutate/by_goldens.py: the faults in it that no golden caught are built in too")
execute_process(COMMAND ${Python3_EXECUTABLE} ${CMAKE_CURRENT_LIST_DIR}/generate.py ${CMAKE_SOURCE_DIR} ${mutated} ${CANDELA_MUTATE_SHADERS}
                RESULT_VARIABLE mutate_result)
if(NOT mutate_result EQUAL 0)
  message(FATAL_ERROR "tests/mutate: the table of faults does not fit the sources")
endif()
# What was read, one a line: a change of any of them generates anew.
file(STRINGS ${mutated}/inputs.txt mutate_inputs)
file(GLOB mutate_own CONFIGURE_DEPENDS ${CMAKE_CURRENT_LIST_DIR}/*)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${mutate_inputs} ${mutate_own})
if(EXISTS ${mutated}/include)
  include_directories(BEFORE ${mutated}/include)
endif()

# Replaces the sources in the list by their copies with faults, where there are any.
function(candela_with_faults list)
  set(result)
  foreach(source IN LISTS ${list})
    file(RELATIVE_PATH name ${CMAKE_SOURCE_DIR} ${source})
    if(EXISTS ${mutated}/${name})
      set(source ${mutated}/${name})
    endif()
    list(APPEND result ${source})
  endforeach()
  set(${list} ${result} PARENT_SCOPE)
endfunction()

# Shaders are changed as text when the program asks for them.
function(candela_shaders_with_faults embedded)
  set_source_files_properties(${embedded} PROPERTIES COMPILE_DEFINITIONS embedded_shaders=embedded_shaders_without_faults)
  target_sources(candela_shaders PRIVATE ${mutated}/shader_faults.cpp)
endfunction()
