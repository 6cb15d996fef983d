# Compile settings that every target of this project shares.
#
# -ffp-contract=off: results must not depend on whether the machine fuses multiply and add.
# x86-64-v2 (SSE4.2) is the lowest machine supported; wider kernels are chosen at run time.
#
# g++ collects garbage while it compiles, by default whenever its heap has grown by a third or so:
# that is a sixth of the time of our sources. Where there is memory for it, two compilers of a
# gigabyte each, it need not.
cmake_host_system_information(RESULT meshprep_memory QUERY TOTAL_PHYSICAL_MEMORY)  # MiB
function(meshprep_target target)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND meshprep_memory GREATER 7000)
    target_compile_options(${target} PRIVATE --param=ggc-min-expand=1000 --param=ggc-min-heapsize=1048576)
  endif()
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion
                         -ffp-contract=off -fno-math-errno)
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    target_compile_options(${target} PRIVATE -march=x86-64-v2)
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    # GCC 12 sees overlapping copies in "text" + std::string where there are none (GCC bug 105651).
    target_compile_options(${target} PRIVATE -Wno-restrict)
  endif()
  if(MESHPREP_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(MESHPREP_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=${MESHPREP_SANITIZE}
                           -fno-omit-frame-pointer -fno-sanitize-recover=all)
    target_link_options(${target} PRIVATE -fsanitize=${MESHPREP_SANITIZE})
    get_target_property(type ${target} TYPE)
    if(type STREQUAL EXECUTABLE AND MESHPREP_SANITIZE MATCHES address)
      # Each check has its place in the source as data with an address in it: where the program is
      # loaded is then written a million times before it starts, a fourth of its start.
      target_link_options(${target} PRIVATE -no-pie)
    endif()
  endif()
  if(MESHPREP_COVERAGE)
    target_compile_options(${target} PRIVATE --coverage)
    target_link_options(${target} PRIVATE --coverage)
  endif()
endfunction()

# Coverage for libFuzzer, of what its targets feed: nearly half as much code again, so not of
# anything else.
function(meshprep_fuzzed target)
  if(MESHPREP_BUILD_FUZZ)
    target_compile_options(${target} PRIVATE -fsanitize=fuzzer-no-link)
  endif()
endfunction()

# What arranges the work of others and repeats nothing often: optimising it is a third of the time
# that its compilation takes, and half of it or more with sanitizers.
function(meshprep_cold target)
  if(MESHPREP_SANITIZE)
    target_compile_options(${target} PRIVATE -O0)
  elseif(CMAKE_BUILD_TYPE STREQUAL "Release")
    target_compile_options(${target} PRIVATE -O1)
  elseif(CMAKE_BUILD_TYPE STREQUAL "Debug" AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(${target} PRIVATE -Og)
  endif()
endfunction()

# Rooms of meshprep_unity() with an optimisation of their own. Cold ones arrange, and are so under
# sanitizers alone, where the others are worth what optimising takes. Hot ones are what the longest tests
# wait for: compiled for the suite as for use, they save five times as long as that takes.
function(meshprep_cold_rooms target)
  if(MESHPREP_SANITIZE)
    meshprep_optimize_rooms(${target} -O0 ${ARGN})
  endif()
endfunction()
function(meshprep_hot_rooms target)
  if(CMAKE_BUILD_TYPE STREQUAL "Debug" AND NOT MESHPREP_SANITIZE)
    meshprep_optimize_rooms(${target} -O2 ${ARGN})
  endif()
endfunction()
function(meshprep_optimize_rooms target optimization)
  if(NOT MESHPREP_UNITY)
    return()
  endif()
  foreach(room IN LISTS ARGN)
    string(MAKE_C_IDENTIFIER "${room}" name)
    set_source_files_properties(${CMAKE_CURRENT_BINARY_DIR}/CMakeFiles/${target}.dir/Unity/unity_${name}_cxx.cxx
                                PROPERTIES COMPILE_OPTIONS ${optimization})
  endforeach()
endfunction()

# Headers that most sources of a target read, compiled once: `header`, or that of another target of
# the same settings; a source compiles in two thirds of the time. Sources include what they use all
# the same: with MESHPREP_PRECOMPILE=OFF, as in the preset coverage, they stand alone.
#
# Not where sources of a library are compiled together, after meshprep_unity(): what it saves there is
# less than what making it takes. g++ compiles with the optimisation that the header had, whatever a
# source asks for.
function(meshprep_precompile target header)
  if(NOT MESHPREP_PRECOMPILE)
    return()
  endif()
  get_target_property(together ${target} UNITY_BUILD)
  if(together)
    return()
  endif()
  if(TARGET ${header})
    target_precompile_headers(${target} REUSE_FROM ${header})
  else()
    target_precompile_headers(${target} PRIVATE ${header})
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(${target} PRIVATE -fpch-preprocess)  # ccache asks for it
  endif()
endfunction()

# meshprep_unity(target ["folder folder ..." ...])
#
# With MESHPREP_UNITY (test, release and sanitizers): sources of one folder are compiled together, and
# those of folders that are named together, since headers, and the templates that each source makes
# anew, take most of the time. Folders are relative to the target's; one that is not named is a room
# of its own. About 200 kB of sources a room keep two compilers busy and within a gigabyte each.
# Sources that are compiled apart: those with flags of their own (CMake sees to that), and those of
# Highway, whose settings hold for a whole file. A local name that shadows a local one is told as
# everywhere; what of one source a name of another shadows says nothing.
function(meshprep_unity target)
  if(NOT MESHPREP_UNITY)
    return()
  endif()
  foreach(room IN LISTS ARGN)
    string(MAKE_C_IDENTIFIER "${room}" name)
    string(REPLACE " " ";" folders "${room}")
    foreach(folder IN LISTS folders)
      set(room_of_${folder} ${name})
    endforeach()
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  target_compile_options(${target} PRIVATE -Wno-shadow)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(${target} PRIVATE -Wshadow=local)
    # What includes a source is no header; and g++ 12 at -O3 sees overflows and uninitialised values
    # inside std::string, vectors and variants where there are none.
    target_compile_options(${target} PRIVATE -Wno-subobject-linkage -Wno-stringop-overflow
                           -Wno-stringop-overread -Wno-array-bounds -Wno-maybe-uninitialized)
  endif()
  get_target_property(sources ${target} SOURCES)
  foreach(source IN LISTS sources)
    cmake_path(IS_ABSOLUTE source is_absolute)
    if(NOT source MATCHES "\\.cpp$" OR NOT is_absolute)
      continue()
    endif()
    file(STRINGS ${source} highway REGEX "include .(hwy/|base/simd_)" LIMIT_COUNT 1)
    if(highway)
      continue()
    endif()
    cmake_path(GET source PARENT_PATH folder)
    cmake_path(RELATIVE_PATH folder BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
    string(MAKE_C_IDENTIFIER "${folder}" room)
    if(DEFINED room_of_${folder})
      set(room ${room_of_${folder}})
    endif()
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${room})
  endforeach()
endfunction()
