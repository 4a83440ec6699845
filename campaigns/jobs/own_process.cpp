#include "campaigns/jobs/own_process.h"

#include "base/files/shipped_files.h"

#include <unistd.h>

#include <utility>

namespace puckloop::jobs {

namespace {

int start(const char* program, std::vector<std::string> words, posix_spawn_file_actions_t& actions,
          pid_t& id) {
    words.insert(words.begin(), "puckloop");
    std::vector<char*> arguments;
    for (std::string& word : words)
        arguments.push_back(word.data());
    arguments.push_back(nullptr);
    const int error = ::posix_spawn(&id, program, &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    return error;
}

}  // namespace

int start_self(std::vector<std::string> words, posix_spawn_file_actions_t& actions, pid_t& id) {
    return start("/proc/self/exe", std::move(words), actions, id);
}

int start_puckloop(std::vector<std::string> words, posix_spawn_file_actions_t& actions, pid_t& id) {
    return start(main_program().c_str(), std::move(words), actions, id);
}

}  // namespace puckloop::jobs
