#include "benchmark/measures/other_load.h"

#include <fmt/format.h>

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <thread>

namespace puckloop::tools {

namespace {

double busy_now() {
    std::ifstream file("/proc/stat");
    std::string line;
    std::getline(file, line);
    return busy_seconds(line, static_cast<double>(::sysconf(_SC_CLK_TCK)));
}

double seconds_of_load(const timeval& time) {
    constexpr double kMicro = 1e-6;
    return static_cast<double>(time.tv_sec) + kMicro * static_cast<double>(time.tv_usec);
}

/// Of this process and of its children that have ended.
double own_cpu_now() {
    double sum = 0;
    for (const int who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
        rusage usage{};
        getrusage(who, &usage);
        sum += seconds_of_load(usage.ru_utime) + seconds_of_load(usage.ru_stime);
    }
    return sum;
}

double wall_now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double average_now() {
    double average = 0;
    ::getloadavg(&average, 1);
    return average;
}

}  // namespace

std::string OtherLoad::text() const {
    return fmt::format(
        "other load: {:.2f} of {} processors busy with other work; load average {:.1f} before, "
        "{:.1f} after",
        busy, processors, average_before, average_after);
}

double busy_seconds(const std::string& stat_line, double ticks_per_second) {
    std::istringstream words(stat_line);
    std::string name;
    words >> name;
    if (name != "cpu") return 0;
    // user, nice, system, idle, iowait, irq, softirq, steal; what follows is part of user and nice.
    std::array<double, 8> ticks{};
    for (double& count : ticks)
        words >> count;
    constexpr std::size_t kIdle = 3, kIoWait = 4;
    double busy = 0;
    for (std::size_t i = 0; i < ticks.size(); ++i)
        if (i != kIdle && i != kIoWait) busy += ticks[i];
    return busy / ticks_per_second;
}

OtherLoadMeter::OtherLoadMeter()
    : busy_(busy_now()), own_(own_cpu_now()), wall_(wall_now()), average_(average_now()) {}

OtherLoad OtherLoadMeter::read() const {
    OtherLoad load;
    load.processors = std::max(1U, std::thread::hardware_concurrency());
    const double wall = wall_now() - wall_;
    const double others = (busy_now() - busy_) - (own_cpu_now() - own_);
    if (wall > 0) load.busy = std::clamp(others / wall, 0.0, static_cast<double>(load.processors));
    load.average_before = average_;
    load.average_after = average_now();
    return load;
}

}  // namespace puckloop::tools
