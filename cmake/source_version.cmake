# Prints or writes what the sources are: `git describe` of tags v1.2.3; without the program git the commit that .git names; else
# what `git archive` left in packaging/source_version.txt; else nothing.
#   cmake -DROOT=... -DOUT=... -P source_version.cmake    a C++ file, written when it changes
# Included, it sets source_version (v1.2.3-14-gabcdef, gabcdef where there is no tag) and tag_version (1.2.3).
if(NOT ROOT)
  set(ROOT ${CMAKE_CURRENT_LIST_DIR}/..)
endif()
set(source_version "")
find_program(GIT_PROGRAM git)
if(GIT_PROGRAM AND EXISTS ${ROOT}/.git)
  execute_process(COMMAND ${GIT_PROGRAM} -C ${ROOT} describe --tags --match v[0-9]* --always --dirty --abbrev=12
                  OUTPUT_VARIABLE source_version OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  if(failed)
    set(source_version "")
  elseif(source_version MATCHES "^[0-9a-f]+(-dirty)?$")
    set(source_version "g${source_version}")
  endif()
endif()
if(source_version STREQUAL "" AND EXISTS ${ROOT}/.git/HEAD)
  file(STRINGS ${ROOT}/.git/HEAD head LIMIT_COUNT 1)
  if(head MATCHES "^ref: (.+)$")
    set(reference ${CMAKE_MATCH_1})
    set(head "")
    if(EXISTS ${ROOT}/.git/${reference})
      file(STRINGS ${ROOT}/.git/${reference} head LIMIT_COUNT 1)
    elseif(EXISTS ${ROOT}/.git/packed-refs)
      file(STRINGS ${ROOT}/.git/packed-refs packed REGEX " ${reference}$" LIMIT_COUNT 1)
      string(REGEX REPLACE " .*" "" head "${packed}")
    endif()
  endif()
  if(head MATCHES "^[0-9a-f]+$")
    string(SUBSTRING ${head} 0 12 head)
    set(source_version "g${head}")
  endif()
endif()
if(source_version STREQUAL "")
  # The tag and what came after it; where there is no tag the commit alone, which is the second line.
  file(STRINGS ${ROOT}/packaging/source_version.txt archived)
  foreach(line IN LISTS archived)
    if(source_version STREQUAL "" AND NOT line MATCHES "^$|Format")
      set(source_version "${line}")
    endif()
  endforeach()
endif()
set(tag_version "")
if(source_version MATCHES "^v([0-9]+\\.[0-9]+\\.[0-9]+)")
  set(tag_version ${CMAKE_MATCH_1})
endif()
if(OUT)
  file(CONFIGURE OUTPUT ${OUT} CONTENT [[
#include "cli/build_info.h"
namespace candela::cli {
const char* const source_version = "@source_version@";
}
]] @ONLY)
endif()
