/* Sleeps <count> times <microseconds>, then prints how long that took by its own clock. */
#include "serial.h"
#include <sys/time.h>

int main(int argc, char** argv) {
    if (argc < 3) return 5;
    int fd = open_serial(1, 0);
    struct timeval start, end;
    gettimeofday(&start, NULL);
    for (int i = 0; i < atoi(argv[1]); i++)
        usleep((useconds_t)atoi(argv[2]));
    gettimeofday(&end, NULL);
    printf("%ld\n", (end.tv_sec - start.tv_sec) * 1000000L + end.tv_usec - start.tv_usec);
    close(fd);
    return 0;
}
