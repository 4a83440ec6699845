/* A Linux program that does what its first argument states. It knows of no emulator. */
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void talk(void) {
    int port = open("/dev/ttyS0", O_RDWR);
    for (int i = 0; i < 5; ++i) {
        if (write(port, "N", 1) != 1) exit(9);
        usleep(100000);
    }
}

int main(int count, char** words) {
    const char* what = count > 1 ? words[1] : "";
    if (strcmp(what, "crash") == 0) {
        talk();
        printf("now I crash\n");
        fflush(stdout);
        volatile int* nowhere = 0;
        *nowhere = 1;
    }
    if (strcmp(what, "colours") == 0) {
        printf("\033[31;1mmotor \033[4m3\033[0m is hot\033[K\r\n\033]0;title\007\n\033[0m\033[0m\n");
        return 3;
    }
    if (strcmp(what, "done") == 0) talk();
    if (strcmp(what, "exit") == 0) return count > 2 ? atoi(words[2]) : 0;
    if (strcmp(what, "sleep") == 0)
        for (;;)
            usleep(100000);
    if (strcmp(what, "spin") == 0)
        for (volatile unsigned n = 0;; n = n + 1) {
        }
    return 0;
}
