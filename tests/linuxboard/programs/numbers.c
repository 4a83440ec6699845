/* Calls that take a process number. `numbers own`: with the program's own numbers, by getpid() and of a
 * child: each is to work. `numbers foreign PID`: with the number of a process of the host: each is to fail
 * with ESRCH. `numbers wait`: what waits for another process of the program, in simulated time. */
#define _GNU_SOURCE
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <mqueue.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/ipc.h>
#include <sys/msg.h>
#include <sys/resource.h>
#include <sys/sem.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static int failures;
static volatile sig_atomic_t heard;

static void count(int number) {
    heard += number == SIGUSR1;
}

/* ESRCH of a foreign process, success of one's own. */
static void expect(const char* call, long result, int foreign) {
    const int error = errno;
    const int right = foreign ? result == -1 && error == ESRCH : result >= 0;
    if (right) return;
    printf("%s: %ld, %s\n", call, result, result < 0 ? strerror(error) : "done");
    ++failures;
}

static void try_all(pid_t process, int foreign) {
    int pipes[2];
    if (pipe(pipes) != 0) exit(9);
    struct sched_param parameters = {0};
    struct timespec interval;
    struct rlimit limit;
    cpu_set_t processors;
    sched_getaffinity(0, sizeof processors, &processors);
    siginfo_t info;
    char byte = 1, copy = 0;
    struct iovec to = {&copy, 1}, from = {&byte, 1};
    memset(&info, 0, sizeof info);
    info.si_code = SI_QUEUE;
    const union sigval value = {7};
    expect("kill", kill(process, 0), foreign);
    expect("sigqueue", sigqueue(process, 0, value), foreign);
    expect("tgkill", tgkill(process, process, 0), foreign);
    expect("SYS_tkill", syscall(SYS_tkill, process, 0), foreign);
    expect("SYS_tgkill", syscall(SYS_tgkill, process, process, 0), foreign);
    expect("SYS_rt_sigqueueinfo", syscall(SYS_rt_sigqueueinfo, process, 0, &info), foreign);
    expect("SYS_rt_tgsigqueueinfo", syscall(SYS_rt_tgsigqueueinfo, process, process, 0, &info), foreign);
    expect("setpriority", setpriority(PRIO_PROCESS, (id_t)process, 3), foreign);
    errno = 0;
    const int level = getpriority(PRIO_PROCESS, (id_t)process);
    expect("getpriority", level, foreign);
    expect("SYS_getpriority", syscall(SYS_getpriority, PRIO_PROCESS, process), foreign);
    expect("sched_getscheduler", sched_getscheduler(process), foreign);
    expect("sched_setscheduler", sched_setscheduler(process, SCHED_OTHER, &parameters), foreign);
    expect("sched_getparam", sched_getparam(process, &parameters), foreign);
    expect("sched_setparam", sched_setparam(process, &parameters), foreign);
    expect("sched_rr_get_interval", sched_rr_get_interval(process, &interval), foreign);
    expect("sched_getaffinity", sched_getaffinity(process, sizeof processors, &processors), foreign);
    expect("sched_setaffinity", sched_setaffinity(process, sizeof processors, &processors), foreign);
    expect("SYS_sched_getaffinity", syscall(SYS_sched_getaffinity, process, sizeof processors, &processors),
           foreign);
    expect("prlimit", prlimit(process, RLIMIT_NOFILE, NULL, &limit), foreign);
    expect("SYS_ioprio_get", syscall(SYS_ioprio_get, 1, process), foreign);
    expect("process_vm_readv", process_vm_readv(process, &to, 1, &from, 1, 0), foreign);
    expect("SYS_process_vm_writev", syscall(SYS_process_vm_writev, process, &from, 1, &from, 1, 0), foreign);
    expect("SYS_kcmp", syscall(SYS_kcmp, process, process, 0, 0, 0), foreign);
    expect("F_SETOWN", fcntl(pipes[0], F_SETOWN, process), foreign);
    expect("getpgid", getpgid(process), foreign);
    expect("getsid", getsid(process), foreign);
    const int descriptor = (int)syscall(SYS_pidfd_open, process, 0);
    expect("SYS_pidfd_open", descriptor, foreign);
    if (!foreign && fcntl(pipes[0], F_GETOWN) != process) printf("F_GETOWN: %d\n", ++failures);
    if (descriptor >= 0) close(descriptor);
    close(pipes[0]);
    close(pipes[1]);
}

static long milliseconds(void) {
    static struct timespec begin;
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    if (begin.tv_sec == 0) begin = now;
    return (now.tv_sec - begin.tv_sec) * 1000 + (now.tv_nsec - begin.tv_nsec) / 1000000;
}

static void after(unsigned pause, void (*act)(void)) {
    if (fork() != 0) return;
    usleep(pause * 1000);
    act();
    exit(0);
}

static int queue, set, file;
static mqd_t mailbox;
static int lines[2];
static void send_message(void) {
    const struct {
        long kind;
        char text[4];
    } message = {1, "abc"};
    if (msgsnd(queue, &message, 4, 0) != 0) exit(1);
}
static void lift(void) {
    struct sembuf up = {0, 1, 0};
    if (semop(set, &up, 1) != 0) exit(1);
}
static void post(void) {
    if (mq_send(mailbox, "x", 1, 0) != 0) exit(1);
}
static void pour(void) {
    if (write(lines[1], "y", 1) != 1) exit(1);
}

/* A child holds the lock for 100 ms. */
static void hold(int kind) {
    if (fork() != 0) {
        usleep(10000);
        return;
    }
    file = open("lockfile", O_RDWR | O_CREAT, 0600);
    struct flock lock = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
    if (kind == 0 ? flock(file, LOCK_EX) != 0 : fcntl(file, F_SETLK, &lock) != 0) exit(1);
    usleep(100000);
    exit(0);
}

/* The result first: the time is when the call came back. */
static void report(const char* call, long result) {
    printf("%s %ld at %ld\n", call, result, milliseconds());
}

static void waits(void) {
    char text[64];
    int status;
    milliseconds();
    file = open("lockfile", O_RDWR | O_CREAT, 0600);
    hold(0);
    printf("flock at once %d\n", flock(file, LOCK_EX | LOCK_NB));
    report("flock", flock(file, LOCK_EX));
    flock(file, LOCK_UN);
    hold(1);
    report("lockf", lockf(file, F_LOCK, 0));
    lockf(file, F_ULOCK, 0);
    queue = msgget(IPC_PRIVATE, 0600);
    set = semget(IPC_PRIVATE, 1, 0600);
    struct {
        long kind;
        char text[8];
    } message;
    after(100, send_message);
    report("msgrcv", msgrcv(queue, &message, 8, 0, 0));
    struct sembuf down = {0, -1, 0};
    after(100, lift);
    report("semop", semop(set, &down, 1));
    const struct timespec brief = {0, 50000000};
    const int late = semtimedop(set, &down, 1, &brief) == -1 && errno == EAGAIN;
    report("semtimedop too late", late);
    msgctl(queue, IPC_RMID, NULL);
    semctl(set, 0, IPC_RMID);
    struct mq_attr attributes = {.mq_maxmsg = 2, .mq_msgsize = 8};
    sprintf(text, "/puckloop-test-%ld", (long)time(NULL) * 1000 + getpid());
    mailbox = mq_open(text, O_RDWR | O_CREAT, 0600, &attributes);
    if (mailbox != (mqd_t)-1) {
        mq_unlink(text);
        after(100, post);
        report("mq_receive", mq_receive(mailbox, text, 8, NULL));
    }
    int out[2];
    if (pipe(lines) != 0 || pipe(out) != 0) exit(1);
    after(100, pour);
    report("splice", splice(lines[0], NULL, out[1], NULL, 1, 0));
    printf("raise %d, kill %d: goes on\n", raise(SIGSTOP), kill(getpid(), SIGSTOP));
    while (wait(&status) > 0)
        if (status != 0) printf("a child ended with %d\n", status);
}

/* A process's folder in /proc, by its number: whether it is there, by several calls that must agree. */
static int has_folder(pid_t process) {
    char path[40];
    struct stat status;
    sprintf(path, "/proc/%d", (int)process);
    const int there = access(path, F_OK) == 0;
    if ((stat(path, &status) == 0) != there) printf("stat %s\n", path), ++failures;
    DIR* folder = opendir(path);
    if ((folder != NULL) != there) printf("opendir %s\n", path), ++failures;
    if (folder != NULL) closedir(folder);
    strcat(path, "/stat");
    FILE* file_of = fopen(path, "r");
    if ((file_of != NULL) != there) printf("fopen %s\n", path), ++failures;
    if (file_of != NULL) fclose(file_of);
    return there;
}

static void expect_folder(const char* whose, pid_t process, int wanted) {
    if (has_folder(process) != wanted) printf("/proc of %s %d\n", whose, (int)process), ++failures;
}

static void folders(pid_t child) {
    char own[200] = "", mine[200] = "", path[40];
    sprintf(path, "/proc/%d/exe", (int)getpid());
    if (readlink("/proc/self/exe", own, sizeof own - 1) < 1 || readlink(path, mine, sizeof mine - 1) < 1 ||
        strcmp(own, mine) != 0)
        printf("%s is %s, not %s\n", path, mine, own), ++failures;
    expect_folder("this process", getpid(), 1);
    expect_folder("its child", child, 1);
    expect_folder("init", 1, 0); /* the host's */
    expect_folder("nobody", 30000, 0);
}

int main(int count_of_words, char** words) {
    setvbuf(stdout, NULL, _IOLBF, 0);
    if (count_of_words > 2) {
        try_all((pid_t)atoi(words[2]), 1);
        expect_folder("a stranger", (pid_t)atoi(words[2]), 0);
    } else if (strcmp(words[1], "wait") == 0) {
        waits();
        return 0;
    } else {
        signal(SIGUSR1, count);
        try_all(getpid(), 0);
        const union sigval value = {7};
        sigqueue(getpid(), SIGUSR1, value);
        tgkill(getpid(), (pid_t)syscall(SYS_gettid), SIGUSR1);
        if (heard != 2) printf("heard %d\n", (int)heard), ++failures;
        if (getpriority(PRIO_PROCESS, 0) != 3) printf("nice %d\n", getpriority(PRIO_PROCESS, 0)), ++failures;
        const pid_t child = fork();
        if (child == 0) {
            pause();
            exit(1);
        }
        usleep(1000);
        try_all(child, 0);
        folders(child);
        int status = 0;
        sigqueue(child, SIGTERM, value);
        waitpid(child, &status, 0);
        if (!WIFSIGNALED(status) || WTERMSIG(status) != SIGTERM)
            printf("child %x\n", (unsigned)status), ++failures;
    }
    printf("failures %d\n", failures);
    return failures != 0;
}
