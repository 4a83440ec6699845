#pragma once
// Processor time of the calling thread, s.

#include <ctime>

namespace puckloop::tools {

inline double processor_seconds() {
    timespec time{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
}

}  // namespace puckloop::tools
