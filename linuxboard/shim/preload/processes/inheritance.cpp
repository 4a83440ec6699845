#include "linuxboard/shim/preload/processes/inheritance.h"

#include "linuxboard/shim/preload/descriptors/external.h"
#include "linuxboard/shim/preload/descriptors/open_file.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/scheduler/timers.h"

#include <fcntl.h>

#include <cstdint>
#include <cstring>
#include <string_view>

namespace puckloop::shim {

namespace {
constexpr std::size_t kMostFiles = 128;
constexpr std::uint32_t kMostChannels = 512;

struct Counts {
    std::uint32_t files = 0;
    std::uint32_t channels = 0;
    std::uint32_t timers = 0;
};

template <typename T>
void put(std::string& text, const T& value) {
    text.append(reinterpret_cast<const char*>(&value), sizeof value);
}

template <typename T>
T get(std::string_view& text) {
    T value{};
    if (text.size() < sizeof value) return value;
    std::memcpy(static_cast<void*>(&value), text.data(), sizeof value);
    text.remove_prefix(sizeof value);
    return value;
}

bool is_open(int fd) {
    return REAL(fcntl)(fd, F_GETFD) >= 0;
}

struct Timers {
    std::string text;
    std::uint32_t count = 0;
};
}  // namespace

std::string leave(bool same_process) {
    Counts counts;
    FileEntry files[kMostFiles];
    counts.files = static_cast<std::uint32_t>(open_files(files, kMostFiles));
    std::string channels;
    for (int fd = 0; fd < kMostDescriptors && counts.channels < kMostChannels; ++fd) {
        if (!is_internal(fd)) continue;
        put(channels, fd);
        ++counts.channels;
    }
    Timers timers;
    if (same_process) {
        each_lasting_timer(
            [](const Timer& timer, void* context) {
                auto& list = *static_cast<Timers*>(context);
                put(list.text, timer);
                ++list.count;
            },
            &timers);
        counts.timers = timers.count;
    }
    std::string left;
    put(left, counts);
    for (std::uint32_t i = 0; i < counts.files; ++i)
        put(left, files[i]);
    return left + channels + timers.text;
}

void take_over(const std::string& left) {
    std::string_view text = left;
    const auto counts = get<Counts>(text);
    FileEntry files[kMostFiles];
    for (std::uint32_t i = 0; i < counts.files; ++i)
        files[i] = get<FileEntry>(text);
    take_over_files(files, counts.files);
    for (std::uint32_t i = 0; i < counts.channels; ++i) {
        const int fd = get<int>(text);
        if (is_open(fd)) mark_internal(fd);
    }
    for (std::uint32_t i = 0; i < counts.timers; ++i) {
        const auto timer = get<Timer>(text);
        if (timer.fd < 0) {
            real_timer() = timer;
        } else if (is_open(timer.fd)) {
            if (Timer* own_timer = new_timer(timer.fd)) *own_timer = timer;
        }
    }
}

}  // namespace puckloop::shim
