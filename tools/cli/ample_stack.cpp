#include "tools/cli/ample_stack.h"

#include <sys/resource.h>

#include <pthread.h>

#include <cstddef>
#include <cstdio>

namespace puckloop::tools {

namespace {
constexpr std::size_t kAmple = 8 << 20;

struct Program {
    int (*main)(int, char**);
    int argc;
    char** argv;
    int status = 1;
};

void* run(void* argument) {
    auto& program = *static_cast<Program*>(argument);
    program.status = program.main(program.argc, program.argv);
    return nullptr;
}
}  // namespace

int with_ample_stack(int (*main)(int, char**), int argc, char** argv) {
    rlimit limit{};
    if (::getrlimit(RLIMIT_STACK, &limit) != 0 || limit.rlim_cur >= kAmple) return main(argc, argv);
    Program program{main, argc, argv};
    pthread_attr_t attributes;
    pthread_t thread{};
    const bool made = pthread_attr_init(&attributes) == 0 &&
                      pthread_attr_setstacksize(&attributes, kAmple) == 0 &&
                      pthread_setattr_default_np(&attributes) == 0 &&
                      pthread_create(&thread, &attributes, run, &program) == 0;
    if (!made) {
        std::fputs("puckloop: not enough memory for a stack of 8 MiB, or processes are limited to less "
                   "(ulimit -s, -u, -v)\n",
                   stderr);
        return 1;
    }
    pthread_join(thread, nullptr);
    return program.status;
}

}  // namespace puckloop::tools
