// The kernel's Syscall User Dispatch raises SIGSYS for each system call whose instruction is outside of one
// range, which is the C library's: runtimes of some languages, OpenMP's and hand-written assembly come here.
// Calls of the dynamic linker and of the kernel's own page (vDSO) are passed on as they are.

#include "linuxboard/shim/preload/host/direct_syscalls.h"

#include "linuxboard/shim/preload/host/fault_signals.h"
#include "linuxboard/shim/preload/host/host.h"
#include "linuxboard/shim/preload/host/kernel_signals.h"

#include <elf.h>
#include <link.h>
#include <signal.h>
#include <sys/auxv.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <ucontext.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>

namespace puckloop::shim {

#if defined(__x86_64__)

namespace {
#ifndef PR_SET_SYSCALL_USER_DISPATCH
constexpr int PR_SET_SYSCALL_USER_DISPATCH = 59;
constexpr int PR_SYS_DISPATCH_ON = 1;
#endif

struct Range {
    std::uintptr_t begin = 0, end = 0;
    bool holds(std::uintptr_t place) const { return place >= begin && place < end; }
};
Range library, linker, vdso, own_code;
std::uintptr_t library_return = 0;  ///< the C library's code for the return from a handler
const volatile char kDispatch = 1;  ///< SYSCALL_DISPATCH_FILTER_BLOCK, for every thread and always

struct Places {
    std::uintptr_t library, linker, vdso, own;
};

int look_at_object(dl_phdr_info* info, std::size_t, void* context) {
    const Places& places = *static_cast<const Places*>(context);
    for (int i = 0; i < info->dlpi_phnum; ++i) {
        const ElfW(Phdr)& part = info->dlpi_phdr[i];
        if (part.p_type != PT_LOAD || (part.p_flags & PF_X) == 0) continue;
        const std::uintptr_t begin = info->dlpi_addr + part.p_vaddr;
        const Range range{begin, begin + part.p_memsz};
        if (range.holds(places.library)) library = range;
        if (range.holds(places.own)) own_code = range;
        if (info->dlpi_addr == places.linker) linker = range;
        if (places.vdso != 0 && range.holds(places.vdso)) vdso = range;
    }
    return 0;
}

/// The auxiliary vector lies behind the environment; the C library has read its own copy of this entry.
void hide_vdso() {
    char** end = environ;
    if (reinterpret_cast<std::uintptr_t>(end) < reinterpret_cast<std::uintptr_t>(&end))
        return;  // moved already
    while (*end != nullptr)
        ++end;
    for (auto* entry = reinterpret_cast<ElfW(auxv_t)*>(end + 1); entry->a_type != AT_NULL; ++entry)
        if (entry->a_type == AT_SYSINFO_EHDR) entry->a_type = AT_IGNORE;
}

/// Where a handler of the C library's sigaction() returns to: it is in the range that is let through.
std::uintptr_t return_of_handlers() {
    KernelAction action{};
    host_call(SYS_rt_sigaction, SIGSYS, 0, reinterpret_cast<long>(&action), kKernelSetSize);
    return reinterpret_cast<std::uintptr_t>(action.restorer);
}

long conducted_call(long number, long a, long b, long c, long d, long e, long f) {
    return ::syscall(number, a, b, c, d, e, f);
}

/// What the call changed of this thread is what its instruction goes on with, not what it was before.
void keep_changes(long number, ucontext_t& context) {
    if (number == SYS_rt_sigprocmask)
        host_call(SYS_rt_sigprocmask, SIG_BLOCK, 0, reinterpret_cast<long>(&context.uc_sigmask),
                  kKernelSetSize);
    if (number == SYS_sigaltstack) host_call(SYS_sigaltstack, 0, reinterpret_cast<long>(&context.uc_stack));
}

void on_direct_call(void* pointer) {
    auto& context = *static_cast<ucontext_t*>(pointer);
    auto& registers = context.uc_mcontext.gregs;
    const long number = registers[REG_RAX];
    const auto place = static_cast<std::uintptr_t>(registers[REG_RIP]) - 1;
    if (number == SYS_rt_sigreturn) {  // of a handler with an own way back: the frame is where its stack is
        asm volatile("mov %0, %%rsp\n\tjmp *%1" : : "r"(registers[REG_RSP]), "r"(library_return) : "memory");
        __builtin_unreachable();
    }
    const int error = errno;
    const auto call =
        linker.holds(place) || vdso.holds(place) || own_code.holds(place) ? host_call : conducted_call;
    const long result = call(number, registers[REG_RDI], registers[REG_RSI], registers[REG_RDX],
                             registers[REG_R10], registers[REG_R8], registers[REG_R9]);
    registers[REG_RAX] = result == -1 ? -errno : result;
    keep_changes(number, context);
    errno = error;
}
}  // namespace

void prepare_direct_syscalls() {
    Places places{place_of_host_call(), getauxval(AT_BASE), getauxval(AT_SYSINFO_EHDR),
                  reinterpret_cast<std::uintptr_t>(&on_direct_call)};
    dl_iterate_phdr(look_at_object, &places);
    if (library.begin == 0) return;
    hide_vdso();
    library_return = return_of_handlers();
    take_direct_calls(on_direct_call);
}

void conduct_direct_syscalls() {
    if (library_return == 0) return;
    host_call(SYS_prctl, PR_SET_SYSCALL_USER_DISPATCH, PR_SYS_DISPATCH_ON, static_cast<long>(library.begin),
              static_cast<long>(library.end - library.begin), reinterpret_cast<long>(&kDispatch));
}

#else

void prepare_direct_syscalls() {}
void conduct_direct_syscalls() {}

#endif

}  // namespace puckloop::shim
