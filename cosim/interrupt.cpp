#include "cosim/interrupt.h"

#include <unistd.h>

#include <array>
#include <cstddef>
#include <string_view>

namespace puckloop::cosim {

namespace {

constexpr std::array kSignals{SIGINT, SIGTERM, SIGHUP};
volatile std::sig_atomic_t caught = 0;
volatile std::sig_atomic_t caught_again = 0;
volatile std::sig_atomic_t on_terminal = 0;

/// A run may wait long for its end: for a program that winds up, or for a debugger that has not come.
void show_what_ends_it() {
    constexpr std::string_view kHint = "\npuckloop: ending; Ctrl-C again ends at once\n";
    [[maybe_unused]] const auto written = ::write(STDERR_FILENO, kHint.data(), kHint.size());
}

extern "C" void puckloop_note_signal(int signal) {
    if (caught == 0) {
        caught = signal;
        if (signal == SIGINT && on_terminal != 0) show_what_ends_it();
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
    on_terminal = ::isatty(STDERR_FILENO);
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
