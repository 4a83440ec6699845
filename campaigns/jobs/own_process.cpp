#include "campaigns/jobs/own_process.h"

#include <unistd.h>

namespace puckloop::jobs {

int start_self(std::vector<std::string> words, posix_spawn_file_actions_t& actions, pid_t& id) {
    words.insert(words.begin(), "puckloop");
    std::vector<char*> arguments;
    for (std::string& word : words)
        arguments.push_back(word.data());
    arguments.push_back(nullptr);
    const int error = ::posix_spawn(&id, "/proc/self/exe", &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    return error;
}

}  // namespace puckloop::jobs
