/* Calls on the serial port and the clock in an order drawn from a seed; every result and its time are
   printed. jumble SEED CALLS alone|threads|family [i2c] */
#define _GNU_SOURCE
#include "serial.h"
#include <errno.h>
#include <linux/i2c-dev.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdint.h>
#include <sys/ioctl.h>
#include <sys/select.h>
#include <sys/wait.h>
#include <time.h>

static int waits, looks, bus = -1; /* the port twice, the second time with O_NONBLOCK; the I2C adapter */
static int calls;
static volatile sig_atomic_t alarms;

struct player {
    const char* name;
    uint64_t seed;
    int changes_settings;
};

static unsigned draw(struct player* me, unsigned below) {
    me->seed = me->seed * 6364136223846793005u + 1442695040888963407u;
    return (unsigned)(me->seed >> 33) % below;
}

static void on_alarm(int number) {
    alarms += number != 0;
    if (write(looks, "!", 1) != 1) alarms += 1000;
}

static void show(struct player* me, const char* what, long result, const char* bytes) {
    const int error = errno;
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    printf("%s %ld.%09ld %s %ld", me->name, (long)t.tv_sec, t.tv_nsec, what, result);
    if (result < 0) printf(" %s", strerror(error));
    for (long i = 0; bytes != NULL && i < result; i++)
        printf(" %02x", (unsigned char)bytes[i]);
    printf(" alarms %d\n", (int)alarms);
}

static void set_up(struct player* me) {
    struct termios t;
    tcgetattr(waits, &t);
    cfmakeraw(&t);
    t.c_cc[VMIN] = (cc_t)draw(me, 4);
    t.c_cc[VTIME] = (cc_t)draw(me, 2);
    if (draw(me, 5) == 0) t.c_lflag |= ICANON;
    if (draw(me, 5) == 0) t.c_oflag |= OPOST | ONLCR;
    show(me, "tcsetattr", tcsetattr(waits, TCSANOW, &t), NULL);
}

static void one_call(struct player* me) {
    char bytes[2000];
    memset(bytes, 'a' + (int)draw(me, 20), sizeof bytes);
    if (draw(me, 6) == 0) bytes[2] = '\n';
    const size_t few = 1 + draw(me, 40);
    int number = 0;
    struct pollfd both[2] = {{waits, POLLIN, 0}, {looks, draw(me, 2) ? POLLOUT : POLLIN, 0}};
    switch (draw(me, 24)) {
    case 0:
    case 1:
    case 2:
        return show(me, "read", read(looks, bytes, few), bytes);
    case 3:
    case 4:
        /* a wait that ends: 3 ms, then only what is there */
        number = poll(both, 1, 3);
        show(me, "poll", number, NULL);
        if (number == 1 && draw(me, 4) != 0) show(me, "read", read(looks, bytes, few), bytes);
        return;
    case 5:
    case 6:
        return show(me, "look", poll(both, 1 + draw(me, 2), 0), NULL);
    case 7:
    case 8:
    case 9:
        return show(me, "usleep", usleep(draw(me, 300)), NULL);
    case 10:
    case 11:
    case 12:
        return show(me, "write", write(draw(me, 2) ? waits : looks, bytes, few), NULL);
    case 13:
        ioctl(waits, FIONREAD, &number);
        return show(me, "queue", number, NULL);
    case 14:
        ioctl(waits, TIOCOUTQ, &number);
        return show(me, "unsent", number, NULL);
    case 15:
        return draw(me, 4) ? (void)0 : show(me, "drain", tcdrain(waits), NULL);
    case 16:
        return draw(me, 6) ? (void)0 : show(me, "flush", tcflush(waits, TCIFLUSH), NULL);
    case 17:
        ualarm(1 + draw(me, 900), 0);
        return;
    case 18: {
        fd_set set;
        FD_ZERO(&set);
        FD_SET(waits, &set);
        struct timeval time = {0, draw(me, 500)};
        return show(me, "select", select(waits + 1, &set, NULL, NULL, &time), NULL);
    }
    case 19:
        return draw(me, 8) ? (void)0 : show(me, "long write", write(waits, bytes, sizeof bytes), NULL);
    case 20:
        if (me->changes_settings && draw(me, 3) == 0) set_up(me);
        return;
    case 21:
        return draw(me, 3) ? (void)0 : show(me, "yield", sched_yield(), NULL);
    case 22:
        if (bus < 0) return;
        ioctl(bus, I2C_SLAVE, 0x60);
        bytes[0] = (char)draw(me, 6);
        if (write(bus, bytes, 1) == 1) show(me, "register", read(bus, bytes, 1), bytes);
        return;
    default:
        return show(me, "clock", 0, NULL);
    }
}

static void* play(void* argument) {
    for (int i = 0; i < calls; i++)
        one_call(argument);
    return NULL;
}

int main(int argc, char** argv) {
    if (argc < 4) return 2;
    struct player first = {"a", (uint64_t)atol(argv[1]), 1}, second = {"b", first.seed + 77, 0};
    calls = atoi(argv[2]);
    waits = open_serial(0, 1);
    looks = open("/dev/ttyS0", O_RDWR | O_NOCTTY | O_NONBLOCK);
    if (argc > 4) bus = open("/dev/i2c-3", O_RDWR);
    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_handler = on_alarm;
    action.sa_flags = draw(&first, 2) ? SA_RESTART : 0;
    sigaction(SIGALRM, &action, NULL);
    sigaction(SIGUSR1, &action, NULL);
    pthread_t thread;
    pid_t child = -1;
    if (strcmp(argv[3], "threads") == 0) pthread_create(&thread, NULL, play, &second);
    if (strcmp(argv[3], "family") == 0) {
        child = fork();
        if (child == 0) {
            play(&second);
            fflush(stdout);
            _exit(5);
        }
    }
    play(&first);
    if (strcmp(argv[3], "threads") == 0) pthread_join(thread, NULL);
    int status = 0;
    while (child > 0 && waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    /* what was written just before any kind of end still goes out */
    if (write(looks, "end", 3) != 3) printf("no room\n");
    const unsigned how = draw(&first, 3);
    if (how == 0) _exit(0);
    if (how == 1) raise(SIGKILL);
    return 0;
}
