#include "tests/end_to_end/kit/load.h"

#include <atomic>
#include <csignal>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace puckloop::tests {

namespace {
constexpr int kNice = 5;
constexpr unsigned kLongest = 30;  // s
}  // namespace

Load::Load(int processes) {
    for (int i = 0; i < processes; ++i) {
        const pid_t burner = fork();
        if (burner == 0) {
            prctl(PR_SET_PDEATHSIG, SIGKILL);
            [[maybe_unused]] const int level = nice(kNice);
            std::signal(SIGALRM, SIG_DFL);
            alarm(kLongest);
            std::atomic<unsigned> count{0};
            while (true)
                ++count;
        }
        if (burner > 0) burners_.push_back(burner);
    }
}

Load::~Load() {
    for (const pid_t burner : burners_) {
        ::kill(burner, SIGKILL);
        waitpid(burner, nullptr, 0);
    }
}

}  // namespace puckloop::tests
