/* One small use of each of the rarer ways to wait, named by the argument. Times in milliseconds. */
#include "serial.h"
#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdint.h>
#include <sys/epoll.h>
#include <sys/ioctl.h>
#include <sys/time.h>
#include <sys/timerfd.h>
#include <sys/wait.h>
#include <time.h>

static struct timespec origin;
static long ms(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (t.tv_sec - origin.tv_sec) * 1000L + (t.tv_nsec - origin.tv_nsec) / 1000000L;
}

static volatile sig_atomic_t alarms;
static void on_alarm(int number) {
    (void)number;
    alarms++;
}

static int timerfd_every(int milliseconds) {
    int fd = timerfd_create(CLOCK_MONOTONIC, 0);
    struct itimerspec every = {{0, milliseconds * 1000000L}, {0, milliseconds * 1000000L}};
    timerfd_settime(fd, 0, &every, NULL);
    return fd;
}

static void timers(int serial) {
    signal(SIGALRM, on_alarm);
    struct itimerval every = {{0, 7000}, {0, 7000}};
    setitimer(ITIMER_REAL, &every, NULL);
    for (int i = 0; i < 3; i++)
        pause();
    printf("alarms %d at %ld\n", (int)alarms, ms());
    memset(&every, 0, sizeof every);
    setitimer(ITIMER_REAL, &every, NULL);
    int timer = timerfd_every(10);
    uint64_t ticks = 0;
    if (read(timer, &ticks, sizeof ticks) != sizeof ticks) exit(4);
    printf("ticks %d at %ld\n", (int)ticks, ms());
    usleep(25000);
    if (read(timer, &ticks, sizeof ticks) != sizeof ticks) exit(4);
    printf("ticks %d at %ld\n", (int)ticks, ms());
    struct pollfd both[2] = {{serial, POLLIN, 0}, {timer, POLLIN, 0}};
    int ready = poll(both, 2, -1);
    printf("poll %d %d %d at %ld\n", ready, both[0].revents, both[1].revents, ms());
}

static void epolls(int serial) {
    int set = epoll_create1(0);
    int timer = timerfd_every(30);
    struct epoll_event event = {EPOLLIN, {.fd = serial}};
    epoll_ctl(set, EPOLL_CTL_ADD, serial, &event);
    event.data.fd = timer;
    epoll_ctl(set, EPOLL_CTL_ADD, timer, &event);
    for (int i = 0; i < 3; i++) {
        struct epoll_event got[4];
        int n = epoll_wait(set, got, 4, 100);
        printf("epoll %d %s at %ld\n", n, n < 1 ? "-" : got[0].data.fd == serial ? "serial" : "timer", ms());
        char buffer[16];
        if (n > 0 && read(got[0].data.fd, buffer, sizeof buffer) < 1) exit(4);
    }
}

/* Edge-triggered: what was reported is not again before something has changed. */
static void epoll_edges(int serial) {
    int set = epoll_create1(0);
    struct epoll_event event = {EPOLLIN | EPOLLOUT | EPOLLET, {.fd = serial}}, got;
    epoll_ctl(set, EPOLL_CTL_ADD, serial, &event);
    for (int i = 0; i < 5; i++) {
        int n = epoll_wait(set, &got, 1, 50);
        printf("edge %d %x at %ld\n", n, n < 1 ? 0 : (unsigned)got.events, ms());
        if (i == 2 && write(serial, "w", 1) != 1) exit(4);
    }
    int bus = open("/dev/i2c-3", O_RDWR);
    int added = epoll_ctl(set, EPOLL_CTL_ADD, bus, &event);
    printf("i2c %d %s\n", added, strerror(errno));
}

static int ends[2];
static void* pipe_writer(void* argument) {
    usleep(12000);
    if (write(ends[1], "p", 1) != 1) exit(4);
    return argument;
}

static void pipes(int serial) {
    pthread_t thread;
    char c = 0;
    if (pipe(ends) != 0) exit(4);
    pthread_create(&thread, NULL, pipe_writer, NULL);
    if (read(ends[0], &c, 1) != 1) exit(4);
    printf("pipe %c at %ld\n", c, ms());
    pthread_join(thread, NULL);
    pthread_create(&thread, NULL, pipe_writer, NULL);
    struct pollfd both[2] = {{serial, POLLIN, 0}, {ends[0], POLLIN, 0}};
    int ready = poll(both, 2, 50);
    printf("poll %d %d at %ld\n", ready, both[1].revents, ms());
    pthread_join(thread, NULL);
}

static pthread_barrier_t barrier;
static pthread_rwlock_t rwlock = PTHREAD_RWLOCK_INITIALIZER;
static pthread_once_t once = PTHREAD_ONCE_INIT;
static void slow_once(void) {
    usleep(5000);
    printf("once at %ld\n", ms());
}
static void* meets(void* argument) {
    usleep((useconds_t)(long)argument * 1000);
    pthread_once(&once, slow_once);
    pthread_rwlock_rdlock(&rwlock);
    usleep(3000);
    pthread_rwlock_unlock(&rwlock);
    int serial = pthread_barrier_wait(&barrier);
    if (serial == PTHREAD_BARRIER_SERIAL_THREAD) printf("barrier at %ld\n", ms());
    pthread_rwlock_wrlock(&rwlock);
    usleep(2000);
    pthread_rwlock_unlock(&rwlock);
    return argument;
}

static void locks(void) {
    pthread_t threads[3];
    pthread_barrier_init(&barrier, NULL, 3);
    for (long i = 0; i < 3; i++)
        pthread_create(&threads[i], NULL, meets, (void*)i);
    for (int i = 0; i < 3; i++)
        pthread_join(threads[i], NULL);
    printf("joined at %ld\n", ms());
    pthread_mutex_t mutex;
    pthread_mutexattr_t attributes;
    pthread_mutexattr_init(&attributes);
    pthread_mutexattr_settype(&attributes, PTHREAD_MUTEX_ERRORCHECK);
    pthread_mutex_init(&mutex, &attributes);
    int first = pthread_mutex_lock(&mutex);
    int second = pthread_mutex_lock(&mutex);
    printf("errorcheck %d %d\n", first, second == EDEADLK);
    struct timespec limit;
    clock_gettime(CLOCK_REALTIME, &limit);
    limit.tv_nsec += 4000000;
    pthread_mutex_t plain = PTHREAD_MUTEX_INITIALIZER;
    pthread_mutex_lock(&plain);
    int timed = pthread_mutex_timedlock(&plain, &limit);
    printf("timedlock %d at %ld\n", timed == ETIMEDOUT, ms());
}

static void streams(void) {
    FILE* port = fopen("/dev/ttyS0", "r+");
    char line[32];
    fprintf(port, "hello\n");
    if (fgets(line, sizeof line, port) == NULL) exit(4);
    printf("line %s", line);
    fclose(port);
}

static void children(void) {
    pid_t child = fork();
    if (child == 0) {
        int fd = open("/dev/ttyS0", O_RDWR);
        _exit(fd < 0 && errno == ENXIO ? 5 : 6);
    }
    int status = 0;
    waitpid(child, &status, 0);
    printf("child %d, system %d, pid %d\n", WEXITSTATUS(status), WEXITSTATUS(system("exit 3")),
           (int)getpid());
}

static void modem(int serial) {
    int waiting = -1, lines = 0;
    usleep(20000);
    ioctl(serial, FIONREAD, &waiting);
    ioctl(serial, TIOCMGET, &lines);
    printf("waiting %d, cts %d\n", waiting, (lines & TIOCM_CTS) != 0);
    tcflush(serial, TCIFLUSH);
    ioctl(serial, FIONREAD, &waiting);
    char data[100];
    memset(data, 'u', sizeof data);
    long start = ms();
    if (write(serial, data, sizeof data) != sizeof data) exit(4);
    long written = ms() - start;
    ioctl(serial, TIOCOUTQ, &lines);
    tcdrain(serial);
    printf("flushed %d, write took %ld, queue %d, drained after %ld\n", waiting, written, lines,
           ms() - start);
}

int main(int argc, char** argv) {
    const char* what = argc > 1 ? argv[1] : "";
    int serial = open_serial(1, 0);
    clock_gettime(CLOCK_MONOTONIC, &origin);
    if (strcmp(what, "timers") == 0) timers(serial);
    if (strcmp(what, "epoll") == 0) epolls(serial);
    if (strcmp(what, "epoll-edges") == 0) epoll_edges(serial);
    if (strcmp(what, "pipes") == 0) pipes(serial);
    if (strcmp(what, "locks") == 0) locks();
    if (strcmp(what, "streams") == 0) streams();
    if (strcmp(what, "children") == 0) children();
    if (strcmp(what, "modem") == 0) modem(serial);
    return 0;
}
