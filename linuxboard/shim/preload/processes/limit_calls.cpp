// Limits that a program sets for itself. Its link to the run stays within them: a process that it makes gets
// a link of its own at the same number, which the kernel refuses beyond the limit of open files.

#include "linuxboard/shim/preload/host/failure.h"
#include "linuxboard/shim/preload/host/host.h"
#include "linuxboard/shim/preload/host/link.h"
#include "linuxboard/shim/preload/host/process_numbers.h"
#include "linuxboard/shim/preload/host/program_memory.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"

#include <sys/resource.h>

#include <algorithm>
#include <cerrno>

using namespace puckloop::shim;

namespace {
/// Of the sizes of files, as the program has set it: the host's stays as it is, since behind the program's
/// standard output is a file of the run, which on the board is none.
rlimit file_size{RLIM_INFINITY, RLIM_INFINITY};

bool is_kept_here(int resource) {
    return active() && resource == static_cast<int>(RLIMIT_FSIZE);
}

template <typename Limit>
int get_file_size(Limit* limit) {
    const Limit current{file_size.rlim_cur, file_size.rlim_max};
    return put_to_program(limit, current) ? 0 : -1;
}

template <typename Limit>
int set_file_size(const Limit* limit) {
    Limit wanted{};
    if (!get_from_program(wanted, limit)) return -1;
    if (wanted.rlim_cur > wanted.rlim_max) return fail(EINVAL);
    if (wanted.rlim_cur != RLIM_INFINITY) note("the limit of file sizes is not enforced");
    file_size = {wanted.rlim_cur, wanted.rlim_max};
    return 0;
}

/// A limit that leaves room for the link.
template <typename Limit>
Limit with_link(Limit limit) {
    const auto least = static_cast<rlim_t>(link_descriptors());
    limit.rlim_cur = std::max(limit.rlim_cur, least);
    limit.rlim_max = std::max(limit.rlim_max, least);
    return limit;
}

template <typename Limit, typename Call>
int set_limit(int resource, const Limit* limit, Call real) {
    if (is_kept_here(resource)) return set_file_size(limit);
    if (!active() || resource != static_cast<int>(RLIMIT_NOFILE)) return real(limit);
    Limit wanted{};
    if (!get_from_program(wanted, limit)) return -1;
    if (wanted.rlim_cur > wanted.rlim_max) return real(limit);
    wanted = with_link(wanted);
    return real(&wanted);
}

template <typename Limit, typename Call>
int change_limit(int resource, const Limit* limit, Limit* before, Call real) {
    if (is_kept_here(resource)) {
        if (before != nullptr && get_file_size(before) != 0) return -1;
        return limit == nullptr ? 0 : set_file_size(limit);
    }
    if (limit == nullptr) return real(nullptr);
    return set_limit(resource, limit, real);
}
}  // namespace

SHIM_EXPORT int setrlimit(__rlimit_resource_t resource, const rlimit* limit) noexcept {
    return set_limit(static_cast<int>(resource), limit,
                     [&](const rlimit* wanted) { return REAL(setrlimit)(resource, wanted); });
}

SHIM_EXPORT int setrlimit64(__rlimit_resource_t resource, const rlimit64* limit) noexcept {
    return set_limit(static_cast<int>(resource), limit,
                     [&](const rlimit64* wanted) { return REAL(setrlimit64)(resource, wanted); });
}

SHIM_EXPORT int getrlimit(__rlimit_resource_t resource, rlimit* limit) noexcept {
    return is_kept_here(static_cast<int>(resource)) ? get_file_size(limit) : REAL(getrlimit)(resource, limit);
}

SHIM_EXPORT int getrlimit64(__rlimit_resource_t resource, rlimit64* limit) noexcept {
    return is_kept_here(static_cast<int>(resource)) ? get_file_size(limit)
                                                    : REAL(getrlimit64)(resource, limit);
}

SHIM_EXPORT int prlimit(pid_t process, __rlimit_resource resource, const rlimit* limit,
                        rlimit* before) noexcept {
    return change_limit(static_cast<int>(resource), limit, before, [&](const rlimit* wanted) {
        const pid_t host = host_process(process);
        return host < 0 ? -1 : REAL(prlimit)(host, resource, wanted, before);
    });
}

SHIM_EXPORT int prlimit64(pid_t process, __rlimit_resource resource, const rlimit64* limit,
                          rlimit64* before) noexcept {
    return change_limit(static_cast<int>(resource), limit, before, [&](const rlimit64* wanted) {
        const pid_t host = host_process(process);
        return host < 0 ? -1 : REAL(prlimit64)(host, resource, wanted, before);
    });
}
