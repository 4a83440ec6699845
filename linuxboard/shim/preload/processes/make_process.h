#pragma once
// One process more. The program's process makes one in between, which makes the new one and ends: so the new
// one's parent is the node, which learns of its end and delivers SIGCHLD in simulated time.

#include <cstdint>
#include <string>

#include <sys/types.h>

namespace puckloop::shim {

/// A process that the node has made room for.
struct Birth {
    std::uint32_t slot = 0;
    int link = -1;
};

/// The calls of this library make a process right now.
bool is_making_process();
/// Asks the node for a process; `left` is for its program. False and errno if there is none.
bool ask_for_process(Birth& birth, const std::string& left);
/// Makes a process that does nothing but `work`, with `context`, whose result is its status (0 to 255).
/// Returns that, or -1 if the host made none. `with_handlers`: pthread_atfork's handlers run.
int in_between(int (*work)(void*), void* context, bool with_handlers);
/// Reports to the node whether the new process is there; its number, or -1.
pid_t report_birth(const Birth& birth, bool made);

/// child_calls.cpp: fork() without the handlers of pthread_atfork().
pid_t fork_plainly();
/// clone_calls.cpp: a process as clone() makes it; ends this one if it cannot be conducted. `name`: the call.
pid_t clone_process(const char* name, std::uint64_t flags, int signal, void* stack, void* parent_number,
                    void* child_number);
/// Ends this process with one line and status 126, because of a call that would escape simulated time.
[[noreturn]] void refuse_call(const char* name, const char* why);

/// The process numbers of ended children, as waitpid() gives them; see wait_calls.cpp.
pid_t await_child(pid_t which, int* status, int options);

/// Ends this process with one line if `file` is a program that cannot be conducted; `spawned`: only reports
/// it, and returns false.
bool can_be_conducted(const char* file, bool spawned);
/// `environment` with what leads to the link of the process at `slot` and to this library.
char** linked_environment(char* const* environment, std::uint32_t slot);
/// Where execvp() finds `file`; `room` of PATH_MAX bytes. `file` itself if it is nowhere.
const char* search_path(const char* file, char* room);

}  // namespace puckloop::shim
