#include "cosim/interrupt.h"

#include <array>
#include <cstddef>

namespace puckloop::cosim {

namespace {

constexpr std::array kSignals{SIGINT, SIGTERM, SIGHUP};
volatile std::sig_atomic_t caught = 0;
volatile std::sig_atomic_t caught_again = 0;

extern "C" void puckloop_note_signal(int signal) {
    if (caught == 0) {
        caught = signal;
        return;
    }
    caught_again = signal;
    for (const int number : kSignals)
        std::signal(number, SIG_DFL);
}

}  // namespace

InterruptGuard::InterruptGuard() {
    caught = 0;
    caught_again = 0;
    struct sigaction action {};
    action.sa_handler = puckloop_note_signal;
    sigemptyset(&action.sa_mask);
    for (std::size_t i = 0; i < kSignals.size(); ++i)
        sigaction(kSignals[i], &action, &before_[i]);
}

InterruptGuard::~InterruptGuard() {
    for (std::size_t i = 0; i < kSignals.size(); ++i)
        sigaction(kSignals[i], &before_[i], nullptr);
}

const volatile std::sig_atomic_t* InterruptGuard::flag() const {
    return &caught;
}

const volatile std::sig_atomic_t* InterruptGuard::again() const {
    return &caught_again;
}

}  // namespace puckloop::cosim
