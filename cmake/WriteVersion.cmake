# Writes OUTPUT, the version that programs and reports name: NUMBER, and the commit that is checked out in
# SOURCE. Run at every build; the file changes only with its content. Outside of a repository the commit is empty.
set(commit "")
set(modified false)
find_program(GIT git)
if(GIT)
  execute_process(COMMAND ${GIT} -C ${SOURCE} rev-parse --show-toplevel OUTPUT_VARIABLE top OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  file(REAL_PATH "${SOURCE}" source)
  if(top STREQUAL source) # not a repository around unpacked sources
    execute_process(COMMAND ${GIT} -C ${SOURCE} rev-parse --short=12 HEAD OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    # What is written about the program does not change it.
    execute_process(COMMAND ${GIT} -C ${SOURCE} --no-optional-locks status --porcelain --untracked-files=no -- . ":!docs" ":!*.md"
                    OUTPUT_VARIABLE changes OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    if(NOT changes STREQUAL "")
      set(modified true)
    endif()
  endif()
endif()
set(text "#include \"base/version/version.h\"

namespace puckloop {

const Version& program_version() {
    static const Version version{\"${NUMBER}\", \"${commit}\", ${modified}};
    return version;
}

}  // namespace puckloop
")
set(old "")
if(EXISTS ${OUTPUT})
  file(READ ${OUTPUT} old)
endif()
if(NOT old STREQUAL text)
  file(WRITE ${OUTPUT} "${text}")
endif()
