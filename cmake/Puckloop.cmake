# What every target of the project shares: warnings as errors, include root, and a way to declare tests.

add_library(puckloop_options INTERFACE)
target_include_directories(puckloop_options INTERFACE ${PROJECT_SOURCE_DIR})
target_compile_options(puckloop_options INTERFACE -Wall -Wextra -Wpedantic $<$<CXX_COMPILER_ID:GNU>:-Wshadow=local> -Wconversion -Wnon-virtual-dtor
                                                  -Wold-style-cast -Woverloaded-virtual -Werror)
# Everything is position independent for the preload library; nobody interposes our own functions, so those of one file may be inlined.
target_compile_options(puckloop_options INTERFACE $<$<CXX_COMPILER_ID:GNU>:-fno-semantic-interposition>)
# GCC collects its garbage from some 130 MB on, which a file with headers precompiled has at once: again and again, in vain.
target_compile_options(puckloop_options INTERFACE $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=393216>)

option(PUCKLOOP_ASAN "Build with the address and undefined-behaviour sanitizers" OFF)
if(PUCKLOOP_ASAN)
  # GCC 12 sees uninitialised members inside std::function when it instruments <regex>.
  target_compile_options(puckloop_options INTERFACE -fsanitize=address,undefined -fno-sanitize-recover=undefined
                                                    -fno-omit-frame-pointer -Wno-maybe-uninitialized)
  target_link_options(puckloop_options INTERFACE -fsanitize=address,undefined)
endif()

# Some targets alone with the sanitizers, in an otherwise usual build: an eighth of what `asan` compiles. Preset `sanitized`.
set(PUCKLOOP_SANITIZED "" CACHE STRING "Targets to build with the address and undefined-behaviour sanitizers")
function(puckloop_sanitize name)
  target_compile_options(${name} PRIVATE -O0 -fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer
                                         -Wno-maybe-uninitialized)
  target_link_options(${name} PUBLIC -fsanitize=address,undefined)
endfunction()
# The suffix of what `name` shares with others: precompiled headers have to be compiled as it is.
function(puckloop_variant name result)
  set(${result} "" PARENT_SCOPE)
  if(name IN_LIST PUCKLOOP_SANITIZED)
    set(${result} "_sanitized" PARENT_SCOPE)
  endif()
endfunction()

option(PUCKLOOP_TSAN "Build with the thread sanitizer" OFF)
if(PUCKLOOP_TSAN)
  target_compile_options(puckloop_options INTERFACE -fsanitize=thread -fno-omit-frame-pointer -Wno-tsan)
  target_link_options(puckloop_options INTERFACE -fsanitize=thread)
endif()

# Most of a file's compile time was reading the same headers of the standard library: they are precompiled once for the
# libraries and once, with Catch2, for the tests. A file still includes what it uses: the presets `plain`, `debug` and `asan` build without.
if(NOT CMAKE_DISABLE_PRECOMPILE_HEADERS)
  # libstdc++ switches these off around its strings by a pragma, which GCC 12 forgets in what is precompiled; `plain` has them.
  target_compile_options(puckloop_options INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds -Wno-stringop-overflow -Wno-stringop-overread>)
endif()
# What fmt's users define holds for all, or those who do not link it could not share them.
find_package(fmt REQUIRED)
target_compile_definitions(puckloop_options INTERFACE $<TARGET_PROPERTY:fmt::fmt,INTERFACE_COMPILE_DEFINITIONS>)
add_library(puckloop_precompiled OBJECT ${CMAKE_CURRENT_LIST_DIR}/precompiled.cpp)
target_link_libraries(puckloop_precompiled PRIVATE puckloop_options)
target_precompile_headers(puckloop_precompiled PRIVATE ${CMAKE_CURRENT_LIST_DIR}/precompiled.h)
# Once more with the JSON library, whose headers take longer to read than all of those.
find_package(nlohmann_json REQUIRED)
add_library(puckloop_precompiled_json OBJECT ${CMAKE_CURRENT_LIST_DIR}/precompiled.cpp)
target_link_libraries(puckloop_precompiled_json PRIVATE puckloop_options nlohmann_json::nlohmann_json)
target_precompile_headers(puckloop_precompiled_json PRIVATE ${CMAKE_CURRENT_LIST_DIR}/precompiled.h ${PROJECT_SOURCE_DIR}/base/json.h)
# Those of the two that `name`, which links the rest, is compiled with.
function(puckloop_precompile name)
  puckloop_variant(${name} variant)
  if(NOT variant AND "puckloop_json" IN_LIST ARGN)
    set(variant _json)
  endif()
  target_precompile_headers(${name} REUSE_FROM puckloop_precompiled${variant})
endfunction()
# The same for a program, which is compiled as the libraries are.
function(puckloop_precompile_program name)
  set_target_properties(${name} PROPERTIES POSITION_INDEPENDENT_CODE OFF)
  target_compile_options(${name} PRIVATE -fPIC)
  puckloop_precompile(${name} ${ARGN})
endfunction()
if(PUCKLOOP_SANITIZED)
  add_library(puckloop_precompiled_sanitized OBJECT ${CMAKE_CURRENT_LIST_DIR}/precompiled.cpp)
  target_link_libraries(puckloop_precompiled_sanitized PRIVATE puckloop_options)
  target_precompile_headers(puckloop_precompiled_sanitized PRIVATE ${CMAKE_CURRENT_LIST_DIR}/precompiled.h)
  puckloop_sanitize(puckloop_precompiled_sanitized)
endif()

# Reading headers was nearly half of a build: some sources of a target are compiled together as one. A file still includes
# what it uses, and compiles alone: the presets without this option prove it. File-level names of one target must differ.
option(PUCKLOOP_UNITY "Compile the sources of a target some at a time" OFF)
if(PUCKLOOP_UNITY)
  # GCC takes every file but the first for a header, whose types others might see; `plain` has the warning.
  set(product $<NOT:$<BOOL:$<TARGET_PROPERTY:PUCKLOOP_IS_TEST>>>)
  target_compile_options(puckloop_options INTERFACE $<$<AND:$<CXX_COMPILER_ID:GNU>,${product}>:-Wno-subobject-linkage>)
endif()
set(PUCKLOOP_UNITY_SOURCES 16)
function(puckloop_unity name)
  set_target_properties(${name} PROPERTIES UNITY_BUILD ${PUCKLOOP_UNITY} UNITY_BUILD_BATCH_SIZE ${PUCKLOOP_UNITY_SOURCES})
endfunction()

# The same with a folder's sources as one: file-level names of a folder must differ, and no more. ALONE are files, and
# folders of them, that are compiled by themselves.
function(puckloop_unity_by_folder name)
  cmake_parse_arguments(ARG "" "" "ALONE" ${ARGN})
  get_target_property(sources ${name} SOURCES)
  foreach(source ${sources})
    get_filename_component(folder ${source} DIRECTORY)
    if(NOT IS_ABSOLUTE ${source} AND NOT folder IN_LIST ARG_ALONE AND NOT source IN_LIST ARG_ALONE)
      set_source_files_properties(${source} PROPERTIES UNITY_GROUP "${folder}")
    endif()
  endforeach()
  set_target_properties(${name} PROPERTIES UNITY_BUILD ${PUCKLOOP_UNITY} UNITY_BUILD_MODE GROUP)
endfunction()

# What reads input, writes reports or is a command, but carries out no node's time: optimising it less costs nobody, and saves
# a quarter of its compilation. Twice as many sources at a time save as much again: they share what they include and expand.
function(puckloop_cold)
  math(EXPR sources "2 * ${PUCKLOOP_UNITY_SOURCES}")
  foreach(name ${ARGN})
    if(NOT name IN_LIST PUCKLOOP_SANITIZED)  # those are as what they precompile is
      target_compile_options(${name} PRIVATE $<$<CONFIG:RelWithDebInfo>:-O1>)
    endif()
    set_target_properties(${name} PROPERTIES UNITY_BUILD_BATCH_SIZE ${sources})
  endforeach()
endfunction()

# The same of some sources of a library, of which the others do carry out nodes' time.
function(puckloop_cold_sources name)
  if(name IN_LIST PUCKLOOP_SANITIZED)
    return()
  endif()
  get_target_property(sources ${name} SOURCES)
  list(REMOVE_ITEM sources ${ARGN})
  set_target_properties(${name} PROPERTIES SOURCES "${sources}")
  add_library(${name}_cold OBJECT ${ARGN})
  get_target_property(link ${name} LINK_LIBRARIES)
  target_link_libraries(${name}_cold PRIVATE ${link})
  puckloop_precompile(${name}_cold ${link})
  puckloop_unity(${name}_cold)
  puckloop_cold(${name}_cold)
  target_sources(${name} PRIVATE $<TARGET_OBJECTS:${name}_cold>)
endfunction()

# puckloop_library(NAME SOURCES a.cpp b.cpp [LINK libraries...])
function(puckloop_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_link_libraries(${name} PUBLIC puckloop_options ${ARG_LINK})
  puckloop_variant(${name} variant)
  if(variant)
    puckloop_sanitize(${name})
  endif()
  puckloop_precompile(${name} ${ARG_LINK})
  puckloop_unity(${name})
endfunction()

# Tests spend their time in the libraries; compiled with less effort they are built a fifth faster.
set(PUCKLOOP_TEST_OPTIONS $<$<CONFIG:RelWithDebInfo>:-Og> $<$<CONFIG:RelWithDebInfo>:-g0>)

# Copying debug information into some 170 executables was most of their linking: theirs have the names of functions alone,
# and gold, which comes with Debian's binutils, puts them together. `debug` has all of it.
include(CheckLinkerFlag)
check_linker_flag(CXX -fuse-ld=gold PUCKLOOP_HAS_GOLD)
function(puckloop_quick_link name)
  target_link_options(${name} PRIVATE $<$<CONFIG:RelWithDebInfo>:-Wl,--strip-debug>)
  if(PUCKLOOP_HAS_GOLD)
    target_link_options(${name} PRIVATE $<$<CONFIG:RelWithDebInfo>:-fuse-ld=gold>)
  endif()
endfunction()

# puckloop_test(NAME SOURCES a_test.cpp [LINK libraries...] [LABELS ...] [ALONE])
# One executable an area; every Catch2 case becomes a CTest case carrying the labels. ALONE: no other test runs beside.
function(puckloop_test name)
  cmake_parse_arguments(ARG "ALONE" "" "SOURCES;LINK;LABELS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE puckloop_test_main ${ARG_LINK})
  target_compile_options(${name} PRIVATE ${PUCKLOOP_TEST_OPTIONS})
  set_target_properties(${name} PROPERTIES PUCKLOOP_IS_TEST ON)
  puckloop_variant(${name} variant)
  if(variant)
    puckloop_sanitize(${name})
  endif()
  target_precompile_headers(${name} REUSE_FROM puckloop_test_precompiled${variant})
  puckloop_quick_link(${name})
  # A test that lacks what it needs (real images, a tool) prints "skipped: reason" or "reason: skipped", and CTest counts it
  # so. The bare word is not enough: it occurs in names of tests and in results, and would hide their failures.
  set(properties PROPERTIES SKIP_REGULAR_EXPRESSION "skipped: |: +skipped|:. +skipped")
  if(ARG_ALONE)
    list(APPEND properties RUN_SERIAL TRUE)
  endif()
  if(ARG_LABELS)
    list(JOIN ARG_LABELS "-" labels)  # one word: ctest -L takes a pattern, so each label still selects
    list(APPEND properties LABELS "${labels}")
  endif()
  catch_discover_tests(${name} TEST_PREFIX "${name}: " ${properties})
endfunction()

# The sources of tests some at a time, too: an object's fixed cost is a third of a test's. Few, as who changes one compiles
# all of them again. ALONE: what has file-level names that another file of the target has.
set(PUCKLOOP_UNITY_TESTS 6)
function(puckloop_unity_tests name)
  cmake_parse_arguments(ARG "" "" "ALONE" ${ARGN})
  set_source_files_properties(${ARG_ALONE} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  set_target_properties(${name} PROPERTIES UNITY_BUILD ${PUCKLOOP_UNITY} UNITY_BUILD_BATCH_SIZE ${PUCKLOOP_UNITY_TESTS})
  target_compile_options(${name} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
endfunction()
