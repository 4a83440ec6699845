// Limits that a program sets for itself. Its link to the run stays within them: a process that it makes gets
// a link of its own at the same number, which the kernel refuses beyond the limit of open files.

#include "linuxboard/shim/preload/host.h"
#include "linuxboard/shim/preload/link.h"
#include "linuxboard/shim/preload/real.h"
#include "linuxboard/shim/preload/threads/scheduler.h"

#include <sys/resource.h>

#include <algorithm>

using namespace puckloop::shim;

namespace {
template <typename Limit>
Limit with_link(Limit limit) {
    const auto least = static_cast<rlim_t>(link_descriptors());
    limit.rlim_cur = std::max(limit.rlim_cur, least);
    limit.rlim_max = std::max(limit.rlim_max, least);
    return limit;
}

bool limits_link(int resource) {
    return active() && resource == static_cast<int>(RLIMIT_NOFILE);
}
}  // namespace

SHIM_EXPORT int setrlimit(__rlimit_resource_t resource, const rlimit* limit) noexcept {
    if (!limits_link(resource) || limit == nullptr) return REAL(setrlimit)(resource, limit);
    const rlimit raised = with_link(*limit);
    return REAL(setrlimit)(resource, &raised);
}

SHIM_EXPORT int setrlimit64(__rlimit_resource_t resource, const rlimit64* limit) noexcept {
    if (!limits_link(resource) || limit == nullptr) return REAL(setrlimit64)(resource, limit);
    const rlimit64 raised = with_link(*limit);
    return REAL(setrlimit64)(resource, &raised);
}

SHIM_EXPORT int prlimit(pid_t process, __rlimit_resource resource, const rlimit* limit,
                        rlimit* before) noexcept {
    if (!limits_link(resource) || limit == nullptr) return REAL(prlimit)(process, resource, limit, before);
    const rlimit raised = with_link(*limit);
    return REAL(prlimit)(process, resource, &raised, before);
}

SHIM_EXPORT int prlimit64(pid_t process, __rlimit_resource resource, const rlimit64* limit,
                          rlimit64* before) noexcept {
    if (!limits_link(resource) || limit == nullptr) return REAL(prlimit64)(process, resource, limit, before);
    const rlimit64 raised = with_link(*limit);
    return REAL(prlimit64)(process, resource, &raised, before);
}
