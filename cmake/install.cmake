# cmake --install: bin/candela, its modules in lib/candela (found from the program's own place, so that a prefix may be moved), and
# below share/ man pages, completion, schemas, documents and licences.
# Components: program (shared libraries of the system), portable (the program with its libraries inside), share, zsh, zsh-debian.
install(TARGETS candela RUNTIME DESTINATION bin COMPONENT program)
foreach(module candela_glslang candela_oiio candela_draco candela_demoscenes_module)
  if(TARGET ${module})
    install(TARGETS ${module} LIBRARY DESTINATION lib/candela COMPONENT program)
  endif()
endforeach()

# Man pages and completion come from the parser.
set(manual ${CMAKE_BINARY_DIR}/generated/share)
add_custom_command(OUTPUT ${manual}.stamp
  COMMAND ${CMAKE_COMMAND} -E rm -rf ${manual}
  COMMAND candela manual ${manual}
  COMMAND ${CMAKE_COMMAND} -E touch ${manual}.stamp
  DEPENDS candela VERBATIM)
add_custom_target(candela_manual ALL DEPENDS ${manual}.stamp)
foreach(folder man bash-completion fish)
  install(DIRECTORY ${manual}/${folder} DESTINATION share COMPONENT share)
endforeach()
install(DIRECTORY ${manual}/zsh DESTINATION share COMPONENT zsh)
# Debian's zsh looks for what packages bring elsewhere.
install(DIRECTORY ${manual}/zsh/site-functions/ DESTINATION share/zsh/vendor-completions COMPONENT zsh-debian EXCLUDE_FROM_ALL)

install(DIRECTORY docs/schemas packaging/ci DESTINATION share/candela COMPONENT share)
install(FILES README.md CHANGELOG.md LICENSE DESTINATION share/doc/candela COMPONENT share)
install(DIRECTORY docs DESTINATION share/doc/candela COMPONENT share PATTERN schemas EXCLUDE)
install(FILES LICENSE RENAME copyright DESTINATION share/doc/candela COMPONENT share)

# Licences of what is inside the program: headers, and archives in the portable one. Debian keeps each package's.
set(licences ${CMAKE_BINARY_DIR}/generated/licences)
add_custom_target(candela_licences ALL COMMAND bash ${CMAKE_SOURCE_DIR}/packaging/licences.sh ${licences} VERBATIM)
install(DIRECTORY ${licences} DESTINATION share/doc/candela COMPONENT share)

if(CANDELA_STATIC_LIBRARIES)
  # The same objects, linked with archives. libstdc++ is inside too: a driver brings its own, which may be newer than ours.
  candela_program(candela_portable static)
  set_target_properties(candela_portable PROPERTIES CANDELA_STATIC ON EXCLUDE_FROM_ALL ON)
  target_link_options(candela_portable PRIVATE -static-libstdc++ -static-libgcc -Wl,--exclude-libs,ALL -Wl,--as-needed)
  install(PROGRAMS $<TARGET_FILE:candela_portable> DESTINATION bin RENAME candela COMPONENT portable EXCLUDE_FROM_ALL)
  candela_glslang_module(candela_glslang_portable EXCLUDE_FROM_ALL)
  target_link_options(candela_glslang_portable PRIVATE -static-libstdc++ -static-libgcc)
  set_target_properties(candela_glslang_portable PROPERTIES OUTPUT_NAME candela_glslang
                        LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/portable)
  install(PROGRAMS $<TARGET_FILE:candela_glslang_portable> DESTINATION lib/candela COMPONENT portable EXCLUDE_FROM_ALL)
  add_dependencies(candela_portable candela_glslang_portable)
  add_library(candela_demoscenes_portable MODULE EXCLUDE_FROM_ALL src/demoscenes/modules/demoscenes_module.cpp)
  target_link_libraries(candela_demoscenes_portable PRIVATE candela_demoscenes)
  target_link_options(candela_demoscenes_portable PRIVATE -static-libstdc++ -static-libgcc -Wl,--exclude-libs,ALL -Wl,--as-needed)
  set_target_properties(candela_demoscenes_portable PROPERTIES PREFIX "" OUTPUT_NAME candela_demoscenes CANDELA_STATIC ON
                        LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/portable)
  install(PROGRAMS $<TARGET_FILE:candela_demoscenes_portable> DESTINATION lib/candela COMPONENT portable EXCLUDE_FROM_ALL)
  add_dependencies(candela_portable candela_demoscenes_portable)
  if(CANDELA_DRACO)
    add_library(candela_draco_portable MODULE EXCLUDE_FROM_ALL src/gltf/modules/draco_module.cpp)
    target_include_directories(candela_draco_portable PRIVATE src)
    target_link_libraries(candela_draco_portable PRIVATE draco::draco_static)
    target_link_options(candela_draco_portable PRIVATE -static-libstdc++ -static-libgcc -Wl,--exclude-libs,ALL)
    set_target_properties(candela_draco_portable PROPERTIES PREFIX "" OUTPUT_NAME candela_draco
                          LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/portable)
    install(PROGRAMS $<TARGET_FILE:candela_draco_portable> DESTINATION lib/candela COMPONENT portable EXCLUDE_FROM_ALL)
    add_dependencies(candela_portable candela_draco_portable)
  endif()
endif()
include(cmake/packages.cmake)
