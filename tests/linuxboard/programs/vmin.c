/* Reads with VMIN and VTIME given as arguments and prints what came, and after how many ms. */
#include "serial.h"
#include <time.h>

static long ms(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec * 1000L + t.tv_nsec / 1000000L;
}

int main(int argc, char** argv) {
    if (argc < 3) return 5;
    int fd = open_serial(atoi(argv[1]), atoi(argv[2]));
    unsigned char buffer[64];
    long start = ms();
    for (int i = 0; i < 3; i++) {
        long n = read(fd, buffer, sizeof buffer);
        printf("%ld bytes at %ld ms\n", n, ms() - start);
    }
    fcntl(fd, F_SETFL, O_NONBLOCK);
    long n = read(fd, buffer, sizeof buffer);
    printf("nonblocking %ld\n", n);
    return 0;
}
