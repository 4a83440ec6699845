/* Tries to leave simulated time or to harm the run, in the way its argument names. */
#define _GNU_SOURCE
#include "serial.h"
#include <errno.h>
#include <fcntl.h>
#include <linux/sched.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <stdint.h>
#include <sys/auxv.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/times.h>
#include <sys/wait.h>
#include <time.h>

extern pid_t _Fork(void);

static void handler(int number) {
    (void)number;
}

static int child(void* argument) {
    usleep(10000);
    if (write(*(int*)argument, "c", 1) != 1) return 9;
    return 5;
}

/* A system call by an instruction of its own. */
static long direct(long number, long a, long b, long c, long d) {
#if defined(__x86_64__)
    register long fourth __asm__("r10") = d;
    long result;
    __asm__ volatile("syscall"
                     : "=a"(result)
                     : "a"(number), "D"(a), "S"(b), "d"(c), "r"(fourth)
                     : "rcx", "r11", "memory");
    return result;
#else
    const long result = syscall(number, a, b, c, d);
    return result < 0 ? -errno : result;
#endif
}

static void* direct_thread(void* argument) {
    struct timespec pause = {0, 10000000};
    direct(SYS_nanosleep, (long)&pause, 0, 0, 0);
    return (void*)direct(SYS_write, *(int*)argument, (long)"t", 1, 0);
}

static volatile int handled;
static void count(int number) {
    handled += number;
}
#if defined(__x86_64__)
void own_return(void);
__asm__(".globl own_return\nown_return: mov $15, %eax\n\tsyscall");
#else
#define own_return 0
#endif

/* A handler with a way back of its own, as some languages' runtimes have, while all signals are blocked. */
static void direct_signals(void) {
    struct {
        void* handler;
        unsigned long flags;
        void* restorer;
        uint64_t mask;
    } action = {(void*)count, 0x04000000, (void*)own_return, ~(uint64_t)0}, before = {0, 0, 0, 0};
    const uint64_t all = ~(uint64_t)0, none = 0;
    const long set = direct(SYS_rt_sigaction, SIGUSR1, (long)&action, 0, 8);
    direct(SYS_rt_sigprocmask, SIG_SETMASK, (long)&all, 0, 8);
    direct(SYS_kill, direct(SYS_getpid, 0, 0, 0, 0), SIGUSR1, 0, 0);
    printf("set %ld, handled %d", set, handled);
    direct(SYS_rt_sigprocmask, SIG_SETMASK, (long)&none, 0, 8);
    direct(SYS_rt_sigaction, SIGUSR1, 0, (long)&before, 8);
    static char room[65536];
    stack_t wanted = {room, 0, sizeof room}, found = {NULL, 0, 0};
    direct(SYS_sigaltstack, (long)&wanted, 0, 0, 0);
    direct(SYS_sigaltstack, 0, (long)&found, 0, 0);
    printf(", then %d, %d, stack %d\n", handled == SIGUSR1, before.handler == (void*)count,
           found.ss_sp == room);
}

/* A child that the call made writes after 10 ms, its parent after 20. */
static int after(long made, int fd) {
    if (made < 0) {
        perror("no child");
        return 2;
    }
    if (made == 0) _exit(child(&fd));
    int status = 0;
    usleep(20000);
    if (write(fd, "p", 1) != 1) return 9;
    const pid_t ended = waitpid(-1, &status, __WALL);
    printf("child %ld, ended %d, status %d\n", made, ended, WEXITSTATUS(status));
    return 0;
}

static int direct_calls(const char* how, int fd) {
    struct timespec from = {0, 0}, to = {0, 0}, pause = {0, 10000000};
    if (strcmp(how, "direct-openat") == 0) {
        const long other = direct(SYS_openat, AT_FDCWD, (long)"/dev/ttyS0", O_RDWR, 0);
        printf("%ld %ld\n", direct(SYS_openat, AT_FDCWD, (long)"/nowhere", O_RDONLY, 0),
               direct(SYS_write, 999, (long)"x", 1, 0));
        return direct(SYS_write, other, (long)"ok", 2, 0) != 2;
    }
    if (strcmp(how, "direct-clock") == 0) {
        direct(SYS_clock_gettime, CLOCK_MONOTONIC, (long)&from, 0, 0);
        direct(SYS_nanosleep, (long)&pause, 0, 0, 0);
        direct(SYS_clock_gettime, CLOCK_MONOTONIC, (long)&to, 0, 0);
        const long passed = (to.tv_sec - from.tv_sec) * 1000000000 + to.tv_nsec - from.tv_nsec;
        printf("%ld us, own clock page %ld\n", passed / 1000, (long)getauxval(AT_SYSINFO_EHDR));
        return 0;
    }
    if (strcmp(how, "direct-fork") == 0) return after(direct(SYS_clone, SIGCHLD, 0, 0, 0), fd);
    if (strcmp(how, "direct-io_uring") == 0) return (int)direct(SYS_io_uring_setup, 4, (long)&from, 0, 0);
    if (strcmp(how, "direct-signals") == 0) {
        direct_signals();
        return 0;
    }
    if (strcmp(how, "direct-thread") == 0) {
        pthread_t thread;
        void* written = NULL;
        pthread_create(&thread, NULL, direct_thread, &fd);
        direct(SYS_write, fd, (long)"m", 1, 0);
        pthread_join(thread, &written);
        return written != (void*)1;
    }
    return 4;
}

/* The file that the library and the run share, as a program may find it. */
static int shared_file(void) {
    for (int fd = 3; fd < 1024; fd++) {
        char name[40], target[200] = "";
        snprintf(name, sizeof name, "/proc/self/fd/%d", fd);
        if (readlink(name, target, sizeof target - 1) > 0 && strstr(target, "puckloop-shim")) return fd;
    }
    return -1;
}

static void* shared_memory(size_t* size) {
    FILE* maps = fopen("/proc/self/maps", "r");
    char line[400];
    while (fgets(line, sizeof line, maps)) {
        unsigned long begin, end;
        if (strstr(line, "puckloop-shim") == NULL || sscanf(line, "%lx-%lx", &begin, &end) != 2) continue;
        *size = end - begin;
        return (void*)begin;
    }
    return NULL;
}

static double cpu(clockid_t id) {
    struct timespec t = {0, 0};
    clock_gettime(id, &t);
    return (double)t.tv_sec + (double)t.tv_nsec / 1e9;
}

static void show_cpu(void) {
    struct rusage self, children;
    struct tms ticks;
    getrusage(RUSAGE_SELF, &self);
    getrusage(RUSAGE_CHILDREN, &children);
    times(&ticks);
    clockid_t id;
    clock_getcpuclockid(0, &id);
    const double all[] = {cpu(CLOCK_PROCESS_CPUTIME_ID),
                          cpu(CLOCK_THREAD_CPUTIME_ID),
                          cpu(id),
                          (double)clock() / CLOCKS_PER_SEC,
                          (double)self.ru_stime.tv_sec + (double)self.ru_stime.tv_usec / 1e6,
                          (double)ticks.tms_stime / (double)sysconf(_SC_CLK_TCK)};
    for (unsigned i = 0; i < sizeof all / sizeof all[0]; i++)
        printf("%.2f ", all[i]);
    printf("%.2f %.2f %ld\n", (double)self.ru_utime.tv_sec, (double)children.ru_stime.tv_usec / 1e6,
           self.ru_maxrss);
}

int main(int argc, char** argv) {
    const char* how = argc > 1 ? argv[1] : "";
    int fd = open_serial(1, 0);
    static char stack[65536];
    if (strncmp(how, "direct-", 7) == 0) return direct_calls(how, fd);
    if (strcmp(how, "SYS_fork") == 0) return after(syscall(SYS_fork), fd);
    if (strcmp(how, "SYS_clone") == 0) return after(syscall(SYS_clone, SIGCHLD, 0, 0, 0, 0), fd);
    if (strcmp(how, "SYS_clone3") == 0) {
        struct clone_args wanted = {.exit_signal = SIGCHLD};
        return after(syscall(SYS_clone3, &wanted, sizeof wanted), fd);
    }
    if (strcmp(how, "_Fork") == 0) return after(_Fork(), fd);
    if (strcmp(how, "clone") == 0) return after(clone(child, stack + sizeof stack, SIGCHLD, &fd), fd);
    if (strcmp(how, "clone-vfork") == 0)
        return after(clone(child, stack + sizeof stack, CLONE_VM | CLONE_VFORK | SIGCHLD, &fd), fd);
    if (strcmp(how, "clone-memory") == 0)
        return after(clone(child, stack + sizeof stack, CLONE_VM | SIGCHLD, &fd), fd);
    if (strcmp(how, "SYS_clone-thread") == 0)
        return after(
            syscall(SYS_clone, CLONE_VM | CLONE_THREAD | CLONE_SIGHAND, stack + sizeof stack, 0, 0, 0), fd);
    if (strcmp(how, "io_uring") == 0) {
        char params[120] = {0};
        printf("%ld\n", syscall(SYS_io_uring_setup, 4, params));
        return 0;
    }
    if (strcmp(how, "ptrace") == 0) return (int)ptrace(PTRACE_TRACEME, 0, 0, 0);
    if (strcmp(how, "SYS_ptrace") == 0) return (int)syscall(SYS_ptrace, PTRACE_TRACEME, 0, 0, 0);
    if (strcmp(how, "unshare") == 0) return unshare(CLONE_NEWPID | CLONE_NEWUSER);
    if (strcmp(how, "SYS_unshare") == 0) return (int)syscall(SYS_unshare, CLONE_NEWUSER);
    if (strcmp(how, "setns") == 0) return setns(0, 0);
    if (strcmp(how, "SYS_setns") == 0) return (int)syscall(SYS_setns, 0, 0);
    if (strcmp(how, "seccomp") == 0) return prctl(PR_SET_SECCOMP, 1);
    if (strcmp(how, "SYS_seccomp") == 0) return (int)syscall(SYS_seccomp, 0, 0, 0);
    if (strcmp(how, "SYS_prctl") == 0) return (int)syscall(SYS_prctl, PR_SET_SECCOMP, 1, 0, 0, 0);
    if (strcmp(how, "dispatch") == 0) return prctl(59, 0, 0, 0, 0);
    if (strcmp(how, "harmless") == 0) {
        char name[16] = "";
        int death = 0, none = -1;
        const int shared = unshare(CLONE_FILES);
        prctl(PR_SET_NAME, "robot");
        prctl(PR_GET_NAME, name);
        prctl(PR_SET_PDEATHSIG, SIGTERM);
        prctl(PR_GET_PDEATHSIG, &death);
        syscall(SYS_prctl, PR_SET_PDEATHSIG, 0, 0, 0, 0);
        prctl(PR_GET_PDEATHSIG, &none);
        printf("unshare %d, name %s, death signal %d, none %d, wrong %d\n", shared, name, death, none,
               prctl(PR_SET_PDEATHSIG, 1000));
        return 0;
    }
    if (strcmp(how, "SYS_openat") == 0) {
        const int other = (int)syscall(SYS_openat, AT_FDCWD, "/dev/ttyS0", O_RDWR, 0);
        return syscall(SYS_write, other, "ok", 2) != 2;
    }
    if (strcmp(how, "truncate") == 0) {
        const int file = shared_file();
        const int cut = ftruncate(file, 0);
        printf("found %d, ftruncate %d %d\n", file >= 0, cut, errno == EPERM);
        printf("again %ld\n", syscall(SYS_ftruncate, file, 0));
        return 0;
    }
    if (strcmp(how, "scribble") == 0) {
        size_t size = 0;
        uint64_t seed = strtoull(argv[2], NULL, 10);
        unsigned char* memory = shared_memory(&size);
        for (size_t i = 0; memory != NULL && i < size; i++) {
            seed = seed * 6364136223846793005u + 1442695040888963407u;
            if ((seed >> 40) % 3 == 0) memory[i] = (unsigned char)(seed >> 33);
        }
        usleep(1000);
        return 0;
    }
    if (strcmp(how, "close") == 0) {
        for (int i = 3; i < 1024; i++)
            syscall(SYS_close, i);
        closefrom(3);
        fd = open_serial(1, 0);
        return write(fd, "ok", 2) != 2;
    }
    if (strcmp(how, "file-size") == 0) {
        struct rlimit limit = {0, 0};
        setrlimit(RLIMIT_FSIZE, &limit);
        getrlimit(RLIMIT_FSIZE, &limit);
        printf("limit %ld\n", (long)limit.rlim_cur);
        return write(fd, "ok", 2) != 2;
    }
    if (strcmp(how, "segv-loop") == 0) {
        signal(SIGSEGV, handler);
        usleep(1000);
        *(volatile int*)(uintptr_t)(argc - 2) = 1;
        return 0;
    }
    if (strcmp(how, "segv-default") == 0) {
        signal(SIGSEGV, SIG_IGN);
        *(volatile int*)(uintptr_t)(argc - 2) = 1;
        return 0;
    }
    if (strcmp(how, "processor-time") == 0) {
        char byte;
        sleep(1);
        show_cpu();
        fcntl(fd, F_SETFL, O_NONBLOCK);
        for (int i = 0; i < 50000; i++) /* 2 us each */
            if (read(fd, &byte, 1) == 1) return 9;
        show_cpu();
        if (fork() == 0) {
            for (int i = 0; i < 25000; i++)
                if (read(fd, &byte, 1) == 1) return 9;
            _exit(0);
        }
        wait(NULL);
        show_cpu();
        return 0;
    }
    return 4;
}
