/* What a program finds of its computer, and ways to wait that the C library has beside POSIX's; named by the
   argument. Times in milliseconds since the start. */
#define _GNU_SOURCE
#include "serial.h"
#include <dirent.h>
#include <errno.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/sysinfo.h>
#include <sys/uio.h>
#include <sys/xattr.h>
#include <threads.h>
#include <time.h>

static struct timespec origin;
static long ms(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (t.tv_sec - origin.tv_sec) * 1000L + (t.tv_nsec - origin.tv_nsec) / 1000000L;
}

/* --- threads of C11 */

static mtx_t mutex;
static cnd_t condition;
static int ready;
static once_flag once = ONCE_FLAG_INIT;
static void begin(void) {
    printf("once\n");
}

static int work(void *argument) {
    call_once(&once, begin);
    struct timespec time = {0, *(long *)argument * 1000000L};
    const int slept = thrd_sleep(&time, NULL);
    printf("slept %d at %ld\n", slept, ms());
    mtx_lock(&mutex);
    ready++;
    cnd_broadcast(&condition);
    mtx_unlock(&mutex);
    return 5;
}

static void c11(void) {
    mtx_init(&mutex, mtx_timed);
    cnd_init(&condition);
    thrd_t threads[2];
    long times[2] = {30, 70};
    for (int i = 0; i < 2; i++)
        if (thrd_create(&threads[i], work, &times[i]) != thrd_success) exit(4);
    mtx_lock(&mutex);
    while (ready < 2)
        cnd_wait(&condition, &mutex);
    printf("ready at %ld\n", ms());
    struct timespec limit;
    timespec_get(&limit, TIME_UTC);
    limit.tv_nsec += 20000000L;
    limit.tv_sec += limit.tv_nsec / 1000000000L;
    limit.tv_nsec %= 1000000000L;
    const int timed_out = cnd_timedwait(&condition, &mutex, &limit) == thrd_timedout;
    printf("timed out %d at %ld\n", timed_out, ms());
    mtx_unlock(&mutex);
    int result = 0;
    thrd_join(threads[0], &result);
    thrd_join(threads[1], NULL);
    printf("joined %d at %ld\n", result, ms());
}

/* --- signals of threads */

static pthread_t main_thread;
static void on_signal(int number) {
    printf("signal %d in the %s at %ld\n", number, pthread_equal(pthread_self(), main_thread) ? "first" : "other",
           ms());
}

static void *sleeper(void *argument) {
    (void)argument;
    struct timespec time = {1, 0};
    const int result = nanosleep(&time, NULL);
    printf("woken %d at %ld\n", result != 0 && errno == EINTR, ms());
    return NULL;
}

static void *sender(void *argument) {
    (void)argument;
    usleep(20000);
    kill(getpid(), SIGUSR2);
    usleep(20000);
    return NULL;
}

static void signals(void) {
    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_handler = on_signal;
    sigaction(SIGUSR1, &action, NULL);
    sigaction(SIGUSR2, &action, NULL);
    main_thread = pthread_self();
    pthread_t thread;
    pthread_create(&thread, NULL, sleeper, NULL);
    usleep(30000);
    const int killed = pthread_kill(thread, SIGUSR1);
    printf("killed %d at %ld\n", killed, ms());
    pthread_join(thread, NULL);

    /* One for the process, from another thread: the first takes it. */
    pthread_create(&thread, NULL, sender, NULL);
    struct timespec time = {1, 0};
    const int interrupted = nanosleep(&time, NULL) != 0;
    printf("interrupted %d at %ld\n", interrupted, ms());
    pthread_join(thread, NULL);

    /* The first blocks it: the other one takes it. */
    sigset_t set, before;
    sigemptyset(&set);
    sigaddset(&set, SIGUSR1);
    pthread_create(&thread, NULL, sleeper, NULL);
    usleep(10000);
    pthread_sigmask(SIG_BLOCK, &set, &before);
    kill(getpid(), SIGUSR1);
    pthread_join(thread, NULL);

    /* All block it: it is kept, ends no sleep, and is there when it is waited for. */
    kill(getpid(), SIGUSR1);
    usleep(10000);
    int number = 0;
    sigwait(&set, &number);
    printf("waited for %d at %ld\n", number == SIGUSR1, ms());
    raise(SIGUSR1);
    printf("unblocking\n");
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    alarm(1);
    signal(SIGALRM, on_signal);
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"
    sigpause(SIGALRM);
#pragma GCC diagnostic pop
    printf("paused until %ld\n", ms());
}

/* --- the computer */

static void show(const char *path) {
    char text[512] = "";
    const int fd = open(path, O_RDONLY);
    const ssize_t size = read(fd, text, sizeof text - 1);
    text[size > 0 ? size : 0] = '\0';
    text[strcspn(text, "\n")] = '\0';
    printf("%s: %s\n", path, text);
    close(fd);
}

static void follow(const char *path) {
    char target[128] = "";
    if (readlink(path, target, sizeof target - 1) < 0) snprintf(target, sizeof target, "%s", strerror(errno));
    printf("%s -> %s\n", path, target);
}

static void list(const char *path, const char *only) {
    DIR *folder = opendir(path);
    printf("%s:", path);
    for (struct dirent *entry = NULL; (entry = readdir(folder)) != NULL;)
        if (entry->d_name[strspn(entry->d_name, "0123456789")] == '\0' ||
            (only != NULL && strncmp(entry->d_name, only, strlen(only)) == 0))
            printf(" %s", entry->d_name);
    printf("\n");
    closedir(folder);
}

static void computer(int serial) {
    for (int i = 0; i < 200; i++)
        ms(); /* 200 calls of 1 us */
    usleep(500000);
    show("/proc/uptime");
    show("/proc/loadavg");
    show("/proc/self/stat");
    show("/proc/1000/stat");
    show("/proc/sys/kernel/hostname");
    show("/proc/sys/kernel/random/boot_id");
    show("/proc/sys/kernel/random/uuid");
    follow("/proc/self");
    char name[40];
    snprintf(name, sizeof name, "/proc/self/fd/%d", serial);
    follow(name);
    list("/proc", NULL);
    list("/dev", "i2c-");
    list("/proc/self/fd", NULL);
    struct sysinfo info;
    sysinfo(&info);
    printf("up %ld s, %u process, processor %d\n", info.uptime, info.procs, sched_getcpu());
    char list_of[10];
    printf("attributes %zd", listxattr("/dev/i2c-3", list_of, sizeof list_of));
    printf(" %zd", getxattr("/dev/i2c-3", "user.a", list_of, sizeof list_of));
    printf(" %s\n", strerror(errno));
    char byte = 0;
    struct iovec part = {&byte, 1};
    printf("preadv2 %zd", preadv64v2(serial, &part, 1, 0, 0));
    printf(" %s\n", strerror(errno));
}

int main(int count, char **words) {
    setvbuf(stdout, NULL, _IOLBF, 0);
    clock_gettime(CLOCK_MONOTONIC, &origin);
    const int serial = open_serial(1, 0);
    const char *how = count > 1 ? words[1] : "";
    if (strcmp(how, "c11") == 0) c11();
    if (strcmp(how, "signals") == 0) signals();
    if (strcmp(how, "computer") == 0) computer(serial);
    if (strcmp(how, "leave") == 0 || strcmp(how, "close") == 0 || strcmp(how, "die") == 0) {
        char bytes[300];
        memset(bytes, 'x', sizeof bytes);
        if (write(serial, bytes, sizeof bytes) != sizeof bytes) return 4;
        if (how[0] == 'c') {
            const int copy = dup(serial);
            close(serial);
            printf("a copy is open at %ld\n", ms());
            close(copy);
            printf("closed at %ld\n", ms());
        }
        if (how[0] == 'd') abort();
    }
    return 0;
}
