/* Prints how long sleeps took by the clocks, in microseconds, and writes one byte a period. */
#include "serial.h"
#include <sys/select.h>
#include <sys/time.h>
#include <time.h>

static long long microseconds(void) {
    struct timeval t;
    gettimeofday(&t, NULL);
    return t.tv_sec * 1000000LL + t.tv_usec;
}

int main(void) {
    int fd = open_serial(1, 0);
    struct timespec ms20 = {0, 20 * 1000 * 1000};
    struct timeval ms30 = {0, 30 * 1000};
    fd_set set;
    char host[30];
    gethostname(host, sizeof host);
    printf("host %s\n", host);
    for (int i = 0; i < 5; i++) {
        long long start = microseconds();
        usleep(10000);
        long long a = microseconds();
        nanosleep(&ms20, NULL);
        long long b = microseconds();
        FD_ZERO(&set);
        FD_SET(fd, &set);
        struct timeval left = ms30;
        int ready = select(fd + 1, &set, NULL, NULL, &left);
        long long c = microseconds();
        printf("%lld %lld %lld %d\n", a - start, b - a, c - b, ready);
        if (write(fd, &i, 1) != 1) return 4;
    }
    struct timespec mono;
    clock_gettime(CLOCK_MONOTONIC, &mono);
    printf("mono %ld, wall %ld\n", (long)mono.tv_sec, (long)time(NULL));
    return 0;
}
