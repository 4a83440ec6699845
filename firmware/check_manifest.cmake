cmake_minimum_required(VERSION 3.25)
# cmake -DFOLDER=firmware/epuck -P check_manifest.cmake
# Fails when a file named in manifest.txt differs from its SHA-256, or a source is missing from the manifest: then
# the committed image was not built from the committed sources.

file(STRINGS ${FOLDER}/manifest.txt lines)
set(listed "")
foreach(line IN LISTS lines)
  if(NOT line MATCHES "^([0-9a-f]+) [ *](.+)$")
    message(FATAL_ERROR "${FOLDER}/manifest.txt: expected 'sha256  file', found '${line}'")
  endif()
  set(expected ${CMAKE_MATCH_1})
  set(name ${CMAKE_MATCH_2})
  list(APPEND listed ${name})
  if(NOT EXISTS ${FOLDER}/${name})
    message(FATAL_ERROR "${FOLDER}/${name}: named in manifest.txt but missing")
  endif()
  file(SHA256 ${FOLDER}/${name} found)
  if(NOT found STREQUAL expected)
    message(FATAL_ERROR "${FOLDER}/${name}: changed since the image was built; build it again (README.md)")
  endif()
endforeach()

file(GLOB sources RELATIVE ${FOLDER} ${FOLDER}/*.c ${FOLDER}/*.h ${FOLDER}/*.s ${FOLDER}/*.ld ${FOLDER}/Makefile
     ${FOLDER}/*.hex ${FOLDER}/*.elf)
foreach(name IN LISTS sources)
  if(NOT name IN_LIST listed)
    message(FATAL_ERROR "${FOLDER}/${name}: not in manifest.txt; build the image again (README.md)")
  endif()
endforeach()
list(LENGTH listed count)
message(STATUS "${FOLDER}: image and ${count} files agree")
