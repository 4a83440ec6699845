#include "firmware/host/host.h"

#include "firmware/host/register_objects.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

extern "C" void __sanitizer_print_stack_trace();

namespace hosted {

Host* Host::present_ = nullptr;

Host::Host() {
    present_ = this;
}
Host::~Host() {
    present_ = nullptr;
}
Host& Host::present() {
    if (present_ == nullptr) fail("the firmware runs without a chip", 0, 0);
    return *present_;
}

void Host::act_if_due() {
    if (acting_ || cycle() < due_) return;
    acting_ = true;
    due_ = act();
    acting_ = false;
}

void Host::pass(Cycle cycles) {
    if (whole_ != 0) return;
    const Cycle end = cycle() + cycles;
    do {
        act_if_due();
        run_to(std::min(end, std::max(due_, cycle() + 1)));
    } while (cycle() < end);
}

void Host::call(void (*routine)()) {
    constexpr int kDeepest = 16;
    if (depth_ == kDeepest) fail("interrupts nest without end", depth_, 0);
    ++depth_;
    routine();
    --depth_;
}

void run_firmware(int (*firmware_main)()) {
    try {
        firmware_main();
        fail("main() of the firmware returned", 0, 0);
    } catch (const InputEnds&) {
    }
}

void fail(const char* what, long long a, long long b) {
    std::fprintf(stderr, "ERROR: firmware: %s (a = %lld, b = %lld)\n", what, a, b);
    __sanitizer_print_stack_trace();
    std::abort();
}

void touch() {
    Host::present().touch();
}
void begin_instruction() {
    Host::present().begin_instruction();
}
void end_instruction() {
    Host::present().end_instruction();
}
std::uint16_t read_word(std::uint16_t address) {
    Host::present().touch();
    return Host::present().read_word(address);
}
void write_word(std::uint16_t address, std::uint16_t value) {
    Host::present().touch();
    Host::present().write_word(address, value);
}
std::uint8_t read_byte(std::uint16_t address) {
    Host::present().touch();
    return Host::present().read_byte(address);
}
void write_byte(std::uint16_t address, std::uint8_t value) {
    Host::present().touch();
    Host::present().write_byte(address, value);
}

}  // namespace hosted
