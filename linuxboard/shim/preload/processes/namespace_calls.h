#pragma once
// What calls that lead past the library come to, whether made by name or by number. Those that refuse end the
// program with status 126.

#include <cstdint>

namespace puckloop::shim {

/// Where `flags`, of unshare(), ask for a namespace.
void refuse_namespaces(const char* name, std::uint64_t flags);
void refuse_joining(const char* name);
/// A filter of system calls.
void refuse_filter(const char* name);
/// True if the library answers this option; `result` as prctl() gives it, errno set.
bool own_prctl(long option, long argument, long* result);

}  // namespace puckloop::shim
