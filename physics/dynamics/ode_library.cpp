#include "physics/dynamics/ode_library.h"

#include "base/error.h"

#include <ode/ode.h>

#include <array>
#include <cstdarg>
#include <cstdio>

namespace puckloop::physics {

namespace {

thread_local OdeWarnings* current = nullptr;

std::string formatted(const char* message, va_list arguments) {
    std::array<char, 256> text{};
    std::vsnprintf(text.data(), text.size(), message, arguments);
    return text.data();
}

void on_message(int, const char* message, va_list arguments) {
    if (current == nullptr) return;
    if (current->count++ == 0) current->first = formatted(message, arguments);
}

void on_error(int, const char* message, va_list arguments) {
    throw RunError("physics: ODE: " + formatted(message, arguments));
}

struct Library {
    Library() {
        dInitODE2(0);
        dSetMessageHandler(on_message);
        dSetErrorHandler(on_error);
        dSetDebugHandler(on_error);
    }
    ~Library() { dCloseODE(); }
};

struct ThreadData {
    ThreadData() { dAllocateODEDataForThread(dAllocateMaskAll); }
};

}  // namespace

OdeSession::OdeSession(OdeWarnings& ode_warnings) : previous_(current) {
    static const Library library;
    static thread_local const ThreadData thread_data;
    static_cast<void>(thread_data);
    current = &ode_warnings;
}

OdeSession::~OdeSession() {
    current = previous_;
}

}  // namespace puckloop::physics
